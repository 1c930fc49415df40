#include "stages.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "tetropolis/city/clean.h"
#include "tetropolis/ground/mesh_ground.h"
#include "tetropolis/io/mesh/stl.h"
#include "tetropolis/io/mesh/vtk.h"
#include "tetropolis/synth/synthetic_city.h"

#include "volume/column/fill_columns.h"
#include "volume/quality/measured_mesh.h"

namespace tetropolis::testing {

WorkCity work_city(std::int64_t buildings) {
  // Whole metres, so that the terrain's nodes fit.
  const double size = std::round(2500 * std::sqrt(static_cast<double>(buildings) / 3096));
  RandomCityOptions options;
  options.buildings = buildings;
  options.size = size;
  options.points_per_m2 = 0;
  return {buildings, synthetic_random_city(options).footprints,
          &random_city_input(buildings, size)};
}

[[gnu::noinline]] Simplification work_simplify(const WorkCity& city) {
  std::vector<Polygon> cleaned;
  for (const Polygon& footprint : city.raw) cleaned.push_back(clean_footprint(footprint).polygon);
  return simplify_footprints(cleaned, city.input->domain, {});
}

[[gnu::noinline]] Simplification work_crowd(const WorkCity& city) {
  std::vector<Polygon> cleaned;
  const auto add = [&](Ring outer) {
    cleaned.push_back(clean_footprint({std::move(outer), {}}).polygon);
  };
  for (std::int64_t i = 0; i < 4 * city.buildings; ++i) {
    for (int k = 0; k < 4; ++k) add({{10, 10}, {30, 10}, {30, 20}, {20, 20}, {20, 30}, {10, 30}});
    const double x = 50 + 0.35 * static_cast<double>(i % 20);
    const double y = 50 + 0.35 * static_cast<double>(i / 20);
    add({{x, y}, {x + 0.3, y}, {x + 0.3, y + 0.3}, {x, y + 0.3}});
  }
  Ring star;
  const auto arms = static_cast<double>(city.buildings);
  for (double i = 0; i < 2 * arms; ++i) {
    const double angle = std::numbers::pi * i / arms;
    const double radius = std::fmod(i, 2) == 0 ? 20 : 80;
    star.push_back({250 + radius * std::cos(angle), 250 + radius * std::sin(angle)});
  }
  add(std::move(star));
  return simplify_footprints(cleaned, {0, 0, 500, 500}, {});
}

[[gnu::noinline]] GroundMesh work_ground(const WorkCity& city) {
  return mesh_ground(city.input->footprints, city.input->domain, {kMeshSize, 25});
}

[[gnu::noinline]] ColumnMesh work_columns(const WorkCity& city, const GroundMesh& ground) {
  return columns_over(*city.input, GroundMesh(ground), kMeshSize);
}

[[gnu::noinline]] UniformResult work_uniform(const WorkCity& city, const GroundMesh& ground) {
  ColumnPlanOptions options;
  options.layer_height = kMeshSize;
  options.fit_lowered_walls = false;
  const ColumnPlan plan =
      plan_columns(ground, city.input->dtm, city.input->roofs, column_spacing(ground), options);
  LayeredMesh mesh =
      make_layers(GroundMesh(ground), plan.layers.layers, plan.layers.bottom, plan.layers.top);
  UniformResult result;
  result.nodes = mesh.z.size();
  result.ground = smooth_to_ground(mesh, plan.ground, {}).solver;
  trim(mesh, plan.lowest_roof, plan.roofs.flat);
  result.roofs = smooth_to_roofs(mesh, plan.lowest_roof, plan.roofs.flat, {}).solver;
  return result;
}

[[gnu::noinline]] std::int64_t work_quality(const ColumnMesh& mesh) {
  const MeshQuality quality = measure_quality(mesh, 10);
  if (quality.cells.histogram.inverted() != 0) throw std::logic_error("inverted cells");
  return quality.faces.faces;
}

[[gnu::noinline]] SurfaceMesh work_boundary(const ColumnMesh& mesh) {
  SurfaceMesh boundary = extract_boundary(mesh);
  if (!check_topology(boundary).closed()) throw std::logic_error("open boundary");
  return boundary;
}

[[gnu::noinline]] std::int64_t work_write(const ColumnMesh& mesh, const SurfaceMesh& boundary,
                                          const std::string& folder) {
  const std::filesystem::path path(folder);
  write_vtu(path / "volume.vtu", mesh, {});
  write_vtp(path / "boundary.vtp", boundary, {});
  write_stl(path / "surface.stl", city_surface(boundary), {});
  std::uintmax_t bytes = 0;
  for (const auto& file : std::filesystem::directory_iterator(path)) bytes += file.file_size();
  return static_cast<std::int64_t>(bytes);
}

}  // namespace tetropolis::testing
