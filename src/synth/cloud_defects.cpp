// Damage to point clouds.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "tetropolis/geometry/polygon.h"

#include "defects.h"

namespace tetropolis {

namespace {

struct Point {
  double x, y, z;
  std::uint8_t code, flags;
};

Point point_at(const PointTile& tile, std::size_t i) {
  return {tile.points.x[i], tile.points.y[i], tile.points.z[i], tile.points.classification[i],
          tile.flags.empty() ? std::uint8_t{0} : tile.flags[i]};
}

void append(PointTile& tile, const Point& p) {
  if (p.flags != 0 && tile.flags.empty()) tile.flags.resize(tile.points.size(), 0);
  tile.points.push_back(p.x, p.y, round_to_mm(p.z), p.code);
  if (!tile.flags.empty()) tile.flags.push_back(p.flags);
}

/// The points for which keep() says so.
template <typename Keep>
PointTile selected(const PointTile& tile, const Keep& keep) {
  PointTile result;
  for (std::size_t i = 0; i < tile.points.size(); ++i) {
    const Point p = point_at(tile, i);
    if (keep(p)) append(result, p);
  }
  return result;
}

/// Removes from every tile; returns how many went. A tile that would be left empty keeps one point.
template <typename Keep>
std::int64_t thin(AdversarialCity& city, const Keep& keep) {
  std::int64_t gone = 0;
  for (PointTile& tile : city.tiles) {
    PointTile rest = selected(tile, keep);
    if (rest.points.size() == 0 && tile.points.size() > 0) append(rest, point_at(tile, 0));
    gone += static_cast<std::int64_t>(tile.points.size() - rest.points.size());
    tile = std::move(rest);
  }
  return gone;
}

std::int64_t points_twice(AdversarialCity& city) {
  std::int64_t count = 0;
  for (PointTile& tile : city.tiles) {
    const std::size_t before = tile.points.size();
    for (std::size_t i = 0; i < before; ++i) append(tile, point_at(tile, i));
    count += static_cast<std::int64_t>(before);
  }
  return count;
}

/// Single returns far above and below everything. `classed`: as noise; else as whatever is there.
std::int64_t stray_points(AdversarialCity& city, bool birds, bool classed, SeededRandom& random) {
  PointTile& tile = city.tiles[random.bits() % city.tiles.size()];
  const std::size_t before = tile.points.size();
  const auto count = static_cast<std::int64_t>(2 + random.bits() % 12);
  for (std::int64_t k = 0; k < count && before > 0; ++k) {
    Point p = point_at(tile, random.bits() % before);
    p.z += birds ? random.uniform(20, 200) : -random.uniform(3, 40);
    if (classed) p.code = birds ? kHighNoise : kLowNoise;
    append(tile, p);
  }
  return before > 0 ? count : 0;
}

std::int64_t voids(AdversarialCity& city, SeededRandom& random) {
  std::int64_t gone = 0;
  const int count = 1 + static_cast<int>(random.bits() % 3);
  for (int k = 0; k < count; ++k) {
    const double x = random.uniform(0, city.domain.xmax);
    const double y = random.uniform(0, city.domain.ymax);
    gone += thin(city, [&](const Point& p) {
      return (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y) > 12.5 * 12.5;
    });
  }
  return gone;
}

/// Cuts the only tile into two or four, which overlap by or stand apart by `band` metres.
std::int64_t cut_tiles(AdversarialCity& city, double band, SeededRandom& random) {
  if (city.tiles.size() != 1) return 0;
  const PointTile whole = std::move(city.tiles.front());
  city.tiles.clear();
  const double x = random.uniform(0.3, 0.7) * city.domain.xmax;
  const double y = random.uniform(0.3, 0.7) * city.domain.ymax;
  const bool four = random.chance(0.5);
  for (int j = 0; j < (four ? 2 : 1); ++j)
    for (int i = 0; i < 2; ++i) {
      PointTile tile = selected(whole, [&](const Point& p) {
        const bool in_x = i == 0 ? p.x < x + band / 2 : p.x >= x - band / 2;
        const bool in_y = !four || (j == 0 ? p.y < y + band / 2 : p.y >= y - band / 2);
        return in_x && in_y;
      });
      if (tile.points.size() > 0) city.tiles.push_back(std::move(tile));
    }
  if (city.tiles.empty()) city.tiles.push_back(whole);
  return static_cast<std::int64_t>(city.tiles.size());
}

/// Sets a flag at some points; what is withheld is also wrong.
std::int64_t set_flags(AdversarialCity& city, std::uint8_t flag, bool spoil, SeededRandom& random) {
  std::int64_t count = 0;
  const double share = random.uniform(0.02, 0.3);
  for (PointTile& tile : city.tiles) {
    if (tile.flags.empty()) tile.flags.resize(tile.points.size(), 0);
    for (std::size_t i = 0; i < tile.points.size(); ++i) {
      if (!random.chance(share)) continue;
      tile.flags[i] |= flag;
      if (spoil) tile.points.z[i] = round_to_mm(tile.points.z[i] + random.uniform(-200, 400));
      ++count;
    }
  }
  return count;
}

/// User-defined classes in place of vegetation and of part of everything.
std::int64_t classes_above_31(AdversarialCity& city, SeededRandom& random) {
  std::int64_t count = 0;
  for (PointTile& tile : city.tiles)
    for (std::uint8_t& code : tile.points.classification) {
      const bool vegetation = code >= kLowVegetation && code <= kHighVegetation;
      if (!vegetation && !random.chance(0.02)) continue;
      code = static_cast<std::uint8_t>(32 + random.bits() % 224);
      ++count;
    }
  return count;
}

std::int64_t no_classes(AdversarialCity& city, SeededRandom& random) {
  std::int64_t count = 0;
  const bool one = random.chance(0.5);
  for (PointTile& tile : city.tiles)
    for (std::uint8_t& code : tile.points.classification) {
      code = one ? kUnclassified : kNeverClassified;
      ++count;
    }
  return count;
}

bool on_ground(const Point& p) { return is_ground(p.code); }

}  // namespace

std::int64_t damage_cloud(std::string_view name, AdversarialCity& city, SeededRandom& random) {
  if (name == "birds_classed") return stray_points(city, true, true, random);
  if (name == "birds_unclassed") return stray_points(city, true, false, random);
  if (name == "pits_classed") return stray_points(city, false, true, random);
  if (name == "pits_unclassed") return stray_points(city, false, false, random);
  if (name == "points_twice") return points_twice(city);
  if (name == "void_25m") return voids(city, random);
  if (name == "tiles_overlap") return cut_tiles(city, random.uniform(2, 30), random);
  if (name == "tiles_gap") return cut_tiles(city, -random.uniform(2, 25), random);
  if (name == "withheld_points") return set_flags(city, kWithheldPoint, true, random);
  if (name == "synthetic_points") return set_flags(city, kSyntheticPoint, false, random);
  if (name == "overlap_points") return set_flags(city, kOverlapPoint, false, random);
  if (name == "class_above_31") return classes_above_31(city, random);
  if (name == "no_classes") return no_classes(city, random);
  if (name == "only_ground") return thin(city, on_ground);
  if (name == "only_buildings")
    return thin(city, [](const Point& p) { return p.code == kBuildingClass; });
  if (name == "half_without_ground") {
    const double middle = random.uniform(0.4, 0.6) * city.domain.xmax;
    const bool west = random.chance(0.5);
    return thin(city, [&](const Point& p) { return !on_ground(p) || (p.x < middle) == west; });
  }
  return 0;
}

}  // namespace tetropolis
