#include "tetropolis/volume/quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tetropolis/core/parallel.h"

namespace tetropolis {

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kBinsPerDegree = 100;
constexpr std::size_t kDihedralBins = 7200;  // the least dihedral angle is at most 70.53 degrees
constexpr double kAspectBase = 1.001;        // bin i starts at aspect ratio 1.001^i
constexpr std::size_t kAspectBins = 16000;   // up to 8.8e6

Point3 minus(const Point3& a, const Point3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Point3& a, const Point3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point3 cross(const Point3& a, const Point3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

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

}  // namespace

TetShape tet_shape(const Point3& p0, const Point3& p1, const Point3& p2, const Point3& p3) {
  const Point3 e01 = minus(p1, p0), e02 = minus(p2, p0), e03 = minus(p3, p0);
  const Point3 e12 = minus(p2, p1), e13 = minus(p3, p1), e23 = minus(p3, p2);
  // Normals of the faces opposite to p0 .. p3, all pointing outwards (or all inwards), length twice
  // the face's area.
  std::array<Point3, 4> normal = {cross(e12, e13), cross(e03, e02), cross(e01, e03),
                                  cross(e02, e01)};
  double area_sum = 0;
  for (Point3& n : normal) {
    const double length = std::sqrt(dot(n, n));
    area_sum += length / 2;
    if (length > 0)
      for (double& c : n) c /= length;
  }
  double least_cosine = 1, greatest_cosine = -1;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double cosine = -dot(normal[i], normal[j]);
      least_cosine = std::min(least_cosine, cosine);
      greatest_cosine = std::max(greatest_cosine, cosine);
    }
  double longest2 = 0;
  for (const Point3* e : {&e01, &e02, &e03, &e12, &e13, &e23})
    longest2 = std::max(longest2, dot(*e, *e));
  TetShape shape;
  shape.volume = dot(cross(e01, e02), e03) / 6;
  shape.min_dihedral_deg = std::acos(std::clamp(greatest_cosine, -1.0, 1.0)) * kDegrees;
  shape.max_dihedral_deg = std::acos(std::clamp(least_cosine, -1.0, 1.0)) * kDegrees;
  const double inradius = 3 * std::abs(shape.volume) / area_sum;
  shape.aspect_ratio = inradius > 0 ? std::sqrt(longest2) / (2 * std::sqrt(6.0) * inradius)
                                    : std::numeric_limits<double>::infinity();
  return shape;
}

QualityHistogram::QualityHistogram()
    : dihedral_bins_(kDihedralBins, 0),
      aspect_bins_(kAspectBins, 0),
      min_dihedral_(std::numeric_limits<double>::infinity()),
      max_dihedral_(0),
      max_aspect_(0) {}

void QualityHistogram::add(const TetShape& shape) {
  ++cells_;
  if (!(shape.volume > 0)) ++inverted_;
  volume_ += shape.volume;
  min_dihedral_ = std::min(min_dihedral_, shape.min_dihedral_deg);
  max_dihedral_ = std::max(max_dihedral_, shape.max_dihedral_deg);
  max_aspect_ = std::max(max_aspect_, shape.aspect_ratio);
  const auto angle_bin = static_cast<std::size_t>(shape.min_dihedral_deg * kBinsPerDegree);
  ++dihedral_bins_[std::min(angle_bin, kDihedralBins - 1)];
  static const double log_base = std::log(kAspectBase);
  const double aspect_bin = std::log(std::max(shape.aspect_ratio, 1.0)) / log_base;
  ++aspect_bins_[aspect_bin < kAspectBins - 1 ? static_cast<std::size_t>(aspect_bin)
                                              : kAspectBins - 1];
}

void QualityHistogram::merge(const QualityHistogram& other) {
  for (std::size_t i = 0; i < kDihedralBins; ++i) dihedral_bins_[i] += other.dihedral_bins_[i];
  for (std::size_t i = 0; i < kAspectBins; ++i) aspect_bins_[i] += other.aspect_bins_[i];
  cells_ += other.cells_;
  inverted_ += other.inverted_;
  volume_ += other.volume_;
  min_dihedral_ = std::min(min_dihedral_, other.min_dihedral_);
  max_dihedral_ = std::max(max_dihedral_, other.max_dihedral_);
  max_aspect_ = std::max(max_aspect_, other.max_aspect_);
}

double QualityHistogram::dihedral_quantile_deg(double fraction) const {
  const auto bin = static_cast<double>(quantile_bin(dihedral_bins_, cells_, fraction));
  return std::max(min_dihedral_, (bin + 0.5) / kBinsPerDegree);
}

double QualityHistogram::aspect_quantile(double fraction) const {
  const auto bin = static_cast<double>(quantile_bin(aspect_bins_, cells_, fraction));
  return std::min(max_aspect_, std::pow(kAspectBase, bin + 0.5));
}

QualityHistogram measure_quality(const ColumnMesh& mesh) {
  const auto point = [&](const Node& node) {
    const Point2 p = mesh.ground.vertices[static_cast<std::size_t>(node.vertex)];
    return Point3{p.x, p.y, mesh.column(static_cast<std::size_t>(node.vertex))[node.layer]};
  };
  // Few large chunks: each carries histograms of its own.
  const std::size_t chunks = 64;
  const std::size_t grain = std::max<std::size_t>(1, (mesh.triangle_count() + chunks - 1) / chunks);
  std::vector<QualityHistogram> partial((mesh.triangle_count() + grain - 1) / grain);
  parallel_chunks(mesh.triangle_count(), grain, [&](std::size_t begin, std::size_t end) {
    QualityHistogram& histogram = partial[begin / grain];
    for (std::size_t t = begin; t < end; ++t)
      for (std::int32_t k = mesh.first_layer[t]; k < mesh.layers; ++k)
        for (const auto& tet : prism_tets(mesh, static_cast<TriangleIndex>(t), k))
          histogram.add(tet_shape(point(tet[0]), point(tet[1]), point(tet[2]), point(tet[3])));
  });
  QualityHistogram result;
  for (const QualityHistogram& histogram : partial) result.merge(histogram);
  return result;
}

}  // namespace tetropolis
