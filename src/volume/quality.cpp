#include "tetropolis/volume/quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

#include "tetropolis/core/parallel.h"

#include "tet_cosines.h"

namespace tetropolis {

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kBinsPerDegree = 100;
constexpr std::size_t kDihedralBins = 7200;  // the least dihedral angle is at most 70.53 degrees
constexpr double kAspectBase = 1.001;        // bin i starts at aspect ratio 1.001^i
constexpr std::size_t kAspectBins = 16000;   // up to 8.8e6

/// Bin whose cumulated count first reaches `fraction` of the total.
std::size_t quantile_bin(const std::vector<std::int64_t>& bins, std::int64_t total,
                         double fraction) {
  const double wanted = std::max(1.0, std::ceil(fraction * static_cast<double>(total)));
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    sum += bins[i];
    if (static_cast<double>(sum) >= wanted) return i;
  }
  return bins.size() - 1;
}

double angle_deg(double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)) * kDegrees; }

/// Finds the bin of a value: a guide table leads near it (Chen & Asau, On generating random
/// variates from an empirical distribution, 1974), comparing with the bounds does the rest.
class BinFinder {
 public:
  /// Bin i is [bounds[i], bounds[i + 1]), ascending; the last one has no end. The guide covers
  /// values up to `guided` in steps of 1 / `per_unit`.
  BinFinder(std::vector<double> bounds, double guided, double per_unit)
      : bounds_(std::move(bounds)), per_unit_(per_unit) {
    const auto steps = static_cast<std::size_t>((guided - bounds_.front()) * per_unit);
    guide_.resize(steps);
    std::size_t bin = 0;
    for (std::size_t i = 0; i < steps; ++i) {
      const double value = bounds_.front() + (static_cast<double>(i) - 0.01) / per_unit;
      while (bin + 1 < bounds_.size() && bounds_[bin + 1] <= value) ++bin;
      guide_[i] = static_cast<std::uint16_t>(bin);
    }
  }
  std::size_t operator()(double value) const {
    const double step = (value - bounds_.front()) * per_unit_;
    if (!(step > 0)) return 0;
    if (!(step < static_cast<double>(guide_.size())))
      return static_cast<std::size_t>(std::upper_bound(bounds_.begin(), bounds_.end(), value) -
                                      bounds_.begin()) -
             1;
    std::size_t bin = guide_[static_cast<std::size_t>(step)];
    while (bin + 1 < bounds_.size() && bounds_[bin + 1] <= value) ++bin;
    return bin;
  }

 private:
  std::vector<double> bounds_;
  double per_unit_;
  std::vector<std::uint16_t> guide_;
};

/// Bins of dihedral angles by 1 - cosine, which grows with the angle.
const BinFinder& dihedral_bins() {
  static const BinFinder finder = [] {
    std::vector<double> bounds;
    for (std::size_t i = 0; i < kDihedralBins; ++i) {
      const double sine = std::sin(static_cast<double>(i) / kBinsPerDegree / kDegrees / 2);
      bounds.push_back(2 * sine * sine);
    }
    return BinFinder(std::move(bounds), 0.7, 65536);
  }();
  return finder;
}

const BinFinder& aspect_bins() {
  static const BinFinder finder = [] {
    std::vector<double> bounds;
    for (std::size_t i = 0; i < kAspectBins; ++i)
      bounds.push_back(std::pow(kAspectBase, static_cast<double>(i)));
    return BinFinder(std::move(bounds), 9, 2048);
  }();
  return finder;
}

}  // namespace

TetShape tet_shape(const Point3& p0, const Point3& p1, const Point3& p2, const Point3& p3) {
  const TetCosines shape = tet_cosines(p0, p1, p2, p3);
  return {shape.volume, angle_deg(shape.greatest), angle_deg(shape.least), shape.aspect_ratio};
}

QualityHistogram::QualityHistogram()
    : dihedral_bins_(kDihedralBins, 0), aspect_bins_(kAspectBins, 0) {}

void QualityHistogram::add(double volume, double greatest_cosine, double least_cosine,
                           double aspect_ratio) {
  ++cells_;
  if (!(volume > 0)) ++inverted_;
  volume_ += volume;
  greatest_cosine_ = std::max(greatest_cosine_, greatest_cosine);
  least_cosine_ = std::min(least_cosine_, least_cosine);
  max_aspect_ = std::max(max_aspect_, aspect_ratio);
  ++dihedral_bins_[dihedral_bins()(1 - greatest_cosine)];
  ++aspect_bins_[aspect_bins()(aspect_ratio)];
}

double QualityHistogram::min_dihedral_deg() const {
  return cells_ == 0 ? std::numeric_limits<double>::infinity() : angle_deg(greatest_cosine_);
}

double QualityHistogram::max_dihedral_deg() const {
  return cells_ == 0 ? 0 : angle_deg(least_cosine_);
}

