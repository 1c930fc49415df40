#include "scan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "tetropolis/core/row_major.h"
#include "tetropolis/geometry/polygon.h"

#include "city/footprint_index.h"
#include "core/infinity.h"
#include "core/parallel.h"
#include "core/ragged_builder.h"
#include "seeded_random.h"

namespace tetropolis {

namespace {

constexpr double kNearWall = 0.5;  // Metres around walls where facades and parapets are seen.
constexpr std::size_t kRowGrain = 8;

/// Lists the discs that overlap each cell of a grid over [0, size]^2.
class DiscIndex {
 public:
  template <typename Things, typename Radius>
  DiscIndex(double size, const Things& things, const Radius& radius)
      : side_(static_cast<std::int32_t>(size / kCell) + 1) {
    cells_ = ragged_from_pairs<std::size_t>(
        static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), [&](const auto& use) {
          for (std::size_t t = 0; t < things.size(); ++t) {
            const Point2 at = things[t].at;
            const double r = radius(things[t]);
            for (std::int32_t j = slot(at.y - r); j <= slot(at.y + r); ++j)
              for (std::int32_t i = slot(at.x - r); i <= slot(at.x + r); ++i) use(index(i, j), t);
          }
        });
  }

  std::span<const std::size_t> at(Point2 p) const { return cells_[index(slot(p.x), slot(p.y))]; }

 private:
  static constexpr double kCell = 8;
  std::int32_t slot(double v) const {
    return std::clamp(static_cast<std::int32_t>(v / kCell), 0, side_ - 1);
  }
  std::size_t index(std::int32_t i, std::int32_t j) const { return row_major(i, j, side_); }

  std::int32_t side_;
  RaggedArray<std::size_t> cells_;
};

/// A return: no point if the class is kNothing.
struct Return {
  double z;
  std::uint8_t code;
};
constexpr std::uint8_t kNothing = 255;

class Scanner {
 public:
  Scanner(const SyntheticScene& scene, std::uint64_t seed)
      : scene_(scene),
        seed_(seed),
        footprints_(pointers(scene.buildings), kNearWall),
        trees_(scene.size, scene.trees, [](const SyntheticTree& tree) { return tree.radius; }),
        cars_(scene.size, scene.cars, [](const SyntheticCar&) { return 3.0; }) {}

  Return look_down(Point2 p, SeededRandom& random) const {
    BuildingIndex roof = kNoBuilding, wall = kNoBuilding;
    footprints_.at(p, [&](BuildingIndex b, bool inside) {
      if (!inside) {
        wall = b;
      } else if (roof == kNoBuilding || scene_.roofs[b] > scene_.roofs[roof]) {
        roof = b;
      }
    });
    if (roof != kNoBuilding) return {roof_height(p, roof, random), kBuildingClass};
    const double ground = synthetic_ground(scene_.terrain, p.x, p.y);
    if (const Return seen = bridge(p, random); seen.code != kNothing) return seen;
    if (synthetic_water(scene_.terrain, p.x, p.y)) {
      const double noise = 0.015 * random.bell();
      // Water swallows most pulses.
      return {ground + noise, random.chance(0.3) ? std::uint8_t{kWater} : kNothing};
    }
    if (const Return seen = tree(p, ground, random); seen.code != kNothing) return seen;
    if (scene_.details && wall != kNoBuilding && random.chance(0.2))
      return {random.uniform(ground, scene_.roofs[wall]), kUnclassified};
    if (const Return seen = car(p, ground, random); seen.code != kNothing) return seen;
    const double noise = 0.02 * random.bell();
    const bool missed = scene_.details && random.chance(0.02);
    return {ground + noise, missed ? std::uint8_t{kUnclassified} : std::uint8_t{kGround}};
  }

 private:
  static std::vector<const Polygon*> pointers(const std::vector<SyntheticBuilding>& buildings) {
    std::vector<const Polygon*> result;
    for (const SyntheticBuilding& building : buildings) result.push_back(&building.footprint);
    return result;
  }

