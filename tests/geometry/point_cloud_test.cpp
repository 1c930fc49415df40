#include "tetropolis/geometry/point_cloud.h"

#include <array>
#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace tetropolis {
namespace {

TEST(PointClass, TheTableOfLasSaysWhatTellsTheTerrainAndWhatMayBeARoof) {
  struct Row {
    const char* meaning;
    int code;
    bool ground, roof;
  };
  // LAS 1.4 R15, table 17.
  constexpr std::array<Row, 19> kTable{
      {{"created, never classified", 0, false, true},
       {"unclassified", 1, false, true},
       {"ground", 2, true, false},
       {"low vegetation", 3, false, false},
       {"medium vegetation", 4, false, false},
       {"high vegetation", 5, false, false},
       {"building", 6, false, true},
       {"low point (noise)", 7, false, false},
       {"reserved; key point of the terrain up to LAS 1.3", 8, false, false},
       {"water", 9, true, false},
       {"rail", 10, false, false},
       {"road surface", 11, false, false},
       {"reserved", 12, false, true},
       {"wire, guard", 13, false, false},
       {"wire, conductor", 14, false, false},
       {"transmission tower", 15, false, false},
       {"wire-structure connector", 16, false, false},
       {"bridge deck", 17, false, false},
       {"high noise", 18, false, false}}};
  for (const Row& row : kTable) {
    const auto code = static_cast<std::uint8_t>(row.code);
    EXPECT_EQ(is_ground(code), row.ground) << row.code << ": " << row.meaning;
    EXPECT_EQ(may_be_roof(code), row.roof) << row.code << ": " << row.meaning;
  }
  // Overhead structures, snow and the like, what is reserved, and what users define; but not ground
  // that was ignored, nor what bathymetry has (LAS 1.4 topo-bathy profile, 40 to 45).
  for (int code = 19; code < 256; ++code) {
    EXPECT_FALSE(is_ground(static_cast<std::uint8_t>(code))) << code;
    EXPECT_EQ(may_be_roof(static_cast<std::uint8_t>(code)), code != 20 && (code < 40 || code > 45))
        << code;
  }
}

TEST(PointClass, TablesHoldTheCodesGivenAndNoOthers) {
  const std::vector<std::uint8_t> codes{0, 6, 255, 6};
  const std::set<std::size_t> given(codes.begin(), codes.end());
  const ClassTable table = class_table(codes), empty = class_table({});
  for (std::size_t code = 0; code < table.size(); ++code) {
    EXPECT_EQ(table[code], given.contains(code)) << code;
    EXPECT_FALSE(empty[code]) << code;
  }
}

}  // namespace
}  // namespace tetropolis
