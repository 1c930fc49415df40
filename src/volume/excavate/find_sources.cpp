#include "find_sources.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/disjoint_sets.h"
#include "core/infinity.h"
#include "geometry/slope.h"
#include "geometry/vec2.h"
#include "volume/column/rising.h"

namespace tetropolis {

namespace {

/// Whether the ground over triangle t is steeper than `slope` (tangent).
bool is_steeper(const GroundMesh& mesh, TriangleIndex t, std::span<const double> ground,
                double slope) {
  const auto& v = mesh.triangles[t];
  const auto at = [&](std::size_t k) { return mesh.vertices[v[k]]; };
  const auto height = [&](std::size_t k) { return ground[v[k]]; };
  return squared_cosine_of_slope(at(0), height(0), at(1), height(1), at(2), height(2)) *
             (1 + slope * slope) <
         1;
}

/// 1 for the vertices at and beside ground that the excavation lowered for the better.
std::vector<std::uint8_t> find_helped(const ColumnMesh& mesh, const TriedExcavation& tried) {
  const std::size_t n = mesh.vertex_count();
  const auto is_lowered = [&](VertexIndex v) {
    return tried.ground_after[v] != tried.ground_before[v];
  };
  DisjointSets<VertexIndex> places(n);
  for (const auto& [a, b] : mesh.edges.vertices)
    if (is_lowered(a) && is_lowered(b)) places.join(a, b);
  std::vector<std::int64_t> gain(n, 0);  // of the place of each vertex, at its root
  const auto gain_at = [&](VertexIndex v) -> std::int64_t& { return gain[places.root(v)]; };
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    // Lowered corners of a triangle are joined, so they are of one place.
    const auto& corners = mesh.ground.triangles[t];
    if (const auto v = std::find_if(corners.begin(), corners.end(), is_lowered); v != corners.end())
      gain_at(*v) += std::int64_t{tried.bad_before[t]} - std::int64_t{tried.bad_after[t]};
  }
  std::vector<std::uint8_t> helped(n, 0);
  for (const auto& [a, b] : mesh.edges.vertices)
    for (const VertexIndex v : {a, b})
      if (is_lowered(v) && gain_at(v) > 0) helped[a] = helped[b] = 1;
  return helped;
}

}  // namespace

std::vector<std::uint8_t> with_neighbours(const ColumnMesh& mesh,
                                          std::span<const std::uint8_t> marked) {
  std::vector<std::uint8_t> touched(mesh.vertex_count(), 0), all(marked.begin(), marked.end());
  const auto& triangles = mesh.ground.triangles;
  for (const TriangleIndex t : triangles.indices())
    if (marked[t] != 0)
      for (const VertexIndex v : triangles[t]) touched[v] = 1;
  for (const TriangleIndex t : triangles.indices())
    for (const VertexIndex v : triangles[t])
      if (touched[v] != 0) all[t] = 1;
  return all;
}

std::int64_t mark_buried_roofs(const ColumnMesh& mesh, const ColumnPlan& plan,
                               std::span<const std::uint8_t> bad, ExcavationMarks& marks) {
  std::int64_t marked = 0;
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    if (bad[t] == 0 || mesh.inside_building(t)) continue;
    double highest = -kInfinity;
    for (const VertexIndex v : mesh.ground.triangles[t])
      highest = std::max(highest, plan.ground[v]);
    const auto is_buried = [&](VertexIndex v) {
      const RegionIndex b = plan.lowest_roof[v];
      return b != kNoRegion && marks.roofs[b] == 0 && highest > plan.lowest_roof_at(v);
    };
    for (const VertexIndex v : mesh.ground.triangles[t]) {
      if (!is_buried(v)) continue;
      marks.roofs[plan.lowest_roof[v]] = 1;
      ++marked;
    }
  }
  return marked;
}

