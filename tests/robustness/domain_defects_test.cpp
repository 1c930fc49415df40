// Domains that cut buildings, hold none or too much, lack points, or lie far from the origin.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tetropolis/geometry/polygon.h"

#include "defect_city.h"
#include "support/test_data.h"

namespace tetropolis::testing {
namespace {

class DomainDefects : public ::testing::Test {
 protected:
  Outcome run() { return run(sound_features(city)); }
  /// `parts`: ids that features get beyond their own.
  Outcome run(const std::vector<Feature>& features, const std::vector<std::string>& parts = {}) {
    write_input(city, features, folder.path());
    Config config = small_config(city, folder.path());
    adjust(config);
    std::vector<std::string> ids = ids_of(features);
    ids.insert(ids.end(), parts.begin(), parts.end());
    return build(config, ids);
  }
  /// Bounds in local coordinates.
  void set_bounds(double xmin, double ymin, double xmax, double ymax) {
    bounds = {xmin + city.origin.x, ymin + city.origin.y, xmax + city.origin.x,
              ymax + city.origin.y};
  }

  TemporaryFolder folder;
  DefectCity city = defect_city();
  std::vector<double> bounds;
  std::function<void(Config&)> settings = [](Config&) {};

 private:
  void adjust(Config& config) {
    if (!bounds.empty()) config.bounds = bounds;
    settings(config);
  }
};

TEST_F(DomainDefects, ABuildingAcrossTheBoundaryIsDroppedOrCut) {
  set_bounds(0, 0, 72, 120);
  Outcome outcome = run();
  ASSERT_EQ(outcome.error, "");
  EXPECT_EQ(outcome.reason_of("patient"), "crosses the domain boundary");
  EXPECT_EQ(outcome.reason_of("tower"), "outside the domain");
  EXPECT_EQ(outcome.reason_of("east"), "outside the domain");
  EXPECT_EQ(outcome.city.buildings.size(), 3U);
  settings = [](Config& config) { config.boundary_buildings = BoundaryBuildings::kClip; };
  outcome = run();
  ASSERT_EQ(outcome.error, "");
  const Building* patient = outcome.building_of("patient");
  ASSERT_NE(patient, nullptr);
  EXPECT_NE(patient->flags & kClipped, 0U);
  EXPECT_NEAR(area(patient->footprint), 11 * 16, 0.1);  // 12 m less the clearance
}

TEST_F(DomainDefects, ABuildingCutIntoPartsKeepsAllOfThem) {
  // Two wings and the house between them, which lies beyond the boundary.
  set_bounds(0, 0, 76, 120);
  settings = [](Config& config) { config.boundary_buildings = BoundaryBuildings::kClip; };
  const Outcome outcome =
      run(with_patient(city, "POLYGON((60 50,84 50,84 66,60 66,60 62,77 62,77 54,60 54,60 50))"),
          {"patient#2"});
  ASSERT_EQ(outcome.error, "");
  for (const char* id : {"patient", "patient#2"}) {
    const Building* wing = outcome.building_of(id);
    ASSERT_NE(wing, nullptr) << id;
    EXPECT_NEAR(area(wing->footprint), 15 * 4, 0.1);
    EXPECT_NE(wing->flags & kClipped, 0U);
  }
  EXPECT_FALSE(outcome.has_warning("parts_lost"));
}

/// What is no part of the building does not count: doubled back, so that it encloses nothing.
TEST_F(DomainDefects, ASpikeAcrossTheBoundary) {
  set_bounds(0, 0, 90, 120);
  const Outcome sound = run();
  ASSERT_EQ(sound.error, "");
  ASSERT_NE(sound.building_of("patient"), nullptr);
  std::vector<Feature> features = sound_features(city);
  for (Feature& feature : features)
    if (feature.id == "patient")
      feature.wkt = "POLYGON((60 50,84 50,84 60,140 60,84 60,84 66,60 66,60 50))";
  const Outcome outcome = run(features);
  ASSERT_EQ(outcome.error, "");
  ASSERT_NE(outcome.building_of("patient"), nullptr) << outcome.reason_of("patient");
  EXPECT_NEAR(area(outcome.building_of("patient")->footprint),
              area(sound.building_of("patient")->footprint), 1e-6);
}

TEST_F(DomainDefects, ABuildingInTheCorner) {
  set_bounds(0, 0, 72, 58);
  Outcome outcome = run();
  ASSERT_EQ(outcome.error, "");
  EXPECT_EQ(outcome.reason_of("patient"), "crosses the domain boundary");
  settings = [](Config& config) { config.boundary_buildings = BoundaryBuildings::kClip; };
  outcome = run();
  ASSERT_EQ(outcome.error, "");
  ASSERT_NE(outcome.building_of("patient"), nullptr);
  EXPECT_NEAR(area(outcome.building_of("patient")->footprint), 11 * 7, 0.1);
}

/// Its box crosses the boundary, and it does not.
TEST_F(DomainDefects, ABuildingAroundTheCornerIsOutside) {
  std::vector<Feature> features = sound_features(city);
  features.push_back(
      {"around", "POLYGON((163 100,163 123,130 123,130 128,168 128,168 100,163 100))"});
  set_bounds(0, 0, 160, 120);
  for (const BoundaryBuildings what : {BoundaryBuildings::kDrop, BoundaryBuildings::kClip}) {
    settings = [what](Config& config) { config.boundary_buildings = what; };
    const Outcome outcome = run(features);
    ASSERT_EQ(outcome.error, "");
    EXPECT_EQ(outcome.reason_of("around"), "outside the domain");
  }
}

TEST_F(DomainDefects, AWallOnTheBoundaryIsCutBack) {
  // The patient's eastern wall and northern wall lie exactly on the boundary.
  set_bounds(0, 0, 84, 66);
  const Outcome outcome = run();
  ASSERT_EQ(outcome.error, "");
  const Building* patient = outcome.building_of("patient");
  ASSERT_NE(patient, nullptr) << outcome.reason_of("patient");
  EXPECT_NEAR(area(patient->footprint), 23 * 15, 0.1);
  EXPECT_NE(patient->flags & kClipped, 0U);
}

TEST_F(DomainDefects, AMillimetreInsideAndOutsideOfTheBoundary) {
  set_bounds(0, 0, 84.001, 120);
  Outcome outcome = run();
  ASSERT_EQ(outcome.error, "");
  ASSERT_NE(outcome.building_of("patient"), nullptr);
  EXPECT_NEAR(area(outcome.building_of("patient")->footprint), 23 * 16, 0.1);
  set_bounds(0, 0, 83.999, 120);
  outcome = run();
  ASSERT_EQ(outcome.error, "");
  EXPECT_EQ(outcome.reason_of("patient"), "crosses the domain boundary");
}

TEST_F(DomainDefects, ABuildingAroundTheDomain) {
  set_bounds(62, 52, 82, 64);  // inside of the patient
  Outcome outcome = run();
  EXPECT_EQ(outcome.exit_code, 3);
  // No ground point anywhere: the terrain cannot be known.
  EXPECT_NE(outcome.error.find("no ground among the points"), std::string::npos) << outcome.error;
  settings = [](Config& config) { config.boundary_buildings = BoundaryBuildings::kClip; };
  outcome = run();
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.error.find("no ground among the points"), std::string::npos) << outcome.error;
}

TEST_F(DomainDefects, TerrainOnly) {
  settings = [](Config& config) { config.terrain_only = true; };
  set_bounds(85, 90, 105, 118);  // between the buildings
  Outcome outcome = run();
  ASSERT_EQ(outcome.error, "");
  EXPECT_TRUE(outcome.city.buildings.empty());
  EXPECT_EQ(outcome.city.dropped.size(), 6U);
  EXPECT_NEAR(outcome.report.volume_mesh->volume,
              outcome.report.volume_mesh->top * 20 * 28 - (20 + 0.02 * 95 + 0.01 * 104) * 20 * 28,
              5);
  settings = [](Config& config) {
    config.terrain_only = true;
    config.footprints.clear();
  };
  outcome = run({});
  ASSERT_EQ(outcome.error, "");
  EXPECT_TRUE(outcome.city.dropped.empty());
  settings = [](Config& config) {
    config.terrain_only = true;
    config.footprints.clear();
    config.bounds.clear();  // all of the points
  };
  outcome = run({});
  ASSERT_EQ(outcome.error, "");
  EXPECT_NEAR(outcome.city.domain.bounds().width(), 159, 1e-9);
}

TEST_F(DomainDefects, NoBuildingWithoutSayingSoIsAnError) {
  set_bounds(85, 90, 105, 118);
  const Outcome outcome = run();
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.error.find("terrain_only"), std::string::npos) << outcome.error;
}