  double roof_height(Point2 p, BuildingIndex b, SeededRandom& random) const {
    const bool has_parts = !scene_.parts.empty() && !scene_.parts[b].empty();
    const double roof = has_parts ? plane_at(scene_.parts[b], p)(p) : scene_.roofs[b];
    const double z = roof + 0.03 * random.bell();
    if (!scene_.details) return z;
    const SyntheticKind kind = scene_.buildings[b].kind;
    if (kind == SyntheticKind::kShed) return z;
    constexpr double kChimney = 1.5;
    const double chimney = cell_hash(seed_, static_cast<std::int64_t>(p.x / kChimney),
                                     static_cast<std::int64_t>(p.y / kChimney));
    if (chimney < 0.004) return z + 1.2;
    if (has_parts) return z;
    const bool parapet = kind == SyntheticKind::kTower || b.value() % 4 == 0;
    if (parapet && footprints_.squared_distance(b, p) < 0.3 * 0.3) return z + 0.7;
    return z;
  }

  /// Of the part that p is in; where rounding left p in none, of the nearest.
  static const RoofPlane& plane_at(const std::vector<RoofPart>& parts, Point2 p) {
    const RoofPart* nearest = nullptr;
    double least = kInfinity;
    for (const RoofPart& part : parts) {
      if (contains(part.outline, p)) return part.roof;
      const double away = distance_to_boundary(part.outline, p);
      if (nearest != nullptr && !(away < least)) continue;
      nearest = &part;
      least = away;
    }
    return nearest->roof;
  }

  Return bridge(Point2 p, SeededRandom& random) const {
    for (const SyntheticBridge& bridge : scene_.bridges)
      if (std::abs(p.x - bridge.at.x) <= bridge.half_width &&
          std::abs(p.y - bridge.at.y) <= bridge.half_length)
        return {scene_.terrain.base + 0.4 + 0.02 * random.bell(), kUnclassified};
    return {0, kNothing};
  }

  /// The highest crown over p, which most pulses do not penetrate.
  Return tree(Point2 p, double ground, SeededRandom& random) const {
    double top = 0;
    for (const std::size_t t : trees_.at(p)) {
      const SyntheticTree& tree = scene_.trees[t];
      const double dx = p.x - tree.at.x;
      const double dy = p.y - tree.at.y;
      const double share = (dx * dx + dy * dy) / (tree.radius * tree.radius);
      // A paraboloid that ends at 45 % of the height.
      if (share < 1) top = std::max(top, tree.height * (1 - 0.55 * share));
    }
    if (top == 0 || random.chance(0.25)) return {0, kNothing};
    const double height = top * random.uniform(0.85, 1.0);
    const std::uint8_t code = height < 0.5   ? kLowVegetation
                              : height < 2.0 ? kMediumVegetation
                                             : kHighVegetation;
    return {ground + height, code};
  }

  Return car(Point2 p, double ground, SeededRandom& random) const {
    for (const std::size_t c : cars_.at(p)) {
      const SyntheticCar& car = scene_.cars[c];
      const double dx = p.x - car.at.x;
      const double dy = p.y - car.at.y;
      const double along = std::abs(dx * car.along.x + dy * car.along.y);
      const double across = std::abs(dx * car.along.y - dy * car.along.x);
      if (along < 2.2 && across < 0.9)
        return {ground + (along < 1.2 ? 1.45 : 0.9) + 0.02 * random.bell(), kUnclassified};
    }
    return {0, kNothing};
  }

