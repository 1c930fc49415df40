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
#include "improve_mesh.h"
#include "make_columns.h"
#include "run/memory.h"
#include "run/write_mesh.h"
#include "stages.h"
#include "volume/column/ground_heights.h"

namespace tetropolis {

namespace {

CitySize size_of(const Config& config, const CityModel& city, const Raster& dtm) {
  CitySize size;
  size.area = city.domain.area();
  for (const Building& building : city.buildings) size.add(building.footprint);
  double sum = 0;
  for (const double z : dtm.values) sum += z;
  size.height = highest_under(dtm, city.domain.bounds()) + config.domain_height -
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

void report_lowered(const ColumnPlan& plan, Report& report) {
  report.volume_mesh->ground_lowered = plan.lowered;
  report.volume_mesh->roofs_cut_back = plan.cut_from.roofs;
  report.volume_mesh->feet_cut_back = plan.cut_from.feet;
  if (plan.lowered == 0) return;
  std::string where = "at walls that would be too low otherwise";
  if (const std::size_t roofs = plan.cut_from.roofs.size(); roofs > 0)
    where += fmt::format("; around {} roof{} below the terrain", roofs, roofs == 1 ? "" : "s");
  if (const std::size_t feet = plan.cut_from.feet.size(); feet > 0)
    where += fmt::format("; at the feet of cliffs or low walls, in {} place{}", feet,
                         feet == 1 ? "" : "s");
  if (plan.undermined > 0)
    where += fmt::format("; {} building{} there, by up to {:.1f} m", plan.undermined,
                         plan.undermined == 1 ? " has its foot above the ground that is now"
                                              : "s have their foot above the ground that is now",
                         plan.deepest_undermined);
  if (!plan.cut_from.roofs.empty() || !plan.cut_from.feet.empty())
    where += "; --cut-slope 90 keeps the terrain, with worse cells instead";
  report.warnings.push_back(
      {"ground_lowered", plan.lowered,
       fmt::format("ground vertices were lowered, by up to {:.1f} m: {}", plan.deepest, where)});
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
SurfaceMesh checked_boundary(const ColumnMesh& mesh, Report& report) {
  SurfaceMesh surface = extract_boundary(mesh);
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
  Columns columns = make_columns(config, city, dtm, size, std::move(ground), clock, report);
  MeshQuality quality = improve_mesh(config, dtm, size, columns, clock, *report.volume_mesh);
  report_lowered(columns.plan, report);
  const ColumnMesh mesh = std::move(columns.mesh);
  columns.plan = {};
  clock.run("3.6", "check and write meshes", [&](const Progress& progress) {
    warn_below_floor(config, mesh, quality, report);
    report_quality(mesh, std::move(quality), *report.volume_mesh);
    const SurfaceMesh boundary = checked_boundary(mesh, report);
    Placement placement{{0, 0, 0}, {city.origin.x, city.origin.y, 0}};
    if (config.coordinates == Coordinates::kAbsolute)
      placement = {{city.origin.x, city.origin.y, 0}, {0, 0, 0}};
    write_mesh(config, mesh, boundary, placement, out, progress);
  });
}

}  // namespace tetropolis
