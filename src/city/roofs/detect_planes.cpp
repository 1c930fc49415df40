#include "city/roofs/detect_planes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "tetropolis/core/ragged_array.h"
#include "tetropolis/ground/triangulation.h"

#include "city/roofs/plane_fit.h"
#include "core/infinity.h"
#include "core/ragged_builder.h"

namespace tetropolis {

namespace {

using PointNumber = std::uint32_t;

constexpr double kReach = 0.25;    ///< Metres off a plane, square to it, for a point to be on it.
constexpr double kMinArea = 2;     ///< Square metres: planes with fewer points than that has: none.
constexpr double kFlatness = 0.2;  ///< Metres: rms of a seed and its neighbours off their plane.

/// Per point: those it has an edge to, and those at the same place; ascending.
RaggedArray<PointNumber> neighbours_of(std::span<const Point3> points) {
  PlanarGraph graph;
  for (const Point3& p : points) graph.points.push_back({p[0], p[1]});
  const Triangulation mesh = constrained_delaunay(graph, {.convex_hull = true});
  const auto at = ragged_from_pairs<PointNumber>(mesh.points.size(), [&](const auto& use) {
    for (std::size_t i = 0; i < points.size(); ++i)
      use(mesh.input_vertex[i], static_cast<PointNumber>(i));
  });
  auto found = ragged_from_pairs<PointNumber>(points.size(), [&](const auto& use) {
    const auto join = [&](VertexIndex a, VertexIndex b) {
      for (const PointNumber i : at[a])
        for (const PointNumber j : at[b])
          if (i != j) use(i, j);
    };
    for (const std::array<VertexIndex, 3>& triangle : mesh.triangles)
      for (std::size_t e = 0; e < 3; ++e) {
        join(triangle[e], triangle[(e + 1) % 3]);
        join(triangle[(e + 1) % 3], triangle[e]);
      }
    for (std::size_t v = 0; v < mesh.points.size(); ++v) join(VertexIndex(v), VertexIndex(v));
  });
  RaggedArray<PointNumber> result;
  result.values.reserve(found.values.size() / 2);  // edges of two triangles were found twice
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::span<PointNumber> row = found[i];
    std::sort(row.begin(), row.end());
    result.push_back({row.begin(), std::unique(row.begin(), row.end())});
  }
  return result;
}

double cosine(const RoofPlane& plane) {
  return 1 / std::sqrt(1 + plane.slope_x * plane.slope_x + plane.slope_y * plane.slope_y);
}

class Detection {
 public:
  Detection(std::span<const Point3> points, double density)
      : points_(points),
        neighbours_(neighbours_of(points)),
        need_(std::max(5.0, kMinArea * density)),
        taken_(points.size(), 0),
        seen_(points.size(), 0) {
    find_seeds();
  }

  std::vector<DetectedPlane> run() {
    for (const PointNumber seed : seeds_)
      if (taken_[seed] == 0) grow(seed);
    return std::move(planes_);
  }

 private:
  Point2 at(PointNumber i) const { return {points_[i][0], points_[i][1]}; }
  bool is_on(const RoofPlane& plane, PointNumber i) const {
    return std::abs(height_above(plane, points_[i])) * cosine(plane) <= kReach;
  }

  void find_seeds() {
    std::vector<double> roughness(points_.size(), kInfinity);
    local_.resize(points_.size());
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const auto i = static_cast<PointNumber>(k);
      if (neighbours_[i].size() < 3) continue;
      PlaneFit fit(at(i));
      fit.add(points_[i]);
      for (const PointNumber j : neighbours_[i]) fit.add(points_[j]);
      local_[i] = fit.plane();
      if (slope_of(local_[i]) > kMaxRoofSlope) continue;
      roughness[i] = std::sqrt(fit.sum_of_squares() / fit.count()) * cosine(local_[i]);
      if (roughness[i] <= kFlatness) seeds_.push_back(i);
    }
    std::stable_sort(seeds_.begin(), seeds_.end(),
                     [&](PointNumber a, PointNumber b) { return roughness[a] < roughness[b]; });
  }

  void grow(PointNumber seed) {
    RoofPlane plane = local_[seed];
    std::vector<PointNumber> grown{seed};
    PlaneFit fit(at(seed));
    fit.add(points_[seed]);
    ++stamp_;
    seen_[seed] = stamp_;
    std::size_t next_fit = 6;
    for (std::size_t k = 0; k < grown.size(); ++k)
      for (const PointNumber j : neighbours_[grown[k]]) {
        if (taken_[j] != 0 || seen_[j] == stamp_ || !is_on(plane, j)) continue;
        seen_[j] = stamp_;
        grown.push_back(j);
        fit.add(points_[j]);
        if (grown.size() < next_fit) continue;
        if (const RoofPlane better = fit.plane(); slope_of(better) < kMaxRoofSlope) plane = better;
        next_fit = next_fit * 4 / 3 + 1;
      }
    take(plane, grown);
  }

  void take(RoofPlane plane, std::vector<PointNumber>& grown) {
    const auto inliers = [&] {
      std::vector<PointNumber> on;
      for (const PointNumber j : grown)
        if (is_on(plane, j)) on.push_back(j);
      return on;
    };
    for (int round = 0; round < 2; ++round) {
      const std::vector<PointNumber> on = inliers();
      if (static_cast<double>(on.size()) < need_) return;
      PlaneFit fit(at(on.front()));
      for (const PointNumber j : on) fit.add(points_[j]);
      plane = fit.plane();
    }
    const std::vector<PointNumber> on = inliers();
    if (static_cast<double>(on.size()) < need_ || slope_of(plane) > kMaxRoofSlope) return;
    Bounds2 box = Bounds2::nothing();
    for (const PointNumber j : on) {
      taken_[j] = 1;
      box.extend(at(j));
    }
    planes_.push_back({plane, box});
  }

  std::span<const Point3> points_;
  RaggedArray<PointNumber> neighbours_;
  double need_;
  std::vector<std::uint8_t> taken_;
  std::vector<std::uint32_t> seen_;
  std::uint32_t stamp_ = 0;
  std::vector<RoofPlane> local_;
  std::vector<PointNumber> seeds_;
  std::vector<DetectedPlane> planes_;
};

}  // namespace

std::vector<DetectedPlane> detect_planes(std::span<const Point3> points, double density) {
  if (points.size() < 4) return {};
  return Detection(points, density).run();
}

}  // namespace tetropolis
