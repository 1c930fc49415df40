#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/core/units.h"
#include "tetropolis/ground/mesh_ground.h"
#include "tetropolis/ground/validate.h"
#include "tetropolis/io/gltf.h"
#include "tetropolis/io/msh.h"
#include "tetropolis/io/obj.h"
#include "tetropolis/io/openfoam.h"
#include "tetropolis/io/ply.h"
#include "tetropolis/io/stl.h"
#include "tetropolis/io/vtk.h"
#include "tetropolis/io/xdmf.h"
#include "tetropolis/volume/boundary.h"
#include "tetropolis/volume/cell_quality.h"
#include "tetropolis/volume/cut_back.h"
#include "tetropolis/volume/face_quality.h"
#include "tetropolis/volume/fill_columns.h"
#include "tetropolis/volume/ground_heights.h"
#include "tetropolis/volume/improve_columns.h"
#include "tetropolis/volume/smooth.h"

#include "memory.h"
#include "stages.h"

namespace tetropolis {

namespace {

/// More layers than this come from a stray point or a slip of the keyboard.
constexpr std::int32_t kMostLayers = 5000;

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

CitySize size_of(const Config& config, const CityModel& city, const Raster& dtm) {
  CitySize size;
  size.area = city.domain.width() * city.domain.height();
  for (const Building& building : city.buildings) size.add(building.footprint);
  double sum = 0;
  for (const double z : dtm.values) sum += z;
  size.height = highest_under(dtm, city.domain) + config.domain_height -
                sum / static_cast<double>(dtm.values.size());
  size.terrain_nodes = static_cast<double>(dtm.values.size());
  return size;
}

/// About the cells that columns will have, before they are made: every segment makes a tet in each
/// of the about six triangles around it.
double estimate_cells(const ColumnPlan& plan) {
  double cells = 0;
  for (std::size_t v = 0; v < plan.top.size(); ++v)
    cells += 6 * std::max(1.0, (plan.top[v] - plan.ground[v]) / plan.spacing[v]);
  return cells;
}

GroundMesh make_ground(const Config& config, const CityModel& city, const Raster& dtm,
                       StepClock& clock, Report& report) {
  std::vector<Polygon> footprints;
  for (const Building& building : city.buildings) footprints.push_back(building.footprint);
  GroundMeshOptions options{config.mesh_size, config.min_angle};
  if (config.layering != Layering::kUniform) {
    options.wall_edge = [&](BuildingIndex building, Point2 a, Point2 b) {
      const double roof = city.buildings[static_cast<std::size_t>(building)].h_roof;
      return longest_wall_edge(dtm, roof, a, b, config.min_wall_height);
    };
    options.elevation = [&](Point2 p) { return sample(dtm, p); };
  }
  GroundMesh ground = clock.run("3.1", "ground mesh", [&](const Progress& progress) {
    return mesh_ground(footprints, city.domain, options, progress);
  });
  report.ground_mesh =
      GroundMeshReport{static_cast<std::int64_t>(ground.vertices.size()),
                       static_cast<std::int64_t>(ground.triangles.size()),
                       angle_statistics(ground.vertices, ground.triangles).min_deg,
                       ground.small_input_angles, ground.triangles_below_min_angle};
  return ground;
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

ColumnPlanOptions plan_options(const Config& config) {
  const bool uniform = config.layering == Layering::kUniform;
  ColumnPlanOptions options;
  options.domain_height = config.domain_height;
  options.layer_height =
      uniform && config.layer_height > 0 ? config.layer_height : config.mesh_size;
  options.minimum_wall = config.min_wall_height;
  options.fit_lowered_walls = !uniform;
  options.cut_slopes.at_start = std::tan(to_radians(config.cut_slope));
  return options;
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

/// The mesh, and what it was made from.
struct Columns {
  ColumnPlan plan;
  ColumnMesh mesh;
};

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

/// Steps 3.2 to 3.5.
Columns make_columns_of_city(const Config& config, const CityModel& city, const Raster& dtm,
                             const CitySize& size, GroundMesh ground, StepClock& clock,
                             Report& report) {
  const bool solves = solves_laplace(config);
  const auto make = solves ? smooth_columns : grade_columns;
  Columns columns = make(config, city, dtm, size, std::move(ground), clock, report);
  report.volume_mesh->min_vertical_gap = require_valid(columns.mesh);
  return columns;
}

/// Cells the report lists.
constexpr std::size_t kWorstCells = 10;

struct MeshQuality {
  CellQuality cells;
  FaceQuality faces;
  std::int64_t below_floor = 0;  ///< Cells outside of kQualityFloor.
};

/// The share of cells that may have an angle below kLeastOfMost.
constexpr double kFewCells = 1e-4;

bool is_within(const QualityHistogram& angles, const AngleBounds& bounds) {
  return angles.min_dihedral_deg() >= bounds.least && angles.max_dihedral_deg() <= bounds.greatest;
}

bool has_many_thin_cells(const MeshQuality& quality) {
  return quality.cells.histogram.dihedral_quantile_deg(kFewCells) < kLeastOfMost;
}

CellQuality measured_cells(const ColumnMesh& mesh, StepClock& clock) {
  return clock.run("3.6", "measure cells",
                   [&](const Progress&) { return measure_cells(mesh, kWorstCells); });
}

MeshQuality with_faces(CellQuality cells, const ColumnMesh& mesh, StepClock& clock) {
  return clock.run("3.6", "measure faces", [&](const Progress&) {
    const std::int64_t below =
        is_within(cells.histogram, kQualityFloor) ? 0 : count_bad_cells(mesh, kQualityFloor);
    return MeshQuality{std::move(cells), measure_faces(mesh), below};
  });
}

/// Works on faces beyond kMostNonOrthogonal, asking more and more of the cells, too: better cells
/// have better faces. Keeps what leaves fewer of these faces and no worse cells.
void straighten_faces(ColumnMesh& mesh, MeshQuality& quality, StepClock& clock,
                      VolumeMeshReport& volume) {
  constexpr double kStraight = 68;  // degrees, a little less than is allowed
  constexpr std::array kTargets{AngleBounds{12, 157}, AngleBounds{16, 152}, AngleBounds{20, 148}};
  for (const AngleBounds& target : kTargets) {
    if (quality.faces.above_70 == 0) return;
    // All that improve_columns changes.
    auto before = std::tuple(mesh.first, mesh.roof, mesh.z);
    const std::int64_t changed =
        clock.run("3.5", "straighten faces", [&](const Progress& progress) {
          ImproveOptions options;
          options.least_deg = target.least;
          options.greatest_deg = target.greatest;
          options.straight_deg = kStraight;
          return improve_columns(mesh, options, progress);
        });
    if (changed == 0) continue;
    const double gap = require_valid(mesh);
    MeshQuality now = with_faces(measured_cells(mesh, clock), mesh, clock);
    if (now.faces.above_70 < quality.faces.above_70 && now.below_floor <= quality.below_floor &&
        (has_many_thin_cells(quality) || !has_many_thin_cells(now))) {
      quality = std::move(now);
      volume.min_vertical_gap = gap;
      volume.columns_improved += changed;
    } else {
      std::tie(mesh.first, mesh.roof, mesh.z) = std::move(before);
    }
  }
}

/// Makes thin cells and faces beyond kMostNonOrthogonal better if there are any. The columns of
/// uniform layers are as asked for.
MeshQuality improve(const Config& config, ColumnMesh& mesh, StepClock& clock,
                    VolumeMeshReport& volume) {
  volume.columns_improved = 0;
  CellQuality cells = measured_cells(mesh, clock);
  if (config.layering == Layering::kUniform) return with_faces(std::move(cells), mesh, clock);
  const ImproveOptions options;
  if (!is_within(cells.histogram, {options.least_deg, options.greatest_deg})) {
    volume.columns_improved = clock.run("3.5", "improve cells", [&](const Progress& progress) {
      return improve_columns(mesh, options, progress);
    });
    if (volume.columns_improved > 0) {
      volume.min_vertical_gap = require_valid(mesh);
      cells = measured_cells(mesh, clock);
    }
  }
  MeshQuality quality = with_faces(std::move(cells), mesh, clock);
  straighten_faces(mesh, quality, clock, volume);
  return quality;
}

/// Times that columns are made anew, at most: where the ground was lowered, other cells change.
constexpr int kMostCuts = 8;

/// The bounds that the mesh is to be worked on for; nothing if it is above the floor.
std::optional<AngleBounds> missed_bounds(const MeshQuality& quality) {
  if (has_many_thin_cells(quality)) return AngleBounds{kLeastOfMost, kQualityFloor.greatest};
  if (quality.below_floor > 0 || quality.faces.above_70 > 0) return kQualityFloor;
  return std::nullopt;
}

/// Makes the columns anew with the terrain cut back as `options` say, if that leaves fewer cells
/// below the floor; or as many, and fewer faces beyond kMostNonOrthogonal; or as many of both, and
/// fewer cells outside the bounds. Else everything stays as it is and the result is false.
bool cut_back_once(const Config& config, const Raster& dtm, const CitySize& size,
                   const ColumnPlanOptions& options, const AngleBounds& bounds, Columns& columns,
                   MeshQuality& quality, StepClock& clock, VolumeMeshReport& volume) {
  // Not at the price of cells that are bad by any measure.
  const auto bad = [&](const MeshQuality& measured) {
    return std::tuple(measured.below_floor, has_many_thin_cells(measured), measured.faces.above_70,
                      count_bad_cells(columns.mesh, bounds));
  };
  const auto bad_before = bad(quality);
  const VolumeMeshReport volume_before = volume;
  Columns before;
  const bool is_cut = clock.run("3.3", "cut terrain back", [&](const Progress&) {
    ColumnPlan plan =
        plan_columns(columns.mesh.ground, dtm, columns.plan.roofs, columns.plan.spacing, options);
    if (plan.ground == columns.plan.ground ||
        !cells_fit(config, size, static_cast<double>(columns.mesh.triangle_count()),
                   estimate_cells(plan)))
      return false;
    plan.top = columns.plan.top;
    before = std::exchange(columns, {});
    columns.plan = std::move(plan);
    columns.mesh =
        divide_columns(std::move(before.mesh.ground), std::move(before.mesh.edges), columns.plan);
    place_nodes(columns.mesh, columns.plan);
    return true;
  });
  if (!is_cut) return false;
  volume.min_vertical_gap = require_valid(columns.mesh);
  MeshQuality now = improve(config, columns.mesh, clock, volume);
  if (bad(now) < bad_before) {
    quality = std::move(now);
    return true;
  }
  before.mesh.ground = std::move(columns.mesh.ground);
  before.mesh.edges = std::move(columns.mesh.edges);
  columns = std::move(before);
  volume = volume_before;
  return false;
}

/// Cuts the terrain back where cells or faces are below the floor, as long as that makes fewer:
/// around roofs below it first, then from the feet of cliffs and low walls. Exact terrain comes
/// first: nothing is cut where the floor is met without.
MeshQuality make_room(const Config& config, const Raster& dtm, const CitySize& size,
                      Columns& columns, MeshQuality quality, StepClock& clock,
                      VolumeMeshReport& volume) {
  if (config.layering == Layering::kUniform || config.cut_slope >= 90) return quality;
  ColumnPlanOptions options = plan_options(config);
  std::vector<std::uint8_t>
      bad_triangles;  // triangles; empty until they are looked for in this mesh
  const auto cut_from = [&](const auto& mark) {
    for (int round = 0; round < kMostCuts; ++round) {
      const std::optional<AngleBounds> bounds = missed_bounds(quality);
      if (!bounds) return;
      if (bad_triangles.empty()) bad_triangles = find_bad_triangles(columns.mesh, *bounds);
      const CutMarks marks_before = options.cut;
      if (mark(bad_triangles) == 0 ||
          !cut_back_once(config, dtm, size, options, *bounds, columns, quality, clock, volume)) {
        options.cut = marks_before;
        return;
      }
      bad_triangles.clear();
    }
  };
  options.cut.roofs.assign(columns.plan.roofs.size(), 0);
  cut_from([&](std::span<const std::uint8_t> bad) {
    return mark_buried_roofs(columns.mesh, columns.plan, bad, options.cut);
  });
  options.cut.feet.assign(columns.plan.ground.size(), std::numeric_limits<double>::infinity());
  cut_from([&](std::span<const std::uint8_t> bad) {
    return mark_feet(columns.mesh, columns.plan, bad, options.cut_slopes.at_start, options.cut);
  });
  return quality;
}

void report_lowered(const ColumnPlan& plan, Report& report) {
  report.volume_mesh->ground_lowered = plan.lowered;
  report.volume_mesh->roofs_cut_back = plan.cut_from.roofs;
  report.volume_mesh->feet_cut_back = plan.cut_from.feet;
  if (plan.lowered == 0) return;
  std::string where = "at walls, to stay below their roof";
  if (const std::size_t roofs = plan.cut_from.roofs.size(); roofs > 0)
    where += fmt::format("; around {} roof{} below the terrain", roofs, roofs == 1 ? "" : "s");
  if (const std::size_t feet = plan.cut_from.feet.size(); feet > 0)
    where += fmt::format("; at the feet of cliffs or low walls, in {} place{}", feet,
                         feet == 1 ? "" : "s");
  report.warnings.push_back(
      {"ground_lowered", plan.lowered,
       fmt::format("ground vertices were lowered, by up to {:.1f} m: {}", plan.deepest, where)});
}

void warn_below_floor(const ColumnMesh& mesh, const MeshQuality& quality, Report& report) {
  const std::optional<AngleBounds> bounds = missed_bounds(quality);
  if (!bounds) return;
  const QualityHistogram& angles = quality.cells.histogram;
  if (const std::int64_t bad = count_bad_cells(mesh, *bounds); bad > 0)
    report.warnings.push_back(
        {"below_quality_floor", bad,
         fmt::format(
             "cells have dihedral angles outside of {} to {} degrees (least {:.2f}, greatest "
             "{:.2f}), where {} to {} are meant for all and {} for all but one in ten thousand; "
             "worst_cells in the report has the worst and why",
             bounds->least, bounds->greatest, angles.min_dihedral_deg(), angles.max_dihedral_deg(),
             kQualityFloor.least, kQualityFloor.greatest, kLeastOfMost)});
  if (quality.faces.above_70 > 0)
    report.warnings.push_back(
        {"faces_non_orthogonal", quality.faces.above_70,
         fmt::format(
             "faces between cells are more than {} degrees non-orthogonal (the worst "
             "{:.2f}), at steep ground, buried roofs or, in uniform layers, low walls; a smaller "
             "--mesh-size may help",
             kMostNonOrthogonal, quality.faces.worst.non_orthogonality_deg)});
}

void fill_quality(const ColumnMesh& mesh, MeshQuality measured, VolumeMeshReport& volume) {
  const QualityHistogram& quality = measured.cells.histogram;
  volume.worst = std::move(measured.cells.worst);
  volume.faces = measured.faces;
  volume.vertices = mesh.node_count();
  volume.cells = quality.cells();
  volume.volume = quality.volume();
  volume.inverted = quality.inverted();
  volume.dihedral_min = quality.min_dihedral_deg();
  volume.dihedral_p0_01 = quality.dihedral_quantile_deg(1e-4);
  volume.dihedral_p0_1 = quality.dihedral_quantile_deg(1e-3);
  volume.dihedral_p1 = quality.dihedral_quantile_deg(1e-2);
  volume.dihedral_median = quality.dihedral_quantile_deg(0.5);
  volume.dihedral_max = quality.max_dihedral_deg();
  volume.aspect_median = quality.aspect_quantile(0.5);
  volume.aspect_p99 = quality.aspect_quantile(0.99);
  volume.aspect_max = quality.max_aspect_ratio();
  if (volume.inverted > 0)
    throw Error(ErrorKind::kGuarantee,
                fmt::format("{} cells are inverted; nothing was written", volume.inverted));
}

SurfaceMesh bound(const ColumnMesh& mesh, const Bounds2& domain, Report& report) {
  SurfaceMesh surface = extract_boundary(mesh, domain);
  const SurfaceTopology topology = check_topology(surface);
  report.surface_mesh =
      SurfaceMeshReport{static_cast<std::int64_t>(surface.triangles.size()), topology.closed(),
                        topology.manifold(), count_by_patch(surface)};
  if (!topology.closed() || !topology.manifold())
    throw Error(
        ErrorKind::kGuarantee,
        fmt::format("the boundary is not a closed manifold: {} open, {} non-manifold, {} "
                    "misoriented edges; nothing was written",
                    topology.open_edges, topology.non_manifold_edges, topology.misoriented_edges));
  return surface;
}

/// The local coordinate nearest to `local` that adding the origin and taking it away again leaves
/// as it is: less than a nanometre away. With all vertices and the terrain's nodes on such
/// coordinates, heights are the same whether they are looked up in local coordinates or in those of
/// the CRS.
double in_crs(double local, double origin) { return (local + origin) - origin; }

void move_into_crs(GroundMesh& ground, Point2 origin) {
  for (Point2& p : ground.vertices) p = {in_crs(p.x, origin.x), in_crs(p.y, origin.y)};
}

bool is_wanted(const Config& config, std::string_view format) {
  return std::find(config.formats.begin(), config.formats.end(), format) != config.formats.end();
}

/// The volume in each format asked for.
void write_volume(const Config& config, const ColumnMesh& mesh, const SurfaceMesh& boundary,
                  const Placement& placement, OutputFolder& out, const Progress& progress) {
  using Write = std::function<void(const Progress&)>;
  std::vector<std::string> foam;
  for (const char* name : {"points", "faces", "owner", "neighbour", "boundary"})
    foam.push_back(fmt::format("constant/polyMesh/{}", name));
  const std::array<std::pair<std::string_view, Write>, 4> writers{{
      {"vtu",
       [&](const Progress& p) {
         write_vtu(out.result("volume.vtu"), mesh, placement, p, config.compression);
       }},
      {"xdmf",
       [&](const Progress& p) {
         write_xdmf(out.result("volume.xdmf", {"volume.h5"}), mesh, boundary, placement, p,
                    config.compression);
       }},
      {"msh",
       [&](const Progress& p) {
         write_msh(out.result("volume.msh"), mesh, boundary, placement, p);
       }},
      {"openfoam",
       [&](const Progress& p) {
         write_openfoam(out.result("constant/polyMesh", foam), mesh, boundary, placement, p);
       }},
  }};
  std::vector<const Write*> wanted;
  for (const auto& [format, write] : writers)
    if (is_wanted(config, format)) wanted.push_back(&write);
  const double share = 1.0 / static_cast<double>(std::max<std::size_t>(wanted.size(), 1));
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const double begin = static_cast<double>(i) * share;
    (*wanted[i])(portion(progress, begin, begin + share));
  }
}

/// Ground, roofs and walls as STL and in each format asked for.
void write_surface(const Config& config, const SurfaceMesh& boundary, const Placement& placement,
                   OutputFolder& out) {
  const std::array land{Patch::kGround, Patch::kRoof, Patch::kWall};
  const SurfaceMesh surface = select_patches(boundary, land);
  write_stl(out.result("surface.stl"), surface, placement);
  if (is_wanted(config, "obj")) write_obj(out.result("surface.obj"), surface, placement);
  if (is_wanted(config, "ply")) write_ply(out.result("surface.ply"), surface, placement);
  if (is_wanted(config, "glb")) write_glb(out.result("surface.glb"), surface, placement);
}

}  // namespace

void make_mesh(const Config& config, const CityModel& city, Raster dtm, OutputFolder& out,
               StepClock& clock, Report& report) {
  const Point2 origin = city.origin;
  const CitySize size = size_of(config, city, dtm);
  require_mesh_fits(config, size);
  GroundMesh ground = make_ground(config, city, dtm, clock, report);
  move_into_crs(ground, origin);
  dtm.x0 = in_crs(dtm.x0, origin.x);
  dtm.y0 = in_crs(dtm.y0, origin.y);
  const Bounds2 domain{in_crs(city.domain.xmin, origin.x), in_crs(city.domain.ymin, origin.y),
                       in_crs(city.domain.xmax, origin.x), in_crs(city.domain.ymax, origin.y)};
  Columns columns = make_columns_of_city(config, city, dtm, size, std::move(ground), clock, report);
  VolumeMeshReport& volume = *report.volume_mesh;
  MeshQuality quality = improve(config, columns.mesh, clock, volume);
  quality = make_room(config, dtm, size, columns, std::move(quality), clock, volume);
  report_lowered(columns.plan, report);
  const ColumnMesh mesh = std::move(columns.mesh);
  columns.plan = {};
  clock.run("3.6", "check and write meshes", [&](const Progress& progress) {
    warn_below_floor(mesh, quality, report);
    fill_quality(mesh, std::move(quality), *report.volume_mesh);
    const SurfaceMesh boundary = bound(mesh, domain, report);
    Placement placement{{0, 0, 0}, {city.origin.x, city.origin.y, 0}};
    if (config.coordinates == Coordinates::kAbsolute)
      placement = {{city.origin.x, city.origin.y, 0}, {0, 0, 0}};
    write_volume(config, mesh, boundary, placement, out, progress);
    write_vtp(out.result("boundary.vtp"), boundary, placement, config.compression);
    write_surface(config, boundary, placement, out);
  });
}

}  // namespace tetropolis
