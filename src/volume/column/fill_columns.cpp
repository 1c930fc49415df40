#include "fill_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"
#include "core/parallel.h"
#include "core/sort_once.h"
#include "ground_heights.h"
#include "layers_at_walls.h"
#include "levels.h"

namespace tetropolis {

namespace {

constexpr std::size_t kColumnsPerChunk = 4096;

// Found by trial, by the least angles and the numbers of cells: of Delft, Amsterdam south and the
// random city of 3,096 buildings for the spacing; of villages on slopes of 45 degrees and with rock
// walls of 20 m (`tetropolis synth --kind adversarial`) for the shares.
constexpr double kSpacingFactor = 1.2;

/// Share of a cliff's height that the first segment at its foot takes.
constexpr double kFootShare = 0.6;

/// A piece that ends below the edge of the cliff, but above this share of its height, takes two.
constexpr double kWholeShare = 0.8;

/// Share of the spacing that a wall is high where the ground was lowered for it.
constexpr double kLoweredWallShare = 0.6;

void require_rise(double low, double high, VertexIndex v, const char* what) {
  if (low < high) return;
  throw Error(ErrorKind::kGuarantee, "column mesh: at ground vertex " + std::to_string(v) + " " +
                                         what + " (" + std::to_string(low) + " m to " +
                                         std::to_string(high) + " m)");
}

/// A piece of a column between two given elevations: below the edge of a cliff first in few long
/// segments, then in even ones.
struct Piece {
  std::array<double, 2> steep{};  ///< Elevations within the piece where the long segments end.
  std::int32_t steep_count = 0;
  std::int32_t even_count = 0;
};

Piece divide_piece(const ColumnPlan& plan, VertexIndex v, double low, double high) {
  const double spacing = plan.spacing[v];
  double edge = plan.ground[v] + plan.rise[v];
  for (const RoofFloor& floor : plan.roofs.sloped_at(v))
    if (floor.z <= low) edge = std::max(edge, floor.z + floor.rise);
  const double rise = edge - low;
  Piece piece;
  const auto divide_above = [&](double from) {
    return static_cast<std::int32_t>(std::max(1.0, std::round((high - from) / spacing)));
  };
  if (!(kFootShare * rise > spacing)) {
    piece.even_count = divide_above(low);
  } else if (edge + spacing / 2 < high) {
    piece.steep = {low + kFootShare * rise, edge};
    piece.steep_count = 2;
    piece.even_count = divide_above(edge);
  } else {
    // The cliff is as high as the piece or higher.
    if (high - low > kWholeShare * rise) piece.steep[piece.steep_count++] = low + kFootShare * rise;
    piece.even_count = 1;
  }
  return piece;
}

std::int32_t segments(const ColumnPlan& plan, VertexIndex v, double low, double high) {
  const Piece piece = divide_piece(plan, v, low, high);
  return piece.steep_count + piece.even_count;
}

/// Elevations that column v has a node at, whatever its spacing: its floors from the lowest up, and
/// its top.
void find_anchors(const ColumnMesh& mesh, const ColumnPlan& plan, VertexIndex v,
                  std::vector<double>& anchors) {
  anchors.clear();
  for (const RegionIndex region : mesh.regions[v])
    anchors.push_back(plan.floor(mesh.ground, region, v));
  if (anchors.size() > 1) sort_once(anchors);
  anchors.push_back(plan.top[v]);
}

void require_rising_floors(const ColumnMesh& mesh, const ColumnPlan& plan, VertexIndex v) {
  const std::span<const RegionIndex> around = mesh.regions[v];
  const auto is_building = [&](RegionIndex region) {
    return mesh.ground.regions[region].is_building();
  };
  const bool outside = !std::all_of(around.begin(), around.end(), is_building);
  for (const RegionIndex region : around) {
    const double floor = plan.floor(mesh.ground, region, v);
    const bool is_roof = is_building(region);
    if (is_roof && outside)
      require_rise(plan.ground[v], floor, v, "the roof is not above the ground");
    require_rise(floor, plan.top[v], v,
                 is_roof ? "the top is not above the roof" : "the top is not above the ground");
  }
}

/// Sets the positions of the column's floors; returns its number of nodes.
std::int32_t divide(const ColumnPlan& plan, VertexIndex v, std::span<const double> anchors,
                    ColumnMesh& mesh) {
  const std::span<const RegionIndex> around = mesh.regions[v];
  const std::span<std::int32_t> floors = mesh.floors_at(v);
  std::int32_t position = 0;
  for (std::size_t i = 0; i + 1 < anchors.size(); ++i) {
    for (std::size_t k = 0; k < around.size(); ++k)
      if (plan.floor(mesh.ground, around[k], v) == anchors[i]) floors[k] = position;
    position += segments(plan, v, anchors[i], anchors[i + 1]);
  }
  return position + 1;
}

/// Writes the nodes from `low` towards, but without, `high`; returns the place after them.
double* spread(double* z, const ColumnPlan& plan, VertexIndex v, double low, double high) {
  const Piece piece = divide_piece(plan, v, low, high);
  for (std::int32_t i = 0; i < piece.steep_count; ++i) {
    *z++ = low;
    low = piece.steep[static_cast<std::size_t>(i)];
  }
  const std::int32_t n = piece.even_count;
  for (std::int32_t i = 0; i < n; ++i) *z++ = low + (high - low) * i / n;
  return z;
}

/// Per building part: the lowest of `ground`, per vertex, at its walls (and inside of it).
std::vector<double> lowest_at_walls(const GroundMesh& mesh, std::size_t parts,
                                    std::span<const double> ground) {
  std::vector<double> lowest(parts, kInfinity);
  for (const TriangleIndex t : mesh.triangles.indices()) {
    if (!mesh.inside_building(t)) continue;
    double& low = lowest[mesh.region[t]];
    for (const VertexIndex v : mesh.triangles[t]) low = std::min(low, ground[v]);
  }
  return lowest;
}

/// Per building part: its greatest height above `ground`, per vertex, at its walls (and inside).
std::vector<double> highest_walls(const GroundMesh& mesh, const RoofHeights& roofs,
                                  std::span<const double> ground) {
  std::vector<double> height(roofs.parts(), -kInfinity);
  for (const TriangleIndex t : mesh.triangles.indices()) {
    if (!mesh.inside_building(t)) continue;
    const RegionIndex part = mesh.region[t];
    for (const VertexIndex v : mesh.triangles[t])
      height[part] = std::max(height[part], roofs.at(part, v) - ground[v]);
  }
  return height;
}

/// Per building part.
std::vector<double> highest_of(const RoofHeights& roofs) {
  std::vector<double> highest = roofs.flat;
  for (const RoofFloor& floor : roofs.sloped.values)
    highest[floor.part] = std::max(highest[floor.part], floor.z);
  return highest;
}

/// Height of a wall whose roof lies `buried` below the terrain at `distance`, so that it is seen
/// from there under 15 degrees; or, where that would leave less between the ground below the wall
/// and the vertical, under half of what the roof leaves.
double wall_below(double buried, double distance) {
  if (!(buried > 0)) return 0;
  const double roof = buried / distance;  // tangents of the angles below the horizontal
  double foot = roof + std::sqrt(1 + roof * roof);
  if (roof * kWallTangent < 1)
    foot = std::min(foot, (roof + kWallTangent) / (1 - roof * kWallTangent));
  return distance * (foot - roof);
}

}  // namespace

std::vector<double> ground_rise(const GroundMesh& mesh, std::span<const double> ground) {
  std::vector<double> rise(mesh.vertices.size(), 0.0);
  for (const TriangleIndex t : mesh.triangles.indices()) {
    if (mesh.inside_building(t)) continue;
    double highest = -kInfinity;
    for (const VertexIndex v : mesh.triangles[t]) highest = std::max(highest, ground[v]);
    for (const VertexIndex v : mesh.triangles[t]) rise[v] = std::max(rise[v], highest - ground[v]);
  }
  return rise;
}

double spacing_over(double altitude, double longest_squared) {
  return kSpacingFactor * std::sqrt(2 / std::sqrt(3.0) * altitude * std::sqrt(longest_squared));
}

std::vector<double> column_spacing(const GroundMesh& ground) {
  std::vector<double> longest(ground.vertices.size(), 0.0);  // squared
  std::vector<double> altitude(ground.vertices.size(), kInfinity);
  for (const auto& triangle : ground.triangles) {
    std::array<Point2, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = ground.vertices[triangle[i]];
    std::array<double, 3> length2{};  // of the edge opposite to corner i
    for (std::size_t i = 0; i < 3; ++i) {
      const Point2 a = p[(i + 1) % 3], b = p[(i + 2) % 3];
      length2[i] = (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
    }
    const double twice_area =
        (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
    const double least = twice_area / std::sqrt(std::max({length2[0], length2[1], length2[2]}));
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexIndex v = triangle[i];
      altitude[v] = std::min(altitude[v], least);
      longest[v] = std::max({longest[v], length2[(i + 1) % 3], length2[(i + 2) % 3]});
    }
  }
  std::vector<double> spacing(ground.vertices.size());
  for (const VertexIndex v : indices<VertexIndex>(spacing.size()))
    spacing[v] = spacing_over(altitude[v], longest[v]);
  return spacing;
}

LayerPlan plan_layers(std::span<const double> ground, std::span<const double> roofs,
                      double highest_ground, double domain_height, double layer_height) {
  LayerPlan plan;
  double sum = 0;
  for (const double z : ground) sum += z;
  plan.bottom = sum / static_cast<double>(ground.size());
  plan.highest_ground = highest_ground;
  plan.top = highest_ground + domain_height;
  for (const double roof : roofs) {
    if (roof + 2 * layer_height <= plan.top) continue;
    plan.top = roof + 2 * layer_height;
    plan.raised = true;
  }
  // Clamped so that absurd layer heights stay absurd numbers instead of overflowing.
  plan.layers = static_cast<std::int32_t>(
      std::clamp(std::round((plan.top - plan.bottom) / layer_height), 2.0, 1e9));
  return plan;
}

ColumnPlan plan_columns(const GroundMesh& mesh, const Raster& dtm, RoofHeights roofs,
                        std::vector<double> spacing, const ColumnPlanOptions& options) {
  ColumnPlan plan;
  plan.roofs = std::move(roofs);
  plan.spacing = std::move(spacing);
  plan.lowest_roof = lowest_roofs(mesh, plan.roofs);
  plan.lift.assign(options.lift.begin(), options.lift.end());
  plan.terrain = terrain_under(mesh, dtm);
  for (const VertexIndex v : indices<VertexIndex>(plan.lift.size()))
    plan.terrain[v] += plan.lift[v];
  plan_ground(mesh, options, plan);
  plan.layers =
      plan_layers(plan.ground, highest_of(plan.roofs), highest_under(dtm, bounds(mesh.vertices)),
                  options.domain_height, options.layer_height);
  plan.top.assign(mesh.vertices.size(), plan.layers.top);
  return plan;
}

void plan_ground(const GroundMesh& mesh, const ColumnPlanOptions& options, ColumnPlan& plan) {
  plan.ground = plan.terrain;
  if (!options.excavated.empty())
    plan.ground.assign(options.excavated.begin(), options.excavated.end());
  std::vector<double> least(plan.spacing.size(), options.minimum_wall);
  for (const VertexIndex v : indices<VertexIndex>(plan.lift.size()))
    least[v] = wall_above_layers(options.minimum_wall, plan.lift[v]);
  std::vector<double> wall(least);
  // What rises beside a wall, but for walls that sink themselves.
  std::vector<double> around = plan.ground;
  lower_at_walls(mesh, plan.lowest_roof, plan.roofs, least, wall, around);
  plan.rise = ground_rise(mesh, around);
  const std::vector<double> highest_wall = highest_walls(mesh, plan.roofs, plan.ground);
  for (const VertexIndex v : indices<VertexIndex>(wall.size())) {
    const RegionIndex b = plan.lowest_roof[v];
    if (b == kNoRegion || !options.fit_lowered_walls) continue;
    const double buried = around[v] + plan.rise[v] - plan.lowest_roof_at(v);
    const double fits = wall_below(buried, plan.spacing[v]);
    // No deeper than the building stands somewhere, which beside a rock wall would be a pit. (Less
    // a micrometre, so that rounding does not lower what is there.)
    double deepest = std::max(highest_wall[b] - 1e-6, least[v]);
    if (!options.deep_walls.empty() && options.deep_walls[b] != 0) deepest = kInfinity;
    least[v] = std::max(least[v], std::min(fits, deepest));
    wall[v] = std::max(least[v], std::min(deepest, kLoweredWallShare * plan.spacing[v]));
  }
  lower_at_walls(mesh, plan.lowest_roof, plan.roofs, least, wall, plan.ground);
  plan.rise = ground_rise(mesh, plan.ground);
  count_lowered(mesh, options.minimum_wall, plan);
}

void count_lowered(const GroundMesh& mesh, double minimum_wall, ColumnPlan& plan) {
  const std::vector<double>& terrain = plan.terrain;
  plan.lowered = plan.undermined = 0;
  plan.deepest = plan.deepest_undermined = 0;
  const std::vector<std::uint8_t> outside = outside_vertices(mesh);
  for (const VertexIndex v : indices<VertexIndex>(terrain.size())) {
    if (outside[v] == 0 || !(plan.ground[v] < terrain[v])) continue;
    ++plan.lowered;
    plan.deepest = std::max(plan.deepest, terrain[v] - plan.ground[v]);
  }
  constexpr double kNothing = 0.01;  // metres
  const std::vector<double> then = lowest_at_walls(mesh, plan.roofs.parts(), terrain);
  const std::vector<double> now = lowest_at_walls(mesh, plan.roofs.parts(), plan.ground);
  BuildingIndex last = kNoBuilding;
  for (const RegionIndex b : indices<RegionIndex>(plan.roofs.parts())) {
    // A wall that is too low by itself does not count.
    const double deep = std::min(then[b], plan.roofs.flat[b] - minimum_wall) - now[b];
    if (!(deep > kNothing)) continue;
    const BuildingIndex building = mesh.regions[b].building;
    plan.undermined += building == std::exchange(last, building) ? 0 : 1;
    plan.deepest_undermined = std::max(plan.deepest_undermined, deep);
  }
}

double estimate_cells(const ColumnPlan& plan) {
  double cells = 0;
  for (const VertexIndex v : indices<VertexIndex>(plan.top.size()))
    cells += 6.0 * segments(plan, v, plan.ground[v], plan.top[v]);
  return cells;
}

ColumnMesh divide_columns(GroundMesh ground, EdgeGraph edges, const ColumnPlan& plan) {
  ColumnMesh mesh;
  mesh.ground = std::move(ground);
  mesh.edges = std::move(edges);
  const std::size_t vertices = mesh.vertex_count();
  mesh.regions = regions_at_vertices(mesh.ground);
  mesh.floors.resize(mesh.regions.values.size());
  mesh.first.resize(vertices + 1);
  parallel_chunks(vertices, kColumnsPerChunk, [&](std::size_t begin, std::size_t end) {
    std::vector<double> anchors;
    for (const VertexIndex v : indices<VertexIndex>(begin, end)) {
      require_rising_floors(mesh, plan, v);
      find_anchors(mesh, plan, v, anchors);
      mesh.first[v + 1] = NodeIndex(divide(plan, v, anchors, mesh));
    }
  });
  for (std::size_t v = 0; v < vertices; ++v) mesh.first[v + 1] += mesh.first[v].value();
  mesh.z.resize(static_cast<std::size_t>(mesh.node_count()));
  return mesh;
}

void place_nodes(ColumnMesh& mesh, const ColumnPlan& plan) {
  parallel_chunks(mesh.vertex_count(), kColumnsPerChunk, [&](std::size_t begin, std::size_t end) {
    std::vector<double> anchors;
    for (const VertexIndex v : indices<VertexIndex>(begin, end)) {
      find_anchors(mesh, plan, v, anchors);
      double* z = mesh.z.data() + mesh.first[v];
      for (std::size_t i = 1; i < anchors.size(); ++i)
        z = spread(z, plan, v, anchors[i - 1], anchors[i]);
      *z = anchors.back();
    }
  });
  set_levels(mesh, plan.roofs);
}

}  // namespace tetropolis
