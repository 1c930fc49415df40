#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "core/ragged_builder.h"
#include "core/units.h"
#include "vector3.h"
#include "violations.h"
#include "volume_parts.h"

namespace tetropolis {

namespace {

/// A cell's vertices in ascending order, and whether an even permutation brings them there.
struct SortedCell {
  std::array<std::int64_t, 4> v;
  bool even = true;

  explicit SortedCell(const std::array<std::int64_t, 4>& cell) : v(cell) {
    order(0, 1);
    order(2, 3);
    order(0, 2);
    order(1, 3);
    order(1, 2);
  }

 private:
  void order(std::size_t i, std::size_t j) {
    const bool wrong = v[j] < v[i];
    const std::int64_t low = wrong ? v[j] : v[i], high = wrong ? v[i] : v[j];
    v[i] = low;
    v[j] = high;
    even = even != wrong;
  }
};

/// A face of a cell, seen from its lowest vertex.
struct FaceUse {
  std::uint64_t others;  ///< Its other vertices, the lower in the upper half.
  std::uint32_t cell;    ///< Position in the row of cells.
  bool ascending;        ///< Whether (lowest, mid, high) is the outward orientation.

  std::int64_t mid() const { return static_cast<std::int64_t>(others >> 32); }
  std::int64_t high() const { return static_cast<std::int64_t>(others & 0xffffffffU); }
};

/// Non-orthogonality and skewness as in OpenFOAM's primitiveMeshTools: `a`, `b` are the centres of
/// the cells, the face (p, q, r) is outward of the first.
void measure_face(const Vector3& p, const Vector3& q, const Vector3& r, const Vector3& a,
                  const Vector3& b, FaceSums& sums) {
  const Vector3 normal = cross(difference(q, p), difference(r, p));
  const Vector3 line = difference(b, a);
  const double along = dot(normal, line), line2 = dot(line, line);
  const double cosine = along / std::sqrt(dot(normal, normal) * line2);
  sums.add_cosine(cosine);
  const Vector3 centre = centre_of(p, q, r);
  const Vector3 to_centre = difference(centre, a);
  const double share = dot(normal, to_centre) / along;
  const Vector3 skew = less(to_centre, share, line);
  // The face's extent from its centre along the skewness vector, times that vector's length.
  const double offset = dot(skew, centre), skew2 = dot(skew, skew);
  const double extent =
      std::max({0.2 * std::sqrt(line2 * skew2), std::abs(dot(skew, p) - offset),
                std::abs(dot(skew, q) - offset), std::abs(dot(skew, r) - offset)});
  if (skew2 > sums.skewness * extent) sums.skewness = skew2 / extent;
}

/// Skewness of a face (p, q, r) on the boundary of a cell with its centre at `a`, as in
/// primitiveMeshTools::boundaryFaceSkewness.
void measure_boundary_face(const Vector3& p, const Vector3& q, const Vector3& r, const Vector3& a,
                           FaceSums& sums) {
  const Vector3 normal = cross(difference(q, p), difference(r, p));
  const double normal2 = dot(normal, normal);
  const Vector3 centre = centre_of(p, q, r);
  const Vector3 to_centre = difference(centre, a);
  const double height = dot(normal, to_centre) / normal2;
  const Vector3 skew = less(to_centre, height, normal);
  const double off = length(skew);
  if (!(off > 0)) return;
  double extent = 0.4 * std::abs(height) * std::sqrt(normal2);
  for (const Vector3& corner : {p, q, r})
    extent = std::max(extent, std::abs(dot(skew, difference(corner, centre))) / off);
  sums.skewness = std::max(sums.skewness, off / extent);
}

/// What a range of lowest vertices brings.
struct Matched {
  std::vector<std::array<std::int64_t, 3>> boundary;
  std::vector<Violation> violations;
  FaceSums sums;
};

/// Matches the faces of one lowest vertex after another; keeps its buffers.
class FaceMatcher {
 public:
  /// `prism_rows`: of `prisms` by their lowest vertex.
  FaceMatcher(const TetMesh& mesh, const RaggedArray<std::uint32_t>& rows,
              const std::vector<WedgeTriangle>& prisms,
              const RaggedArray<std::uint32_t>& prism_rows)
      : mesh_(mesh), rows_(rows), prisms_(prisms), prism_rows_(prism_rows) {}

  void match(std::int64_t low, Matched& matched) {
    collect(low);
    std::sort(faces_.begin(), faces_.end(), [](const FaceUse& a, const FaceUse& b) {
      return a.others != b.others ? a.others < b.others : a.cell < b.cell;
    });
    const auto cells = rows_[static_cast<std::size_t>(low)];
    const auto of_prisms = prism_rows_[static_cast<std::size_t>(low)];
    for (std::size_t i = 0, j = 0; i < faces_.size(); i = j) {
      const FaceUse& face = faces_[i];
      while (j < faces_.size() && faces_[j].others == face.others) ++j;
      const auto place = [&] {
        return face.cell < cells.size()
                   ? place_of(mesh_, cells[face.cell])
                   : place_of_wedge(mesh_, prisms_[of_prisms[face.cell - cells.size()]].wedge);
      };
      if (j - i == 1) {
        matched.boundary.push_back(face.ascending
                                       ? std::array<std::int64_t, 3>{low, face.mid(), face.high()}
                                       : std::array<std::int64_t, 3>{low, face.high(), face.mid()});
        measure_boundary_face(point(low), point(face.mid()), point(face.high()),
                              centres_[face.cell], matched.sums);
      } else if (j - i > 2)
        note_violation(matched.violations, "faces of more than two cells", place);
      else if (face.ascending == faces_[i + 1].ascending)
        note_violation(matched.violations, "neighbouring cells that overlap", place);
      else
        measure(low, face.ascending ? face : faces_[i + 1], face.ascending ? faces_[i + 1] : face,
                matched.sums);
    }
  }

