// Steps 3.1 to 3.5 on the paper's random city: tets per second.
#include <benchmark/benchmark.h>

#include "tetropolis/core/threads.h"

#include "random_city.h"

namespace {

using namespace tetropolis;

/// Arguments: buildings, mesh size in metres, threads.
void steps_3_1_to_3_5(benchmark::State& state) {
  const CityInput& input = random_city_input(state.range(0));
  const ThreadLimit limit(static_cast<int>(state.range(2)));
  double cells = 0;
  for (auto _ : state)
    cells = static_cast<double>(
        cell_offsets(mesh_of(input, static_cast<double>(state.range(1)))).back().value());
  state.counters["tets"] = cells;
  state.counters["tets/s"] =
      benchmark::Counter(cells, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(steps_3_1_to_3_5)
    ->Args({3096, 10, 1})
    ->Args({3096, 10, 2})
    ->Args({11585, 10, 2})
    ->Args({3096, 5, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
