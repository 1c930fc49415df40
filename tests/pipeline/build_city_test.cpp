// build_city of polygons that a program has made, without files.
#include "tetropolis/pipeline/build_city.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "support/errors.h"

namespace tetropolis {
namespace {

/// Two houses on level ground at 3 m, of which nothing else is filled in.
CitySources houses() {
  CitySources sources;
  for (const double x : {40.0, 80.0}) {
    Footprint house;
    house.source_id = std::to_string(static_cast<int>(x));
    house.polygon = rectangle({x, 30, x + 20, 50});
    house.height = 12;
    sources.footprints.features.push_back(house);
  }
  sources.terrain = TerrainInput{.raster = {1, 1, 0, 0, 1, {3}}, .origin = {}, .crs = {}};
  for (const Footprint& house : sources.footprints.features)
    sources.footprints.bounds.extend(bounds(house.polygon));
  return sources;
}

TEST(BuildCity, NeedsIdsPolygonsAndHeightsAlone) {
  const BuiltCity built = build_city(houses(), {.domain_margin = 50});
  ASSERT_EQ(built.city.buildings.size(), 2U);
  for (const Building& building : built.city.buildings)
    EXPECT_EQ(building.h_roof - building.h_ground, 12) << building.id;
  const Bounds2 domain = built.city.domain.bounds().moved(built.city.origin);
  EXPECT_TRUE((domain == Bounds2{-10, -20, 150, 100}));
}

TEST(BuildCity, ARingWithoutVerticesIsDropped) {
  CitySources sources = houses();
  sources.footprints.features[0].polygon.outer.clear();
  sources.footprints.features[0].base = 3;
  const BuiltCity built = build_city(std::move(sources));
  EXPECT_EQ(built.city.buildings.size(), 1U);
  ASSERT_EQ(built.city.dropped.size(), 1U);
  EXPECT_EQ(built.city.dropped[0].source_id, "40");
  EXPECT_EQ(built.city.dropped[0].cause, DropCause::kUnusable);
}

}  // namespace
}  // namespace tetropolis
