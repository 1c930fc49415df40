#include "tetropolis/city/city_model.h"

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/test_data.h"

namespace tetropolis {
namespace {

TEST(CityModel, FlagsHaveTheNamesThatFilesAndReportsState) {
  struct Row {
    std::uint32_t flag;
    const char* name;
  };
  // In bit order; readers of files know them by name, so that none may change.
  const std::vector<Row> table{{kGroundFromDtm, "ground_from_dtm"},
                               {kRoofFromUnclassified, "roof_from_unclassified"},
                               {kRoofFromAttribute, "roof_from_attribute"},
                               {kNoRoofPoints, "no_roof_points"},
                               {kMinimumHeight, "minimum_height"},
                               {kMerged, "merged"},
                               {kConvexHull, "convex_hull"},
                               {kRepaired, "repaired"},
                               {kClipped, "clipped"},
                               {kRoofFromFloors, "roof_from_floors"},
                               {kDefaultHeight, "default_height"},
                               {kPlanned, "planned"}};
  std::uint32_t all = 0;
  std::vector<std::string> names;
  for (const auto& [flag, name] : table) {
    EXPECT_EQ(flag_names(flag), std::vector<std::string>{name});
    EXPECT_EQ(flags_from_names({name}), flag) << name;
    all |= flag;
    names.emplace_back(name);
  }
  EXPECT_EQ(all, (1U << table.size()) - 1) << "a bit twice, or one left out";
  EXPECT_EQ(flag_names(all), names);
}

TEST(CityModel, FlagsComeBackFromTheirNamesInAnyOrder) {
  constexpr std::uint32_t kFlagSets = 1U << 12;
  for (std::uint32_t flags = 0; flags < kFlagSets; ++flags) {
    const std::vector<std::string> names = flag_names(flags);
    EXPECT_EQ(flags_from_names(names), flags);
    EXPECT_EQ(flags_from_names({names.rbegin(), names.rend()}), flags);
  }
  EXPECT_EQ(flags_from_names({"merged", "merged"}), kMerged);
  EXPECT_EQ(flags_from_names({"Merged", "", "painted_red", "clipped"}), kClipped);
  // A bit without a name, of a later version: the others keep theirs.
  EXPECT_EQ(flag_names(kFlagSets | kMerged), std::vector<std::string>{"merged"});
}

TEST(CityModel, SnappedCoordinatesAreTheSameDoubleForTheSameMultiple) {
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(::testing::Message() << "TETROPOLIS_TEST_SEED=" << seed);
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::int64_t> steps(-10'000'000'000, 10'000'000'000);
  std::uniform_real_distribution<double> off(-0.49, 0.49);
  for (int i = 0; i < 10'000; ++i) {
    const std::int64_t multiple = steps(random);
    // The double nearest to the decimal number, as a file has it.
    const std::int64_t size = std::abs(multiple);
    std::string fraction = std::to_string(size % 10'000);
    fraction.insert(0, 4 - fraction.size(), '0');
    const double written =
        std::stod((multiple < 0 ? "-" : "") + std::to_string(size / 10'000) + "." + fraction);
    EXPECT_EQ(snap_coordinate((static_cast<double>(multiple) + off(random)) * 1e-4), written);
    EXPECT_EQ(snap_coordinate(written), written);
  }
}

}  // namespace
}  // namespace tetropolis
