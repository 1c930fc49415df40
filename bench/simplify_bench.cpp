// Simplification of random overlapping rectangles on 2.5 km x 2.5 km, sides uniform in 1 to 20 m.
#include <cstdint>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "tetropolis/city/clean.h"
#include "tetropolis/city/clearance.h"
#include "tetropolis/city/simplify.h"

namespace tetropolis {
namespace {

constexpr Bounds2 kDomain{0, 0, 2500, 2500};

std::vector<Polygon> random_rectangles(std::int64_t count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> side(1, 20), place(2, 2478);
  std::vector<Polygon> result;
  for (std::int64_t i = 0; i < count; ++i) {
    const double x = place(random), y = place(random), w = side(random), h = side(random);
    result.push_back({{{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}}, {}});
  }
  return result;
}

std::vector<Polygon> cleaned_rectangles(std::int64_t count) {
  std::vector<Polygon> result;
  for (const Polygon& raw : random_rectangles(count))
    result.push_back(clean_footprint(raw).polygon);
  return result;
}

void clean_footprints(benchmark::State& state) {
  const std::vector<Polygon> raw = random_rectangles(state.range(0));
  for (auto _ : state)
    for (const Polygon& polygon : raw) benchmark::DoNotOptimize(clean_footprint(polygon));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(clean_footprints)->Arg(11585)->Unit(benchmark::kMillisecond);

void simplify(benchmark::State& state) {
  const std::vector<Polygon> input = cleaned_rectangles(state.range(0));
  Simplification result;
  for (auto _ : state) result = simplify_footprints(input, kDomain, {});
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.counters["footprints"] = static_cast<double>(result.footprints.size());
  state.counters["changed_percent"] = 100 * result.stats.area_changed / result.stats.area_before;
}
BENCHMARK(simplify)->Arg(3096)->Arg(11585)->Arg(20000)->Unit(benchmark::kMillisecond);

void validate(benchmark::State& state) {
  const Simplification city = simplify_footprints(cleaned_rectangles(state.range(0)), kDomain, {});
  for (auto _ : state) {
    benchmark::DoNotOptimize(joint_clearance(city.footprints, kDomain));
    benchmark::DoNotOptimize(footprint_defects(city.footprints));
  }
}
BENCHMARK(validate)->Arg(11585)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tetropolis
