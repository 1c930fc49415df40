#include "tetropolis/city/heights.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tetropolis/core/threads.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/terrain/dtm.h"

#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::test_seed;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double percentile_of(std::vector<double> values, double p) { return percentile(values, p); }

/// One building at the origin with the given heights of roof and ground points, on a DTM of 7 m.
struct Case {
  std::vector<Building> buildings = std::vector<Building>(1);
  PointCloud cloud;
  BuildingPoints points;
  Raster dtm{2, 2, 0, 0, 10, {7, 7, 7, 7}};

  Case(const std::vector<double>& roof, const std::vector<double>& ground) {
    buildings[0].footprint = {{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, {}};
    fill(points.roof, roof);
    fill(points.ground, ground);
    points.by_exclusion = {0};
  }

  void fill(PointLists& lists, const std::vector<double>& heights) {
    for (const double z : heights) {
      lists.values.push_back(static_cast<PointIndex>(cloud.z.size()));
      cloud.z.push_back(z);
    }
    cloud.x.resize(cloud.z.size());
    cloud.y.resize(cloud.z.size());
    cloud.classification.resize(cloud.z.size());
    lists.offsets.push_back(static_cast<std::int64_t>(lists.values.size()));
  }

  Building compute(const HeightOptions& options = {}) {
    compute_heights(buildings, points, cloud, dtm, options);
    return buildings[0];
  }
};

TEST(Percentile, NumPyResults) {
  EXPECT_EQ(percentile_of({5}, 0), 5);
  EXPECT_EQ(percentile_of({5}, 100), 5);
  EXPECT_EQ(percentile_of({3, 1, 2}, 50), 2);
  EXPECT_EQ(percentile_of({4, 1, 3, 2}, 50), 2.5);
  // Printed by numpy.percentile, all digits.
  EXPECT_EQ(percentile_of({7, 15, 36, 39, 40, 41}, 10), 11.0);
  EXPECT_EQ(percentile_of({7, 15, 36, 39, 40, 41}, 25), 20.25);
  EXPECT_EQ(percentile_of({7, 15, 36, 39, 40, 41}, 75), 39.75);
  EXPECT_EQ(percentile_of({7, 15, 36, 39, 40, 41}, 90), 40.5);
  EXPECT_EQ(percentile_of({0.5, -3.25, 8, 2.75, 1e3, 2.75, 4}, 90), 404.80000000000035);
  EXPECT_EQ(percentile_of({0.5, -3.25, 8, 2.75, 1e3, 2.75, 4}, 10), -0.9999999999999996);
  EXPECT_EQ(percentile_of({0.5, -3.25, 8, 2.75, 1e3, 2.75, 4}, 33.3), 2.7454999999999994);
}

TEST(Percentile, AgreesWithTheSortedDefinition) {
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> value(-50, 50);
  for (int n = 1; n < 120; ++n) {
    std::vector<double> values;
    for (int k = 0; k < n; ++k)
      values.push_back(n % 3 == 0 ? std::round(value(random)) : value(random));
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (const double p : {0.0, 1.0, 10.0, 37.5, 50.0, 90.0, 99.0, 100.0}) {
      // The piecewise linear function through (100 k / (n - 1), sorted[k]).
      double expected = sorted[0];
      for (int k = 0; k + 1 < n; ++k) {
        const double from = 100.0 * k / (n - 1);
        const double to = 100.0 * (k + 1) / (n - 1);
        if (p >= from)
          expected =
              sorted[k] + (sorted[k + 1] - sorted[k]) * std::min(1.0, (p - from) / (to - from));
      }
      std::vector<double> copy = values;
      const double result = percentile(copy, p);
      EXPECT_NEAR(result, expected, 1e-10) << "n " << n << " p " << p << " seed " << test_seed();
      EXPECT_GE(result, sorted.front());
      EXPECT_LE(result, sorted.back());
      std::sort(copy.begin(), copy.end());
      EXPECT_EQ(copy, sorted) << "only the order may change";
    }
  }
}

TEST(Heights, ArePercentilesOfThePoints) {
  const Building building = Case({20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30}, {1, 2, 3}).compute();
  EXPECT_DOUBLE_EQ(building.h_ground, 1.2);
  EXPECT_DOUBLE_EQ(building.h_roof, 27);
  EXPECT_EQ(building.n_roof_points, 11);
  EXPECT_EQ(building.n_ground_points, 3);
  EXPECT_EQ(building.flags, 0U);
  const Building other = Case({20, 30}, {1, 3}).compute({50, 0, 2.5});
  EXPECT_DOUBLE_EQ(other.h_ground, 2);
  EXPECT_DOUBLE_EQ(other.h_roof, 20);
}

TEST(Heights, WithoutGroundPointsComeFromTheDtmInsideTheFootprint) {
  Case scene({20}, {});
  // A DTM that rises to the north-east, and a U whose box has its centre outside.
  scene.dtm = {2, 2, 0, 0, 10, {0, 10, 20, 30}};
  scene.buildings[0].footprint = {{{0, 0}, {9, 0}, {9, 8}, {7, 8}, {7, 1}, {1, 1}, {1, 8}, {0, 8}},
                                  {}};
  const Building building = scene.compute();
  EXPECT_DOUBLE_EQ(building.h_ground, 8 + 2 * 4.5);
  EXPECT_EQ(building.flags, static_cast<std::uint32_t>(kGroundFromDtm));
  EXPECT_EQ(building.n_ground_points, 0);
}

TEST(Heights, WithoutRoofPointsComeFromTheAttributeOrTheMinimum) {
  Case scene({}, {4});
  scene.buildings[0].attribute_height = 6.5;
  EXPECT_DOUBLE_EQ(scene.compute().h_roof, 10.5);
  EXPECT_EQ(scene.buildings[0].flags, static_cast<std::uint32_t>(kRoofFromAttribute));
  scene.buildings[0].attribute_height = 1;
  EXPECT_DOUBLE_EQ(scene.compute().h_roof, 6.5);
  EXPECT_EQ(scene.buildings[0].flags, kRoofFromAttribute | kMinimumHeight);
  for (const double none : {0.0, -3.0, kNan, std::numeric_limits<double>::infinity()}) {
    scene.buildings[0].attribute_height = none;
    EXPECT_DOUBLE_EQ(scene.compute().h_roof, 6.5);
    EXPECT_EQ(scene.buildings[0].flags, static_cast<std::uint32_t>(kNoRoofPoints));
  }
  EXPECT_EQ(scene.buildings[0].n_roof_points, 0);
}

TEST(Heights, AnElevationThatIsStatedDoesNotMoveWithTheGround) {
  for (const double ground : {4.0, -30.0}) {
    Case scene({}, {ground});
    scene.buildings[0].attribute_height = 6.5;  // above another ground
    scene.buildings[0].attribute_roof = 11;
    EXPECT_DOUBLE_EQ(scene.compute().h_roof, 11);
    EXPECT_DOUBLE_EQ(scene.buildings[0].attribute_height, 11 - ground);
    EXPECT_EQ(scene.buildings[0].flags, static_cast<std::uint32_t>(kRoofFromAttribute));
  }
  Case buried({}, {12});
  buried.buildings[0].attribute_roof = 11;
  EXPECT_DOUBLE_EQ(buried.compute().h_roof, 14.5);
  EXPECT_EQ(buried.buildings[0].flags, kRoofFromAttribute | kMinimumHeight);
}

TEST(Heights, PointsWinOverTheAttribute) {
  Case scene({20}, {4});
  scene.buildings[0].attribute_height = 6.5;
  EXPECT_EQ(scene.compute().h_roof, 20);
}

TEST(Heights, AreAtLeastTheMinimum) {
  const Building low = Case({5}, {4}).compute();
  EXPECT_DOUBLE_EQ(low.h_roof, 6.5);
  EXPECT_EQ(low.flags, static_cast<std::uint32_t>(kMinimumHeight));
  const Building below = Case({-5}, {4}).compute({10, 90, 3});
  EXPECT_DOUBLE_EQ(below.h_roof, 7);
  EXPECT_EQ(Case({6.5}, {4}).compute().flags, 0U) << "exactly the minimum is not raised";
}

TEST(Heights, FlagRoofsByExclusionAndKeepOtherFlags) {
  Case scene({20}, {4});
  scene.points.by_exclusion = {1};
  scene.buildings[0].flags = kMerged | kNoRoofPoints | kGroundFromDtm;
  EXPECT_EQ(scene.compute().flags, kMerged | kRoofFromUnclassified);
  Case bare({}, {4});
  bare.points.by_exclusion = {1};
  EXPECT_EQ(bare.compute().flags, static_cast<std::uint32_t>(kNoRoofPoints));
}

TEST(Heights, SameForAnyNumberOfThreads) {
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> height(0, 30);
  Case scene({}, {});
  scene.buildings.assign(1000, scene.buildings[0]);
  scene.points = {{}, {}, std::vector<std::uint8_t>(1000)};
  for (int b = 0; b < 1000; ++b) {
    std::vector<double> heights;
    for (int k = 0; k < b % 41; ++k) heights.push_back(height(random));
    scene.fill(scene.points.roof, heights);
    scene.fill(scene.points.ground, heights);
  }
  std::vector<Building> one = scene.buildings;
  std::vector<Building> four = scene.buildings;
  {
    const ThreadLimit limit(1);
    compute_heights(one, scene.points, scene.cloud, scene.dtm);
  }
  const ThreadLimit limit(4);
  compute_heights(four, scene.points, scene.cloud, scene.dtm);
  for (std::size_t b = 0; b < one.size(); ++b) {
    EXPECT_EQ(one[b].h_ground, four[b].h_ground);
    EXPECT_EQ(one[b].h_roof, four[b].h_roof);
    EXPECT_EQ(one[b].flags, four[b].flags);
  }
}

// Real data ---------------------------------------------------------------------------------------

/// A real place: footprints and points in a local frame, without any cleaning.
struct Place {
  std::vector<Building> buildings;
  PointCloud cloud;
  Raster dtm;
};

Place read_place(const std::filesystem::path& footprints, const std::string& id_attribute,
                 const std::vector<std::string>& points, Point2 origin) {
  Place place;
  const FootprintsInput input =
      read_footprints(footprints, {.id_attribute = id_attribute, .source_crs = "EPSG:28992"});
  for (const Footprint& feature : input.features) {
    Building building;
    building.source_ids = {feature.source_id};
    building.footprint = feature.polygon;
    for_each_vertex(building.footprint, [&](Point2& p) { p = {p.x - origin.x, p.y - origin.y}; });
    place.buildings.push_back(building);
  }
  ReadPointsOptions options;
  options.origin = origin;
  const PointsInput read = read_points(expand_point_paths(points), options);
  place.cloud = read.points;
  place.dtm = build_dtm(place.cloud, read.extent);
  compute_heights(
      place.buildings,
      extract_building_points(std::span<const Building>(place.buildings), {}, place.cloud),
      place.cloud, place.dtm);
  return place;
}

/// Steps 1.5 and 1.6 once more, with the angle sum for "inside", another variance formula and a
/// full sort.
class ByHand {
 public:
  ByHand(const Place& place, const Polygon& footprint) {
    const Bounds2 box = bounds(footprint).grown(1);
    for (std::size_t p = 0; p < place.cloud.size(); ++p) {
      const Point2 at{place.cloud.x[p], place.cloud.y[p]};
      if (!box.contains(at)) continue;
      const int code = place.cloud.classification[p];
      const bool inside = turns_around(footprint, at) > 0.5;
      if (inside && code == 6) roof.push_back(place.cloud.z[p]);
      if (!inside && (code == 2 || code == 9) && distance_to_boundary(footprint, at) <= 1)
        ground.push_back(place.cloud.z[p]);
    }
    drop(roof);
    drop(ground);
  }