void QualityHistogram::merge(const QualityHistogram& other) {
  for (std::size_t i = 0; i < kDihedralBins; ++i) dihedral_bins_[i] += other.dihedral_bins_[i];
  for (std::size_t i = 0; i < kAspectBins; ++i) aspect_bins_[i] += other.aspect_bins_[i];
  cells_ += other.cells_;
  inverted_ += other.inverted_;
  volume_ += other.volume_;
  greatest_cosine_ = std::max(greatest_cosine_, other.greatest_cosine_);
  least_cosine_ = std::min(least_cosine_, other.least_cosine_);
  max_aspect_ = std::max(max_aspect_, other.max_aspect_);
}

double QualityHistogram::dihedral_quantile_deg(double fraction) const {
  const auto bin = static_cast<double>(quantile_bin(dihedral_bins_, cells_, fraction));
  return std::max(min_dihedral_deg(), (bin + 0.5) / kBinsPerDegree);
}

double QualityHistogram::aspect_quantile(double fraction) const {
  const auto bin = static_cast<double>(quantile_bin(aspect_bins_, cells_, fraction));
  return std::min(max_aspect_, std::pow(kAspectBase, bin + 0.5));
}

namespace {

/// Few large chunks: each carries histograms of its own.
constexpr std::size_t kChunks = 64;

std::size_t grain_of(std::size_t size) {
  return std::max<std::size_t>(1, (size + kChunks - 1) / kChunks);
}

Point3 centre_of(const std::array<Point3, 4>& p) {
  Point3 centre{};
  for (std::size_t c = 0; c < 3; ++c) centre[c] = (p[0][c] + p[1][c] + p[2][c] + p[3][c]) / 4;
  return centre;
}

FaceShape worse(const FaceShape& a, const FaceShape& b) {
  return {std::max(a.non_orthogonality_deg, b.non_orthogonality_deg),
          std::max(a.skewness, b.skewness)};
}

FaceQuality combined(const FaceQuality& a, const FaceQuality& b) {
  return {a.faces + b.faces, a.above_70 + b.above_70, worse(a.worst, b.worst)};
}

/// Collects faces. The full measures are taken of those only that may be among the worst or above
/// 70 degrees; the others are told from them without roots.
class FaceCollector {
 public:
  void add(const std::array<Point3, 3>& face, const Point3& c0, const Point3& c1) {
    const Point3 n = cross(minus(face[1], face[0]), minus(face[2], face[0]));
    const Point3 d = minus(c1, c0);
    const double n_d = dot(n, d), d2 = dot(d, d);
    constexpr double third = 1.0 / 3;
    Point3 centre{}, skew{};
    for (std::size_t c = 0; c < 3; ++c) centre[c] = (face[0][c] + face[1][c] + face[2][c]) * third;
    const Point3 to_centre = minus(centre, c0);
    const double share = dot(n, to_centre) / n_d;
    for (std::size_t c = 0; c < 3; ++c) skew[c] = to_centre[c] - share * d[c];
    double extent = 0;  // times the skewness vector's length
    for (const Point3& corner : face)
      extent = std::max(extent, std::abs(dot(skew, minus(corner, centre))));
    const double skew2 = dot(skew, skew);
    const bool ordinary = n_d * n_d > least_cosine2_ * (dot(n, n) * d2) &&
                          (skew2 < skewness_ * extent || skew2 < skewness_ * skewness_ * 0.04 * d2);
    ++quality_.faces;
    if (!ordinary) add_in_full(face_shape(face, c0, c1));
  }
  const FaceQuality& quality() const { return quality_; }

 private:
  void add_in_full(const FaceShape& shape) {
    if (shape.non_orthogonality_deg > 70) ++quality_.above_70;
    quality_.worst = worse(quality_.worst, shape);
    const double cosine = std::cos(std::min(quality_.worst.non_orthogonality_deg, 70.0) / kDegrees);
    least_cosine2_ = cosine * cosine * (1 + kMargin);
    skewness_ = quality_.worst.skewness * (1 - kMargin);
  }

