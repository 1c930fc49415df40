// Meshes the air around two houses made in memory, and goes over its cells and their faces.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <tetropolis/core/error.h>
#include <tetropolis/geometry/polygon.h>
#include <tetropolis/pipeline/build_city.h>
#include <tetropolis/pipeline/mesh_city.h>
#include <tetropolis/volume/column/explicit_mesh.h>

using namespace tetropolis;

/// Of a triangle: along its normal (right-hand rule), as long as its area.
Point3 area_vector(const Point3& p, const Point3& q, const Point3& r) {
  const Point3 a{q[0] - p[0], q[1] - p[1], q[2] - p[2]}, b{r[0] - p[0], r[1] - p[1], r[2] - p[2]};
  return {(a[1] * b[2] - a[2] * b[1]) / 2, (a[2] * b[0] - a[0] * b[2]) / 2,
          (a[0] * b[1] - a[1] * b[0]) / 2};
}

int main() try {
  CitySources sources;
  for (const Bounds2& box : {Bounds2{40, 30, 60, 50}, Bounds2{80, 30, 95, 60}}) {
    Footprint house;
    house.source_id = "house " + std::to_string(sources.footprints.features.size() + 1);
    house.polygon = rectangle(box);  // CRS coordinates
    house.height = 12;               // metres
    sources.footprints.features.push_back(house);
  }
  sources.terrain.emplace().raster = {1, 1, 0, 0, 1, {3}};  // one node: level at 3 m
  const BuiltCity built = build_city(std::move(sources), {.domain_margin = 50});
  const CityMesh mesh = mesh_city(built.city, built.terrain, {.mesh_size = 10});

  std::vector<Point3> points(static_cast<std::size_t>(mesh.volume.node_count()));
  fill_points(mesh.volume, {}, points);  // local; mesh.placement.origin for those of the CRS
  const std::vector<CellIndex> offsets = cell_offsets(mesh.volume);
  std::vector<std::array<NodeIndex, 4>> cells(std::size_t{offsets.back()});
  fill_cells(mesh.volume, offsets, 0, offsets.size() - 1, cells);

  // As a finite-volume program has them: what leaves a cell through its faces adds up to nothing.
  std::vector<Point3> sums(cells.size());
  const auto add = [&](CellIndex cell, double sign, const Point3& area) {
    for (std::size_t i = 0; i < 3; ++i) sums[cell][i] += sign * area[i];
  };
  for (const CellFace& face : internal_faces(mesh.volume)) {
    const auto& n = face.nodes;  // of prisms, with boundary_layers, face.corners may be 4
    const Point3 area = area_vector(points[n[0]], points[n[1]], points[n[2]]);
    add(face.owner, 1, area);
    add(face.neighbour, -1, area);
  }
  std::map<std::string, double> areas;  // by patch
  const SurfaceMesh& boundary = mesh.boundary;
  for (std::size_t f = 0; f < boundary.triangles.size(); ++f) {
    const auto node = [&](std::size_t i) {
      return boundary.node[static_cast<std::size_t>(boundary.triangles[f][i])];
    };
    const Point3 area = area_vector(points[node(0)], points[node(1)], points[node(2)]);
    add(boundary.cell[f], 1, area);
    areas[boundary.patch_of(f).name] += std::hypot(area[0], area[1], area[2]);
  }
  double most = 0;
  for (const Point3& sum : sums) most = std::max(most, std::hypot(sum[0], sum[1], sum[2]));
  std::printf("%zu cells, closed to %.0e m2\n", cells.size(), most);
  for (const auto& [name, area] : areas) std::printf("%s: %.0f m2\n", name.c_str(), area);
  for (const Warning& warning : mesh.warnings) std::printf("%s\n", warning.message.c_str());
  return most < 1e-9 ? 0 : 1;
} catch (const Error& error) {
  return std::fprintf(stderr, "%s\n", error.what()), static_cast<int>(error.kind());
}
