#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/ground/mesh_ground.h"
#include "tetropolis/volume/column/boundary.h"

#include "ground/validate.h"
#include "make_columns.h"
#include "mesh_warnings.h"
#include "run/memory.h"
#include "run/write_mesh.h"
#include "stages.h"
#include "volume/column/ground_heights.h"

namespace tetropolis {

namespace {

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

void report_excavation(const Config& config, const ColumnPlan& plan, ExcavationSources excavated,
                       VolumeMeshReport& volume) {
  volume.ground_lowered = plan.lowered;
  volume.cut_slope = config.cut_slope;
  double gentlest = 90;
  for (const auto* slopes : {&excavated.roof_slopes_deg, &excavated.toe_slopes_deg})
    for (const double slope : *slopes) gentlest = std::min(gentlest, slope);
  if (gentlest < 90) volume.cut_slope = gentlest;
  volume.roofs_cut_back = std::move(excavated.roofs);
  volume.roof_cut_slopes = std::move(excavated.roof_slopes_deg);
  volume.feet_cut_back = std::move(excavated.toes);
  volume.foot_cut_slopes = std::move(excavated.toe_slopes_deg);
}

/// Guarantee 4, too: throws if a cell is inverted.
void report_quality(const ColumnMesh& mesh, MeshQuality measured, VolumeMeshReport& volume) {
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

/// The boundary, closed and manifold (guarantee 5).
SurfaceMesh checked_boundary(const ColumnMesh& mesh, const Bounds2& domain, Report& report) {
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
  Columns columns = make_columns(config, city, dtm, size, std::move(ground), clock, report);
  ExcavationSources excavated;
  if (config.layering != Layering::kUniform) {
    QualityFloorOptions floor;
    floor.plan = plan_options(config);
    floor.gentlest_deg = config.cut_slope;
    floor.require_fits = [&, triangles = static_cast<double>(columns.mesh.triangle_count())](
                             double cells) { require_cells_fit(config, size, triangles, cells); };
    ImprovedColumns improved = reach_quality_floor(std::move(columns), dtm, floor, clock);
    columns = std::move(improved.columns);
    excavated = std::move(improved.excavated);
    report.volume_mesh->columns_improved = improved.columns_improved;
    report.volume_mesh->min_vertical_gap = improved.min_vertical_gap;
  }
  MeshQuality quality = measure_quality(columns.mesh, clock);
  warn_of_lowered_ground(columns.plan, excavated, report);
  report_excavation(config, columns.plan, std::move(excavated), *report.volume_mesh);
  const ColumnMesh mesh = std::move(columns.mesh);
  columns.plan = {};
  clock.run("3.6", "check and write meshes", [&](const Progress& progress) {
    warn_below_floor(config, mesh, quality, report);
    report_quality(mesh, std::move(quality), *report.volume_mesh);
    const SurfaceMesh boundary = checked_boundary(mesh, domain, report);
    Placement placement{{0, 0, 0}, {city.origin.x, city.origin.y, 0}};
    if (config.coordinates == Coordinates::kAbsolute)
      placement = {{city.origin.x, city.origin.y, 0}, {0, 0, 0}};
    write_mesh(config, mesh, boundary, placement, out, progress);
  });
}

}  // namespace tetropolis
