#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/row_major.h"
#include "tetropolis/synth/synthetic_city.h"

#include "scan.h"
#include "seeded_random.h"

namespace tetropolis {

namespace {

constexpr std::uint64_t kRandomTerrainStream = 1;
constexpr std::uint64_t kPlaceStream = 2;
constexpr std::uint64_t kRandomScanSeed = 0x7363616e;
constexpr int kMaxTries = 1000;  // For one building, before the square counts as full.

void check(const RandomCityOptions& options) {
  const auto refuse = [](const char* what) {
    throw Error(ErrorKind::kUsage, fmt::format("cannot make a random city: {}", what));
  };
  if (!(options.size > 0 && options.size <= 1e5)) refuse("the size must be in (0, 100000] m");
  if (options.buildings < 0) refuse("the number of buildings must not be negative");
  if (!(options.points_per_m2 >= 0 && options.points_per_m2 <= 1000))
    refuse("the point density must be in [0, 1000] per m2");
  if (!(options.relief >= 0)) refuse("the relief must not be negative");
  if (!(options.margin >= 0)) refuse("the margin must not be negative");
  if (!(options.min_distance >= 0)) refuse("the distance between centres must not be negative");
  if (options.buildings > 0 && !(options.size > 2 * options.margin + 20))
    refuse("the size must exceed twice the margin by more than 20 m");
}

/// Finds centres that are too close, through a grid whose cells are as wide as the distance.
class Centres {
 public:
  Centres(double size, double min_distance)
      : min_distance_(min_distance),
        cell_(std::max(min_distance, size / 4096)),
        columns_(static_cast<std::int64_t>(size / cell_) + 1),
        cells_(static_cast<std::size_t>(columns_ * columns_)) {}

  bool free(Point2 p) const {
    const std::int64_t i = slot(p.x);
    const std::int64_t j = slot(p.y);
    for (std::int64_t nj = std::max<std::int64_t>(j - 1, 0); nj <= std::min(j + 1, columns_ - 1);
         ++nj)
      for (std::int64_t ni = std::max<std::int64_t>(i - 1, 0); ni <= std::min(i + 1, columns_ - 1);
           ++ni)
        for (const Point2 q : cells_[row_major(ni, nj, columns_)]) {
          const double dx = p.x - q.x;
          const double dy = p.y - q.y;
          if (dx * dx + dy * dy < min_distance_ * min_distance_) return false;
        }
    return true;
  }

  void add(Point2 p) { cells_[row_major(slot(p.x), slot(p.y), columns_)].push_back(p); }

 private:
  std::int64_t slot(double v) const { return static_cast<std::int64_t>(v / cell_); }

  double min_distance_;
  double cell_;
  std::int64_t columns_;
  std::vector<std::vector<Point2>> cells_;
};

SyntheticBuilding random_building(const RandomCityOptions& options, Centres& centres,
                                  SeededRandom& random) {
  // Half sides and centres in whole millimetres keep the centre of the rectangle exact.
  const double half_x = round_to_mm(random.uniform(0.5, 10));
  const double half_y = round_to_mm(random.uniform(0.5, 10));
  const double height = round_to_mm(random.uniform(12.5, 50));
  for (int tries = 0; tries < kMaxTries; ++tries) {
    const double free_x = options.margin + half_x;
    const double free_y = options.margin + half_y;
    const double x = random.uniform(free_x, options.size - free_x);
    const double y = random.uniform(free_y, options.size - free_y);
    const Point2 c{round_to_mm(x), round_to_mm(y)};
    if (!centres.free(c)) continue;
    centres.add(c);
    const double west = round_to_mm(c.x - half_x);
    const double east = round_to_mm(c.x + half_x);
    const double south = round_to_mm(c.y - half_y);
    const double north = round_to_mm(c.y + half_y);
    return {{{{west, south}, {east, south}, {east, north}, {west, north}}, {}},
            height,
            SyntheticKind::kScattered};
  }
  throw Error(ErrorKind::kUsage,
              fmt::format("{} buildings with centres {} m apart do not fit into {} x {} m: give "
                          "fewer `buildings` or a larger `size`",
                          options.buildings, options.min_distance, options.size, options.size));
}

}  // namespace

SyntheticCity synthetic_random_city(const RandomCityOptions& options, const Progress& progress) {
  check(options);
  SyntheticScene scene;
  scene.size = options.size;
  scene.terrain.relief = options.relief;
  SeededRandom terrain_random(options.seed, kRandomTerrainStream);
  for (double& phase : scene.terrain.phases) phase = terrain_random.unit();
  Centres centres(options.size, options.min_distance);
  SeededRandom random(options.seed, kPlaceStream);
  for (std::int64_t b = 0; b < options.buildings; ++b)
    scene.buildings.push_back(random_building(options, centres, random));
  SyntheticCity city = city_of_scene(scene);
  city.points =
      scan_scene(scene, options.points_per_m2, mix64(options.seed ^ kRandomScanSeed), progress);
  return city;
}

}  // namespace tetropolis
