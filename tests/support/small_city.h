// A few buildings on hills, meshed: what the volume tests work on.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/ground/mesh_ground.h"
#include "tetropolis/terrain/raster.h"
#include "tetropolis/volume/column/column_mesh.h"

#include "shapes.h"
#include "volume/column/fill_columns.h"
#include "volume/layered/smooth.h"

namespace tetropolis::testing {

/// The table for buildings of one part each: region b is building b, the last one open ground.
inline IndexedVector<RegionIndex, Region> regions_of_buildings(std::size_t buildings) {
  IndexedVector<RegionIndex, Region> regions(buildings + 1);
  for (const BuildingIndex b : indices<BuildingIndex>(buildings))
    regions[std::size_t{b}] = {RegionKind::kBuildingPart, b, 0, Patch::kRoof};
  return regions;
}

struct SmallCity {
  Bounds2 domain{0, 0, 120, 90};
  std::vector<Polygon> footprints;
  std::vector<double> roofs;  ///< Elevations.
  Raster dtm;
};

inline Raster raster_of(const Bounds2& domain,
                        const std::function<double(double, double)>& height) {
  Raster raster{static_cast<std::int32_t>(domain.width()) + 1,
                static_cast<std::int32_t>(domain.height()) + 1,
                domain.xmin,
                domain.ymin,
                1.0,
                {}};
  for (std::int32_t j = 0; j < raster.ny; ++j)
    for (std::int32_t i = 0; i < raster.nx; ++i)
      raster.values.push_back(height(domain.xmin + i, domain.ymin + j));
  return raster;
}

/// Buildings of 3 m.
inline CityModel city_model(const SmallCity& small) {
  CityModel city;
  city.domain = small.domain;
  city.origin = {1000, 2000};
  for (std::size_t b = 0; b < small.footprints.size(); ++b) {
    Building building;
    building.id = "b" + std::to_string(b);
    building.footprint = small.footprints[b];
    building.h_roof = small.roofs[b];
    building.h_ground = small.roofs[b] - 3;
    city.buildings.push_back(building);
  }
  return city;
}

/// Five buildings, one with a courtyard, one low and one a tower, on `height`.
inline SmallCity small_city(const std::function<double(double, double)>& height) {
  SmallCity city;
  city.footprints = {rectangle(20, 15, 38, 27), rectangle(39.5, 15, 55, 40),
                     rectangle(70, 20, 105, 60), rectangle(15, 50, 22, 56),
                     Polygon{{{30, 50}, {58, 48}, {60, 75}, {44, 66}, {30, 76}}, {}}};
  city.footprints[2].holes = {{{80, 30}, {80, 50}, {95, 50}, {95, 30}}};
  city.dtm = raster_of(city.domain, height);
  const std::vector<double> above{12, 31, 18, 3, 64};
  for (std::size_t i = 0; i < city.footprints.size(); ++i)
    city.roofs.push_back(height(city.footprints[i].outer[0].x, city.footprints[i].outer[0].y) +
                         above[i]);
  return city;
}

inline double hills(double x, double y) {
  // A hill of 20 m with slopes of up to 40 degrees.
  const double dx = (x - 60) / 30, dy = (y - 45) / 30;
  return 100 + 20 / (1 + dx * dx + dy * dy);
}

/// Terrains that leave inverted cells with plain smoothing.
inline const std::vector<std::pair<const char*, double (*)(double, double)>> kHardTerrains = {
    {"flat", [](double, double) { return -5.0; }},
    {"hills", hills},
    {"45 degrees", [](double x, double) { return x; }},
    {"quarry", [](double x, double) { return x < 45 ? 0.0 : 20.0; }},
    {"mountains",
     [](double x, double y) { return 2500 + 25 * std::sin(x / 7) * std::sin(y / 9); }}};

inline ColumnPlan plan_of(const SmallCity& city, const GroundMesh& ground, double mesh_size,
                          bool uniform) {
  ColumnPlanOptions options;
  options.fit_lowered_walls = !uniform;
  options.domain_height = 80;
  options.layer_height = mesh_size;
  return plan_columns(ground, city.dtm, city.roofs, column_spacing(ground), options);
}

/// Steps 3.1 to 3.5 with uniform layers.
struct LayeredCity {
  SmallCity city;
  LayeredMesh mesh;
  ColumnPlan plan;
};

inline LayeredCity layered(const SmallCity& city, double mesh_size = 8, bool fixed_top = true) {
  LayeredCity result;
  result.city = city;
  GroundMesh ground = mesh_ground(city.footprints, city.domain, {mesh_size, 25});
  result.plan = plan_of(city, ground, mesh_size, true);
  const LayerPlan& layers = result.plan.layers;
  result.mesh = make_layers(std::move(ground), layers.layers, layers.bottom, layers.top);
  SmoothOptions options;
  options.laplace.fixed_top = fixed_top;
  smooth_to_ground(result.mesh, result.plan.ground, options);
  trim(result.mesh, result.plan.lowest_roof, city.roofs);
  smooth_to_roofs(result.mesh, result.plan.lowest_roof, city.roofs, options);
  return result;
}

/// The tets of the prism of triangle t between layers k and k + 1, as (vertex, layer), in the split
/// drawn in layered_mesh.h; orientation as it comes.
inline std::array<std::array<std::pair<VertexIndex, std::int32_t>, 4>, 3> prism_tets(
    const LayeredMesh& mesh, std::size_t t, std::int32_t k) {
  const auto v = sorted_vertices(mesh.ground.triangles[t]);
  const auto u = [&](std::size_t i) { return std::pair(v[i], k); };
  const auto w = [&](std::size_t i) { return std::pair(v[i], k + 1); };
  return {{{u(0), u(1), u(2), w(2)}, {u(0), u(1), w(2), w(1)}, {u(0), w(1), w(2), w(0)}}};
}

/// Steps 3.1 to 3.5 with graded columns.
struct MeshedCity {
  SmallCity city;
  ColumnMesh mesh;
  ColumnPlan plan;
};

inline MeshedCity meshed(const SmallCity& city, double mesh_size = 8) {
  MeshedCity result;
  result.city = city;
  GroundMesh ground = mesh_ground(city.footprints, city.domain, {mesh_size, 25});
  result.plan = plan_of(city, ground, mesh_size, false);
  EdgeGraph edges = build_edge_graph(ground);
  result.mesh = divide_columns(std::move(ground), std::move(edges), result.plan);
  place_nodes(result.mesh, result.plan);
  return result;
}

}  // namespace tetropolis::testing
