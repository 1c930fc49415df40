// Small synthetic cities with every defect that has been seen in real data.
//
// Deterministic like the other synthetic cities (synthetic_city.h); only damaged vertices are not
// whole millimetres.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/synth/synthetic_city.h"

#include "raw_feature.h"

namespace tetropolis {

/// Every defect there is, in the order in which they are applied.
struct DefectKind {
  const char* name;   ///< "bow_tie"
  const char* group;  ///< "building", "outline", "cloud", "terrain", "domain" or "scale".
  const char* what;   ///< One line for the reader.
  bool refusable;     ///< Whether a clear error is as good an answer to it as a mesh.
};
std::span<const DefectKind> defect_kinds();

/// A defect that a city has, and in how many places (buildings, outlines, points).
struct Defect {
  std::string name;
  std::int64_t count = 0;
};

/// Points of one file.
struct PointTile {
  PointCloud points;
  std::vector<std::uint8_t> flags;  ///< Per point, of PointFlag (point_cloud.h); empty: none set.
};

struct AdversarialCity {
  std::vector<RawFeature> features;  ///< Local frame; undamaged rings turn as the format wants it.
  bool with_z = false;               ///< Whether the vertices' z counts.
  bool as_geojson = false;           ///< Which of the formats to write: GeoJSON, else a shapefile.
  std::vector<PointTile> tiles;      ///< Local frame; at least one.
  Bounds2 domain;                    ///< {0, 0, size, size}, what the points cover.
  bool needs_bounds = false;  ///< Whether the domain has to be given for the defects to show.
  Point2 origin;
  std::string crs = "EPSG:3006";
  SyntheticTerrain terrain;
  std::vector<Defect> defects;
  bool refusable = false;  ///< Whether one of the defects is.
};

struct AdversarialCityOptions {
  double size = 200;  ///< Side of the square domain, metres, in [100, 1000].
  std::uint64_t seed = 1;
  double points_per_m2 = 1;            ///< > 0.
  double relief = 6;                   ///< Of the hills, metres, >= 0.
  std::vector<std::string> defects{};  ///< Exactly these; empty: a mix drawn from the seed.
};

/// A few dozen houses, row houses, courtyards, towers and sheds with trees and cars on hills, and a
/// mix of defects. Throws Error(kUsage) if an option is out of range or a defect unknown.
AdversarialCity synthetic_adversarial_city(const AdversarialCityOptions& options,
                                           const Progress& progress = {});

}  // namespace tetropolis
