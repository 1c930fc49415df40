// Real clouds with every class blanked, compared with what the classes say.
#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/run/run.h"

#include "support/test_data.h"

namespace tetropolis {
namespace {

struct Blanked {
  const char* name;
  const char* footprints;
  std::vector<const char*> points;
  /// Buildings whose heights may differ by more than half a metre: measured. What is left are
  /// sheds under trees, and ground at two levels around one house.
  int most_raw;
  int most_merged;
};

void PrintTo(const Blanked& cloud, std::ostream* out) { *out << cloud.name; }

class Unclassified : public ::testing::TestWithParam<Blanked> {};

/// Buildings of which a height differs by more than half a metre.
int different_buildings(const CityModel& expected, const CityModel& found) {
  std::map<std::vector<std::string>, const Building*> by_source;
  for (const Building& building : expected.buildings) by_source[building.source_ids] = &building;
  EXPECT_EQ(found.buildings.size(), expected.buildings.size());
  int different = 0;
  for (const Building& building : found.buildings) {
    const Building* other = by_source.at(building.source_ids);
    if (std::abs(building.h_ground - other->h_ground) > 0.5 ||
        std::abs(building.h_roof - other->h_roof) > 0.5)
      ++different;
  }
  return different;
}

TEST_P(Unclassified, HeightsAreThoseOfTheClassifiedCloud) {
  const Blanked& real = GetParam();
  TETROPOLIS_REQUIRE_DATA(footprints, real.footprints);
  const testing::TemporaryFolder scratch;
  Config config;
  config.footprints = {footprints.string()};
  for (const char* points : real.points)
    config.points.push_back(testing::data_path(points).string());
  config.out = (scratch / "classified").string();
  const Report classified = run_city(config);
  EXPECT_EQ(classified.input->ground_filtered, 0);

  PointsInput input = read_points(expand_point_paths(config.points));
  std::fill(input.points.classification.begin(), input.points.classification.end(), kUnclassified);
  write_points(scratch / "blank.las", input.points, input.origin);
  config.points = {(scratch / "blank.las").string()};
  config.out = (scratch / "blank").string();
  const Report blank = run_city(config);
  EXPECT_GT(blank.input->ground_filtered, 0);
  const auto model = [&](const char* run, const char* name) {
    return read_city(scratch / run / name);
  };
  EXPECT_LE(different_buildings(model("classified", "city_raw.city.json"),
                                model("blank", "city_raw.city.json")),
            real.most_raw);
  EXPECT_LE(
      different_buildings(model("classified", "city.city.json"), model("blank", "city.city.json")),
      real.most_merged);
}

const Blanked kClouds[] = {
    {"Delft",
     "delft_3dfier/footprints.gpkg",
     {"delft_3dfier/ahn3_cropped_1.laz", "delft_3dfier/ahn3_cropped_2.laz"},
     2,
     0},
    {"Amsterdam", "amsterdam_south/footprints.gpkg", {"amsterdam_south/ahn3"}, 21, 3},
    {"AmsterdamSparse",
     "amsterdam_south/footprints.gpkg",
     {"amsterdam_south/ahn3_sparse/c_25gn1_b.laz"},
     17,
     1},
};

INSTANTIATE_TEST_SUITE_P(Clouds, Unclassified, ::testing::ValuesIn(kClouds),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace tetropolis
