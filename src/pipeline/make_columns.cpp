#include "make_columns.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/infinity.h"
#include "volume/column/ground_heights.h"
#include "volume/column/levels.h"
#include "volume/column/roof_heights.h"
#include "volume/excavate/ease_ground.h"
#include "volume/layered/free_top.h"
#include "volume/layered/ladder.h"
#include "volume/layered/layered_mesh.h"
#include "volume/layered/smooth.h"
#include "volume/layers/prism_layers.h"
#include "volume/upper/lid.h"

namespace tetropolis {

namespace {

/// More layers than this come from a stray point or a slip of the keyboard.
constexpr std::int32_t kMostLayers = 5000;

/// Rounds of closing steps between roofs.
constexpr int kMostClosings = 5;

/// Tangent of a free top's slope, at most.
constexpr double kSteepestTop = 1.5;

void require_plausible(const LayerPlan& plan) {
  if (plan.layers <= kMostLayers) return;
  throw Error(ErrorKind::kUsage,
              fmt::format("the mesh would have {} layers between the mean ground at {:.1f} m and "
                          "the top at {:.1f} m (highest ground {:.1f} m{}); raise mesh_size or "
                          "layer_height, or lower domain_height",
                          plan.layers, plan.bottom, plan.top, plan.highest_ground,
                          plan.raised ? "; the top clears a roof above it: is that roof real?"
                                      : ", a stray point?"));
}

void keep_solver(const std::string& step, const SmoothReport& smooth, CityMesh& result) {
  const SolverReport& solver = smooth.solver;
  result.solver.push_back(
      {step, solver.unknowns, solver.iterations, solver.relative_residual, solver.converged});
  result.volume_facts.moved_by_guard += smooth.guard.moved;
  if (!solver.converged)
    result.warnings.push_back(
        {"solver_not_converged", 1,
         fmt::format(
             "step {}: relative residual {:.2g} after {} iterations; cells are valid nevertheless",
             step, solver.relative_residual, solver.iterations)});
}

std::vector<double> spacing_of(const MeshCityOptions& options, const GroundMesh& ground) {
  std::vector<double> spacing = column_spacing(ground);
  if (options.layer_height > 0)
    for (double& s : spacing) s = std::min(s, options.layer_height);
  return spacing;
}

/// Roofs of the mesh's vertices; without `edges` they are horizontal.
RoofHeights roofs_over(const MeshCityOptions& options, const CityParts& parts,
                       const GroundMesh& ground, const EdgeGraph* edges, CityMesh& result) {
  if (edges == nullptr) {
    RoofHeights roofs;
    for (const RoofPlane& roof : parts.roofs) roofs.flat.push_back(roof.elevation);
    return roofs;
  }
  ReconciledRoofs reconciled =
      reconcile_roofs(ground, *edges, parts.roofs, least_roof_step(options.mesh_size));
  VolumeMeshFacts& volume = result.volume_facts;
  volume.roofs_met = reconciled.closed;
  volume.most_roofs_met = reconciled.most_closed;
  volume.roofs_lifted = reconciled.lifted;
  volume.most_roofs_lifted = reconciled.most_lifted;
  return std::move(reconciled.roofs);
}

/// Height of the layers below the columns.
std::vector<double> lift_of(const MeshCityOptions& options, const Raster& dtm,
                            const GroundMesh& ground, const EdgeGraph* edges,
                            const RoofHeights& roofs) {
  const LayerHeights& heights = options.boundary_layers;
  if (heights.count == 0) return {};
  if (heights.total() > options.domain_height / 2)
    throw Error(ErrorKind::kUsage,
                fmt::format("boundary_layers: {} layers are {:.1f} m high, more than half of the "
                            "domain's {:.1f} m; lower boundary_layers, first_layer or layer_growth",
                            heights.count, heights.total(), options.domain_height));
  return layer_lift(ground, edges == nullptr ? build_edge_graph(ground) : *edges,
                    terrain_under(ground, dtm), lowest_roofs(ground, roofs), roofs, heights,
                    options.min_wall_height, options.cells == Cells::kPrisms ? 0 : 1);
}

/// Heights of ground, roofs and top; tells the report of the top.
ColumnPlan plan_of(const MeshCityOptions& options, const CityParts& parts, const Raster& dtm,
                   const GroundMesh& ground, const EdgeGraph* edges, std::vector<double> spacing,
                   CityMesh& result) {
  RoofHeights roofs = roofs_over(options, parts, ground, edges, result);
  ColumnPlanOptions to_plan = plan_options(options);
  const std::vector<double> lift = lift_of(options, dtm, ground, edges, roofs);
  to_plan.lift = lift;
  ColumnPlan plan = plan_columns(ground, dtm, std::move(roofs), std::move(spacing), to_plan);
  require_plausible(plan.layers);
  VolumeMeshFacts& volume = result.volume_facts;
  volume.layers = plan.layers.layers;
  volume.top = plan.layers.top;
  if (plan.layers.raised)
    result.warnings.push_back(
        {"domain_raised", 1,
         fmt::format("the top was raised to {:.1f} m, two {} above the highest roof",
                     plan.layers.top,
                     options.layering == Layering::kUniform ? "layers" : "mesh sizes")});
  return plan;
}

/// Lowers ground that prisms would be sheared on.
void ease(const MeshCityOptions& options, const GroundMesh& ground, ColumnPlan& plan) {
  if (options.cut_slope_deg >= 90) return;
  PrismBounds bounds;
  bounds.slope_deg = eased_slope(options);
  plan.eased = ease_ground(ground, build_edge_graph(ground), plan.lift,
                           options.boundary_layers.first, bounds, plan.ground);
  if (plan.eased.empty()) return;
  count_lowered(ground, options.min_wall_height, plan);
}

/// The highest layer on which the flattest triangle makes no prism of a greater aspect ratio than
/// is meant, less what layers are stretched by where ground is low.
double highest_layer(const GroundMesh& ground) {
  constexpr double kAspect = 54;
  double least = kInfinity;
  for (const auto& v : ground.triangles) {
    const Point2 a = ground.vertices[v[0]], b = ground.vertices[v[1]], c = ground.vertices[v[2]];
    const double area = ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
    const auto [left, right] = std::minmax({a.x, b.x, c.x});
    const auto [front, back] = std::minmax({a.y, b.y, c.y});
    least = std::min(least, area / std::max(right - left, back - front));
  }
  return kAspect * least;
}

/// The layers that columns of prisms share: between buildings as high as triangles of the mesh size
/// are far from corner to centre, above them up to six times that.
std::vector<double> ladder_of(const MeshCityOptions& options, const GroundMesh& ground,
                              const ColumnPlan& plan) {
  constexpr double kCanopy = 0.6, kFar = 3.6;
  const LayerHeights& below = options.boundary_layers;
  LadderSpacing spacing;
  spacing.first = below.first * std::pow(below.growth, below.count);
  spacing.growth = std::max(below.growth, 1.05);
  spacing.canopy = std::max(kCanopy * options.mesh_size, spacing.first);
  spacing.far = std::max(std::min(kFar * options.mesh_size, highest_layer(ground)), spacing.canopy);
  const auto& roofs = plan.roofs.flat;
  const double highest =
      roofs.empty() ? plan.layers.bottom : *std::max_element(roofs.begin(), roofs.end());
  return make_ladder(plan.layers.bottom, highest, plan.layers.top, spacing);
}

/// Steps 3.2 to 3.5 as in the paper; with graded columns as far as the top they give.
Columns smooth_columns(const MeshCityOptions& options, const CityParts& parts, const Raster& dtm,
                       const CitySize& size, GroundMesh ground, StepClock& clock,
                       CityMesh& result) {
  ColumnPlan plan;
  LayeredMesh layered = clock.run("3.2", "layers", [&](const Progress&) {
    plan = plan_of(options, parts, dtm, ground, nullptr, spacing_of(options, ground), result);
    const auto triangles = static_cast<double>(ground.triangles.size());
    if (options.cells == Cells::kPrisms) {
      ease(options, ground, plan);
      std::vector<double> ladder = ladder_of(options, ground, plan);
      plan.layers.layers = static_cast<std::int32_t>(ladder.size()) - 1;
      result.volume_facts.layers = plan.layers.layers;
      require_cells_fit(options, size, triangles, 3 * triangles * plan.layers.layers);
      return make_layers(std::move(ground), std::move(ladder));
    }
    require_cells_fit(options, size, triangles, 3 * triangles * plan.layers.layers);
    return make_layers(std::move(ground), plan.layers.layers, plan.layers.bottom, plan.layers.top);
  });
  SmoothOptions smooth;
  smooth.laplace.tolerance = options.solver_tolerance;
  smooth.laplace.max_iterations = options.solver_iterations;
  smooth.laplace.fixed_top = options.top == Top::kFlat;
  smooth.gap_share = options.min_gap_share;
  const SmoothReport to_ground =
      clock.run("3.3", "smooth to ground", [&](const Progress& progress) {
        return smooth_to_ground(layered, plan.ground, smooth, progress);
      });
  keep_solver("3.3", to_ground, result);
  clock.run("3.4", "trim buildings",
            [&](const Progress&) { trim(layered, plan.lowest_roof, plan.roofs.flat); });
  const SmoothReport to_roofs = clock.run("3.5", "smooth to roofs", [&](const Progress& progress) {
    return smooth_to_roofs(layered, plan.lowest_roof, plan.roofs.flat, smooth, progress);
  });
  keep_solver("3.5", to_roofs, result);
  if (options.layering == Layering::kUniform)
    return {std::move(plan), columns_of_layers(std::move(layered))};
  for (const VertexIndex v : layered.ground.vertices.indices())
    plan.top[v] = layered.column(v)[layered.layers];
  limit_slope(layered.ground, layered.edges, kSteepestTop, plan.top);
  require_cells_fit(options, size, static_cast<double>(layered.ground.triangles.size()),
                    estimate_cells(plan));
  ColumnMesh mesh = divide_columns(std::move(layered.ground), std::move(layered.edges), plan);
  place_nodes(mesh, plan);
  return {std::move(plan), std::move(mesh)};
}

/// Steps 3.2 to 3.5 with columns spaced by the triangles around them. Their heights follow from
/// ground, roofs and top directly, so 3.3 and 3.5 have nothing to solve.
Columns grade_columns(const MeshCityOptions& options, const CityParts& parts, const Raster& dtm,
                      const CitySize& size, GroundMesh ground, StepClock& clock, CityMesh& result) {
  std::vector<double> spacing = clock.run(
      "3.2", "spacing of columns", [&](const Progress&) { return spacing_of(options, ground); });
  EdgeGraph edges;
  ColumnPlan plan = clock.run("3.3", "ground and top", [&](const Progress&) {
    edges = build_edge_graph(ground);
    ColumnPlan to_top = plan_of(options, parts, dtm, ground, &edges, std::move(spacing), result);
    if (ends_at_lid(options)) lower_tops(ground, edges, to_top);
    return to_top;
  });
  const auto divide = [&](const Progress&) {
    require_cells_fit(options, size, static_cast<double>(ground.triangles.size()),
                      estimate_cells(plan));
    return divide_columns(std::move(ground), std::move(edges), plan);
  };
  ColumnMesh mesh = clock.run("3.4", "divide and trim columns", divide);
  const auto place = [&](const Progress&) { place_nodes(mesh, plan); };
  clock.run("3.5", "place nodes", place);
  // Where no front passes through a roof's edge, the step there is closed.
  for (int i = 0; i < kMostClosings && !plan.roofs.all_flat(); ++i) {
    const std::int64_t closed = clock.run(
        "3.5", "levels of roofs", [&](const Progress&) { return find_levels(mesh, plan.roofs); });
    if (closed == 0) break;
    result.volume_facts.roof_steps_closed += closed;
    ground = std::move(mesh.ground);
    edges = std::move(mesh.edges);
    mesh = clock.run("3.4", "divide and trim columns", divide);
    clock.run("3.5", "place nodes", place);
  }
  for (const char* step : {"3.3", "3.5"}) result.solver.push_back({step, 0, 0, 0.0, true});
  return {std::move(plan), std::move(mesh)};
}

}  // namespace

double eased_slope(const MeshCityOptions& options) {
  return std::min(PrismBounds{}.slope_deg, options.cut_slope_deg);
}

ColumnPlanOptions plan_options(const MeshCityOptions& options) {
  const bool uniform = options.layering == Layering::kUniform;
  ColumnPlanOptions plan;
  plan.domain_height = options.domain_height;
  plan.layer_height =
      uniform && options.layer_height > 0 ? options.layer_height : options.mesh_size;
  plan.minimum_wall = options.min_wall_height;
  plan.fit_lowered_walls = !uniform;
  return plan;
}

Columns make_columns(const MeshCityOptions& options, const CityParts& parts, const Raster& dtm,
                     const CitySize& size, GroundMesh ground, StepClock& clock, CityMesh& result) {
  const auto make = solves_laplace(options) ? smooth_columns : grade_columns;
  return make(options, parts, dtm, size, std::move(ground), clock, result);
}

}  // namespace tetropolis
