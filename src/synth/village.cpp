#include "village.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace tetropolis {

namespace {

void add(VillagePlot& plot, Ring outer, double height, SyntheticKind kind,
         std::vector<Ring> holes = {}) {
  plot.buildings.push_back({{std::move(outer), std::move(holes)}, round_to_mm(height), kind});
}

void build_house(VillagePlot& plot, SeededRandom& random) {
  const double width = random.uniform(7, 13);
  const double depth = random.uniform(6, 10);
  const double west = random.uniform(-plot.half, plot.half - width);
  const double south = random.uniform(-plot.half, plot.half - depth - 5);
  add(plot, plot.rectangle(west, south, west + width, south + depth), random.uniform(4, 9),
      SyntheticKind::kHouse);
  if (random.chance(0.6))
    add(plot, plot.rectangle(west, south + depth + 1.5, west + 3.2, south + depth + 4.5),
        random.uniform(2.2, 3), SyntheticKind::kShed);
}

void build_ell(VillagePlot& plot, SeededRandom& random) {
  const double h = plot.half;
  const double deep = random.uniform(0.5, 0.9) * h;
  Ring ring{plot.on_mm(-h, -h),       plot.on_mm(h, -h),
            plot.on_mm(h, -h + deep), plot.on_mm(-h + deep, -h + deep),
            plot.on_mm(-h + deep, h), plot.on_mm(-h, h)};
  add(plot, std::move(ring), random.uniform(6, 14), SyntheticKind::kRowHouse);
}

void build_courtyard(VillagePlot& plot, SeededRandom& random) {
  const double h = plot.half;
  const double wing = random.uniform(0.35, 0.6) * h;
  Ring hole = plot.rectangle(-h + wing, -h + wing, h - wing, h - wing);
  std::reverse(hole.begin(), hole.end());
  add(plot, plot.rectangle(-h, -h, h, h), random.uniform(9, 18), SyntheticKind::kCourtyard,
      {std::move(hole)});
}

/// Three houses that share their party walls vertex by vertex, each as deep as it likes.
void build_row(VillagePlot& plot, SeededRandom& random) {
  const double h = plot.half;
  std::array<double, 5> depths{0, 0, 0, 0, 0};
  for (std::size_t k = 1; k < 4; ++k) depths[k] = random.uniform(6, 2 * h);
  for (std::size_t k = 1; k < 4; ++k) {
    const double west = -h + 2 * h / 3 * static_cast<double>(k - 1);
    const double east = -h + 2 * h / 3 * static_cast<double>(k);
    Ring ring{plot.on_mm(west, -h), plot.on_mm(east, -h)};
    if (depths[k + 1] > 0 && depths[k + 1] < depths[k])
      ring.push_back(plot.on_mm(east, -h + depths[k + 1]));
    ring.push_back(plot.on_mm(east, -h + depths[k]));
    ring.push_back(plot.on_mm(west, -h + depths[k]));
    if (depths[k - 1] > 0 && depths[k - 1] < depths[k])
      ring.push_back(plot.on_mm(west, -h + depths[k - 1]));
    add(plot, std::move(ring), random.uniform(8, 16), SyntheticKind::kRowHouse);
  }
}

void build_tower(VillagePlot& plot, SeededRandom& random) {
  const double r = random.uniform(5, plot.half);
  const double c = r * 0.4142;
  Ring ring{plot.on_mm(r, -c), plot.on_mm(r, c),   plot.on_mm(c, r),   plot.on_mm(-c, r),
            plot.on_mm(-r, c), plot.on_mm(-r, -c), plot.on_mm(-c, -r), plot.on_mm(c, -r)};
  add(plot, std::move(ring), random.uniform(20, 45), SyntheticKind::kTower);
}

}  // namespace

Ring VillagePlot::rectangle(double west, double south, double east, double north) const {
  return {on_mm(west, south), on_mm(east, south), on_mm(east, north), on_mm(west, north)};
}

Point2 direction(double t) {
  const double scale = 1 / (1 + t * t);
  return {(1 - t * t) * scale, 2 * t * scale};
}

std::vector<VillagePlot> village(double size, double margin, SeededRandom& random) {
  const Point2 axis = direction(random.chance(0.3) ? 0 : random.uniform(-0.4, 0.4));
  const double pitch = std::min(random.uniform(26, 36), size / 5);
  const double half = (pitch - random.uniform(5, 9)) / 2;
  std::vector<VillagePlot> plots;
  const int reach = static_cast<int>(size / pitch) + 1;
  for (int j = -reach; j <= reach; ++j)
    for (int i = -reach; i <= reach; ++i) {
      VillagePlot plot{{size / 2, size / 2}, axis, half, {}};
      plot.centre = plot.at((i + 0.5) * pitch, (j + 0.5) * pitch);
      const double room = margin + 1.42 * half;
      if (std::min(plot.centre.x, plot.centre.y) < room ||
          std::max(plot.centre.x, plot.centre.y) > size - room)
        continue;
      const double what = random.unit();
      if (what < 0.34 || plots.size() < 2)
        build_house(plot, random);
      else if (what < 0.5)
        build_ell(plot, random);
      else if (what < 0.62)
        build_courtyard(plot, random);
      else if (what < 0.82)
        build_row(plot, random);
      else if (what < 0.9)
        build_tower(plot, random);
      plots.push_back(std::move(plot));
    }
  return plots;
}

void furnish(SyntheticScene& scene, SeededRandom& random) {
  const auto somewhere = [&] {
    const double x = random.uniform(4, scene.size - 4);
    const double y = random.uniform(4, scene.size - 4);
    return Point2{x, y};
  };
  const auto trees = static_cast<std::size_t>(scene.size * scene.size / 900);
  for (std::size_t k = 0; k < trees; ++k) {
    const Point2 at = somewhere();
    const double radius = random.uniform(0.8, 4);
    scene.trees.push_back({at, radius, radius * random.uniform(1.5, 3.5)});
  }
  for (std::size_t k = 0; k < trees / 2; ++k)
    scene.cars.push_back({somewhere(), direction(random.uniform(-1, 1))});
}

}  // namespace tetropolis