TEST_F(DomainDefects, HalfOfTheDomainWithoutGround) {
  city.ground_class = [](double x, double) { return x > 80 ? 0 : 2; };
  const Outcome outcome = run();
  ASSERT_EQ(outcome.error, "");
  EXPECT_EQ(outcome.city.buildings.size(), 6U);
  EXPECT_EQ(outcome.building_of("tower")->flags, kGroundFromDtm);
  EXPECT_EQ(outcome.building_of("east")->flags, kGroundFromDtm);
  EXPECT_EQ(outcome.building_of("west")->flags, 0U);
  // Filled from the rim at x = 80.
  EXPECT_NEAR(outcome.building_of("tower")->h_ground, 20 + 1.6 + 0.8, 0.5);
  EXPECT_NEAR(outcome.building_of("tower")->h_roof, 20 + 2.2 + 0.75 + 40, 0.001);
}

TEST_F(DomainDefects, DomainThatReachesFarBeyondThePoints) {
  set_bounds(-300, -300, 400, 400);
  const Outcome outcome = run();
  ASSERT_EQ(outcome.error, "");
  EXPECT_EQ(outcome.city.buildings.size(), 6U);
  EXPECT_TRUE(outcome.has_warning("terrain_mostly_filled"));
}

TEST_F(DomainDefects, DomainThinnerThanTheClearance) {
  set_bounds(0, 0, 160, 1.5);
  const Outcome outcome = run();
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.error.find("too small"), std::string::npos) << outcome.error;
}