 private:
  /// The faces whose lowest vertex is `low`. Its row has the cells of which it is the lowest vertex
  /// (three such faces) or the second lowest (one).
  void collect(std::int64_t low) {
    faces_.clear();
    centres_.clear();
    for (const std::uint32_t c : rows_[static_cast<std::size_t>(low)]) {
      const SortedCell cell(mesh_.cells[c]);
      const auto own = static_cast<std::uint32_t>(centres_.size());
      const auto& v = cell.v;
      if (v[0] == low) {
        faces_.push_back({pair_of(v[1], v[2]), own, !cell.even});
        faces_.push_back({pair_of(v[1], v[3]), own, cell.even});
        faces_.push_back({pair_of(v[2], v[3]), own, !cell.even});
      } else {
        faces_.push_back({pair_of(v[2], v[3]), own, cell.even});
      }
      centres_.push_back(centre_of(point(v[0]), point(v[1]), point(v[2]), point(v[3])));
    }
    for (const std::uint32_t f : prism_rows_[static_cast<std::size_t>(low)]) {
      const auto& [lowest, a, b] = prisms_[f].corners;
      faces_.push_back({pair_of(std::min(a, b), std::max(a, b)),
                        static_cast<std::uint32_t>(centres_.size()), a < b});
      centres_.push_back(prisms_[f].centre);
    }
  }

  static std::uint64_t pair_of(std::int64_t mid, std::int64_t high) {
    return static_cast<std::uint64_t>(mid) << 32 | static_cast<std::uint64_t>(high);
  }

  void measure(std::int64_t low, const FaceUse& from, const FaceUse& to, FaceSums& sums) const {
    measure_face(point(low), point(from.mid()), point(from.high()), centres_[from.cell],
                 centres_[to.cell], sums);
  }

  const Vector3& point(std::int64_t v) const { return mesh_.points[static_cast<std::size_t>(v)]; }

  const TetMesh& mesh_;
  const RaggedArray<std::uint32_t>& rows_;
  const std::vector<WedgeTriangle>& prisms_;
  const RaggedArray<std::uint32_t>& prism_rows_;
  std::vector<FaceUse> faces_;
  std::vector<Vector3> centres_;
};

void add(FaceSums& a, const FaceSums& b) {
  a.faces += b.faces;
  a.above_70 += b.above_70;
  a.cosines += b.cosines;
  a.least_cosine = std::min(a.least_cosine, b.least_cosine);
  a.skewness = std::max(a.skewness, b.skewness);
}

double acos_deg(double cosine) { return to_degrees(std::acos(std::clamp(cosine, -1.0, 1.0))); }

}  // namespace

void FaceSums::add_cosine(double cosine) {
  static const double cosine_of_70 = std::cos(to_radians(70));
  ++faces;
  cosines += cosine;
  least_cosine = std::min(least_cosine, cosine);
  if (!(cosine >= cosine_of_70)) ++above_70;
}

void match_faces(const TetMesh& mesh, VolumeCheck& check, const Progress& progress) {
  // A cell is filed under its two lowest vertices: one of them is the lowest of each of its faces.
  const RaggedArray<std::uint32_t> rows =
      file_under_rows(mesh.cells.size(), mesh.points.size(), [&](std::size_t c, const auto& use) {
        const SortedCell cell(mesh.cells[c]);
        use(static_cast<std::size_t>(cell.v[0]));
        if (cell.v[1] != cell.v[0]) use(static_cast<std::size_t>(cell.v[1]));
      });
  const std::vector<WedgeTriangle> prisms = wedge_triangles(mesh);
  const RaggedArray<std::uint32_t> prism_rows = file_under_rows(
      prisms.size(), mesh.points.size(),
      [&](std::size_t f, const auto& use) { use(static_cast<std::size_t>(prisms[f].corners[0])); });
  constexpr std::size_t kGrain = 1024, kBatch = 64 * kGrain;
  FaceSums sums;
  for (std::size_t start = 0; start < rows.size(); start += kBatch) {
    progress.update(0.5 + 0.5 * static_cast<double>(start) / static_cast<double>(rows.size()));
    const std::size_t size = std::min(kBatch, rows.size() - start);
    std::vector<Matched> parts((size + kGrain - 1) / kGrain);
    parallel_chunks(size, kGrain, [&](std::size_t begin, std::size_t end) {
      FaceMatcher matcher(mesh, rows, prisms, prism_rows);
      for (std::size_t low = start + begin; low < start + end; ++low)
        matcher.match(static_cast<std::int64_t>(low), parts[begin / kGrain]);
    });
    for (const Matched& part : parts) {
      check.boundary.insert(check.boundary.end(), part.boundary.begin(), part.boundary.end());
      add_violations(check.violations, part.violations);
      add(sums, part.sums);
    }
  }
  match_quads(mesh, sums, check);
  check.boundary_faces =
      static_cast<std::int64_t>(check.boundary.size() + check.boundary_quads.size());
  check.faces.internal = sums.faces;
  check.faces.max_skewness = sums.skewness;
  if (sums.faces == 0) return;
  check.faces.above_70 = sums.above_70;
  check.faces.max_non_orthogonality_deg = acos_deg(sums.least_cosine);
  check.faces.mean_non_orthogonality_deg = acos_deg(sums.cosines / static_cast<double>(sums.faces));
}

}  // namespace tetropolis
