#include "find_sources.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/disjoint_sets.h"
#include "core/infinity.h"
#include "geometry/slope.h"
#include "volume/column/rising.h"

namespace tetropolis {

namespace {

/// Whether the ground over triangle t is steeper than `slope` (tangent).
bool is_steeper(const GroundMesh& mesh, std::size_t t, std::span<const double> ground,
                double slope) {
  const auto& v = mesh.triangles[t];
  const auto at = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(v[k])]; };
  const auto height = [&](std::size_t k) { return ground[static_cast<std::size_t>(v[k])]; };
  return squared_cosine_of_slope(at(0), height(0), at(1), height(1), at(2), height(2)) *
             (1 + slope * slope) <
         1;
}

/// 1 for the vertices at and beside ground that the excavation lowered for the better.
std::vector<std::uint8_t> find_helped(const ColumnMesh& mesh, const TriedExcavation& tried) {
  const std::size_t n = mesh.vertex_count();
  const auto is_lowered = [&](VertexIndex v) {
    const auto i = static_cast<std::size_t>(v);
    return tried.ground_after[i] != tried.ground_before[i];
  };
  DisjointSets places(n);
  for (const auto& [a, b] : mesh.edges.vertices)
    if (is_lowered(a) && is_lowered(b)) places.join(a, b);
  std::vector<std::int64_t> gain(n, 0);  // of the place of each vertex, at its root
  const auto gain_at = [&](VertexIndex v) -> std::int64_t& {
    return gain[static_cast<std::size_t>(places.root(v))];
  };
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    // Lowered corners of a triangle are joined, so they are of one place.
    const auto& corners = mesh.ground.triangles[t];
    if (const auto v = std::find_if(corners.begin(), corners.end(), is_lowered); v != corners.end())
      gain_at(*v) += std::int64_t{tried.bad_before[t]} - std::int64_t{tried.bad_after[t]};
  }
  std::vector<std::uint8_t> helped(n, 0);
  for (const auto& [a, b] : mesh.edges.vertices)
    for (const VertexIndex v : {a, b})
      if (is_lowered(v) && gain_at(v) > 0)
        helped[static_cast<std::size_t>(a)] = helped[static_cast<std::size_t>(b)] = 1;
  return helped;
}

}  // namespace

std::vector<std::uint8_t> with_neighbours(const ColumnMesh& mesh,
                                          std::span<const std::uint8_t> marked) {
  std::vector<std::uint8_t> touched(mesh.vertex_count(), 0), all(marked.begin(), marked.end());
  const auto& triangles = mesh.ground.triangles;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (marked[t] != 0)
      for (const VertexIndex v : triangles[t]) touched[static_cast<std::size_t>(v)] = 1;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const VertexIndex v : triangles[t])
      if (touched[static_cast<std::size_t>(v)] != 0) all[t] = 1;
  return all;
}

std::int64_t mark_buried_roofs(const ColumnMesh& mesh, const ColumnPlan& plan,
                               std::span<const std::uint8_t> bad, ExcavationMarks& marks) {
  std::int64_t marked = 0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    if (bad[t] == 0 || mesh.inside_building(t)) continue;
    double highest = -kInfinity;
    for (const VertexIndex v : mesh.ground.triangles[t])
      highest = std::max(highest, plan.ground[static_cast<std::size_t>(v)]);
    const auto is_buried = [&](VertexIndex v) {
      const RegionIndex b = plan.lowest_roof[static_cast<std::size_t>(v)];
      return b != kNoRegion && marks.roofs[static_cast<std::size_t>(b)] == 0 &&
             highest > plan.roofs[static_cast<std::size_t>(b)];
    };
    for (const VertexIndex v : mesh.ground.triangles[t]) {
      if (!is_buried(v)) continue;
      marks.roofs[static_cast<std::size_t>(plan.lowest_roof[static_cast<std::size_t>(v)])] = 1;
      ++marked;
    }
  }
  return marked;
}

std::int64_t mark_slope_toes(const ColumnMesh& mesh, const ColumnPlan& plan,
                             std::span<const std::uint8_t> bad, const ToeRule& rule,
                             ExcavationMarks& marks) {
  std::int64_t marked = 0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    if (bad[t] == 0 || mesh.inside_building(t)) continue;
    const auto corner = [&](std::size_t k) {
      return static_cast<std::size_t>(mesh.ground.triangles[t][k % 3]);
    };
    std::array<double, 3> toe{kInfinity, kInfinity, kInfinity};
    if (is_steeper(mesh.ground, t, plan.ground, rule.slope)) {
      const auto [low, high] =
          std::minmax({plan.ground[corner(0)], plan.ground[corner(1)], plan.ground[corner(2)]});
      for (std::size_t i = 0; i < 3; ++i)
        if (const double z = plan.ground[corner(i)]; z <= low + rule.share * (high - low))
          toe[i] = z;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t v = corner(i);
      if (plan.lowest_roof[v] == kNoRegion) continue;
      const Point2 p = mesh.ground.vertices[v];
      double edge = 0;
      for (const std::size_t u : {corner(i + 1), corner(i + 2)})
        edge = std::max(
            edge, std::hypot(mesh.ground.vertices[u].x - p.x, mesh.ground.vertices[u].y - p.y));
      const double below =
          plan.roofs[static_cast<std::size_t>(plan.lowest_roof[v])] - kWallTangent * edge;
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
  const auto start_at = [&](std::size_t v, double high) {
    if (plan.lowest_roof[v] == kNoRegion) return plan.ground[v];
    const double roof = plan.roofs[static_cast<std::size_t>(plan.lowest_roof[v])];
    return roof < high ? roof : plan.ground[v];
  };
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    if (bad[t] == 0 || mesh.inside_building(t)) continue;
    const auto corner = [&](std::size_t k) {
      return static_cast<std::size_t>(mesh.ground.triangles[t][k % 3]);
    };
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t v = corner(i), a = corner(i + 1), b = corner(i + 2);
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
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    if (bad[t] == 0 || mesh.inside_building(t)) continue;
    for (const VertexIndex v : mesh.ground.triangles[t]) {
      const RegionIndex b = plan.lowest_roof[static_cast<std::size_t>(v)];
      if (b == kNoRegion || marks.walls[static_cast<std::size_t>(b)] != 0) continue;
      marks.walls[static_cast<std::size_t>(b)] = 1;
      ++marked;
    }
  }
  return marked;
}

void keep_helpful_marks(const ColumnMesh& mesh, std::span<const RegionIndex> building,
                        const TriedExcavation& tried, const ExcavationMarks& before,
                        ExcavationMarks& marks) {
  const std::vector<std::uint8_t> helped = find_helped(mesh, tried);
  for (std::size_t v = 0; v < marks.toes.size(); ++v)
    if (helped[v] == 0) marks.toes[v] = before.toes.empty() ? kInfinity : before.toes[v];
  const auto keep = [&](const std::vector<std::uint8_t>& old, std::vector<std::uint8_t>& now) {
    std::vector<std::uint8_t> kept = old;
    kept.resize(now.size(), 0);
    for (std::size_t v = 0; v < helped.size(); ++v)
      if (helped[v] != 0 && building[v] != kNoRegion && !now.empty()) {
        const auto b = static_cast<std::size_t>(building[v]);
        kept[b] = now[b];
      }
    now = std::move(kept);
  };
  keep(before.roofs, marks.roofs);
  keep(before.walls, marks.walls);
}

}  // namespace tetropolis