TEST_F(DomainDefects, ATowerOf300MetresAmongSheds) {
  city.houses[3].height = 300;
  city.houses.push_back({"hut", rectangle(100, 78, 106, 83), 2.6});
  city.houses.push_back({"hut2", rectangle(128, 78, 134, 83), 2.6});
  const Outcome outcome = run();
  ASSERT_EQ(outcome.error, "");
  EXPECT_EQ(outcome.city.buildings.size(), 8U);
  EXPECT_TRUE(outcome.has_warning("domain_raised"));
  EXPECT_GT(outcome.report.volume_mesh->top, outcome.building_of("tower")->h_roof);
  EXPECT_NEAR(outcome.building_of("tower")->h_roof, 20 + 2.2 + 0.75 + 300, 0.001);
  EXPECT_NEAR(outcome.building_of("hut")->h_roof, 20 + 2 + 0.78 + 2.6, 0.1);
}

/// Where footprints of a whole country go with the cloud, only points tell where the domain is.
TEST_F(DomainDefects, StrayPointsDoNotStretchTheDomain) {
  settings = [](Config& config) {
    config.bounds.clear();
    config.domain_margin = 10;
  };
  std::vector<Feature> features = sound_features(city);
  features.push_back({"far", "POLYGON((60000 50000,60010 50000,60010 50010,60000 50000))"});
  Outcome outcome = run(features);
  ASSERT_EQ(outcome.error, "");
  const CityModel usual = outcome.city;
  EXPECT_FALSE(outcome.has_warning("stray_points"));
  ASSERT_TRUE(std::filesystem::remove(folder / "points.las"));  // to be scanned anew
  city.strays = {{50000, 40000, 20}, {400, 50, 20}};  // the second is seen when the first is gone
  for (int i = 0; i < 8; ++i) city.strays.push_back({20.0 + i, 5000, 20});
  outcome = run(features);
  ASSERT_EQ(outcome.error, "");
  EXPECT_TRUE(outcome.has_warning("stray_points"));
  EXPECT_EQ(outcome.city.domain, usual.domain);
  EXPECT_EQ(outcome.city.origin, usual.origin);
  ASSERT_EQ(outcome.city.buildings.size(), usual.buildings.size());
  for (std::size_t b = 0; b < usual.buildings.size(); ++b)
    EXPECT_EQ(outcome.city.buildings[b].h_ground, usual.buildings[b].h_ground);
  // Where a building is, points are none.
  ASSERT_TRUE(std::filesystem::remove(folder / "points.las"));
  city.strays = {{1000, 50, 20}, {1005, 55, 20}};
  features.push_back({"lonely", "POLYGON((990 40,1010 40,1010 60,990 60,990 40))"});
  outcome = run(features);
  ASSERT_EQ(outcome.error, "");
  EXPECT_FALSE(outcome.has_warning("stray_points"));
  EXPECT_GT(outcome.city.domain.bounds().width(), 900);
}

