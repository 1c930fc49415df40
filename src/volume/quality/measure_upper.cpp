#include "measure_upper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "tetropolis/volume/quality/face_quality.h"

#include "cells_of.h"
#include "core/parallel.h"
#include "core/units.h"
#include "tet_cosines.h"
#include "volume/column/upper_faces.h"

namespace tetropolis {

namespace {

/// Far beyond the rounding of cosines and squares.
constexpr double kMargin = 1e-9;

using Corners = std::array<Point3, 4>;

/// The worst cells, worst first; of those as bad, the first.
class WorstCells {
 public:
  explicit WorstCells(std::size_t most) : most_(most) {}
  /// Whether a cell with these angles may be one of them.
  bool may_take(const TetCosines& shape) const {
    return most_ > 0 && (shape.greatest > least_ || shape.least < greatest_);
  }
  void add(WorstCell cell) {
    const auto worse = [](const WorstCell& a, const WorstCell& b) {
      return a.share_of_floor < b.share_of_floor;
    };
    if (most_ == 0 || (cells_.size() == most_ && !worse(cell, cells_.back()))) return;
    cells_.insert(std::upper_bound(cells_.begin(), cells_.end(), cell, worse), std::move(cell));
    if (cells_.size() > most_) cells_.pop_back();
    if (cells_.size() < most_) return;
    const AngleBounds bounds = angles_at(cells_.back().share_of_floor);
    least_ = std::cos(to_radians(bounds.least)) - kMargin;
    greatest_ = std::cos(to_radians(bounds.greatest)) + kMargin;
  }
  const std::vector<WorstCell>& cells() const { return cells_; }

 private:
  std::size_t most_;
  double least_ = -1 - kMargin, greatest_ = 1 + kMargin;  // cosines that others are beyond
  std::vector<WorstCell> cells_;
};

/// What some cells add to the figures.
struct CellSums {
  QualityHistogram histogram;
  FaultCounts faults;
  std::vector<WorstCell> worst;
  std::vector<double> volumes;  // per block
};

/// Degrees that are good by all that is asked.
AngleBounds good_by_all() {
  AngleBounds good{kLeastOfMost, 180};
  for (const AngleBounds& bounds : kAskedBounds)
    good = {std::max(good.least, bounds.least), std::min(good.greatest, bounds.greatest)};
  return good;
}

void add_cells(std::span<const Corners> cells, WorstCells& worst, CellSums& sums) {
  static const double good_least = std::cos(to_radians(good_by_all().least)) - kMargin;
  static const double good_greatest = std::cos(to_radians(good_by_all().greatest)) + kMargin;
  FaultCounts& faults = sums.faults;
  faults.cells += static_cast<std::int64_t>(cells.size());
  std::vector<double> greatest, aspect2;
  std::int64_t inverted = 0;
  double volume = 0;
  for (const Corners& p : cells) {
    const TetCosines shape = tet_cosines(p[0], p[1], p[2], p[3]);
    greatest.push_back(shape.greatest);
    aspect2.push_back(shape.aspect_ratio * shape.aspect_ratio);
    inverted += shape.volume > 0 ? 0 : 1;
    volume += shape.volume;
    sums.histogram.widen(shape.greatest, shape.least, shape.aspect_ratio);
    const bool is_good = shape.greatest < good_least && shape.least > good_greatest;
    if (is_good && !worst.may_take(shape)) continue;
    const double least_deg = angle_deg(shape.greatest), greatest_deg = angle_deg(shape.least);
    faults.thin += least_deg < kLeastOfMost ? 1 : 0;
    for (std::size_t i = 0; i < kAskedBounds.size(); ++i)
      faults.outside[i] +=
          least_deg < kAskedBounds[i].least || greatest_deg > kAskedBounds[i].greatest ? 1 : 0;
    worst.add({share_of_floor(least_deg, greatest_deg), least_deg, greatest_deg, centre_of(p),
               kNoTriangle, "change of size"});
  }
  sums.histogram.add(greatest, aspect2, inverted);
  sums.volumes.push_back(volume);
}

/// Of faces. Exact where a face may be the worst, or is about as far from orthogonal as is allowed.
class FaceSums {
 public:
  void add(const std::array<Point3, 3>& face, const Point3& c0, const Point3& c1) {
    ++faces_.faces;
    const Point3 n = cross(minus(face[1], face[0]), minus(face[2], face[0]));
    const Point3 d = minus(c1, c0);
    const double n_d = dot(n, d), dd = dot(d, d);
    const Point3 centre = {(face[0][0] + face[1][0] + face[2][0]) / 3,
                           (face[0][1] + face[1][1] + face[2][1]) / 3,
                           (face[0][2] + face[1][2] + face[2][2]) / 3};
    const Point3 to_centre = minus(centre, c0);
    const double share = dot(n, to_centre) / n_d;
    const Point3 skew = {to_centre[0] - share * d[0], to_centre[1] - share * d[1],
                         to_centre[2] - share * d[2]};
    const double ss = dot(skew, skew);
    double q2 = 0.04 * dd * ss;  // of skewness, the squared denominator
    for (const Point3& corner : face) {
      const double q = dot(skew, minus(corner, centre));
      q2 = std::max(q2, q * q);
    }
    if (n_d * n_d > straight2_ * (dot(n, n) * dd) && ss * ss < skewness2_ * q2) return;
    const FaceShape shape = face_shape(face, c0, c1);
    faces_.above_70 += shape.non_orthogonality_deg > kMostNonOrthogonal ? 1 : 0;
    worsen({shape.non_orthogonality_deg, shape.skewness});
  }
  void add_boundary(const std::array<Point3, 3>& face, const Point3& centre) {
    worsen({0, boundary_skewness(face, centre)});
  }
  void add(const FaceSums& other) {
    faces_.faces += other.faces_.faces;
    faces_.above_70 += other.faces_.above_70;
    worsen(other.faces_.worst);
  }
  const FaceQuality& quality() const { return faces_; }

