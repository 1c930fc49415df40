#include "tetropolis/volume/fill_columns.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "tetropolis/core/error.h"
#include "tetropolis/core/parallel.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/volume/ground_heights.h"

namespace tetropolis {

namespace {

constexpr std::size_t kColumnsPerChunk = 4096;
constexpr double kSpacingFactor = 1.2;

/// Share of a cliff's height that the first segment at its foot takes.
constexpr double kFootShare = 0.6;

/// How one column is divided.
struct Division {
  std::int32_t below_roof = 0;  ///< Segments from the ground to the roof.
  std::int32_t above = 0;       ///< Segments from there (or from the ground) to the top.
};

/// Vertices with a triangle outside buildings.
std::vector<std::uint8_t> outside_vertices(const GroundMesh& mesh) {
  std::vector<std::uint8_t> outside(mesh.vertices.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (mesh.region[t] == kNoBuilding)
      for (const VertexIndex v : mesh.triangles[t]) outside[static_cast<std::size_t>(v)] = 1;
  return outside;
}

void require_rise(double low, double high, std::size_t v, const char* what) {
  if (low < high) return;
  throw Error(ErrorKind::kGuarantee, "column mesh: at ground vertex " + std::to_string(v) + " " +
                                         what + " (" + std::to_string(low) + " m to " +
                                         std::to_string(high) + " m)");
}

/// Whether the piece of the column that begins at the ground and is `height` high begins with the
/// two segments of a cliff's foot.
bool is_foot(const ColumnPlan& plan, std::size_t v, double height) {
  return kFootShare * plan.rise[v] > plan.spacing[v] && plan.rise[v] + plan.spacing[v] / 2 < height;
}

std::int32_t even_segments(const ColumnPlan& plan, std::size_t v, double height) {
  return static_cast<std::int32_t>(std::max(1.0, std::round(height / plan.spacing[v])));
}

/// Segments of a piece that begins at the ground.
std::int32_t ground_segments(const ColumnPlan& plan, std::size_t v, double height) {
  if (!is_foot(plan, v, height)) return even_segments(plan, v, height);
  return 2 + even_segments(plan, v, height - plan.rise[v]);
}

Division divide(const ColumnPlan& plan, std::size_t v, bool outside) {
  Division division;
  const double ground = plan.ground[v], top = plan.top[v];
  if (plan.building[v] == kNoBuilding) {
    require_rise(ground, top, v, "the top is not above the ground");
    division.above = ground_segments(plan, v, top - ground);
    return division;
  }
  const double roof = plan.roofs[static_cast<std::size_t>(plan.building[v])];
  if (outside) {
    require_rise(ground, roof, v, "the roof is not above the ground");
    division.below_roof = ground_segments(plan, v, roof - ground);
  }
  require_rise(roof, top, v, "the top is not above the roof");
  division.above = even_segments(plan, v, top - roof);
  return division;
}

/// Writes count nodes from `low` towards, but without, `high`; returns the place after them.
double* spread(double* z, double low, double high, std::int32_t count) {
  for (std::int32_t i = 0; i < count; ++i) *z++ = low + (high - low) * i / count;
  return z;
}

/// Likewise for a piece that begins at the ground.
double* spread_from_ground(double* z, const ColumnPlan& plan, std::size_t v, double high,
                           std::int32_t count) {
  const double ground = plan.ground[v];
  if (!is_foot(plan, v, high - ground)) return spread(z, ground, high, count);
  *z++ = ground;
  *z++ = ground + kFootShare * plan.rise[v];
  return spread(z, ground + plan.rise[v], high, count - 2);
}

}  // namespace

std::vector<double> ground_rise(const GroundMesh& mesh, std::span<const double> ground) {
  std::vector<double> rise(mesh.vertices.size(), 0.0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.region[t] != kNoBuilding) continue;
    double highest = -std::numeric_limits<double>::infinity();
    for (const VertexIndex v : mesh.triangles[t])
      highest = std::max(highest, ground[static_cast<std::size_t>(v)]);
    for (const VertexIndex v : mesh.triangles[t]) {
      const auto i = static_cast<std::size_t>(v);
      rise[i] = std::max(rise[i], highest - ground[i]);
    }
  }
  return rise;
}

std::vector<double> column_spacing(const GroundMesh& ground) {
  std::vector<double> longest(ground.vertices.size(), 0.0);  // squared
  std::vector<double> altitude(ground.vertices.size(), std::numeric_limits<double>::infinity());
  for (const auto& triangle : ground.triangles) {
    std::array<Point2, 3> p;
    for (std::size_t i = 0; i < 3; ++i)
      p[i] = ground.vertices[static_cast<std::size_t>(triangle[i])];
    std::array<double, 3> length2{};  // of the edge opposite to corner i
    for (std::size_t i = 0; i < 3; ++i) {
      const Point2 a = p[(i + 1) % 3], b = p[(i + 2) % 3];
      length2[i] = (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
    }
    const double twice_area =
        (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
    const double least = twice_area / std::sqrt(std::max({length2[0], length2[1], length2[2]}));
    for (std::size_t i = 0; i < 3; ++i) {
      const auto v = static_cast<std::size_t>(triangle[i]);
      altitude[v] = std::min(altitude[v], least);
      longest[v] = std::max({longest[v], length2[(i + 1) % 3], length2[(i + 2) % 3]});
    }
  }
  std::vector<double> spacing(ground.vertices.size());
  for (std::size_t v = 0; v < spacing.size(); ++v)
    spacing[v] =
        kSpacingFactor * std::sqrt(2 / std::sqrt(3.0) * altitude[v] * std::sqrt(longest[v]));
  return spacing;
}

ColumnPlan plan_columns(const GroundMesh& mesh, const Raster& dtm, std::vector<double> roofs,
                        std::vector<double> spacing, const ColumnPlanOptions& options) {
  ColumnPlan plan;
  plan.roofs = std::move(roofs);
  plan.spacing = std::move(spacing);
  plan.building = vertex_buildings(mesh);
  std::vector<double> wall(plan.spacing);
  for (double& w : wall) w = std::max(options.lowered_wall_share * w, options.minimum_wall);
  GroundHeights heights =
      ground_heights(mesh, plan.building, plan.roofs, dtm, options.minimum_wall, wall);
  plan.ground = std::move(heights.z);
  plan.lowered = heights.lowered;
  plan.rise = ground_rise(mesh, plan.ground);
  plan.layers = plan_layers(plan.ground, plan.roofs, highest_under(dtm, bounds(mesh.vertices)),
                            options.domain_height, options.layer_height);
  plan.top.assign(mesh.vertices.size(), plan.layers.top);
  return plan;
}

ColumnMesh divide_columns(GroundMesh ground, EdgeGraph edges, const ColumnPlan& plan) {
  ColumnMesh mesh;
  mesh.ground = std::move(ground);
  mesh.edges = std::move(edges);
  const std::size_t vertices = mesh.vertex_count();
  const std::vector<std::uint8_t> outside = outside_vertices(mesh.ground);
  mesh.roof.assign(vertices, kNoRoof);
  mesh.first.assign(vertices + 1, 0);
  parallel_chunks(vertices, kColumnsPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Division division = divide(plan, v, outside[v] != 0);
      if (plan.building[v] != kNoBuilding) mesh.roof[v] = division.below_roof;
      mesh.first[v + 1] = division.below_roof + division.above + 1;
    }
  });
  for (std::size_t v = 0; v < vertices; ++v) mesh.first[v + 1] += mesh.first[v];
  mesh.z.resize(static_cast<std::size_t>(mesh.node_count()));
  return mesh;
}

void place_nodes(ColumnMesh& mesh, const ColumnPlan& plan) {
  parallel_chunks(mesh.vertex_count(), kColumnsPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      double* z = mesh.z.data() + mesh.first[v];
      const auto segments =
          static_cast<std::int32_t>(mesh.top(static_cast<VertexIndex>(v)) - mesh.first[v]);
      const std::int32_t roof = std::max(mesh.roof[v], 0);
      if (plan.building[v] == kNoBuilding) {
        z = spread_from_ground(z, plan, v, plan.top[v], segments);
      } else {
        const double height = plan.roofs[static_cast<std::size_t>(plan.building[v])];
        if (roof > 0) z = spread_from_ground(z, plan, v, height, roof);
        z = spread(z, height, plan.top[v], segments - roof);
      }
      *z = plan.top[v];
    }
  });
}

ColumnMesh columns_of_layers(LayeredMesh&& layered) {
  ColumnMesh mesh;
  const std::size_t vertices = layered.vertex_count();
  mesh.first.assign(vertices + 1, 0);
  mesh.roof.assign(vertices, kNoRoof);
  for (std::size_t v = 0; v < vertices; ++v) {
    mesh.first[v + 1] = mesh.first[v] + layered.layers + 1 - layered.first_node[v];
    if (layered.roof_layer[v] != kNoRoof)
      mesh.roof[v] = layered.roof_layer[v] - layered.first_node[v];
  }
  mesh.z.resize(static_cast<std::size_t>(mesh.node_count()));
  parallel_chunks(vertices, kColumnsPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      std::copy(layered.column(v) + layered.first_node[v], layered.column(v) + layered.layers + 1,
                mesh.z.begin() + mesh.first[v]);
  });
  mesh.ground = std::move(layered.ground);
  mesh.edges = std::move(layered.edges);
  layered = {};
  return mesh;
}

}  // namespace tetropolis
