// build_city of polygons that a program has made, without files.
#include "tetropolis/pipeline/build_city.h"

#include <cmath>
#include <string>
#include <utility>

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

std::string refusal_of(CitySources sources) {
  return testing::error_of([&] { build_city(std::move(sources)); }, ErrorKind::kInput);
}

TEST(BuildCity, ASurfaceWithoutGroundIsNoCloudToClassify) {
  CitySources sources = houses();
  sources.terrain.reset();
  sources.has_surface = true;
  sources.points.source = "dsm.tif";
  for (int x = 0; x < 140; ++x)
    for (int y = 0; y < 80; ++y) sources.points.points.push_back(x, y, 3, kUnclassified);
  sources.points.extent = {0, 0, 139, 79};
  sources.points.points_by_class[kUnclassified] = 140 * 80;
  EXPECT_NO_THROW(build_city(sources));
  const auto build = [&] { build_city(sources, {.ground_filter = GroundFilter::kNever}); };
  EXPECT_EQ(testing::error_of(build, ErrorKind::kInput),
            "dsm.tif: nothing in this surface is known as ground; give the terrain, too, as `dtm`, "
            "or find the ground with ground_filter = auto");
}

TEST(BuildCity, RefusesIdsThatDoNotTellFeaturesApart) {
  CitySources sources = houses();
  sources.footprints.features[1].source_id = "40";
  EXPECT_EQ(refusal_of(std::move(sources)),
            "footprints: a second footprint has the source_id '40'; give each one of its own");
  sources = houses();
  sources.footprints.features[1].source_id = "";
  EXPECT_EQ(refusal_of(std::move(sources)),
            "footprints: a footprint has the source_id ''; give each one of its own");
}

TEST(BuildCity, RefusesNeitherPointsNorTerrain) {
  CitySources sources = houses();
  sources.terrain.reset();
  EXPECT_EQ(refusal_of(std::move(sources)), "no points and no terrain; give one");
}

}  // namespace
}  // namespace tetropolis
