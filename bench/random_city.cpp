#include "random_city.h"

#include <algorithm>
#include <map>
#include <utility>

#include "tetropolis/city/clean.h"
#include "tetropolis/city/simplify/simplify.h"
#include "tetropolis/core/row_major.h"
#include "tetropolis/ground/mesh_ground.h"
#include "tetropolis/synth/synthetic_city.h"
#include "tetropolis/terrain/dtm.h"

#include "volume/column/fill_columns.h"

namespace tetropolis {

namespace {

CityInput make_input(std::int64_t buildings, double size) {
  RandomCityOptions options;
  options.buildings = buildings;
  options.size = size;
  options.points_per_m2 = 0;
  const SyntheticCity city = synthetic_random_city(options);
  CityInput input;
  input.domain = city.domain;
  input.dtm = dtm_grid(city.domain, 1);
  for (std::int32_t j = 0; j < input.dtm.ny; ++j)
    for (std::int32_t i = 0; i < input.dtm.nx; ++i)
      input.dtm.values[row_major(i, j, input.dtm.nx)] = synthetic_ground(city.terrain, i, j);
  std::vector<Polygon> cleaned;
  for (const Polygon& footprint : city.footprints)
    cleaned.push_back(clean_footprint(footprint).polygon);
  const Simplification simple = simplify_footprints(cleaned, city.domain, {});
  input.footprints = simple.footprints;
  for (const auto& members : simple.members) {
    const auto first = static_cast<std::size_t>(members.front());
    input.roofs.push_back(city.ground[first] + city.heights[first]);
  }
  return input;
}

}  // namespace

const CityInput& random_city_input(std::int64_t buildings, double size) {
  static std::map<std::pair<std::int64_t, double>, CityInput> inputs;
  const std::pair key(buildings, size);
  const auto found = inputs.find(key);
  return found != inputs.end() ? found->second
                               : inputs.emplace(key, make_input(buildings, size)).first->second;
}

ColumnMesh columns_over(const CityInput& input, GroundMesh ground, double mesh_size) {
  ColumnPlanOptions options;
  options.layer_height = mesh_size;
  const ColumnPlan plan =
      plan_columns(ground, input.dtm, input.roofs, column_spacing(ground), options);
  EdgeGraph edges = build_edge_graph(ground);
  ColumnMesh mesh = divide_columns(std::move(ground), std::move(edges), plan);
  place_nodes(mesh, plan);
  return mesh;
}

ColumnMesh mesh_of(const CityInput& input, double mesh_size) {
  return columns_over(input, mesh_ground(input.footprints, input.domain, {mesh_size, 25}),
                      mesh_size);
}

}  // namespace tetropolis
