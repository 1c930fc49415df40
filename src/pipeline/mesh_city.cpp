#include "tetropolis/pipeline/mesh_city.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/geometry/polygon.h"
#include "tetropolis/ground/mesh_ground.h"
#include "tetropolis/volume/column/boundary.h"

#include "city/roofs/divide_ground.h"
#include "city_parts.h"
#include "core/infinity.h"
#include "core/parallel.h"
#include "core/sort_once.h"
#include "core/units.h"
#include "ground/size_field.h"
#include "ground/validate.h"
#include "make_columns.h"
#include "memory.h"
#include "mesh_scores.h"
#include "mesh_warnings.h"
#include "require_terrain.h"
#include "volume/column/ground_heights.h"
#include "volume/column/levels.h"
#include "volume/column/roof_heights.h"
#include "volume/layers/improve_prisms.h"
#include "volume/layers/prism_layers.h"
#include "volume/upper/grow_upper.h"

namespace tetropolis {

namespace {

/// Throws Error(kUsage), naming the setting, unless numbers are in the ranges that mesh_city.h
/// states.
void require_in_range(const MeshCityOptions& options) {
  require_sizes(options.mesh_size, options.grading);
  struct Limits {
    const char* setting;
    double value, least, most;
    const char* range;
  };
  constexpr double kSmallest = std::numeric_limits<double>::min();
  constexpr double kGreatest = std::numeric_limits<double>::max();
  constexpr double kBelowOne = 1 - std::numeric_limits<double>::epsilon();
  constexpr auto kPositive = "above 0", kNotNegative = "0 or more";
  const LayerHeights& layers = options.boundary_layers;
  for (const Limits& limits :
       {Limits{"mesh_size", options.mesh_size, kSmallest, 1e4, "above 0, 10000 at most"},
        Limits{"min_building_distance", options.surface_clearance, kSmallest, kGreatest, kPositive},
        Limits{"target_cells", options.target_cells, 0, kGreatest, kNotNegative},
        Limits{"min_angle", options.min_angle_deg, 0, 33, "0 to 33"},
        Limits{"domain_height", options.domain_height, kSmallest, kGreatest, kPositive},
        Limits{"layer_height", options.layer_height, 0, kGreatest, kNotNegative},
        Limits{"boundary_layers", static_cast<double>(layers.count), 0, kGreatest, kNotNegative},
        Limits{"first_layer", layers.first, kSmallest, kGreatest, kPositive},
        Limits{"layer_growth", layers.growth, 1, kGreatest, "1 or more"},
        Limits{"min_wall_height", options.min_wall_height, kSmallest, kGreatest, kPositive},
        Limits{"cut_slope", options.cut_slope_deg, kSmallest, 90, "above 0, 90 at most"},
        Limits{"min_gap_share", options.min_gap_share, kSmallest, kBelowOne, "above 0 and below 1"},
        Limits{"solver_tolerance", options.solver_tolerance, kSmallest, kGreatest, kPositive},
        Limits{"solver_iterations", static_cast<double>(options.solver_iterations), 1, kGreatest,
               "1 or more"},
        Limits{"max_memory", options.max_bytes, 0, kInfinity, kNotNegative}})
    if (!(limits.value >= limits.least && limits.value <= limits.most))
      throw Error(ErrorKind::kUsage,
                  fmt::format("{} {}: must be {}", limits.setting, limits.value, limits.range));
}

/// Of sizes that are sought for a number of cells.
constexpr double kLeastScale = 1e-3, kGreatestScale = 1e3;
constexpr double kGreatestStep = 4;
constexpr double kTargetError = 0.02;
constexpr int kMostRounds = 12;

CitySize size_of(const MeshCityOptions& options, const CityModel& city, const Raster& dtm) {
  CitySize size;
  size.area = city.domain.area();
  for (const Building& building : city.buildings) size.add(building.footprint);
  double sum = 0;
  for (const double z : dtm.values) sum += z;
  size.height = highest_under(dtm, city.domain.bounds()) + options.domain_height -
                sum / static_cast<double>(dtm.values.size());
  size.terrain_nodes = static_cast<double>(dtm.values.size());
  const Bounds2 box = city.domain.bounds();
  // Of the box, which a turned domain does not fill.
  const double share = size.area / (box.width() * box.height());
  std::vector<const Polygon*> footprints;
  for (const Building& building : city.buildings) footprints.push_back(&building.footprint);
  size.sizes_with = [footprints = std::move(footprints), box, share](const MeshCityOptions& with) {
    if (!is_graded(with.mesh_size, with.grading)) return AreasBySize{};
    AreasBySize sizes = graded_sizes(footprints, box, with.mesh_size, with.grading).sizes();
    for (auto& [edge, area] : sizes) area *= share;
    return sizes;
  };
  size.sizes = size.sizes_with(options);
  size.mesh_size = options.mesh_size;
  return size;
}

/// Mesh size, metres: coarser ones would show no terrain.
constexpr double kCoarsestPreview = 50;

/// Prisms on steep ground are sheared: from this slope on 5 % of the terrain on, degrees.
constexpr double kSteepForPrisms = 36;

/// The slope, in degrees, that 95 % of the terrain's squares in the domain do not exceed.
double steep_slope(const Raster& dtm, const Domain& domain) {
  constexpr std::size_t kBins = 900;
  constexpr double kPerDegree = 10;
  std::vector<std::int64_t> counts(kBins + 1, 0);
  std::int64_t all = 0;
  const Bounds2 box = domain.bounds();
  for (std::int32_t j = 0; j + 1 < dtm.ny; ++j)
    for (std::int32_t i = 0; i + 1 < dtm.nx; ++i) {
      const Point2 centre{dtm.x0 + (i + 0.5) * dtm.step, dtm.y0 + (j + 0.5) * dtm.step};
      if (!box.contains(centre) || !domain.contains(centre)) continue;
      const double a = dtm.at(i, j), b = dtm.at(i + 1, j), c = dtm.at(i, j + 1);
      const double d = dtm.at(i + 1, j + 1);
      const double rise = std::hypot((b + d - a - c) / 2, (c + d - a - b) / 2) / dtm.step;
      ++counts[static_cast<std::size_t>(to_degrees(std::atan(rise)) * kPerDegree)];
      ++all;
    }
  std::int64_t below = 0;
  for (std::size_t bin = 0; bin < counts.size(); ++bin) {
    below += counts[bin];
    if (static_cast<double>(below) >= 0.95 * static_cast<double>(all))
      return (static_cast<double>(bin) + 0.5) / kPerDegree;
  }
  return 0;
}

/// Options for cells that are prisms, or tets where the terrain is too steep for them.
MeshCityOptions for_prisms(MeshCityOptions options, const CityModel& city, const Raster& terrain,
                           std::vector<Warning>& warnings) {
  if (options.cells != Cells::kPrisms) return options;
  if (options.top != Top::kFlat)
    throw Error(ErrorKind::kUsage, "cells: prisms need a flat top; set top = \"flat\"");
  if (options.boundary_layers.count == 0) options.boundary_layers.count = kLayersBelowPrisms;
  const double slope = steep_slope(terrain, city.domain);
  if (slope <= kSteepForPrisms) {
    options.layering = Layering::kUniform;
    options.min_wall_height = std::max(options.min_wall_height, kWallOfPrisms);
    return options;
  }
  options.cells = Cells::kTets;
  warnings.push_back(
      {"too_steep_for_prisms", 1,
       fmt::format("cells = prisms: 5 % of the terrain is steeper than {:.0f} degrees (at most {} "
                   "is meant); the mesh has {} layers of prisms below tets instead",
                   slope, kSteepForPrisms, options.boundary_layers.count)});
  return options;
}

/// All lengths that sizes are given by, times a factor.
MeshCityOptions scaled(const MeshCityOptions& options, double factor) {
  MeshCityOptions result = options;
  result.mesh_size *= factor;
  result.grading.far_size *= factor;
  result.grading.ground_size *= factor;
  for (SizeRegion& region : result.grading.regions) region.size *= factor;
  return result;
}

GroundMesh make_ground(const MeshCityOptions& options, const CityModel& city,
                       const CityParts& parts, const Surfaces& surfaces, const Raster& dtm,
                       StepClock& clock, CityMesh& result) {
  GroundMeshOptions meshing{options.mesh_size, options.min_angle_deg};
  meshing.grading = options.grading;
  if (!surfaces.kinds.empty()) meshing.surfaces = &surfaces;
  if (options.layering != Layering::kUniform) {
    meshing.wall_edge = [&](RegionIndex part, Point2 a, Point2 b) {
      return longest_wall_edge(dtm, parts.roofs[part], a, b, options.min_wall_height,
                               options.boundary_layers.total());
    };
    meshing.party_line = [&](RegionIndex left, RegionIndex right, Point2 a, Point2 b) {
      return divide_party_line(parts.roofs[left], parts.roofs[right], a, b, options.mesh_size,
                               least_roof_step(options.mesh_size));
    };
    meshing.elevation = [&](Point2 p) { return sample(dtm, p); };
  }
  GroundMesh ground = clock.run("3.1", "ground mesh", [&](const Progress& progress) {
    return mesh_ground_parts(parts.outlines, city.domain, meshing, progress);
  });
  GroundMeshFacts& facts = result.ground_facts;
  facts.vertices = static_cast<std::int64_t>(ground.vertices.size());
  facts.triangles = static_cast<std::int64_t>(ground.triangles.size());
  facts.min_angle_deg = angle_statistics(ground.vertices, ground.triangles).min_deg;
  facts.small_input_angles = ground.small_input_angles;
  facts.triangles_below_min_angle = ground.triangles_below_min_angle;
  double shortest2 = kInfinity, longest2 = 0;
  for (const auto& corners : ground.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const Point2 p = ground.vertices[corners[i]], q = ground.vertices[corners[(i + 1) % 3]];
      const double length2 = (q.x - p.x) * (q.x - p.x) + (q.y - p.y) * (q.y - p.y);
      shortest2 = std::min(shortest2, length2);
      longest2 = std::max(longest2, length2);
    }
  facts.shortest_edge = std::sqrt(shortest2);
  facts.longest_edge = std::sqrt(longest2);
  return ground;
}

void tell_excavation(const MeshCityOptions& options, const ColumnPlan& plan,
                     ExcavationSources excavated, VolumeMeshFacts& volume) {
  volume.ground_lowered = plan.lowered;
  volume.cut_slope_deg = options.cut_slope_deg;
  double gentlest = 90;
  for (const auto* slopes : {&excavated.roof_slopes_deg, &excavated.toe_slopes_deg})
    for (const double slope : *slopes) gentlest = std::min(gentlest, slope);
  if (gentlest < 90) volume.cut_slope_deg = gentlest;
  volume.roofs_cut_back = std::move(excavated.roofs);
  volume.roof_cut_slopes_deg = std::move(excavated.roof_slopes_deg);
  volume.feet_cut_back = std::move(excavated.toes);
  volume.foot_cut_slopes_deg = std::move(excavated.toe_slopes_deg);
}

/// Throws Error(kGuarantee) if a cell is inverted.
void tell_quality(const ColumnMesh& mesh, MeshQuality measured, VolumeMeshFacts& volume) {
  const QualityHistogram& quality = measured.cells.histogram;
  volume.worst = std::move(measured.cells.worst);
  volume.faces = measured.faces;
  volume.vertices = mesh.node_count();
  const PrismQuality& prisms = volume.prisms;
  volume.cells = quality.cells() + prisms.cells;
  volume.volume = quality.volume() + prisms.volume;
  FaceQuality& faces = volume.faces;
  faces.faces += prisms.faces;
  faces.above_70 += prisms.above_70;
  faces.worst.non_orthogonality_deg =
      std::max(faces.worst.non_orthogonality_deg, prisms.max_non_orthogonality_deg);
  faces.worst.skewness = std::max(faces.worst.skewness, prisms.max_skewness);
  volume.inverted = quality.inverted();
  volume.dihedral_counts = quality.dihedral_counts();
  if (quality.cells() == 0) return;  // prisms alone, which are valid
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

/// The boundary, closed and manifold (guarantee 5).
SurfaceMesh checked_boundary(const ColumnMesh& mesh, CityMesh& result) {
  SurfaceMesh surface = extract_boundary(mesh);
  const SurfaceTopology topology = check_topology(surface);
  result.surface_facts = SurfaceMeshFacts{
      std::ssize(surface.triangles) - 2 * std::ssize(surface.quads), std::ssize(surface.quads),
      topology.closed(), topology.manifold(), count_by_patch(surface)};
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

/// Steps 3.1 to 3.5, with some buildings as blocks.
Columns columns_of(const MeshCityOptions& options, const CityModel& city, const Surfaces& surfaces,
                   const Raster& terrain, const CitySize& size,
                   std::span<const BuildingIndex> blocks, StepClock& clock, CityMesh& result) {
  const CityParts parts = parts_of(city, options, blocks);
  GroundMesh ground = make_ground(options, city, parts, surfaces, terrain, clock, result);
  move_into_crs(ground, city.origin);
  return make_columns(options, parts, terrain, size, std::move(ground), clock, result);
}

MeshCityOptions in_local_frame(MeshCityOptions options, Point2 origin) {
  const auto move = [&](Polygon& area) {
    for_each_vertex(area, [&](Point2& p) { p = {p.x - origin.x, p.y - origin.y}; });
  };
  for (SizeRegion& region : options.grading.regions) move(region.area);
  for (SurfaceArea& surface : options.surfaces) move(surface.area);
  for (Canopy& canopy : options.canopies) move(canopy.area);
  return options;
}

/// The ground divided by options.surfaces. Warns of what is lost.
Surfaces surfaces_of(const MeshCityOptions& options, const CityModel& city, StepClock& clock,
                     CityMesh& result) {
  if (options.surfaces.empty()) return {};
  std::vector<Polygon> footprints;
  for (const Building& building : city.buildings) footprints.push_back(building.footprint);
  Surfaces surfaces = clock.run("3.1", "surface layers", [&](const Progress&) {
    return divide_ground(options.surfaces, footprints, city.domain, options.surface_clearance);
  });
  constexpr double kLost = 0.05;
  for (std::size_t k = 0; k < kSurfaceKindNames.size(); ++k) {
    const double given = surfaces.area_given[k], meshed = surfaces.area_meshed[k];
    result.ground_facts.surfaces[k] = meshed;
    if (meshed < (1 - kLost) * given)
      result.warnings.push_back(
          {"surface_lost", static_cast<std::int64_t>(std::llround(given - meshed)),
           fmt::format(
               "{:.0f} m2 of {}'s {:.0f} are narrower or smaller than the clearance of {} m "
               "allows; a smaller min_building_distance keeps more",
               given - meshed, kSurfaceKindNames[k], given, options.surface_clearance)});
  }
  return surfaces;
}

void add_upper(const MeshCityOptions& options, Columns& columns, StepClock& clock) {
  if (!ends_at_lid(options)) return;
  columns.mesh.upper = clock.run("3.5", "upper part", [&](const Progress& progress) {
    return grow_upper(columns.mesh, columns.plan.layers.top, progress);
  });
}

/// The factor at which the estimate has so many cells.
double estimated_scale(const MeshCityOptions& options, const CitySize& size, double cells) {
  double low = kLeastScale, high = kGreatestScale;
  for (int i = 0; i < 40; ++i) {
    const double middle = std::sqrt(low * high);
    (estimate_mesh(scaled(options, middle), size).cells > cells ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

/// The factor at which the mesh has options.target_cells, to kTargetError where there is one: by
/// meshing, and a secant of the logarithms within the bracket that is known.
double find_scale(const MeshCityOptions& options, const CityModel& city, const Surfaces& surfaces,
                  const Raster& terrain, const CitySize& size, StepClock& clock,
                  std::vector<Warning>& warnings) {
  const double target = options.target_cells;
  double scale = std::min(estimated_scale(options, size, target), kGreatestStep);
  double low = kLeastScale, high = kGreatestScale;  // too many cells, too few
  double best = scale, best_error = kInfinity, best_cells = 0;
  double last_scale = 0, last_cells = 0, power = 2.5;
  for (int round = 0; round < kMostRounds && high / low > 1 + 1e-4; ++round) {
    const MeshCityOptions trial = scaled(options, scale);
    if (estimate_mesh(trial, size).bytes > trial.max_bytes) {
      low = scale;
      scale = std::sqrt(low * high);
      continue;
    }
    CityMesh scratch;
    Columns columns;
    try {
      columns = columns_of(trial, city, surfaces, terrain, size, {}, clock, scratch);
    } catch (const MeshTooLarge&) {
      low = scale;
      scale = std::sqrt(low * high);
      continue;
    }
    add_upper(trial, columns, clock);
    auto cells = static_cast<double>(cell_offsets(columns.mesh).back().value());
    if (options.cells == Cells::kPrisms) cells /= 3;
    for (const TriangleIndex t : columns.mesh.ground.triangles.indices())
      cells += columns.mesh.inside_building(t) ? 0 : options.boundary_layers.count;
    const double error = std::abs(std::log(cells / target));
    if (error < best_error) {
      best = scale;
      best_error = error;
      best_cells = cells;
    }
    if (error < kTargetError) return best;
    // Beyond some size there are more cells again: the top has to be higher.
    const bool is_past_least = last_cells > 0 && scale > last_scale && cells > last_cells;
    (cells > target && !is_past_least ? low : high) = scale;
    if (last_cells > 0 && cells != last_cells)
      power = std::clamp(std::log(last_cells / cells) / std::log(scale / last_scale), 0.3, 4.0);
    last_scale = scale;
    last_cells = cells;
    scale *= std::clamp(std::pow(cells / target, 1 / power), 1 / kGreatestStep, kGreatestStep);
    if (!(scale > low && scale < high)) scale = std::sqrt(low * high);
  }
  warnings.push_back({"target_cells", 1,
                      fmt::format("no sizes give {:.0f} cells: {:.0f} is the nearest that was "
                                  "found; the footprints' corners set a least number",
                                  target, best_cells)});
  return best;
}

/// Columns of the whole city. Buildings whose parts they cannot have become blocks.
Columns columns_with_blocks(const MeshCityOptions& options, const CityModel& city,
                            const Surfaces& surfaces, const Raster& terrain, const CitySize& size,
                            StepClock& clock, CityMesh& result) {
  std::vector<BuildingIndex>& blocks = result.volume_facts.parts_left_out;
  if (solves_laplace(options)) {
    for (const BuildingIndex b : city.buildings.indices())
      if (!city.buildings[b].parts.empty()) blocks.push_back(b);
    if (!blocks.empty())
      result.warnings.push_back(
          {"parts_left_out", static_cast<std::int64_t>(blocks.size()),
           fmt::format("{} buildings have parts, but are meshed as blocks: cells = "
                       "\"tets\", layering = \"graded\" and a flat top "
                       "keep the parts, lod = \"block\" makes none",
                       blocks.size())});
  }
  const std::vector<Warning> before = result.warnings;
  Columns columns = columns_of(options, city, surfaces, terrain, size, blocks, clock, result);
  // With steep roofs a few decimetres above each other there may be no order of climbing. Over
  // blocks there is one (their levels are elevations), so each round finds others.
  for (auto missed = missed_buildings(columns.mesh); !missed.empty();
       missed = missed_buildings(columns.mesh)) {
    blocks.insert(blocks.end(), missed.begin(), missed.end());
    sort_once(blocks);
    result.warnings = before;
    result.solver.clear();
    result.volume_facts.roof_steps_closed = 0;
    columns = columns_of(options, city, surfaces, terrain, size, blocks, clock, result);
  }
  result.volume_facts.min_vertical_gap = require_valid(columns.mesh);
  if (!blocks.empty() && !solves_laplace(options))
    result.warnings.push_back(
        {"parts_left_out", static_cast<std::int64_t>(blocks.size()),
         fmt::format(
             "{} buildings are meshed as blocks: no cells fit the steps between their roofs",
             blocks.size())});
  return columns;
}

/// Columns with cells below the floor of quality become better where they can.
ImprovedColumns improved(Columns columns, const MeshCityOptions& options, const CitySize& size,
                         StepClock& clock, VolumeMeshFacts& facts) {
  QualityFloorOptions floor;
  floor.plan = plan_options(options);
  floor.gentlest_deg = options.cut_slope_deg;
  if (options.layer_height > 0) floor.most_gap = options.layer_height;
  floor.require_fits = [&, triangles = static_cast<double>(columns.mesh.triangle_count())](
                           double cells) { require_cells_fit(options, size, triangles, cells); };
  ImprovedColumns better = reach_quality_floor(std::move(columns), floor, clock);
  facts.columns_improved = better.columns_improved;
  facts.min_vertical_gap = better.min_vertical_gap;
  return better;
}

void add_toes(const ColumnPlan& plan, const GroundMesh& ground, const MeshCityOptions& options,
              ExcavationSources& excavated) {
  for (const VertexIndex v : plan.eased) {
    const Point2 p = ground.vertices[v];
    excavated.toes.push_back({p.x, p.y, plan.ground[v]});
    excavated.toe_slopes_deg.push_back(eased_slope(options));
  }
}

void add_boundary_layers(const MeshCityOptions& options, const ColumnPlan& plan, ColumnMesh& mesh,
                         VolumeMeshFacts& facts) {
  const bool alone = options.cells == Cells::kPrisms;
  lay_prisms(plan.lift, options.boundary_layers, mesh);
  if (alone) make_whole(mesh);
  facts.prisms = measure_prisms(mesh, options.boundary_layers.first);
  if (!alone || is_within(facts.prisms, PrismAims{})) return;
  facts.columns_improved = improve_prisms(mesh, PrismAims{});
  facts.prisms = measure_prisms(mesh, options.boundary_layers.first);
}

/// Step 3.6: boundary, scores, and what is left to measure of the cells.
void measure(const MeshCityOptions& options, const CityModel& city, MeshQuality quality,
             CityMesh& result) {
  // One thread at most follows the boundary, and several measure.
  parallel_in_order(2, [&](std::size_t job) {
    if (job == 0) {
      result.boundary = checked_boundary(result.volume, result);
      result.ground_facts.resolution = score_resolution(city, result.volume);
    } else if (options.cells == Cells::kTets) {
      if (options.layering == Layering::kUniform)
        quality = measure_quality(result.volume, kWorstCells);
      else
        measure_ends(result.volume, kWorstCells, quality);
    }
  });
  warn_of_prisms(result.volume_facts.prisms, result.warnings);
  if (!result.volume.layers.whole)
    warn_below_floor(options, result.ground_facts.size_scale, quality, result.warnings);
  tell_quality(result.volume, std::move(quality), result.volume_facts);
}

}  // namespace

CityMesh mesh_city(const CityModel& city, Raster terrain, const MeshCityOptions& given,
                   const StepHooks& hooks) {
  require_in_range(given);
  require_raster(terrain, "terrain");
  require_terrain_under(city, terrain, "terrain");
  CityMesh result;
  StepClock clock(hooks, result.steps);
  const Point2 origin = city.origin;
  MeshCityOptions options =
      for_prisms(in_local_frame(given, origin), city, terrain, result.warnings);
  options.max_bytes = memory_limit(options.max_bytes);
  const double highest = highest_under(terrain, city.domain.bounds());
  if (options.own_top && city.domain_top > highest)
    options.domain_height = city.domain_top - highest;
  const CitySize size = size_of(options, city, terrain);
  const Surfaces surfaces = surfaces_of(options, city, clock, result);
  if (options.target_cells > 0) {
    const double scale = find_scale(options, city, surfaces, terrain, size, clock, result.warnings);
    options = scaled(options, scale);
    result.ground_facts.size_scale = scale;
  }
  require_mesh_fits(options, size);
  terrain.x0 = in_crs(terrain.x0, origin.x);
  terrain.y0 = in_crs(terrain.y0, origin.y);
  Columns columns = columns_with_blocks(options, city, surfaces, terrain, size, clock, result);
  ExcavationSources excavated;
  MeshQuality quality;
  if (options.layering != Layering::kUniform) {
    ImprovedColumns better =
        improved(std::move(columns), options, size, clock, result.volume_facts);
    columns = std::move(better.columns);
    excavated = std::move(better.excavated);
    quality = std::move(better.quality);
  }
  terrain = {};  // as large as some meshes
  add_toes(columns.plan, columns.mesh.ground, options, excavated);
  add_upper(options, columns, clock);
  if (options.boundary_layers.count > 0)
    clock.run("3.5", "boundary layers", [&](const Progress&) {
      add_boundary_layers(options, columns.plan, columns.mesh, result.volume_facts);
    });
  if (!columns.mesh.upper.empty() || columns.mesh.layers.cells() > 0)
    result.volume_facts.min_vertical_gap = require_valid(columns.mesh);
  warn_of_lowered_ground(columns.plan, excavated, result.warnings);
  tell_excavation(options, columns.plan, std::move(excavated), result.volume_facts);
  result.volume = std::move(columns.mesh);
  columns.plan = {};
  clock.run("3.6", "quality and boundary",
            [&](const Progress&) { measure(options, city, std::move(quality), result); });
  if (!options.canopies.empty())
    clock.run("3.6", "canopies",
              [&](const Progress&) { result.zones = zone_cells(result.volume, options.canopies); });
  warn_of_canopies(result.zones, result.warnings);
  result.placement.origin = {origin.x, origin.y, 0};
  return result;
}

std::optional<ColumnMesh> mesh_preview(const CityModel& city, const Raster& terrain,
                                       std::int64_t most_triangles, const StepHooks& hooks) {
  MeshCityOptions options;
  options.max_bytes = memory_limit(0);
  const CitySize size = size_of(options, city, terrain);
  const auto most = static_cast<double>(most_triangles);
  while (estimate_mesh(options, size).triangles > most) {
    options.mesh_size *= 1.25;
    if (options.mesh_size > kCoarsestPreview) return std::nullopt;
  }
  CityMesh scratch;
  StepClock clock(hooks, scratch.steps);
  return columns_with_blocks(options, city, {}, terrain, size, clock, scratch).mesh;
}

}  // namespace tetropolis