TEST_F(DomainDefects, StrayFootprintsFarAwayDoNotStretchTheDomain) {
  settings = [](Config& config) {
    config.bounds.clear();
    config.domain_margin = 10;
  };
  Outcome outcome = run();
  ASSERT_EQ(outcome.error, "");
  const Bounds2 usual = outcome.city.domain.bounds();
  std::vector<Feature> features = sound_features(city);
  features.push_back({"null_island",
                      "POLYGON((-319000 -6398000,-318990 -6398000,-318990 -6397990,"
                      "-319000 -6398000))"});
  features.push_back({"overflow", "POLYGON((60 50,84 50,1e300 66,60 66,60 50))"});
  outcome = run(features);
  ASSERT_EQ(outcome.error, "");
  EXPECT_EQ(outcome.reason_of("null_island"), "outside the domain");
  EXPECT_NE(outcome.reason_of("overflow"), "");
  EXPECT_EQ(outcome.city.buildings.size(), 6U);
  // As far as there are points, at most.
  EXPECT_GE(outcome.city.domain.bounds().width(), usual.width());
  EXPECT_LE(outcome.city.domain.bounds().width(), 160);
}

TEST_F(DomainDefects, ShiftsOfCentimetresShiftTheResult) {
  const Outcome here = run();
  ASSERT_EQ(here.error, "");
  for (const Point2 by : {Point2{0.03, 0.07}, Point2{-0.01, 0.5}, Point2{0.37, -0.02}}) {
    const TemporaryFolder other;
    DefectCity moved = city;
    moved.origin = {city.origin.x + by.x, city.origin.y + by.y};
    write_input(moved, sound_features(moved), other.path());
    const Outcome there = build(small_config(moved, other.path()), ids_of(sound_features(moved)));
    ASSERT_EQ(there.error, "");
    ASSERT_EQ(there.city.buildings.size(), here.city.buildings.size());
    const Point2 d{there.city.origin.x - here.city.origin.x - by.x,
                   there.city.origin.y - here.city.origin.y - by.y};
    for (const House& house : city.houses) {
      const Building* a = here.building_of(house.id);
      Building b = *there.building_of(house.id);
      for (Point2& p : b.footprint.outer) p = {p.x + d.x, p.y + d.y};
      for (Ring& hole : b.footprint.holes)
        for (Point2& p : hole) p = {p.x + d.x, p.y + d.y};
      EXPECT_LE(outline_distance(a->footprint, b.footprint), kCoordinateStep);
      EXPECT_NEAR(a->h_roof, b.h_roof, 0.001);
      EXPECT_NEAR(a->h_ground, b.h_ground, 0.05);
    }
  }
}

TEST_F(DomainDefects, CoordinatesOfEverySize) {
  // Near zero, negative, Dutch, Swedish (northings of 6.4 and 7.6 million), and web Mercator.
  for (const Point2 origin :
       {Point2{500, 500}, Point2{-200000, -5000000}, Point2{85000, 446000},
        Point2{319000.37, 6398000.61}, Point2{720000, 7590000}, Point2{-20037000, 19900000}}) {
    SCOPED_TRACE(origin.x);
    const TemporaryFolder other;
    city.origin = origin;
    write_input(city, sound_features(city), other.path());
    const Outcome outcome = build(small_config(city, other.path()), ids_of(sound_features(city)));
    ASSERT_EQ(outcome.error, "");
    EXPECT_EQ(outcome.city.buildings.size(), 6U);
    EXPECT_NEAR(area(outcome.building_of("patient")->footprint), 384, 0.01);
    EXPECT_NEAR(outcome.building_of("patient")->h_roof, 20 + 1.2 + 0.5 + 12, 0.001);
  }
}

}  // namespace
}  // namespace tetropolis::testing