  static double quantile(const std::vector<double>& sorted, double share) {
    const double at = share * static_cast<double>(sorted.size() - 1);
    const auto low = static_cast<std::size_t>(std::floor(at));
    const auto high = static_cast<std::size_t>(std::ceil(at));
    return sorted[low] * (1 - (at - std::floor(at))) + sorted[high] * (at - std::floor(at));
  }

  std::vector<double> roof;
  std::vector<double> ground;

 private:
  static double turns_around(const Polygon& footprint, Point2 p) {
    double angle = 0;
    const auto add = [&](const Ring& ring, double sign) {
      double sum = 0;
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Point2 a = ring[i];
        const Point2 b = ring[(i + 1) % ring.size()];
        sum += std::atan2((a.x - p.x) * (b.y - p.y) - (b.x - p.x) * (a.y - p.y),
                          (a.x - p.x) * (b.x - p.x) + (a.y - p.y) * (b.y - p.y));
      }
      angle += sign * std::abs(sum);
    };
    add(footprint.outer, 1);
    for (const Ring& hole : footprint.holes) add(hole, -1);
    return angle / (2 * M_PI);
  }

  static void drop(std::vector<double>& heights) {
    std::sort(heights.begin(), heights.end());
    long double sum = 0;
    long double squares = 0;
    for (const double z : heights) {
      sum += static_cast<long double>(z);
      squares += static_cast<long double>(z) * static_cast<long double>(z);
    }
    const auto n = static_cast<long double>(heights.size());
    const long double mean = sum / n;
    const long double limit = 2 * std::sqrt(std::max(squares / n - mean * mean, 0.0L)) + 1e-9L;
    std::erase_if(heights,
                  [&](double z) { return std::abs(static_cast<long double>(z) - mean) > limit; });
  }
};