  const SyntheticScene& scene_;
  std::uint64_t seed_;
  FootprintIndex footprints_;
  DiscIndex trees_;
  DiscIndex cars_;
};

void add_point(PointCloud& cloud, Point2 p, double z, std::uint8_t code) {
  cloud.push_back(p.x, p.y, round_to_mm(z), code);
}

/// Now and then a bird above or a multiple reflection below.
void add_noise(PointCloud& cloud, Point2 p, double z, SeededRandom& random) {
  const double what = random.unit();
  if (what < 1e-4) add_point(cloud, p, z - random.uniform(4, 20), kLowNoise);
  if (what > 1 - 1e-4) add_point(cloud, p, z + random.uniform(80, 200), kHighNoise);
}

PointCloud scan_row(const Scanner& scanner, const SyntheticScene& scene, std::size_t row,
                    std::size_t cells, std::uint64_t seed) {
  SeededRandom random(seed, row);
  const double cell = scene.size / static_cast<double>(cells);
  PointCloud points;
  for (std::size_t i = 0; i < cells; ++i) {
    const double x = (static_cast<double>(i) + random.unit()) * cell;
    const double y = (static_cast<double>(row) + random.unit()) * cell;
    const Point2 p{round_to_mm(x), round_to_mm(y)};
    const Return seen = scanner.look_down(p, random);
    if (seen.code == kNothing) continue;
    add_point(points, p, seen.z, seen.code);
    if (scene.details) add_noise(points, p, seen.z, random);
  }
  return points;
}

void append(PointCloud& cloud, const PointCloud& more) {
  cloud.x.insert(cloud.x.end(), more.x.begin(), more.x.end());
  cloud.y.insert(cloud.y.end(), more.y.begin(), more.y.end());
  cloud.z.insert(cloud.z.end(), more.z.begin(), more.z.end());
  cloud.classification.insert(cloud.classification.end(), more.classification.begin(),
                              more.classification.end());
}

}  // namespace

PointCloud scan_scene(const SyntheticScene& scene, double points_per_m2, std::uint64_t seed,
                      const Progress& progress) {
  PointCloud cloud;
  const auto cells = static_cast<std::size_t>(std::ceil(scene.size * std::sqrt(points_per_m2)));
  const Scanner scanner(scene, seed);
  constexpr std::size_t kBatch = 32 * kRowGrain;
  for (std::size_t start = 0; start < cells; start += kBatch) {
    progress.update(static_cast<double>(start) / static_cast<double>(cells));
    std::vector<PointCloud> rows(std::min(kBatch, cells - start));
    parallel_chunks(rows.size(), kRowGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t r = begin; r < end; ++r)
        rows[r] = scan_row(scanner, scene, start + r, cells, seed);
    });
    for (const PointCloud& row : rows) append(cloud, row);
  }
  progress.update(1);
  return cloud;
}

SyntheticCity city_of_scene(SyntheticScene& scene) {
  SyntheticCity city;
  city.terrain = scene.terrain;
  city.domain = {0, 0, scene.size, scene.size};
  for (const SyntheticBuilding& building : scene.buildings) {
    const Point2 inside = interior_point(building.footprint);
    const double ground = round_to_mm(synthetic_ground(scene.terrain, inside.x, inside.y));
    city.footprints.push_back(building.footprint);
    city.ids.push_back(fmt::format("s{}", city.ids.size() + 1));
    city.ground.push_back(ground);
    city.heights.push_back(building.height);
    scene.roofs.push_back(ground + building.height);
    switch (building.kind) {
      case SyntheticKind::kScattered:
        ++city.counts.scattered;
        break;
      case SyntheticKind::kRowHouse:
        ++city.counts.row_houses;
        break;
      case SyntheticKind::kCourtyard:
        ++city.counts.courtyards;
        break;
      case SyntheticKind::kTower:
        ++city.counts.towers;
        break;
      case SyntheticKind::kHouse:
        ++city.counts.houses;
        break;
      case SyntheticKind::kShed:
        ++city.counts.sheds;
        break;
    }
  }
  city.counts.buildings = static_cast<std::int64_t>(scene.buildings.size());
  city.counts.trees = static_cast<std::int64_t>(scene.trees.size());
  return city;
}

}  // namespace tetropolis
