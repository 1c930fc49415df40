// Buildings nobody would plan, as polygons that are valid in themselves.
#include <algorithm>
#include <cstddef>
#include <utility>

#include "defects.h"

namespace tetropolis {

namespace {

using Plots = std::vector<VillagePlot>;

constexpr double kMicrometre = 1e-6;

void add(VillagePlot& plot, Ring outer, double height, std::vector<Ring> holes = {}) {
  for (Ring& hole : holes) std::reverse(hole.begin(), hole.end());
  plot.buildings.push_back(
      {{std::move(outer), std::move(holes)}, round_to_mm(height), SyntheticKind::kHouse});
}

/// A building around a yard, in it a building around a yard, in it a hut.
std::int64_t nested_courtyard(VillagePlot& plot, SeededRandom& random) {
  double h = plot.half;
  std::int64_t count = 0;
  for (; h > 2.2; ++count) {
    const double inner = h - random.uniform(1.6, 3.2);
    const bool yard = inner > 1.2;
    add(plot, plot.rectangle(-h, -h, h, h), random.uniform(5, 15),
        yard ? std::vector<Ring>{plot.rectangle(-inner, -inner, inner, inner)}
             : std::vector<Ring>{});
    h = inner - random.uniform(0.4, 2.5);
  }
  return count;
}

/// Two houses against the middle of the wall of a third, a micrometre in or out.
std::int64_t tjunction_micrometre(VillagePlot& plot, SeededRandom& random) {
  const double h = plot.half;
  add(plot, plot.rectangle(-h, -h, h, 0), random.uniform(5, 15));
  const double off = random.chance(0.5) ? kMicrometre : -kMicrometre;
  const double west = random.uniform(-h + 0.5, -h / 3);
  const double east = random.uniform(0, h / 2);
  add(plot,
      {plot.at(west, off), plot.at(east, -off), plot.on_mm(east, h), plot.on_mm(west, h * 0.8)},
      random.uniform(5, 15));
  add(plot,
      {plot.at(east + kMicrometre, off), plot.at(h, off), plot.on_mm(h, h * 0.6),
       plot.at(east + off, h * 0.6)},
      random.uniform(5, 15));
  return 2;
}

std::int64_t crack_1cm(VillagePlot& plot, SeededRandom& random) {
  const double h = plot.half;
  const double crack = random.chance(0.7) ? 0.01 : random.uniform(0.002, 0.08);
  const double at = random.uniform(-h / 2, h / 2);
  // Sometimes it closes towards one end.
  const double end = random.chance(0.4) ? 0 : crack;
  add(plot, {plot.on_mm(-h, -h), plot.on_mm(at, -h), plot.on_mm(at, h), plot.on_mm(-h, h)},
      random.uniform(5, 20));
  add(plot,
      {plot.on_mm(at + crack, -h), plot.on_mm(h, -h), plot.on_mm(h, h), plot.on_mm(at + end, h)},
      random.uniform(5, 20));
  return 1;
}

/// Walls of 5 cm around a yard, or one that stands free.
std::int64_t wall_5cm(VillagePlot& plot, SeededRandom& random) {
  const double h = plot.half;
  constexpr double kWall = 0.05;
  if (random.chance(0.5)) {
    const double thick = random.chance(0.5) ? kWall : random.uniform(1, 5);
    add(plot, plot.rectangle(-h, -h, h, h), random.uniform(3, 10),
        {plot.rectangle(-h + kWall, -h + thick, h - kWall, h - kWall)});
    return 1;
  }
  add(plot, plot.rectangle(-h, -h, -h + kWall, h), random.uniform(2, 5));
  add(plot, plot.rectangle(0, -h, h, 0), random.uniform(5, 10));
  add(plot, plot.rectangle(-h / 2, 0.7, h, 0.7 + kWall), random.uniform(2, 5));
  return 2;
}

std::int64_t shed_2cm(VillagePlot& plot, SeededRandom& random) {
  const double h = plot.half;
  add(plot, plot.rectangle(-h / 2, -h, h / 2, 0), random.uniform(4, 9));
  for (int k = 0; k < 4; ++k) {
    const double u = random.uniform(-h, h - 0.02);
    const double v = random.uniform(-h, h - 0.02);
    const double wide = random.chance(0.5) ? 0.02 : random.uniform(0.1, 2);
    add(plot, plot.rectangle(u, v, u + wide, v + 0.02), random.uniform(2, 3));
  }
  return 4;
}

std::int64_t building_twice(Plots& plots, SeededRandom& random) {
  std::int64_t count = 0;
  const double share = random.chance(0.2) ? 1 : 0.15;
  for (VillagePlot& plot : plots) {
    const std::size_t before = plot.buildings.size();
    for (std::size_t b = 0; b < before; ++b) {
      if (!random.chance(share)) continue;
      SyntheticBuilding copy = plot.buildings[b];
      if (random.chance(0.5) && !copy.footprint.outer.empty())
        std::rotate(copy.footprint.outer.begin(), copy.footprint.outer.begin() + 1,
                    copy.footprint.outer.end());
      plot.buildings.push_back(std::move(copy));
      ++count;
    }
  }
  return count;
}

std::int64_t massive_overlaps(VillagePlot& plot, SeededRandom& random) {
  const double h = plot.half;
  const auto count = static_cast<std::int64_t>(random.uniform(6, 16));
  for (std::int64_t k = 0; k < count; ++k) {
    const double u = random.uniform(-h, h);
    const double v = random.uniform(-h, h);
    const double width = random.uniform(1, 14);
    const double depth = random.uniform(1, 14);
    VillagePlot turned = plot;
    turned.axis = direction(random.uniform(-1, 1));
    add(plot, turned.rectangle(u - width / 2, v - depth / 2, u + width / 2, v + depth / 2),
        random.uniform(3, 25));
  }
  return count;
}

std::int64_t checkerboard(VillagePlot& plot, SeededRandom& random) {
  const double step = plot.half / (random.chance(0.5) ? 2 : 3);
  const int cells = static_cast<int>(2 * plot.half / step + 0.5);
  std::int64_t count = 0;
  for (int j = 0; j < cells; ++j)
    for (int i = j % 2; i < cells; i += 2, ++count)
      add(plot,
          plot.rectangle(-plot.half + i * step, -plot.half + j * step, -plot.half + (i + 1) * step,
                         -plot.half + (j + 1) * step),
          random.uniform(4, 12));
  return count;
}

/// A circle from the rational parametrisation: no sine is needed.
std::int64_t circle_4000(VillagePlot& plot, SeededRandom& random) {
  const double r = random.uniform(4, plot.half);
  constexpr int kQuarter = 1000;
  Ring ring;
  for (int quarter = 0; quarter < 4; ++quarter)
    for (int k = 0; k < kQuarter; ++k) {
      Point2 p = direction(static_cast<double>(k) / kQuarter);
      for (int turn = 0; turn < quarter; ++turn) p = {-p.y, p.x};
      ring.push_back(plot.at(r * p.x, r * p.y));
    }
  add(plot, std::move(ring), random.uniform(4, 25));
  return 1;
}

/// A lone needle, and a house that ends in one.
std::int64_t needle(VillagePlot& plot, SeededRandom& random) {
  const double h = plot.half;
  constexpr double kTangent = 0.0087269;  // Of half a degree.
  const double base = 2 * h * kTangent;
  add(plot, {plot.on_mm(-h, h), plot.at(h, h), plot.at(h, h + base)}, random.uniform(4, 9));
  const double length = random.uniform(h, 1.8 * h);
  add(plot,
      {plot.on_mm(-h, -h), plot.on_mm(-h + 6, -h), plot.at(-h + 6 + length, -h),
       plot.at(-h + 6, -h + length * kTangent), plot.on_mm(-h + 6, -h + 7), plot.on_mm(-h, -h + 7)},
      random.uniform(4, 9));
  return 2;
}

/// Lower than the ground behind it once the terrain is steep.
std::int64_t sunken_roof(VillagePlot& plot, SeededRandom& random) {
  const double h = plot.half;
  add(plot, plot.rectangle(-h, -3, h, 3), random.uniform(0.5, 2.6));
  add(plot, plot.rectangle(-3, 4.5, 3, h), random.uniform(0.5, 2.6));
  return 2;
}

std::int64_t tower_300(VillagePlot& plot, SeededRandom& random) {
  const double h = plot.half;
  const double half = random.uniform(3, 8);
  add(plot, plot.rectangle(-half, -half, half, half), random.uniform(200, 300));
  for (double u = -h; u < h - 2.5; u += 4.5) {
    add(plot, plot.rectangle(u, -h, u + 2.5, -h + 2.5), 2.5);
    if (random.chance(0.5)) add(plot, plot.rectangle(u, h - 2.2, u + 2.5, h), 2.2);
  }
  return 1;
}

/// A plot whose frame is that of the square, its lower left corner at the origin.
VillagePlot straight_plot() { return {{0, 0}, {1, 0}, 0, {}}; }

std::int64_t domain_sized(Plots& plots, double size, SeededRandom& random) {
  VillagePlot plot = straight_plot();
  const double edge = random.chance(0.5) ? 0.5 : random.uniform(1, 10);
  add(plot, plot.rectangle(edge, edge, size - edge, size - edge), random.uniform(3, 12));
  plots.push_back(std::move(plot));
  return 1;
}

std::int64_t on_boundary(Plots& plots, double size, SeededRandom& random) {
  const auto count = static_cast<std::int64_t>(random.uniform(1, 5));
  for (std::int64_t k = 0; k < count; ++k) {
    VillagePlot plot = straight_plot();
    const double along = random.uniform(12, size - 24);
    const double what = random.unit();
    // Across the boundary, exactly against it, or short of it by a millimetre to a metre.
    const double end = what < 0.4   ? -random.uniform(0.1, 6)
                       : what < 0.6 ? 0
                                    : random.uniform(0.001, 1);
    const double deep = random.uniform(5, 10);
    const double wide = random.uniform(5, 12);
    const bool far = random.chance(0.5);
    const double v0 = far ? size - deep : end;
    const double v1 = far ? size - end : deep;
    const bool upright = random.chance(0.5);
    add(plot,
        upright ? plot.rectangle(v0, along, v1, along + wide)
                : plot.rectangle(along, v0, along + wide, v1),
        random.uniform(4, 12));
    plots.push_back(std::move(plot));
  }
  return count;
}

std::int64_t on_corner(Plots& plots, double size, SeededRandom& random) {
  VillagePlot plot = straight_plot();
  const double out = random.chance(0.5) ? -random.uniform(0.5, 8) : random.uniform(0, 0.9);
  const double in = random.uniform(5, 11);
  const bool east = random.chance(0.5);
  const bool north = random.chance(0.5);
  add(plot,
      plot.rectangle(east ? size - in : out, north ? size - in : out, east ? size - out : in,
                     north ? size - out : in),
      random.uniform(4, 12));
  plots.push_back(std::move(plot));
  return 1;
}

struct PlotDefect {
  std::string_view name;
  std::int64_t (*build)(VillagePlot&, SeededRandom&);
};
constexpr PlotDefect kPlotDefects[] = {{"nested_courtyard", nested_courtyard},
                                       {"tjunction_micrometre", tjunction_micrometre},
                                       {"crack_1cm", crack_1cm},
                                       {"wall_5cm", wall_5cm},
                                       {"shed_2cm", shed_2cm},
                                       {"massive_overlaps", massive_overlaps},
                                       {"checkerboard", checkerboard},
                                       {"circle_4000", circle_4000},
                                       {"needle_half_degree", needle},
                                       {"roof_below_terrain", sunken_roof},
                                       {"tower_300", tower_300}};

}  // namespace

std::int64_t build_defect(std::string_view name, double size, std::vector<VillagePlot>& plots,
                          SeededRandom& random) {
  for (const PlotDefect& defect : kPlotDefects) {
    if (defect.name != name || plots.empty()) continue;
    std::int64_t count = 0;
    const int places = 1 + static_cast<int>(3 * random.unit() * random.unit());
    for (int k = 0; k < places; ++k) {
      VillagePlot& plot = plots[random.bits() % plots.size()];
      if (plot.half <= 0) continue;
      // Now and then among what stands there already.
      if (random.chance(0.8)) plot.buildings.clear();
      count += defect.build(plot, random);
    }
    return count;
  }
  if (name == "building_twice") return building_twice(plots, random);
  if (name == "domain_sized") return domain_sized(plots, size, random);
  if (name == "on_boundary") return on_boundary(plots, size, random);
  if (name == "on_corner") return on_corner(plots, size, random);
  return 0;
}

}  // namespace tetropolis
