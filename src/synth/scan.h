// What a laser would see of a synthetic city.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/synth/synthetic_city.h"

namespace tetropolis {

enum class SyntheticKind { kScattered, kRowHouse, kCourtyard, kTower, kHouse, kShed };

/// One footprint with its roof: level, unless the scene has parts for it.
struct SyntheticBuilding {
  Polygon footprint;
  double height = 0;  ///< Above the ground at the interior point, metres.
  SyntheticKind kind = SyntheticKind::kScattered;
};

struct SyntheticTree {
  Point2 at;
  double radius = 0;  ///< Of the crown, metres.
  double height = 0;  ///< Metres; below 2 m it is a bush.
};

struct SyntheticCar {
  Point2 at;
  Point2 along;  ///< Unit vector.
};

/// The rectangle |x - at.x| <= half_width, |y - at.y| <= half_length, level.
struct SyntheticBridge {
  Point2 at;
  double half_width = 0;
  double half_length = 0;
};

struct SyntheticScene {
  double size = 0;  ///< The domain is [0, size]^2.
  SyntheticTerrain terrain;
  std::vector<SyntheticBuilding> buildings;
  std::vector<double> roofs;  ///< Elevation per building, of level roofs.
  /// Per building its parts; none of those with level roofs. Empty: all are level.
  std::vector<std::vector<RoofPart>> parts;
  std::vector<SyntheticTree> trees;
  std::vector<SyntheticCar> cars;
  std::vector<SyntheticBridge> bridges;
  bool details = false;  ///< Chimneys, parapets, facades, noise.
};

/// Points at the centres of a grid with the given density, each moved within its cell; rows from
/// south to north. Rows are independent random streams of `seed`: the same for any thread count.
PointCloud scan_scene(const SyntheticScene& scene, double points_per_m2, std::uint64_t seed,
                      const Progress& progress);

/// Footprints, ids, heights and ground elevations of the scene's buildings, without points.
/// Sets scene.roofs.
SyntheticCity city_of_scene(SyntheticScene& scene);

}  // namespace tetropolis
