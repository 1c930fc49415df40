#include "vegetation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "tetropolis/geometry/polygon.h"

#include "city/footprint_index.h"
#include "convex.h"

namespace tetropolis {

namespace {

using namespace convex;

constexpr double kLargestCrown = 5;
constexpr double kAvenueReach = 17;  // Metres from a quarter within which an avenue is street.

std::vector<const Polygon*> footprints_of(const SyntheticScene& scene) {
  std::vector<const Polygon*> pointers;
  for (const SyntheticBuilding& building : scene.buildings) pointers.push_back(&building.footprint);
  return pointers;
}

class Gardener {
 public:
  Gardener(SyntheticScene& scene, SeededRandom& random)
      : scene_(scene), random_(random), footprints_(footprints_of(scene), kLargestCrown + 1) {}

  /// A tree, or a bush now and then, unless it would overhang a building, the water or a bridge.
  void plant(Point2 at) {
    const bool bush = random_.chance(0.15);
    const double radius = bush ? random_.uniform(0.6, 1.3) : random_.uniform(2.2, kLargestCrown);
    const double height = bush ? random_.uniform(0.4, 1.9) : radius * random_.uniform(2.4, 3.6);
    if (at.x < 0 || at.y < 0 || at.x > scene_.size || at.y > scene_.size) return;
    if (!free(at, 0.85 * radius + 0.5)) return;
    scene_.trees.push_back({{round_to_mm(at.x), round_to_mm(at.y)}, radius, height});
  }

  /// Trees in the cells of a grid over a convex ring, each with the given chance.
  void plant_area(const Ring& ring, double spacing, double chance) {
    if (ring.empty()) return;
    const Bounds2 box = bounds(ring);
    for (double y = box.ymin; y < box.ymax; y += spacing)
      for (double x = box.xmin; x < box.xmax; x += spacing) {
        const bool wanted = random_.chance(chance);
        const Point2 at = jitter({x, y}, spacing);
        if (wanted && contains({ring, {}}, at)) plant(at);
      }
  }

  /// Trees along the edges of a convex ring, `outside` metres from it.
  void plant_along(const Ring& ring, double outside, double spacing, double chance) {
    walk(ring, outside, spacing, [&](Point2 at, Point2) {
      if (random_.chance(chance)) plant(at);
    });
  }

  void park_along(const Ring& ring, double outside, double chance) {
    walk(ring, outside, 6, [&](Point2 at, Point2 along) {
      if (random_.chance(chance) && free(at, 2.5))
        scene_.cars.push_back({{round_to_mm(at.x), round_to_mm(at.y)}, along});
    });
  }

  Point2 jitter(Point2 cell, double spacing) {
    const double x = cell.x + spacing * random_.unit();
    const double y = cell.y + spacing * random_.unit();
    return {x, y};
  }

 private:
  template <typename Visit>
  void walk(const Ring& ring, double outside, double spacing, const Visit& visit) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point2 edge = ring[(i + 1) % ring.size()] - ring[i];
      const Point2 along = unit(edge);
      for (double s = spacing / 2; s < length(edge); s += spacing)
        visit(ring[i] + s * along - outside * left_of(along), along);
    }
  }

  bool free(Point2 at, double clearance) const {
    bool result = true;
    footprints_.at(at, [&](BuildingIndex building, bool inside) {
      if (inside || footprints_.squared_distance(building, at) < clearance * clearance)
        result = false;
    });
    if (synthetic_river_distance(scene_.terrain, at.x, at.y) <
        scene_.terrain.river_half_width + clearance)
      return false;
    for (const SyntheticBridge& bridge : scene_.bridges)
      if (std::abs(at.x - bridge.at.x) < bridge.half_width + clearance &&
          std::abs(at.y - bridge.at.y) < bridge.half_length + clearance)
        return false;
    return result;
  }

  SyntheticScene& scene_;
  SeededRandom& random_;
  FootprintIndex footprints_;
};

/// Trees where there are neither quarters nor avenues: the margin and the river's meadows.
void plant_outskirts(const StreetPlan& plan, double size, Gardener& gardener,
                     SeededRandom& random) {
  std::vector<Polygon> quarters;
  for (const Quarter& quarter : plan.quarters) quarters.push_back({quarter.ring, {}});
  std::vector<const Polygon*> pointers;
  for (const Polygon& quarter : quarters) pointers.push_back(&quarter);
  const FootprintIndex index(pointers, kAvenueReach);
  constexpr double kSpacing = 9;
  for (double y = 0; y < size; y += kSpacing)
    for (double x = 0; x < size; x += kSpacing) {
      const Point2 at = gardener.jitter({x, y}, kSpacing);
      bool built = false;
      index.at(at, [&](BuildingIndex, bool) { built = true; });
      if (random.chance(built ? 0.01 : 0.4)) gardener.plant(at);
    }
}

void plant_quays(const SyntheticTerrain& terrain, double size, Gardener& gardener,
                 SeededRandom& random) {
  constexpr double kSpacing = 9;
  for (double x = kSpacing / 2; x < size; x += kSpacing)
    for (double y = 0; y < size; y += 1) {
      // The two places on this line that are a tree's distance from the bank.
      const double off = synthetic_river_distance(terrain, x, y) - terrain.river_half_width - 5.5;
      const double next =
          synthetic_river_distance(terrain, x, y + 1) - terrain.river_half_width - 5.5;
      if ((off < 0) != (next < 0) && random.chance(0.75)) gardener.plant({x, y + 0.5});
    }
}

}  // namespace

void plant_and_park(const StreetPlan& plan, SeededRandom& random, SyntheticScene& scene) {
  Gardener gardener(scene, random);
  for (const Quarter& quarter : plan.quarters) {
    const bool park = quarter.kind == QuarterKind::kPark;
    gardener.plant_along(quarter.ring, 3.5, park ? 8 : 11, park ? 0.9 : 0.6);
  }
  for (const Block& block : plan.blocks) {
    switch (block.kind) {
      case QuarterKind::kPark:
        gardener.plant_area(inset(block.ring, 6), 7, 0.5);
        break;
      case QuarterKind::kVillas:
        gardener.plant_area(block.ring, 6, 0.35);
        break;
      case QuarterKind::kModern:
        gardener.plant_area(block.ring, 8, 0.35);
        break;
      case QuarterKind::kPerimeter:
        gardener.plant_area(inset(block.ring, 14), 7, 0.45);
        break;
    }
    if (block.kind == QuarterKind::kPark) continue;
    gardener.park_along(block.ring, 2.6, 0.3);
    if (block.kind == QuarterKind::kPerimeter) gardener.plant_along(block.ring, 3.2, 14, 0.12);
  }
  plant_quays(plan.terrain, scene.size, gardener, random);
  plant_outskirts(plan, scene.size, gardener, random);
}

}  // namespace tetropolis