/// Heights are rounded to whole millimetres.
constexpr double kHalfMillimetre = 0.0005 + 1e-9;

TEST(HeightsOfDelft, AgreeWithWorkByHandAndWith3dfier) {
  TETROPOLIS_REQUIRE_DATA(folder, "delft_3dfier");
  const Place place = read_place(folder / "footprints.gpkg", "lokaalid",
                                 {(folder / "ahn3_cropped_*.laz").string()}, {84800, 447400});
  ASSERT_EQ(place.cloud.size(), 848942U);
  ASSERT_EQ(place.buildings.size(), 160U);
  for (const Building& building : place.buildings) {
    const ByHand expected(place, building.footprint);
    SCOPED_TRACE(building.source_ids[0]);
    ASSERT_EQ(building.n_roof_points, static_cast<std::int64_t>(expected.roof.size()));
    ASSERT_EQ(building.n_ground_points, static_cast<std::int64_t>(expected.ground.size()));
    if (expected.ground.empty()) {
      EXPECT_TRUE((building.flags & kGroundFromDtm) != 0);
    } else {
      EXPECT_NEAR(building.h_ground, ByHand::quantile(expected.ground, 0.1), kHalfMillimetre);
    }
    if (!expected.roof.empty()) {
      const double roof = ByHand::quantile(expected.roof, 0.7);
      EXPECT_NEAR(building.h_roof, std::max(roof, building.h_ground + 2.5), kHalfMillimetre);
    }
  }

  std::ifstream file(folder / "reference/3dfier_output_cityjson.json");
  const nlohmann::json city = nlohmann::json::parse(file);
  std::map<std::string, double> reference;
  for (const auto& object : city["CityObjects"])
    if (object["type"] == "Building")
      reference[object["attributes"]["lokaalid"]] = object["attributes"]["measuredHeight"];
  std::vector<double> differences;
  for (const Building& building : place.buildings)
    differences.push_back(std::abs(building.h_roof - reference.at(building.source_ids[0])));
  EXPECT_LT(percentile(differences, 50), 1.0);
  RecordProperty("median_difference", std::to_string(percentile(differences, 50)));
}

