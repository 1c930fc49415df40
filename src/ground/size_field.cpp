#include "size_field.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"
#include "geometry/convex_hull.h"

namespace tetropolis {

namespace {

constexpr int kDeepest = 30;
constexpr std::size_t kFewEdges = 8;

/// Quarter k of a square: its middle.
Point2 quarter(Point2 middle, double half, int k) {
  return {middle.x + (k % 2 == 0 ? -0.5 : 0.5) * half, middle.y + (k < 2 ? -0.5 : 0.5) * half};
}

}  // namespace

SizeField::SizeField(std::span<const SizeSource> sources, const Bounds2& box, double far_size,
                     double slope)
    : box_(box), slope_(slope), least_(far_size) {
  for (const SizeSource& source : sources) {
    least_ = std::min(least_, source.size);
    if (source.inside) areas_.push_back({*source.area, source.size});
    for_each_edge(*source.area, [&](Point2 a, Point2 b) { edges_.push_back({a, b, source.size}); });
  }
  middle_ = {0.5 * (box.xmin + box.xmax), 0.5 * (box.ymin + box.ymax)};
  half_ = 0.5 * std::max(box.width(), box.height());
  std::vector<std::int32_t> edges(edges_.size()), areas(areas_.size());
  for (std::size_t i = 0; i < edges.size(); ++i) edges[i] = static_cast<std::int32_t>(i);
  for (std::size_t i = 0; i < areas.size(); ++i) areas[i] = static_cast<std::int32_t>(i);
  nodes_.push_back({});
  nodes_[0].most = far_size;
  build(0, middle_, half_, edges, areas, 0);
}

void SizeField::build(std::size_t node, Point2 middle, double half,
                      std::span<const std::int32_t> edges, std::span<const std::int32_t> areas,
                      int depth) {
  const double reach = half * 1.4142135623730951;
  double most = nodes_[node].most;  // of its parent
  std::vector<std::int32_t> own_areas;
  for (const std::int32_t i : areas) {
    const auto& [polygon, size] = areas_[static_cast<std::size_t>(i)];
    if (size >= most) continue;
    if (distance_to_boundary(polygon, middle) <= reach)
      own_areas.push_back(i);
    else if (contains(polygon, middle))
      most = size;
  }
  std::vector<double> at_middle;
  at_middle.reserve(edges.size());
  double here = most;
  for (const std::int32_t i : edges) {
    const Edge& edge = edges_[static_cast<std::size_t>(i)];
    at_middle.push_back(edge.size + slope_ * distance_to_segment(middle, edge.a, edge.b));
    here = std::min(here, at_middle.back());
  }
  most = std::min(most, here + slope_ * reach);
  std::vector<std::int32_t> own_edges;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const double size = edges_[static_cast<std::size_t>(edges[k])].size;
    if (std::max(size, at_middle[k] - slope_ * reach) < most) own_edges.push_back(edges[k]);
  }
  nodes_[node].most = most;
  const bool is_plain = own_areas.empty() && own_edges.size() <= kFewEdges;
  const bool is_even = own_edges.empty() || slope_ * reach < 0.5 * here;
  if ((is_plain && is_even) || depth >= kDeepest || half < 0.5 * least_) {
    Node& leaf = nodes_[node];
    leaf.edges_begin = static_cast<std::int32_t>(leaf_edges_.size());
    leaf_edges_.insert(leaf_edges_.end(), own_edges.begin(), own_edges.end());
    leaf.edges_end = static_cast<std::int32_t>(leaf_edges_.size());
    leaf.areas_begin = static_cast<std::int32_t>(leaf_areas_.size());
    leaf_areas_.insert(leaf_areas_.end(), own_areas.begin(), own_areas.end());
    leaf.areas_end = static_cast<std::int32_t>(leaf_areas_.size());
    return;
  }
  const std::size_t first = nodes_.size();
  nodes_[node].children = static_cast<std::int32_t>(first);
  nodes_.resize(first + 4);
  for (int k = 0; k < 4; ++k) {
    const std::size_t child = first + static_cast<std::size_t>(k);
    nodes_[child].most = most;
    build(child, quarter(middle, half, k), 0.5 * half, own_edges, own_areas, depth + 1);
  }
}