  static constexpr double kMargin = 1e-9;  // far beyond rounding
  FaceQuality quality_;
  double least_cosine2_ = 2;
  double skewness_ = 0;
};

/// Faces between the cells over triangle t.
void add_faces_over(const ColumnMesh& mesh, std::size_t t, FaceCollector& faces) {
  const auto& v = mesh.ground.triangles[t];
  Climb<3> front = climb_triangle(mesh, t);
  std::array<Point3, 3> face;
  for (std::size_t i = 0; i < 3; ++i) face[i] = position(mesh, v[i], front.at(i));
  Point3 below{};
  for (bool first = true; true; first = false) {
    const std::size_t c = front.next();
    if (c == 3) return;
    const Point3 apex = position(mesh, v[c], front.at(c) + 1);
    const Point3 centre = centre_of({face[0], face[1], face[2], apex});
    if (!first) faces.add(face, below, centre);
    below = centre;
    face[c] = apex;
    front.advance(c);
  }
}

/// Faces over edge e between the cells on its two sides.
void add_faces_beside(const ColumnMesh& mesh, std::size_t e, FaceCollector& faces) {
  const auto [t0, t1] = mesh.edges.triangles[e];
  if (t1 == kNoTriangle) return;
  const auto [a, b] = mesh.edges.vertices[e];
  const std::array<std::size_t, 2> sides{static_cast<std::size_t>(t0),
                                         static_cast<std::size_t>(t1)};
  std::array<VertexIndex, 4> v{a, b, 0, 0};
  std::array<NodeIndex, 4> from{};
  for (std::size_t s = 0; s < 2; ++s)
    for (const VertexIndex corner : mesh.ground.triangles[sides[s]])
      if (corner != a && corner != b) {
        v[2 + s] = corner;
        from[2 + s] = mesh.floor(sides[s], corner);
      }
  // Under a roof there are cells on one side only: that side's front is taken up to the roof.
  for (std::size_t i = 0; i < 2; ++i)
    from[i] = std::max(mesh.floor(sides[0], v[i]), mesh.floor(sides[1], v[i]));
  if (mesh.inside_building(sides[0]) != mesh.inside_building(sides[1])) {
    const std::size_t air = mesh.inside_building(sides[0]) ? 1 : 0;
    const double roof = mesh.z[static_cast<std::size_t>(from[0])];
    NodeIndex& free = from[2 + air];
    for (const NodeIndex top = mesh.top(v[2 + air]); free < top; ++free) {
      const auto n = static_cast<std::size_t>(free);
      if (!(mesh.z[n] + mesh.z[n + 1] < 2 * roof)) break;
    }
  }
  Climb<4> front(mesh, v, from);
  std::array<Point3, 4> p;
  for (std::size_t i = 0; i < 4; ++i) p[i] = position(mesh, v[i], front.at(i));
  for (std::size_t c; (c = front.next()) < 4; front.advance(c)) {
    const Point3 apex = position(mesh, v[c], front.at(c) + 1);
    if (c < 2)
      faces.add({p[0], p[1], apex}, centre_of({p[0], p[1], apex, p[2]}),
                centre_of({p[0], p[1], apex, p[3]}));
    p[c] = apex;
  }
}

/// Keeps the `count` worst, worst first; ties by place, so that the order of adding is irrelevant.
void keep_worst(std::vector<WorstCell>& cells, std::size_t count) {
  std::sort(cells.begin(), cells.end(), [](const WorstCell& a, const WorstCell& b) {
    return std::tie(a.badness, a.triangle, a.centre) < std::tie(b.badness, b.triangle, b.centre);
  });
  if (cells.size() > count) cells.resize(count);
}

/// Ground that rises above a roof by more than this times the triangle's altitude leaves the cells
/// between them no good shape: the roof's edge has one cell on that side, however columns are cut.
constexpr double kBuried = 2;

double altitude(const Point3& a, const Point3& b, const Point3& c) {
  const Point3 e0 = minus(b, a), e1 = minus(c, a), e2 = minus(c, b);
  const double longest =
      std::sqrt(std::max({e0[0] * e0[0] + e0[1] * e0[1], e1[0] * e1[0] + e1[1] * e1[1],
                          e2[0] * e2[0] + e2[1] * e2[1]}));
  return std::abs(e0[0] * e1[1] - e0[1] * e1[0]) / longest;
}

/// What makes a bad cell over triangle t, from its nodes: p[3] is above one of the others.
std::string_view cause_of(const ColumnMesh& mesh, std::size_t t,
                          const std::array<NodeIndex, 4>& nodes, const std::array<Point3, 4>& p) {
  const auto& v = mesh.ground.triangles[t];
  const double least = altitude(p[0], p[1], p[2]);
  double low = std::numeric_limits<double>::infinity(), high = -low, roof = low;
  bool at_floor = true, at_building = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const NodeIndex floor = mesh.floor(t, v[i]);
    low = std::min(low, mesh.z[static_cast<std::size_t>(floor)]);
    high = std::max(high, mesh.z[static_cast<std::size_t>(floor)]);
    at_floor = at_floor && nodes[i] <= floor + 1;
    const auto corner = static_cast<std::size_t>(v[i]);
    if (mesh.roof[corner] == kNoRoof) continue;
    at_building = true;
    roof = std::min(roof, mesh.z[static_cast<std::size_t>(mesh.first[corner] + mesh.roof[corner])]);
  }
  const auto below =
      static_cast<std::size_t>(std::find(nodes.begin(), nodes.end(), nodes[3] - 1) - nodes.begin());
  const double edge = p[3][2] - p[below][2];
  const double bottom = std::min({p[0][2], p[1][2], p[2][2]});
  if (at_building && bottom < high && high - roof > kBuried * least) return "buried roof";
  if (at_floor && high - low > least) return "steep ground";
  if (at_floor && at_building && edge < least) return "low wall";
  if (edge > 2 * least) return "small detail";
  return "change of size";
}

}  // namespace