TEST(HeightsOfAmsterdam, WithoutClassSixComeOutSimilar) {
  TETROPOLIS_REQUIRE_DATA(folder, "amsterdam_south");
  const Point2 origin{120600, 485900};
  const auto read = [&](const char* survey) {
    return read_place(folder / "footprints.gpkg", "", {(folder / survey).string()}, origin);
  };
  const Place classified = read("ahn3");
  const Place unclassified = read("ahn2");
  ASSERT_EQ(classified.buildings.size(), unclassified.buildings.size());
  std::vector<double> differences;
  for (std::size_t b = 0; b < classified.buildings.size(); ++b) {
    const Building& building = unclassified.buildings[b];
    EXPECT_EQ((building.flags & kRoofFromUnclassified) != 0, building.n_roof_points > 0);
    EXPECT_TRUE((classified.buildings[b].flags & kRoofFromUnclassified) == 0);
    EXPECT_TRUE(std::isfinite(building.h_ground));
    EXPECT_GE(building.h_roof, building.h_ground + 2.5);
    if (building.n_roof_points > 0 && classified.buildings[b].n_roof_points > 0)
      differences.push_back(std::abs(building.h_roof - classified.buildings[b].h_roof));
  }
  ASSERT_GT(differences.size(), 700U);
  EXPECT_LT(percentile(differences, 50), 0.5);
  RecordProperty("median_difference", std::to_string(percentile(differences, 50)));
}

}  // namespace
}  // namespace tetropolis