std::int64_t mark_slope_toes(const ColumnMesh& mesh, const ColumnPlan& plan,
                             std::span<const std::uint8_t> bad, const ToeRule& rule,
                             ExcavationMarks& marks) {
  std::int64_t marked = 0;
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    if (bad[t] == 0 || mesh.inside_building(t)) continue;
    const auto corner = [&](std::size_t k) { return mesh.ground.triangles[t][k % 3]; };
    std::array<double, 3> toe{kInfinity, kInfinity, kInfinity};
    if (is_steeper(mesh.ground, t, plan.ground, rule.slope)) {
      const auto [low, high] =
          std::minmax({plan.ground[corner(0)], plan.ground[corner(1)], plan.ground[corner(2)]});
      for (std::size_t i = 0; i < 3; ++i)
        if (const double z = plan.ground[corner(i)]; z <= low + rule.share * (high - low))
          toe[i] = z;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexIndex v = corner(i);
      if (plan.lowest_roof[v] == kNoRegion) continue;
      const Point2 p = mesh.ground.vertices[v];
      double edge = 0;
      for (const VertexIndex u : {corner(i + 1), corner(i + 2)})
        edge = std::max(edge, distance(mesh.ground.vertices[u], p));
      const double below = plan.lowest_roof_at(v) - kWallTangent * edge;
      if (below < plan.ground[v]) toe[i] = below;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      if (!(toe[i] < marks.toes[corner(i)])) continue;
      marks.toes[corner(i)] = toe[i];
      ++marked;
    }
  }
  return marked;
}

std::int64_t mark_gentle(const ColumnMesh& mesh, const ColumnPlan& plan,
                         std::span<const std::uint8_t> bad, double slope, ExcavationMarks& marks) {
  constexpr double kWorthwhile = 0.01;  // metres
  std::int64_t marked = 0;
  // From the roof, if `high` is above it.
  const auto start_at = [&](VertexIndex v, double high) {
    if (plan.lowest_roof[v] == kNoRegion) return plan.ground[v];
    const double roof = plan.lowest_roof_at(v);
    return roof < high ? roof : plan.ground[v];
  };
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    if (bad[t] == 0 || mesh.inside_building(t)) continue;
    const auto corner = [&](std::size_t k) { return mesh.ground.triangles[t][k % 3]; };
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexIndex v = corner(i), a = corner(i + 1), b = corner(i + 2);
      const double high = plan.ground[v];
      const double most =
          highest_at(mesh.ground.vertices[v], mesh.ground.vertices[a], start_at(a, high),
                     mesh.ground.vertices[b], start_at(b, high), slope);
      if (!(most < std::min(high, marks.toes[v]) - kWorthwhile)) continue;
      marks.toes[v] = most;
      ++marked;
    }
  }
  return marked;
}

std::int64_t mark_deep_walls(const ColumnMesh& mesh, const ColumnPlan& plan,
                             std::span<const std::uint8_t> bad, ExcavationMarks& marks) {
  std::int64_t marked = 0;
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    if (bad[t] == 0 || mesh.inside_building(t)) continue;
    for (const VertexIndex v : mesh.ground.triangles[t]) {
      const RegionIndex b = plan.lowest_roof[v];
      if (b == kNoRegion || marks.walls[b] != 0) continue;
      marks.walls[b] = 1;
      ++marked;
    }
  }
  return marked;
}

void keep_helpful_marks(const ColumnMesh& mesh, std::span<const RegionIndex> building,
                        const TriedExcavation& tried, const ExcavationMarks& before,
                        ExcavationMarks& marks) {
  const std::vector<std::uint8_t> helped = find_helped(mesh, tried);
  for (const VertexIndex v : indices<VertexIndex>(marks.toes.size()))
    if (helped[v] == 0) marks.toes[v] = before.toes.empty() ? kInfinity : before.toes[v];
  const auto keep = [&](const std::vector<std::uint8_t>& old, std::vector<std::uint8_t>& now) {
    std::vector<std::uint8_t> kept = old;
    kept.resize(now.size(), 0);
    for (const VertexIndex v : indices<VertexIndex>(helped.size()))
      if (helped[v] != 0 && building[v] != kNoRegion && !now.empty()) {
        kept[building[v]] = now[building[v]];
      }
    now = std::move(kept);
  };
  keep(before.roofs, marks.roofs);
  keep(before.walls, marks.walls);
}

}  // namespace tetropolis
