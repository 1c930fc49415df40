// Steps 3.1 to 3.5 on the paper's random city: tets per second, and bytes per tet.
#include <algorithm>
#include <map>

#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/clean.h"
#include "tetropolis/city/simplify.h"
#include "tetropolis/city/synthetic.h"
#include "tetropolis/core/parallel.h"
#include "tetropolis/ground/mesh_ground.h"
#include "tetropolis/terrain/dtm.h"
#include "tetropolis/volume/fill_columns.h"
#include "tetropolis/volume/ground_heights.h"
#include "tetropolis/volume/smooth.h"

namespace {

using namespace tetropolis;

/// The city after step 2 and its terrain.
struct Input {
  std::vector<Polygon> footprints;
  std::vector<double> roofs;
  Raster dtm;
  Bounds2 domain;
};

Input make_input(std::int64_t buildings) {
  RandomCityOptions options;
  options.buildings = buildings;
  options.points_per_m2 = 0;
  const SyntheticCity city = synthetic_random_city(options);
  Input input;
  input.domain = city.domain;
  input.dtm = dtm_grid(city.domain, 1);
  for (std::int32_t j = 0; j < input.dtm.ny; ++j)
    for (std::int32_t i = 0; i < input.dtm.nx; ++i)
      input.dtm.values[static_cast<std::size_t>(j) * static_cast<std::size_t>(input.dtm.nx) +
                       static_cast<std::size_t>(i)] = synthetic_ground(city.terrain, i, j);
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

const Input& cached_input(std::int64_t buildings) {
  static std::map<std::int64_t, Input> inputs;
  const auto found = inputs.find(buildings);
  return found != inputs.end() ? found->second
                               : inputs.emplace(buildings, make_input(buildings)).first->second;
}

double peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024;
}

/// Arguments: buildings, mesh size in metres, threads.
void steps_3_1_to_3_5(benchmark::State& state) {
  const Input& input = cached_input(state.range(0));
  const auto size = static_cast<double>(state.range(1));
  const ThreadLimit limit(static_cast<int>(state.range(2)));
  double cells = 0;
  for (auto _ : state) {
    GroundMesh ground = mesh_ground(input.footprints, input.domain, {size, 25});
    const auto owner = vertex_buildings(ground);
    const std::vector<double> spacing = column_spacing(ground);
    const std::vector<double> wall(ground.vertices.size(), 1.0);
    const GroundHeights heights = ground_heights(ground, owner, input.roofs, input.dtm, 1, wall);
    const std::vector<double> rise = ground_rise(ground, heights.z);
    const double highest = *std::max_element(input.dtm.values.begin(), input.dtm.values.end());
    const LayerPlan plan = plan_layers(heights.z, input.roofs, highest, 100, size);
    const std::vector<double> top(ground.vertices.size(), plan.top);
    const ColumnEnds ends{heights.z, owner, input.roofs, top, spacing, rise};
    EdgeGraph edges = build_edge_graph(ground);
    ColumnMesh mesh = divide_columns(std::move(ground), std::move(edges), ends);
    place_nodes(mesh, ends);
    cells = static_cast<double>(cell_offsets(mesh).back());
  }
  state.counters["tets"] = cells;
  state.counters["tets/s"] =
      benchmark::Counter(cells, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["peak_bytes_per_tet"] = peak_bytes() / cells;
}
BENCHMARK(steps_3_1_to_3_5)
    ->Args({3096, 10, 1})
    ->Args({3096, 10, 2})
    ->Args({11585, 10, 2})
    ->Args({3096, 5, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
