#include "smooth.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "tetropolis/core/error.h"

#include "core/infinity.h"
#include "core/parallel.h"
#include "core/ragged_builder.h"
#include "geometry/vec2.h"

namespace tetropolis {

namespace {

constexpr std::size_t kColumnsPerChunk = 512;

MonotoneReport guard(LayeredMesh& mesh, const SmoothOptions& options, double layer_height) {
  return make_monotone(mesh, {options.gap_share, options.laplace.fixed_top, layer_height});
}

/// Adds the displacement to every node that has cells.
void displace(LayeredMesh& mesh, const std::vector<float>& u) {
  parallel_chunks(mesh.vertex_count(), kColumnsPerChunk, [&](std::size_t begin, std::size_t end) {
    for (const VertexIndex v : indices<VertexIndex>(begin, end))
      for (std::int32_t k = mesh.first_node[v]; k <= mesh.layers; ++k)
        mesh.column(v)[k] +=
            static_cast<double>(u[v * mesh.stride() + static_cast<std::size_t>(k)]);
  });
}

/// Share of the height from layer `low` to the top that is above layer k.
double share_above(const LayeredMesh& mesh, std::int32_t low, std::int32_t k) {
  if (mesh.ladder.empty()) return static_cast<double>(mesh.layers - k) / (mesh.layers - low);
  return 1 - share_below(mesh, low, k, mesh.layers);
}

/// Position of elevation `z` in a column, in layers above its ground.
double position_in_layers(const double* column, std::int32_t layers, double z) {
  std::int32_t k = 0;
  while (k + 1 < layers && column[k + 1] < z) ++k;
  return k + (z - column[k]) / (column[k + 1] - column[k]);
}

/// The whole number p is nearest to in ratio.
std::int32_t nearest_in_ratio(double p) {
  const double below = std::floor(p);
  return static_cast<std::int32_t>(p * p > below * (below + 1) ? below + 1 : below);
}

/// An open edge from a wall, and the column beyond.
struct WallEdge {
  VertexIndex on_wall, beyond;
  double length;
};

/// Per building part.
RaggedArray<WallEdge> wall_edges(const LayeredMesh& mesh, std::span<const RegionIndex> roof,
                                 std::size_t parts) {
  return ragged_from_pairs<WallEdge>(parts, [&](const auto& use) {
    for (const EdgeIndex e : indices<EdgeIndex>(mesh.edges.size())) {
      const auto& beside = mesh.edges.triangles[e];
      if (std::none_of(beside.begin(), beside.end(), [&](TriangleIndex t) {
            return t != kNoTriangle && !mesh.ground.inside_building(t);
          }))
        continue;
      const auto& [a, b] = mesh.edges.vertices[e];
      if (roof[a] == roof[b]) continue;
      const Point2 p = mesh.ground.vertices[a], q = mesh.ground.vertices[b];
      const double length = distance(p, q);
      if (roof[a] != kNoRegion) use(roof[a].value(), WallEdge{a, b, length});
      if (roof[b] != kNoRegion) use(roof[b].value(), WallEdge{b, a, length});
    }
  });
}

/// Of slopes from a roof to layers that improve_prisms() can move; one to another roof counts in
/// full.
constexpr double kShareOfFree = 0.75;

/// Moves roofs to other layers, between the lowest and the highest that their walls reach, where
/// those rise or fall less steeply to the columns beside them, which may be walls of others.
void fit_to_neighbours(const LayeredMesh& mesh, std::span<const RegionIndex> roof,
                       std::span<const double> roofs, std::span<const double> least,
                       std::span<const double> most, std::vector<std::int32_t>& roof_layer) {
  const auto layer_at = [&](VertexIndex v, std::int32_t k) {
    const double* const z = mesh.column(v);
    if (roof[v] == kNoRegion) return z[k];
    const std::int32_t own = roof_layer[roof[v]];
    if (k > own) return roofs[roof[v]] + z[k] - z[own];
    return z[0] + (roofs[roof[v]] - z[0]) * (z[k] - z[0]) / (z[own] - z[0]);
  };
  const RaggedArray<WallEdge> edges = wall_edges(mesh, roof, roofs.size());
  constexpr int kMostSweeps = 10;
  bool again = true;
  for (int sweep = 0; again && sweep < kMostSweeps; ++sweep) {
    again = false;
    for (std::size_t b = 0; b < roofs.size(); ++b) {
      if (roof_layer[b] == kNoRoof) continue;
      const auto steepest = [&](std::int32_t k) {
        double slope = 0;
        for (const WallEdge& edge : edges[b]) {
          const RegionIndex other = roof[edge.beyond];
          const double share = other != kNoRegion && roof_layer[other] == k ? 1 : kShareOfFree;
          slope =
              std::max(slope, share * std::abs(layer_at(edge.beyond, k) - roofs[b]) / edge.length);
        }
        return slope;
      };
      const std::int32_t before = roof_layer[b];
      double best = steepest(before);
      const auto lowest = std::max(static_cast<std::int32_t>(std::floor(least[b])), 1);
      const auto highest = std::min(static_cast<std::int32_t>(std::ceil(most[b])), mesh.layers - 1);
      for (std::int32_t k = lowest; k <= highest; ++k) {
        const double slope = steepest(k);
        if (!(slope < 0.95 * best)) continue;
        best = slope;
        roof_layer[b] = k;
      }
      again |= roof_layer[b] != before;
    }
  }
}

/// Over all columns, each from its lowest node up.
double mean_layer_height(const LayeredMesh& mesh) {
  double height = 0, layers = 0;
  for (const VertexIndex v : mesh.ground.vertices.indices()) {
    height += mesh.column(v)[mesh.layers] - mesh.column(v)[mesh.first_node[v]];
    layers += mesh.layers - mesh.first_node[v];
  }
  return height / layers;
}

}  // namespace

SmoothReport smooth_to_ground(LayeredMesh& mesh, std::span<const double> ground,
                              const SmoothOptions& options, const Progress& progress) {
  const double layer_height = mean_layer_height(mesh);
  const std::size_t n = mesh.stride();
  // First guess: the ground's displacement, fading linearly towards the top.
  std::vector<float> u(mesh.z.size());
  parallel_chunks(mesh.vertex_count(), kColumnsPerChunk, [&](std::size_t begin, std::size_t end) {
    for (const VertexIndex v : indices<VertexIndex>(begin, end)) {
      const double shift = ground[v] - mesh.column(v)[0];
      for (std::int32_t k = 0; k <= mesh.layers; ++k)
        u[v * n + static_cast<std::size_t>(k)] = static_cast<float>(
            options.laplace.fixed_top ? shift * (1 - share_below(mesh, 0, k, mesh.layers)) : shift);
    }
  });
  SmoothReport report;
  report.solver = solve_laplace(mesh, u, options.laplace, progress);
  displace(mesh, u);
  for (const VertexIndex v : mesh.ground.vertices.indices()) mesh.column(v)[0] = ground[v];
  report.guard = guard(mesh, options, layer_height);
  return report;
}

void trim(LayeredMesh& mesh, std::span<const RegionIndex> lowest_roof,
          std::span<const double> roofs) {
  std::vector<double> least(roofs.size(), kInfinity);
  std::vector<double> most(roofs.size(), 0.0);
  for (const VertexIndex v : mesh.ground.vertices.indices()) {
    const RegionIndex b = lowest_roof[v];
    if (b == kNoRegion) continue;
    const double p = position_in_layers(mesh.column(v), mesh.layers, roofs[b]);
    least[b] = std::min(least[b], p);
    most[b] = std::max(most[b], p);
  }
  std::vector<std::int32_t> roof_layer(roofs.size(), kNoRoof);
  for (std::size_t b = 0; b < roofs.size(); ++b)
    if (least[b] < kInfinity)
      roof_layer[b] =
          std::clamp(nearest_in_ratio(std::sqrt(least[b] * most[b])), 1, mesh.layers - 1);
  if (!mesh.ladder.empty()) fit_to_neighbours(mesh, lowest_roof, roofs, least, most, roof_layer);

  std::fill(mesh.first_node.begin(), mesh.first_node.end(), mesh.layers);
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    const RegionIndex region = mesh.ground.region[t];
    const bool is_roof = mesh.ground.inside_building(t);
    mesh.first_layer[t] = is_roof ? roof_layer[region] : 0;
    for (const VertexIndex v : mesh.ground.triangles[t]) {
      if (is_roof && lowest_roof[v] != region)
        throw Error(ErrorKind::kGuarantee,
                    "uniform layers: two roofs end at ground vertex " + std::to_string(v));
      auto& first = mesh.first_node[v];
      first = std::min(first, mesh.first_layer[t]);
    }
  }
  for (const VertexIndex v : mesh.ground.vertices.indices())
    mesh.roof_layer[v] = lowest_roof[v] == kNoRegion ? kNoRoof : roof_layer[lowest_roof[v]];
}

