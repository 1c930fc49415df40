// Triangles per second of the ground mesher: random disjoint rectangles on 2.5 km x 2.5 km.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "tetropolis/ground/mesh_ground.h"
#include "tetropolis/ground/triangulation.h"

namespace tetropolis {
namespace {

constexpr double kSide = 2500;
constexpr double kClearance = 1;

// Rectangles of 6 to 24 metres whose circumscribed circles are a metre apart.
std::vector<Polygon> random_city(int count) {
  struct Disc {
    Point2 centre;
    double radius;
  };
  constexpr double kCell = 40;  // more than the sum of two radii and the clearance
  const auto cells = static_cast<std::ptrdiff_t>(kSide / kCell) + 1;
  std::vector<std::vector<Disc>> grid(static_cast<std::size_t>(cells * cells));
  std::mt19937 engine(1);
  const auto real = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(engine()) * 0x1p-32;
  };
  std::vector<Polygon> city;
  while (static_cast<int>(city.size()) < count) {
    const double w = real(6, 24), h = real(6, 24), turn = real(0, 6.28);
    const double r = 0.5 * std::hypot(w, h);
    const Point2 c{real(r + 5, kSide - r - 5), real(r + 5, kSide - r - 5)};
    const auto i = static_cast<std::ptrdiff_t>(c.x / kCell);
    const auto j = static_cast<std::ptrdiff_t>(c.y / kCell);
    bool free = true;
    for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(0, i - 1); k <= std::min(cells - 1, i + 1);
         ++k)
      for (std::ptrdiff_t l = std::max<std::ptrdiff_t>(0, j - 1); l <= std::min(cells - 1, j + 1);
           ++l)
        for (const Disc& d : grid[static_cast<std::size_t>(l * cells + k)])
          free = free && std::hypot(d.centre.x - c.x, d.centre.y - c.y) > d.radius + r + kClearance;
    if (!free) continue;
    grid[static_cast<std::size_t>(j * cells + i)].push_back({c, r});
    Polygon p;
    for (const Point2 k : {Point2{-1, -1}, Point2{1, -1}, Point2{1, 1}, Point2{-1, 1}}) {
      const double u = 0.5 * w * k.x, v = 0.5 * h * k.y;
      p.outer.push_back({c.x + u * std::cos(turn) - v * std::sin(turn),
                         c.y + u * std::sin(turn) + v * std::cos(turn)});
    }
    city.push_back(p);
  }
  return city;
}

void mesh_random_city(benchmark::State& state) {
  const std::vector<Polygon> city = random_city(static_cast<int>(state.range(0)));
  const GroundMeshOptions options{static_cast<double>(state.range(1)),
                                  static_cast<double>(state.range(2))};
  std::size_t triangles = 0;
  for (auto _ : state) {
    const GroundMesh mesh = mesh_ground(city, {0, 0, kSide, kSide}, options);
    triangles = mesh.triangles.size();
  }
  state.counters["triangles"] = static_cast<double>(triangles);
  state.counters["m2_per_triangle"] = kSide * kSide / static_cast<double>(triangles);
  state.counters["triangles/s"] = benchmark::Counter(static_cast<double>(triangles),
                                                     benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(mesh_random_city)
    ->ArgNames({"buildings", "size", "angle"})
    ->Args({3000, 10, 25})
    ->Args({10000, 10, 25})
    ->Args({3000, 5, 25})
    ->Args({10000, 5, 25})
    ->Args({10000, 5, 30})
    ->Unit(benchmark::kMillisecond);

void triangulate_random_points(benchmark::State& state) {
  PlanarGraph graph;
  std::mt19937 engine(1);
  for (std::int64_t i = 0; i < state.range(0); ++i) {
    const double x = static_cast<double>(engine()), y = static_cast<double>(engine());
    graph.points.push_back({x * 0x1p-22, y * 0x1p-22});
  }
  for (auto _ : state) benchmark::DoNotOptimize(constrained_delaunay(graph));
  state.counters["points/s"] = benchmark::Counter(static_cast<double>(state.range(0)),
                                                  benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(triangulate_random_points)->Arg(100'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tetropolis
