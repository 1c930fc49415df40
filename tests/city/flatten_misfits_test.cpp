// What becomes flat where planes fit worse.
#include "city/roofs/flatten_misfits.h"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

namespace tetropolis {
namespace {

/// A row of three squares of 4 m, regions 0 to 2, the first two of one member; points at 1 to 9 m.
struct Row {
  std::vector<Point3> positions;
  std::vector<RoofRegion> region_of;
  Partition lines{{0, 0, 12, 4}, 1};
  FinishedRoof roof;

  Row() {
    std::vector<Partition::NodeId> below, above;
    for (int k = 0; k < 4; ++k) {
      const bool is_corner = k % 3 == 0;
      below.push_back(lines.add_node({4.0 * k, 0}, is_corner, true));
      above.push_back(lines.add_node({4.0 * k, 4}, is_corner, true));
    }
    const auto out = Partition::kOutside;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto r = static_cast<RoofRegion>(k);
      if (k < 3) {
        lines.add_edge(below[k], below[k + 1], r, out);
        lines.add_edge(above[k], above[k + 1], out, r);
      }
      lines.add_edge(below[k], above[k], k > 0 ? r - 1 : out, k < 3 ? r : out);
    }
    for (int r = 0; r < 3; ++r)
      for (int k = 0; k < 3; ++k) {
        positions.push_back({4.0 * r + 1 + k, 2, 1.0 + 3 * r + k});
        region_of.push_back(r);
      }
    roof.counts = {40, 40};
    roof.squared_errors = {10, 10};
    roof.flat_squared_errors = {10, 10};
  }
  RegionPoints points() const {
    const RoofPlane plane{{0, 0}, 1, 0.5, 0};
    return {positions,
            std::vector<double>(positions.size(), 1),
            region_of,
            {{plane, 0, Lod::k2_2}, {plane, 0, Lod::k2_2}, {plane, 1, Lod::k2_2}},
            {0, 0, 12, 4},
            50,
            3};
  }
};

TEST(FlattenMisfits, NothingHappensWherePlanesFit) {
  Row row;
  RegionPoints points = row.points();
  row.roof.squared_errors[0] = 11;  // 4.9 % of the root
  EXPECT_FALSE(flatten_misfits(row.roof, row.lines, points));
  row.roof.counts[1] = 19;  // too few to tell
  row.roof.squared_errors[1] = 100;
  EXPECT_FALSE(flatten_misfits(row.roof, row.lines, points));
  EXPECT_EQ(row.lines.areas().size(), 3U);
}

TEST(FlattenMisfits, AMemberBecomesOneFlatRegion) {
  Row row;
  RegionPoints points = row.points();
  row.roof.squared_errors[0] = 11.1;
  ASSERT_TRUE(flatten_misfits(row.roof, row.lines, points));
  const std::vector<Partition::Face> faces = row.lines.faces();
  ASSERT_EQ(faces.size(), 2U);
  for (const Partition::Face& face : faces) {
    const RegionRoof& roof = points.roof(face.region);
    EXPECT_EQ(face.area, roof.member == 0 ? 32 : 16);
    EXPECT_EQ(face.rings.front().size(), 4U);  // the line's ends are gone
    if (roof.member == 1) {
      EXPECT_EQ(roof.lod, Lod::k2_2);
      EXPECT_EQ(roof.plane.slope_x, 0.5);
      continue;
    }
    EXPECT_EQ(roof.lod, Lod::k1_2);
    EXPECT_EQ(roof.plane.slope_x, 0);
    EXPECT_EQ(roof.plane({5, 2}), 3.5);  // the median of 1 to 6
    EXPECT_EQ(points.points_of(face.region).size(), 6U);
  }
  EXPECT_FALSE(flatten_misfits(row.roof, row.lines, points));
}

TEST(FlattenMisfits, MembersStayApart) {
  Row row;
  RegionPoints points = row.points();
  row.roof.squared_errors = {20, 20};
  ASSERT_TRUE(flatten_misfits(row.roof, row.lines, points));
  EXPECT_EQ(row.lines.areas().size(), 2U);
}

}  // namespace
}  // namespace tetropolis
