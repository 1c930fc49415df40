#include "make_columns.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "volume/layered/free_top.h"
#include "volume/layered/smooth.h"

namespace tetropolis {

namespace {

/// More layers than this come from a stray point or a slip of the keyboard.
constexpr std::int32_t kMostLayers = 5000;

/// Tangent of a free top's slope, at most.
constexpr double kSteepestTop = 1.5;

void require_plausible(const LayerPlan& plan) {
  if (plan.layers <= kMostLayers) return;
  throw Error(ErrorKind::kUsage,
              fmt::format("the mesh would have {} layers between the mean ground at {:.1f} m and "
                          "the top at {:.1f} m (highest ground {:.1f} m{}); raise --mesh-size or "
                          "--layer-height, or lower --domain-height",
                          plan.layers, plan.bottom, plan.top, plan.highest_ground,
                          plan.raised ? "; the top clears a roof above it: is that roof real?"
                                      : ", a stray point?"));
}

void keep_solver(const std::string& step, const SmoothReport& smooth, Report& report) {
  const SolverReport& solver = smooth.solver;
  report.solver.push_back(
      {step, solver.unknowns, solver.iterations, solver.relative_residual, solver.converged});
  report.volume_mesh->moved_by_guard += smooth.guard.moved;
  if (!solver.converged)
    report.warnings.push_back(
        {"solver_not_converged", 1,
         fmt::format(
             "step {}: relative residual {:.2g} after {} iterations; cells are valid nevertheless",
             step, solver.relative_residual, solver.iterations)});
}

std::vector<double> spacing_of(const Config& config, const GroundMesh& ground) {
  std::vector<double> spacing = column_spacing(ground);
  if (config.layer_height > 0)
    for (double& s : spacing) s = std::min(s, config.layer_height);
  return spacing;
}

/// Heights of ground, roofs and top; tells the report of the top.
ColumnPlan plan_of(const Config& config, const CityModel& city, const Raster& dtm,
                   const GroundMesh& ground, std::vector<double> spacing, Report& report) {
  std::vector<double> roofs;
  for (const Building& building : city.buildings) roofs.push_back(building.h_roof);
  ColumnPlan plan =
      plan_columns(ground, dtm, std::move(roofs), std::move(spacing), plan_options(config));
  require_plausible(plan.layers);
  VolumeMeshReport& volume = report.volume_mesh.emplace();
  volume.layers = plan.layers.layers;
  volume.top = plan.layers.top;
  if (plan.layers.raised)
    report.warnings.push_back(
        {"domain_raised", 1,
         fmt::format("the top was raised to {:.1f} m, two {} above the highest roof",
                     plan.layers.top,
                     config.layering == Layering::kUniform ? "layers" : "mesh sizes")});
  return plan;
}

/// Steps 3.2 to 3.5 as in the paper; with graded columns as far as the top they give.
Columns smooth_columns(const Config& config, const CityModel& city, const Raster& dtm,
                       const CitySize& size, GroundMesh ground, StepClock& clock, Report& report) {
  ColumnPlan plan;
  LayeredMesh layered = clock.run("3.2", "layers", [&](const Progress&) {
    plan = plan_of(config, city, dtm, ground, spacing_of(config, ground), report);
    const auto triangles = static_cast<double>(ground.triangles.size());
    require_cells_fit(config, size, triangles, 3 * triangles * plan.layers.layers);
    return make_layers(std::move(ground), plan.layers.layers, plan.layers.bottom, plan.layers.top);
  });
  SmoothOptions options;
  options.laplace.tolerance = config.solver_tolerance;
  options.laplace.max_iterations = config.solver_iterations;
  options.laplace.fixed_top = config.top == Top::kFlat;
  options.gap_share = config.min_gap_share;
  const SmoothReport to_ground =
      clock.run("3.3", "smooth to ground", [&](const Progress& progress) {
        return smooth_to_ground(layered, plan.ground, options, progress);
      });
  keep_solver("3.3", to_ground, report);
  clock.run("3.4", "trim buildings",
            [&](const Progress&) { trim(layered, plan.building, plan.roofs); });
  const SmoothReport to_roofs = clock.run("3.5", "smooth to roofs", [&](const Progress& progress) {
    return smooth_to_roofs(layered, plan.building, plan.roofs, options, progress);
  });
  keep_solver("3.5", to_roofs, report);
  if (config.layering == Layering::kUniform)
    return {std::move(plan), columns_of_layers(std::move(layered))};
  for (std::size_t v = 0; v < plan.top.size(); ++v) plan.top[v] = layered.column(v)[layered.layers];
  limit_slope(layered.ground, layered.edges, kSteepestTop, plan.top);
  require_cells_fit(config, size, static_cast<double>(layered.ground.triangles.size()),
                    estimate_cells(plan));
  ColumnMesh mesh = divide_columns(std::move(layered.ground), std::move(layered.edges), plan);
  place_nodes(mesh, plan);
  return {std::move(plan), std::move(mesh)};
}

/// Steps 3.2 to 3.5 with columns spaced by the triangles around them. Their heights follow from
/// ground, roofs and top directly, so 3.3 and 3.5 have nothing to solve.
Columns grade_columns(const Config& config, const CityModel& city, const Raster& dtm,
                      const CitySize& size, GroundMesh ground, StepClock& clock, Report& report) {
  std::vector<double> spacing = clock.run(
      "3.2", "spacing of columns", [&](const Progress&) { return spacing_of(config, ground); });
  ColumnPlan plan = clock.run("3.3", "ground and top", [&](const Progress&) {
    return plan_of(config, city, dtm, ground, std::move(spacing), report);
  });
  ColumnMesh mesh = clock.run("3.4", "divide and trim columns", [&](const Progress&) {
    require_cells_fit(config, size, static_cast<double>(ground.triangles.size()),
                      estimate_cells(plan));
    EdgeGraph edges = build_edge_graph(ground);
    return divide_columns(std::move(ground), std::move(edges), plan);
  });
  clock.run("3.5", "place nodes", [&](const Progress&) { place_nodes(mesh, plan); });
  for (const char* step : {"3.3", "3.5"}) report.solver.push_back({step, 0, 0, 0.0, true});
  return {std::move(plan), std::move(mesh)};
}

}  // namespace

ColumnPlanOptions plan_options(const Config& config) {
  const bool uniform = config.layering == Layering::kUniform;
  ColumnPlanOptions options;
  options.domain_height = config.domain_height;
  options.layer_height =
      uniform && config.layer_height > 0 ? config.layer_height : config.mesh_size;
  options.minimum_wall = config.min_wall_height;
  options.fit_lowered_walls = !uniform;
  return options;
}

Columns make_columns(const Config& config, const CityModel& city, const Raster& dtm,
                     const CitySize& size, GroundMesh ground, StepClock& clock, Report& report) {
  const bool solves = solves_laplace(config);
  const auto make = solves ? smooth_columns : grade_columns;
  Columns columns = make(config, city, dtm, size, std::move(ground), clock, report);
  report.volume_mesh->min_vertical_gap = require_valid(columns.mesh);
  return columns;
}

}  // namespace tetropolis