double SizeField::at(Point2 p, const Node& leaf) const {
  double size = leaf.most;
  for (std::int32_t k = leaf.areas_begin; k < leaf.areas_end; ++k) {
    const auto number = static_cast<std::size_t>(leaf_areas_[static_cast<std::size_t>(k)]);
    const Area& area = areas_[number];
    if (area.size < size && contains(area.polygon, p)) size = area.size;
  }
  double nearest = kInfinity;
  for (std::int32_t k = leaf.edges_begin; k < leaf.edges_end; ++k) {
    const auto number = static_cast<std::size_t>(leaf_edges_[static_cast<std::size_t>(k)]);
    const Edge& edge = edges_[number];
    nearest = std::min(nearest, edge.size + slope_ * distance_to_segment(p, edge.a, edge.b));
  }
  return std::min(size, nearest);
}

double SizeField::operator()(Point2 p) const {
  const Node* node = nodes_.data();
  Point2 middle = middle_;
  double half = half_;
  while (node->children >= 0) {
    const int k = (p.x > middle.x ? 1 : 0) + (p.y > middle.y ? 2 : 0);
    middle = quarter(middle, half, k);
    half *= 0.5;
    node = &nodes_[static_cast<std::size_t>(node->children + k)];
  }
  return at(p, *node);
}

void SizeField::collect(const Node& node, Point2 middle, double half,
                        std::vector<std::pair<double, double>>& sizes) const {
  if (node.children >= 0) {
    for (int k = 0; k < 4; ++k)
      collect(nodes_[static_cast<std::size_t>(node.children + k)], quarter(middle, half, k),
              0.5 * half, sizes);
    return;
  }
  const Bounds2 square{middle.x - half, middle.y - half, middle.x + half, middle.y + half};
  const Bounds2 part = square.intersection(box_);
  if (part.empty()) return;
  const Point2 at_part{0.5 * (part.xmin + part.xmax), 0.5 * (part.ymin + part.ymax)};
  sizes.emplace_back(at(at_part, node), part.width() * part.height());
}

std::vector<std::pair<double, double>> SizeField::sizes() const {
  std::vector<std::pair<double, double>> sizes;
  collect(nodes_.front(), middle_, half_, sizes);
  return sizes;
}

void require_sizes(double mesh_size, const SizeGrading& grading) {
  const auto is_size = [](double size) { return size > 0 && std::isfinite(size); };
  if (!is_size(mesh_size))
    throw Error(ErrorKind::kUsage, fmt::format("mesh_size {}: must be positive", mesh_size));
  if (grading.far_size != 0 && !(grading.far_size >= mesh_size))
    throw Error(ErrorKind::kUsage,
                fmt::format("far_size {} is below mesh_size {}: edges grow away from buildings",
                            grading.far_size, mesh_size));
  if (!(grading.ground_size >= 0))
    throw Error(ErrorKind::kUsage,
                fmt::format("ground_size {}: must not be negative", grading.ground_size));
  if (!(grading.growth > 1))
    throw Error(ErrorKind::kUsage, fmt::format("size_growth {}: must be above 1", grading.growth));
  for (const SizeRegion& region : grading.regions)
    if (!is_size(region.size))
      throw Error(ErrorKind::kUsage, fmt::format("refine: size {}: must be positive", region.size));
}

SizeField graded_sizes(std::span<const Polygon* const> buildings, const Bounds2& box,
                       double mesh_size, const SizeGrading& grading) {
  std::vector<SizeSource> sources;
  for (const Polygon* building : buildings) sources.push_back({building, mesh_size, false});
  for (const SizeRegion& region : grading.regions)
    sources.push_back({&region.area, region.size, true});
  Polygon hull;
  if (grading.ground_size > 0) {
    for (const Polygon* building : buildings)
      hull.outer.insert(hull.outer.end(), building->outer.begin(), building->outer.end());
    hull.outer = convex_hull(std::move(hull.outer));
  }
  if (hull.outer.size() > 2) sources.push_back({&hull, grading.ground_size, true});
  return {sources, box, std::max(grading.far_size, mesh_size), grading.growth - 1};
}

}  // namespace tetropolis
