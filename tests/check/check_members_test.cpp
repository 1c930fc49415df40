#include "check/check_members.h"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace tetropolis {
namespace {

using testing::rectangle;

CityModel model_of(const std::vector<std::pair<std::vector<std::string>, Polygon>>& buildings) {
  CityModel city;
  for (const auto& [ids, footprint] : buildings) {
    Building building;
    building.id = "b" + std::to_string(city.buildings.size());
    building.source_ids = ids;
    building.footprint = footprint;
    city.buildings.push_back(building);
  }
  return city;
}

const CityModel kRaw = model_of({{{"west"}, rectangle(0, 0, 10, 10)},
                                 {{"middle"}, rectangle(10.5, 0, 20, 10)},
                                 {{"east"}, rectangle(40, 0, 50, 10)}});

TEST(CheckMembers, BuildingsAreWhereTheirFeaturesAre) {
  const CityModel city = model_of({{{"west", "middle"}, rectangle(0, 0, 20, 10)},
                                   {{"east", "of another run"}, rectangle(40.2, 0, 50, 10)}});
  EXPECT_TRUE(check_members(kRaw, city, 0.3).empty());
}

TEST(CheckMembers, IdsThatHaveChangedPlacesAreFound) {
  const CityModel city = model_of(
      {{{"west", "east"}, rectangle(0, 0, 20, 10)}, {{"middle"}, rectangle(40.2, 0, 50, 10)}});
  const std::vector<Violation> found = check_members(kRaw, city, 0.3);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].what, "features far from the building that names them");
  EXPECT_EQ(found[0].count, 2);
  EXPECT_EQ(found[0].first, "east in b0");
}

TEST(CheckMembers, NearIsWithinReachInsideOrAcross) {
  const auto holds = [](const Polygon& raw, const Polygon& merged, double reach) {
    return check_members(model_of({{{"a"}, raw}}), model_of({{{"a"}, merged}}), reach).empty();
  };
  EXPECT_TRUE(holds(rectangle(0, 0, 10, 10), rectangle(10.4, 0, 20, 10), 0.5));
  EXPECT_FALSE(holds(rectangle(0, 0, 10, 10), rectangle(10.6, 0, 20, 10), 0.5));
  // Boxes that overlap are not enough.
  EXPECT_FALSE(holds({{{0, 0}, {10, 0}, {0, 10}}, {}}, rectangle(6, 6, 20, 20), 0.5));
  EXPECT_TRUE(holds({{{0, 0}, {10, 0}, {0, 10}}, {}}, rectangle(6, 6, 20, 20), 1.5));
  EXPECT_TRUE(holds(rectangle(0, 0, 30, 30), rectangle(10, 10, 20, 20), 0.5));
  EXPECT_TRUE(holds(rectangle(10, 10, 20, 20), rectangle(0, 0, 30, 30), 0.5));
  EXPECT_TRUE(holds(rectangle(0, 10, 30, 20), rectangle(10, 0, 20, 30), 0.5));
}

}  // namespace
}  // namespace tetropolis