FaceShape face_shape(const std::array<Point3, 3>& face, const Point3& c0, const Point3& c1) {
  const Point3 n = cross(minus(face[1], face[0]), minus(face[2], face[0]));
  const Point3 d = minus(c1, c0);
  const double n_d = dot(n, d), length = std::sqrt(dot(d, d));
  FaceShape shape;
  shape.non_orthogonality_deg =
      std::acos(std::clamp(std::abs(n_d) / (std::sqrt(dot(n, n)) * length), 0.0, 1.0)) * kDegrees;
  Point3 centre{}, skew{};
  for (std::size_t c = 0; c < 3; ++c) centre[c] = (face[0][c] + face[1][c] + face[2][c]) / 3;
  const Point3 to_centre = minus(centre, c0);
  const double share = dot(n, to_centre) / n_d;
  for (std::size_t c = 0; c < 3; ++c) skew[c] = to_centre[c] - share * d[c];
  const double distance = std::sqrt(dot(skew, skew));
  double extent = 0.2 * length;
  if (distance > 0)
    for (const Point3& corner : face)
      extent = std::max(extent, std::abs(dot(skew, minus(corner, centre))) / distance);
  shape.skewness = distance / extent;
  return shape;
}

CellQuality measure_quality(const ColumnMesh& mesh, std::size_t worst) {
  const std::size_t grain = grain_of(mesh.triangle_count());
  std::vector<CellQuality> partial((mesh.triangle_count() + grain - 1) / grain);
  parallel_chunks(mesh.triangle_count(), grain, [&](std::size_t begin, std::size_t end) {
    CellQuality& quality = partial[begin / grain];
    // Cells whose cosines stay within this are not among the worst.
    double limit = -2;
    for (std::size_t t = begin; t < end; ++t) {
      const auto& v = mesh.ground.triangles[t];
      const Climb<3> start = climb_triangle(mesh, t);
      std::array<Point3, 4> p;
      for (std::size_t i = 0; i < 3; ++i) p[i] = position(mesh, v[i], start.at(i));
      for_each_tet_over(mesh, t, [&](const std::array<NodeIndex, 4>& nodes) {
        for (std::size_t i = 0; i < 3; ++i) p[i][2] = mesh.z[static_cast<std::size_t>(nodes[i])];
        const auto below = static_cast<std::size_t>(
            std::find(nodes.begin(), nodes.end(), nodes[3] - 1) - nodes.begin());
        p[3] = {p[below][0], p[below][1], mesh.z[static_cast<std::size_t>(nodes[3])]};
        const TetCosines shape = tet_cosines(p[0], p[1], p[2], p[3]);
        quality.histogram.add(shape.volume, shape.greatest, shape.least, shape.aspect_ratio);
        if (worst == 0 || std::max(shape.greatest, -shape.least) < limit) return;
        const double least = angle_deg(shape.greatest), greatest = angle_deg(shape.least);
        quality.worst.push_back({std::min(least, 180 - greatest), least, greatest, centre_of(p),
                                 static_cast<TriangleIndex>(t), cause_of(mesh, t, nodes, p)});
        if (quality.worst.size() < 2 * worst) return;
        keep_worst(quality.worst, worst);
        limit = std::cos(quality.worst.back().badness / kDegrees) - 1e-12;
      });
    }
  });
  CellQuality result;
  for (CellQuality& part : partial) {
    result.histogram.merge(part.histogram);
    result.worst.insert(result.worst.end(), part.worst.begin(), part.worst.end());
  }
  keep_worst(result.worst, worst);
  return result;
}

FaceQuality measure_faces(const ColumnMesh& mesh) {
  const auto over = [&](std::size_t begin, std::size_t end) {
    FaceCollector faces;
    for (std::size_t t = begin; t < end; ++t) add_faces_over(mesh, t, faces);
    return faces.quality();
  };
  const auto beside = [&](std::size_t begin, std::size_t end) {
    FaceCollector faces;
    for (std::size_t e = begin; e < end; ++e) add_faces_beside(mesh, e, faces);
    return faces.quality();
  };
  const std::size_t triangles = mesh.triangle_count(), edges = mesh.edges.size();
  return combined(
      parallel_reduce_ordered(triangles, grain_of(triangles), FaceQuality{}, over, combined),
      parallel_reduce_ordered(edges, grain_of(edges), FaceQuality{}, beside, combined));
}

}  // namespace tetropolis