SmoothReport smooth_to_roofs(LayeredMesh& mesh, std::span<const RegionIndex> lowest_roof,
                             std::span<const double> roofs, const SmoothOptions& options,
                             const Progress& progress) {
  const double layer_height = mean_layer_height(mesh);
  const std::size_t n = mesh.stride();
  // First guess: the roof's displacement, fading linearly towards the top and down the wall.
  std::vector<float> u(mesh.z.size(), 0.0F);
  const auto guess_column = [&](VertexIndex v) {
    if (lowest_roof[v] == kNoRegion) return;
    const std::int32_t roof = mesh.roof_layer[v];
    const double shift = roofs[lowest_roof[v]] - mesh.column(v)[roof];
    for (std::int32_t k = mesh.first_node[v] == roof ? roof : 0; k <= mesh.layers; ++k) {
      const double share = k <= roof                   ? share_below(mesh, 0, k, roof)
                           : options.laplace.fixed_top ? share_above(mesh, roof, k)
                                                       : 1.0;
      u[v * n + static_cast<std::size_t>(k)] = static_cast<float>(shift * share);
    }
  };
  parallel_chunks(mesh.vertex_count(), kColumnsPerChunk, [&](std::size_t begin, std::size_t end) {
    for (const VertexIndex v : indices<VertexIndex>(begin, end)) guess_column(v);
  });
  SmoothReport report;
  report.solver = solve_laplace(mesh, u, options.laplace, progress);
  displace(mesh, u);
  for (const VertexIndex v : mesh.ground.vertices.indices())
    if (lowest_roof[v] != kNoRegion) mesh.column(v)[mesh.roof_layer[v]] = roofs[lowest_roof[v]];
  report.guard = guard(mesh, options, layer_height);
  return report;
}

}  // namespace tetropolis
