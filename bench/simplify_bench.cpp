// Simplification of random cities and of cases made to hurt: one huge cluster, combs, grids of
// touching squares, long strips, outlines of very many vertices, a spiral.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "tetropolis/city/clean.h"
#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/city/simplify/simplify.h"
#include "tetropolis/core/threads.h"
#include "tetropolis/geometry/polygon.h"

namespace tetropolis {
namespace {

constexpr Bounds2 kDomain{0, 0, 2500, 2500};

Polygon box(double x, double y, double w, double h) {
  return {{{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}}, {}};
}

/// Rectangles with sides uniform in `shortest` to `longest`, on a square of `size` metres.
std::vector<Polygon> random_rectangles(std::int64_t count, double size, double shortest,
                                       double longest) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> side(shortest, longest), place(2, size - longest - 2);
  std::vector<Polygon> result;
  for (std::int64_t i = 0; i < count; ++i) {
    const double x = place(random), y = place(random), w = side(random), h = side(random);
    result.push_back(box(x, y, w, h));
  }
  return result;
}

/// The density of 11,585 on 2.5 km.
std::vector<Polygon> city(std::int64_t count) {
  return random_rectangles(count, 2500 * std::sqrt(static_cast<double>(count) / 11585), 1, 20);
}
std::vector<Polygon> rectangles(std::int64_t count) {
  return random_rectangles(count, 2500, 1, 20);
}
std::vector<Polygon> one_cluster(std::int64_t count) {
  return random_rectangles(count, 2500, 10, 60);
}

/// One outline with teeth and gaps of half a metre.
std::vector<Polygon> comb(std::int64_t teeth) {
  Polygon comb{{{0, 0}, {static_cast<double>(teeth), 0}}, {}};
  for (std::int64_t i = teeth; i-- > 0;) {
    const auto x = static_cast<double>(i);
    for (const Point2 p : {Point2{x + 0.5, 30}, {x + 0.5, 20}, {x, 20}, {x, 30}})
      comb.outer.push_back(p);
  }
  comb.outer.insert(comb.outer.begin() + 2, {static_cast<double>(teeth), 30});
  return {comb};
}

std::vector<Polygon> touching_squares(std::int64_t count) {
  const auto side = static_cast<std::int64_t>(std::sqrt(static_cast<double>(count)));
  std::vector<Polygon> result;
  for (std::int64_t y = 0; y < side; ++y)
    for (std::int64_t x = 0; x < side; ++x)
      result.push_back(box(10.0 * static_cast<double>(x), 10.0 * static_cast<double>(y), 10, 10));
  return result;
}

/// Strips of 2 km, half a metre apart, a little turned.
std::vector<Polygon> strips(std::int64_t count) {
  std::vector<Polygon> result;
  for (std::int64_t i = 0; i < count; ++i) {
    Polygon strip = box(0, 2.0 * static_cast<double>(i), 2000, 1.5);
    for (Point2& p : strip.outer) p = {p.x * 0.96 - p.y * 0.28, p.x * 0.28 + p.y * 0.96};
    result.push_back(strip);
  }
  return result;
}

/// A circle whose radius is noisy: edges of a few centimetres.
std::vector<Polygon> noisy_circle(std::int64_t vertices) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-0.5, 0.5);
  Polygon circle;
  for (std::int64_t i = 0; i < vertices; ++i) {
    const double a = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(vertices);
    const double r = 500 + noise(random);
    circle.outer.push_back({r * std::cos(a), r * std::sin(a)});
  }
  return {circle};
}

/// A wall of 0.8 m that winds up with gaps of 0.7 m.
std::vector<Polygon> spiral(std::int64_t vertices) {
  Ring inner, outer;
  double a = 20;
  for (std::int64_t i = 0; i < vertices / 2; ++i) {
    const double r = 1.5 * a / (2 * std::numbers::pi);
    inner.push_back({r * std::cos(a), r * std::sin(a)});
    outer.push_back({(r + 0.8) * std::cos(a), (r + 0.8) * std::sin(a)});
    a += 1.2 / r;
  }
  Polygon spiral{outer, {}};
  spiral.outer.insert(spiral.outer.end(), inner.rbegin(), inner.rend());
  return {spiral};
}

std::vector<Polygon> cleaned(const std::vector<Polygon>& raw) {
  std::vector<Polygon> result;
  for (const Polygon& polygon : raw) result.push_back(clean_footprint(polygon).polygon);
  return result;
}

Bounds2 domain_around(const std::vector<Polygon>& polygons) {
  Bounds2 box = bounds(polygons.at(0));
  for (const Polygon& polygon : polygons) {
    const Bounds2 b = bounds(polygon);
    box = {std::min(box.xmin, b.xmin), std::min(box.ymin, b.ymin), std::max(box.xmax, b.xmax),
           std::max(box.ymax, b.ymax)};
  }
  return box.grown(50);
}

void clean_footprints(benchmark::State& state) {
  const std::vector<Polygon> raw = rectangles(state.range(0));
  for (auto _ : state)
    for (const Polygon& polygon : raw) benchmark::DoNotOptimize(clean_footprint(polygon));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(clean_footprints)->Arg(11585)->Unit(benchmark::kMillisecond);

/// Arguments: how many, and how many threads.
void simplify(benchmark::State& state, std::vector<Polygon> (*make)(std::int64_t)) {
  const std::vector<Polygon> input = cleaned(make(state.range(0)));
  const Bounds2 domain = domain_around(input);
  const ThreadLimit limit(static_cast<int>(state.range(1)));
  Simplification result;
  for (auto _ : state) result = simplify_footprints(input, domain, {});
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.counters["footprints"] = static_cast<double>(result.footprints.size());
  state.counters["changed_percent"] =
      100 * result.stats.symmetric_difference / result.stats.area_before;
  state.counters["rounds"] = result.stats.rounds;
  state.counters["hulls"] = static_cast<double>(result.stats.hulls);
}

#define SIMPLIFY(make)                    \
  BENCHMARK_CAPTURE(simplify, make, make) \
      ->Unit(benchmark::kMillisecond)     \
      ->MeasureProcessCPUTime()           \
      ->UseRealTime()
SIMPLIFY(rectangles)->ArgsProduct({{3096, 11585, 20000, 100000}, {1, 2}});
SIMPLIFY(city)->ArgsProduct({{100000}, {1, 2}});
SIMPLIFY(one_cluster)->ArgsProduct({{20000, 100000}, {1, 2}});
SIMPLIFY(comb)->Args({2500, 1})->Args({10000, 1});
SIMPLIFY(touching_squares)->Args({10000, 1})->Args({90000, 1});
SIMPLIFY(strips)->Args({250, 1})->Args({1000, 1});
SIMPLIFY(noisy_circle)->Args({25000, 1})->Args({100000, 1});
SIMPLIFY(spiral)->Args({5000, 1})->Args({20000, 1});
#undef SIMPLIFY

void validate(benchmark::State& state) {
  const Simplification city = simplify_footprints(cleaned(rectangles(state.range(0))), kDomain, {});
  for (auto _ : state) {
    benchmark::DoNotOptimize(joint_clearance(city.footprints, kDomain));
    benchmark::DoNotOptimize(footprint_defects(city.footprints));
  }
}
BENCHMARK(validate)->Arg(11585)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tetropolis
