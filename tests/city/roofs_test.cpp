// Roofs whose planes are known, and what the validator sees.
#include "tetropolis/city/roofs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/city/heights.h"
#include "tetropolis/geometry/polygon.h"

#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::test_seed;
using Roof = std::function<double(Point2)>;

Ring ring_between(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

/// Points of known roofs over footprints that are merged into one building.
struct Block {
  CityModel raw, city;
  BuildingPoints points;
  PointCloud cloud;
  std::vector<std::vector<BuildingIndex>> members{{}};

  explicit Block(const Ring& outline) {
    city.domain = Domain(-100, -100, 200, 200);
    Building block;
    block.id = "b0";
    block.footprint = {outline, {}};
    block.h_roof = 6;
    city.buildings.push_back(block);
  }

  /// A footprint with `density` points per square metre, uniformly at random, 2 cm off the roof.
  void add(const std::string& id, const Ring& ring, const Roof& roof, double density) {
    std::mt19937 random(test_seed());
    Building member;
    member.id = id;
    member.source_ids = {id};
    member.footprint = {ring, {}};
    members[0].push_back(raw.buildings.next());
    city.buildings[BuildingIndex(0)].source_ids.push_back(id);
    const Bounds2 around = bounds(ring);
    std::uniform_real_distribution<double> x(around.xmin, around.xmax);
    std::uniform_real_distribution<double> y(around.ymin, around.ymax);
    std::normal_distribution<double> noise(0, 0.02);
    std::vector<PointIndex> list;
    const double count = density * area(member.footprint);
    while (static_cast<double>(list.size()) < count) {
      const Point2 p{x(random), y(random)};
      if (!contains(member.footprint, p)) continue;
      list.push_back(static_cast<PointIndex>(cloud.size()));
      cloud.push_back(p.x, p.y, roof(p) + noise(random), kBuildingClass);
    }
    points.roof.push_back(list);
    points.ground.push_back({});
    points.by_exclusion.push_back(0);
    raw.buildings.push_back(member);
  }

  RoofFacts make(Lod lod, double clearance = 1) {
    RoofOptions options;
    options.lod = lod;
    options.clearance = clearance;
    const RoofFacts facts = make_roofs(city, raw, points, members, cloud, options);
    EXPECT_TRUE(part_defects(city.buildings, clearance).empty())
        << part_defects(city.buildings, clearance).front() << ", seed " << test_seed();
    return facts;
  }

  const std::vector<RoofPart>& parts() const { return city.buildings[BuildingIndex(0)].parts; }

  /// The largest distance between roofs and truth, at places further than `rim` from where
  /// `is_near` says that the truth bends or ends.
  double worst(const Roof& truth, const std::function<bool(Point2)>& is_near) const {
    double most = 0;
    const Polygon& outline = city.buildings[BuildingIndex(0)].footprint;
    const Bounds2 around = bounds(outline);
    for (double y = around.ymin + 0.11; y < around.ymax; y += 0.37)
      for (double x = around.xmin + 0.07; x < around.xmax; x += 0.37) {
        const Point2 p{x, y};
        if (!contains(outline, p) || is_near(p)) continue;
        int inside = 0;
        for (const RoofPart& part : parts())
          if (contains(part.outline, p)) {
            ++inside;
            most = std::max(most, std::abs(part.roof(p) - truth(p)));
          }
        EXPECT_EQ(inside, 1) << x << " " << y;
      }
    return most;
  }
};

double gable(Point2 p) { return 9 - 0.7 * std::abs(p.y - 5); }
/// Over 16 m x 10 m: the lowest of four planes.
double hip(Point2 p) {
  return 5 + std::min({0.8 * p.y, 0.8 * (10 - p.y), 0.8 * p.x, 0.8 * (16 - p.x)});
}
double shed(Point2 p) { return 6 + 0.2 * p.x; }
double step(Point2 p) { return p.x < 7 ? 9 : 6; }

TEST(Roofs, AGableHasTwoPlanes) {
  for (const double density : {8.0, 2.0}) {
    Block block(ring_between(0, 0, 14, 10));
    block.add("a", ring_between(0, 0, 14, 10), gable, density);
    const RoofFacts facts = block.make(Lod::k2_2);
    EXPECT_EQ(block.parts().size(), 2U);
    EXPECT_LT(block.worst(gable, [](Point2 p) { return std::abs(p.y - 5) < 0.6; }), 0.2)
        << "seed " << test_seed();
    EXPECT_EQ(facts.fallbacks, 0);
    EXPECT_NEAR(facts.max_slope_deg, std::atan(0.7) * 180 / 3.14159265, 1);
    EXPECT_LT(facts.rmse_median, 0.1);
    EXPECT_EQ(block.parts()[0].source_id, "a");
    // The ridge: 9 m over 14 m x 10 m less the two prisms below it.
    EXPECT_NEAR(facts.volume, 140 * (9 - 0.7 * 2.5), 5);
  }
}

TEST(Roofs, AHipHasFourPlanes) {
  Block block(ring_between(0, 0, 16, 10));
  block.add("a", ring_between(0, 0, 16, 10), hip, 8);
  block.make(Lod::k2_2);
  EXPECT_EQ(block.parts().size(), 4U);
  const auto near = [](Point2 p) {
    std::vector<double> planes{p.y, 10 - p.y, p.x, 16 - p.x};
    std::sort(planes.begin(), planes.end());
    return planes[1] - planes[0] < 1.8;
  };
  EXPECT_LT(block.worst(hip, near), 0.2) << "seed " << test_seed();
}

TEST(Roofs, AShedHasOnePlane) {
  Block block(ring_between(0, 0, 12, 8));
  block.add("a", ring_between(0, 0, 12, 8), shed, 3);
  block.make(Lod::k2_2);
  ASSERT_EQ(block.parts().size(), 1U);
  EXPECT_EQ(block.parts()[0].lod, Lod::k2_2);
  EXPECT_NEAR(block.parts()[0].roof.slope_x, 0.2, 0.01);
  EXPECT_NEAR(block.parts()[0].roof.slope_y, 0, 0.01);
}

TEST(Roofs, AStepDividesAFootprintFromLod13On) {
  for (const Lod lod : {Lod::k1_2, Lod::k1_3, Lod::k2_2}) {
    Block block(ring_between(0, 0, 14, 10));
    block.add("a", ring_between(0, 0, 14, 10), step, 5);
    block.make(lod);
    if (lod == Lod::k1_2) {
      ASSERT_EQ(block.parts().size(), 1U);
      EXPECT_EQ(block.parts()[0].lod, Lod::k1_2);
      continue;
    }
    EXPECT_EQ(block.parts().size(), 2U) << name_of(lod);
    EXPECT_LT(block.worst(step, [](Point2 p) { return std::abs(p.x - 7) < 1.2; }), 0.3)
        << name_of(lod) << ", seed " << test_seed();
    for (const RoofPart& part : block.parts()) EXPECT_EQ(part.lod, lod);
  }
}

TEST(Roofs, HeightsLessThanAMetreApartAreOnePartOfLod13) {
  Block block(ring_between(0, 0, 14, 10));
  const auto low_step = [](Point2 p) { return p.x < 7 ? 6.7 : 6.0; };
  block.add("a", ring_between(0, 0, 14, 10), low_step, 5);
  block.make(Lod::k1_3);
  EXPECT_EQ(block.parts().size(), 1U);
}

TEST(Roofs, PartyWallsDivideABlock) {
  // Two houses of 9 m and 6 m that are 0.6 m apart, and a third that nobody has seen.
  Block block(ring_between(0, 0, 30, 10));
  block.add(
      "a", ring_between(0, 0, 9.7, 10), [](Point2) { return 9.0; }, 4);
  block.add(
      "b", ring_between(10.3, 0, 20, 10), [](Point2) { return 6.0; }, 4);
  block.add(
      "c", ring_between(20, 0, 30, 10), [](Point2) { return 0.0; }, 0);
  const RoofFacts facts = block.make(Lod::k1_2);
  ASSERT_EQ(block.parts().size(), 3U);
  std::set<std::string> sources;
  for (const RoofPart& part : block.parts()) {
    sources.insert(part.source_id);
    EXPECT_TRUE(part.roof.is_flat());
    EXPECT_NEAR(area(part.outline), 100, 3) << part.source_id;
    if (part.source_id != "c") {
      EXPECT_NEAR(part.roof.elevation, part.source_id == "a" ? 9 : 6, 0.05);
      continue;
    }
    EXPECT_EQ(part.lod, Lod::kBlock);
    EXPECT_EQ(part.roof.elevation, 6);  // the building's
    EXPECT_TRUE(std::isnan(part.rmse));
  }
  EXPECT_EQ(sources.size(), 3U);
  EXPECT_EQ(facts.parts_without_points, 1);
}

TEST(Roofs, AFilledGapGoesToTheLongestNeighbour) {
  // Between a long wall, and two houses that share the other side of it.
  Block block(ring_between(0, 0, 20, 10));
  block.add(
      "a", ring_between(0, 0, 8, 10), [](Point2) { return 9.0; }, 4);
  block.add(
      "b", ring_between(9.5, 0, 20, 4), [](Point2) { return 6.0; }, 4);
  block.add(
      "c", ring_between(9.5, 4, 20, 10), [](Point2) { return 4.0; }, 4);
  block.make(Lod::k1_2);
  ASSERT_EQ(block.parts().size(), 3U);
  const std::map<std::string, double> areas{{"a", 95}, {"b", 42}, {"c", 63}};
  for (const RoofPart& part : block.parts())
    EXPECT_NEAR(area(part.outline), areas.at(part.source_id), 1.5) << part.source_id;
}

TEST(Roofs, AFootprintThatFitsWorseThanFlatStaysFlat) {
  // One plane does for the shop and its annexe, but the annexe is 10 cm off it.
  Block block(ring_between(0, 0, 23, 10));
  block.add(
      "shop", ring_between(0, 0, 20, 10), [](Point2) { return 6.0; }, 8);
  block.add(
      "annexe", ring_between(20, 0, 23, 10), [](Point2) { return 6.1; }, 8);
  block.make(Lod::k2_2);
  double squares = 0, count = 0;
  for (PointIndex p : block.points.roof[1]) {
    const Point2 at{block.cloud.x[p], block.cloud.y[p]};
    for (const RoofPart& part : block.parts())
      if (contains(part.outline, at)) {
        const double d = part.roof(at) - block.cloud.z[p];
        squares += d * d, ++count;
      }
  }
  std::vector<double> heights;
  for (PointIndex p : block.points.roof[1]) heights.push_back(block.cloud.z[p]);
  const double level = percentile(heights, 70);
  double flat = 0;
  for (const double z : heights) flat += (z - level) * (z - level);
  EXPECT_LE(std::sqrt(squares / count), 1.1 * std::sqrt(flat / count));
}

TEST(Roofs, NoCornerLeavesTheRangeOfItsPoints) {
  // Points on the lower half alone: the plane is not drawn out to the ridge.
  Block block(ring_between(0, 0, 10, 10));
  block.add(
      "a", ring_between(0, 0, 10, 10), [](Point2 p) { return 5 + p.x; }, 6);
  PointLists half;
  std::vector<PointIndex> list;
  double highest = 0;
  for (const PointIndex p : block.points.roof[0])
    if (block.cloud.x[p] < 5) {
      list.push_back(p);
      highest = std::max<double>(highest, block.cloud.z[p]);
    }
  half.push_back(list);
  block.points.roof = half;
  block.make(Lod::k2_2);
  ASSERT_FALSE(block.parts().empty());
  for (const RoofPart& part : block.parts())
    for (const Point2 corner : part.outline.outer) EXPECT_LE(part.roof(corner), highest + 0.502);
}

TEST(Roofs, LowRoofsAreRaised) {
  Block block(ring_between(0, 0, 10, 10));
  block.add(
      "a", ring_between(0, 0, 10, 10), [](Point2 p) { return 1 + 0.2 * p.x; }, 6);
  const RoofFacts facts = block.make(Lod::k2_2);
  EXPECT_EQ(facts.raised, 1);
  for (const RoofPart& part : block.parts())
    for (const Point2 corner : part.outline.outer) EXPECT_GE(part.roof(corner), 2.498);
}

TEST(Roofs, ABlockStaysABlock) {
  Block block(ring_between(0, 0, 10, 10));
  block.add("a", ring_between(0, 0, 10, 10), shed, 6);
  EXPECT_EQ(block.make(Lod::kBlock).parts, 0);
  EXPECT_TRUE(block.parts().empty());
}

// ---------------------------------------------------------------- the validator

Building two_parts() {
  Building building;
  building.id = "b0";
  building.footprint = {{{0, 0}, {5, 0}, {10, 0}, {10, 8}, {5, 8}, {0, 8}}, {}};
  building.parts.resize(2);
  building.parts[0].outline = {{{0, 0}, {5, 0}, {5, 8}, {0, 8}}, {}};
  building.parts[1].outline = {{{5, 0}, {10, 0}, {10, 8}, {5, 8}}, {}};
  return building;
}

std::string first_defect(const Building& building, double clearance = 1) {
  const std::vector<std::string> defects = part_defects(std::vector{building}, clearance);
  return defects.empty() ? "" : defects.front();
}

TEST(PartDefects, NoneWherePartsTile) {
  EXPECT_EQ(first_defect(two_parts()), "");
  EXPECT_EQ(part_defects(std::vector{Building{}}, 1).size(), 0U);
}

TEST(PartDefects, AreSeen) {
  Building gap = two_parts();
  gap.parts[1].outline.outer[0].x = gap.parts[1].outline.outer[3].x = 5.5;
  EXPECT_NE(first_defect(gap).find("footprint's side"), std::string::npos) << first_defect(gap);

  Building hanging = two_parts();  // a vertex of one part on the line of another
  hanging.parts[0].outline.outer.insert(hanging.parts[0].outline.outer.begin() + 2, {5, 4});
  EXPECT_NE(first_defect(hanging).find("no two parts"), std::string::npos);

  Building missing = two_parts();  // a vertex of parts that the footprint has not
  missing.footprint.outer.erase(missing.footprint.outer.begin() + 1);
  EXPECT_NE(first_defect(missing), "");

  Building turned = two_parts();
  std::reverse(turned.parts[0].outline.outer.begin(), turned.parts[0].outline.outer.end());
  EXPECT_NE(first_defect(turned).find("counter-clockwise"), std::string::npos);

  Building steep = two_parts();
  steep.parts[0].roof.slope_x = 2.8;
  EXPECT_NE(first_defect(steep).find("steeper"), std::string::npos);

  EXPECT_NE(first_defect(two_parts(), 6).find(" m between"), std::string::npos);

  Building small = two_parts();
  for (Point2& p : small.footprint.outer) p.y *= 0.02;
  for (RoofPart& part : small.parts)
    for (Point2& p : part.outline.outer) p.y *= 0.02;
  EXPECT_NE(first_defect(small, 0.1).find("less than"), std::string::npos);

  Building sharp;  // a line that leaves a corner at 11 degrees
  sharp.id = "b0";
  sharp.footprint = {{{0, 0}, {40, 0}, {40, 8}, {0, 8}}, {}};
  sharp.parts.resize(2);
  sharp.parts[0].outline = {{{0, 0}, {40, 0}, {40, 8}}, {}};
  sharp.parts[1].outline = {{{0, 0}, {40, 8}, {0, 8}}, {}};
  EXPECT_NE(first_defect(sharp).find("11.3 degrees"), std::string::npos);
}

}  // namespace
}  // namespace tetropolis
