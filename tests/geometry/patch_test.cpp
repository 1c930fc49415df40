#include "tetropolis/geometry/patch.h"

#include <gtest/gtest.h>

namespace tetropolis {
namespace {

TEST(PatchTable, HasTheEightOfEveryCityWithTheirNumbers) {
  const PatchTable table;
  const std::vector<std::string> names{"ground", "roof", "wall", "top",
                                       "xmin",   "xmax", "ymin", "ymax"};
  ASSERT_EQ(table.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(static_cast<std::size_t>(table[i].patch), i + 1);
    EXPECT_EQ(table[i].name, names[i]);
    EXPECT_EQ(table.position(table[i].patch), i);
    EXPECT_EQ(table[i].is_solid(), i < 3);
    EXPECT_EQ(table[i].of_building(), i == 1 || i == 2);
  }
  EXPECT_EQ(table.solid(), (std::vector{Patch::kGround, Patch::kRoof, Patch::kWall}));
}

TEST(PatchTable, KeepsMoreInTheirOrder) {
  PatchTable table;
  table.add({Patch{20}, "inlet", PatchKind::kSide});
  table.add({Patch{9}, "street", PatchKind::kGround});
  ASSERT_EQ(table.size(), 10U);
  EXPECT_EQ(table[8].name, "street");
  EXPECT_EQ(table.of(Patch{20}).name, "inlet");
  EXPECT_EQ(table.position(Patch{20}), 9U);
  for (const int none : {-1, 0, 10, 21}) EXPECT_FALSE(table.contains(Patch{none})) << none;
  EXPECT_EQ(table.solid().back(), Patch{9});
}

}  // namespace
}  // namespace tetropolis