 private:
  void worsen(const FaceShape& shape) {
    FaceShape& worst = faces_.worst;
    worst.non_orthogonality_deg =
        std::max(worst.non_orthogonality_deg, shape.non_orthogonality_deg);
    worst.skewness = std::max(worst.skewness, shape.skewness);
    const double degrees = std::min(worst.non_orthogonality_deg, kMostNonOrthogonal);
    straight2_ = std::pow(std::cos(to_radians(degrees)), 2) + kMargin;
    skewness2_ = worst.skewness * worst.skewness * (1 - kMargin);
  }
  FaceQuality faces_;
  double straight2_ = 2, skewness2_ = 0;
};

}  // namespace

void add_upper_quality(const ColumnMesh& mesh, std::size_t worst, MeshQuality& quality) {
  const UpperMesh& upper = mesh.upper;
  const auto corners = [&](const UpperMesh::Cell& cell) {
    const auto at = [&](std::size_t i) { return upper_position(mesh, cell[i]); };
    return Corners{at(0), at(1), at(2), at(3)};
  };
  const std::size_t cells = upper.cells();
  constexpr std::size_t kBlock = 16384;
  const std::size_t blocks = (cells + kBlock - 1) / kBlock;
  const std::size_t grain = grain_of_chunks(blocks, 16);  // each has a histogram
  std::vector<CellSums> sums((blocks + grain - 1) / grain);
  parallel_chunks(blocks, grain, [&](std::size_t block, std::size_t end) {
    CellSums& own = sums[block / grain];
    WorstCells own_worst(worst);
    std::vector<Corners> here;
    for (; block < end; ++block) {
      here.clear();
      upper.for_each_cell(block * kBlock, std::min((block + 1) * kBlock, cells),
                          [&](const UpperMesh::Cell& cell) { here.push_back(corners(cell)); });
      add_cells(here, own_worst, own);
    }
    own.worst = own_worst.cells();
  });
  WorstCells all(worst);
  for (const WorstCell& cell : quality.cells.worst) all.add(cell);
  for (const CellSums& part : sums) {
    quality.cells.histogram.merge(part.histogram);
    for (const double volume : part.volumes) quality.cells.histogram.add_volume(volume);
    quality.faults.cells += part.faults.cells;
    quality.faults.thin += part.faults.thin;
    for (std::size_t i = 0; i < kAskedBounds.size(); ++i)
      quality.faults.outside[i] += part.faults.outside[i];
    for (const WorstCell& cell : part.worst) all.add(cell);
  }
  quality.cells.worst = all.cells();

  const auto centre = [&](const UpperMesh::Cell& cell) { return centre_of(corners(cell)); };
  const auto points = [&](const std::array<UpperPlace, 3>& p) {
    const auto at = [&](std::size_t i) { return upper_position(mesh, p[i]); };
    return std::array<Point3, 3>{at(0), at(1), at(2)};
  };
  std::vector<FaceSums> parts(inner_face_chunks(mesh));
  visit_inner_faces(mesh, [&](std::size_t chunk, const InnerFace& face) {
    parts[chunk].add(points(face.places), centre(face.corners[0]), centre(face.corners[1]));
  });
  FaceSums faces;
  for (const FaceSums& part : parts) faces.add(part);
  visit_outer_faces(
      mesh, [&](std::size_t, const UpperMesh::Cell& cell, const std::array<UpperPlace, 3>& places,
                bool) { faces.add_boundary(points(places), centre(cell)); });
  const CellIndex first = cell_offsets(mesh)[mesh.triangle_count()];
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    if (!mesh.is_covered(t)) continue;
    const auto& v = mesh.ground.triangles[t];
    const auto above = static_cast<std::size_t>(upper.over_lid[t] - first);
    upper.for_each_cell(above, above + 1, [&](const UpperMesh::Cell& cell) {
      const auto end = [&](std::size_t i) { return UpperPlace(v[i].value()); };
      faces.add(points({end(0), end(1), end(2)}), centre_of(uppermost_cell(mesh, t)), centre(cell));
    });
  }
  FaceQuality& result = quality.faces;
  result.faces += faces.quality().faces;
  result.above_70 += faces.quality().above_70;
  result.worst = {
      std::max(result.worst.non_orthogonality_deg, faces.quality().worst.non_orthogonality_deg),
      std::max(result.worst.skewness, faces.quality().worst.skewness)};
}

}  // namespace tetropolis
