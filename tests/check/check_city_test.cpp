#include "tetropolis/check/check_city.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tetropolis/core/threads.h"
#include "tetropolis/geometry/polygon.h"

#include "support/shapes.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

CityModel model_of(const std::vector<Polygon>& footprints) {
  CityModel city;
  city.domain = {0, 0, 100, 100};
  for (std::size_t b = 0; b < footprints.size(); ++b) {
    Building building;
    building.id = "b" + std::to_string(b);
    building.source_ids = {"s" + std::to_string(b)};
    building.footprint = footprints[b];
    building.h_roof = 10;
    city.buildings.push_back(building);
  }
  return city;
}

std::string first_violation(const CityModel& city, std::optional<double> distance = 1.0) {
  const CityCheck check = check_city(city, distance);
  return check.violations.empty() ? "" : check.violations[0].what;
}

using testing::rectangle;

TEST(CheckCity, MeasuresClearanceBetweenAndWithinRings) {
  const CityCheck apart =
      check_city(model_of({rectangle(10, 10, 20, 20), rectangle(21.5, 10, 30, 20)}), 1.0);
  EXPECT_TRUE(apart.violations.empty());
  EXPECT_DOUBLE_EQ(apart.min_clearance, 1.5);
  EXPECT_DOUBLE_EQ(apart.area, 185);
  EXPECT_EQ(first_violation(model_of({rectangle(10, 10, 20, 20), rectangle(20.5, 10, 30, 20)})),
            "clearance below the threshold");
  // A corner that comes close to the middle of a wall; a needle; a courtyard near the outline.
  EXPECT_EQ(
      first_violation(model_of({rectangle(10, 10, 20, 20), {{{20.9, 15}, {30, 5}, {30, 25}}, {}}})),
      "clearance below the threshold");
  EXPECT_EQ(first_violation(model_of({{{{10, 10}, {40, 10}, {40, 10.5}}, {}}})),
            "clearance below the threshold");
  EXPECT_EQ(first_violation(model_of(
                {{{{10, 10}, {40, 10}, {40, 40}, {10, 40}}, {{{20, 20}, {20, 39.5}, {30, 30}}}}})),
            "clearance below the threshold");
}

TEST(CheckCity, SeesBrokenRings) {
  EXPECT_EQ(first_violation(model_of({{{{10, 10}, {10, 20}, {20, 20}, {20, 10}}, {}}})),
            "outer rings not counter-clockwise");
  EXPECT_EQ(first_violation(model_of(
                {{{{10, 10}, {40, 10}, {40, 40}, {10, 40}}, {{{20, 20}, {30, 20}, {30, 30}}}}})),
            "holes not clockwise");
  EXPECT_EQ(first_violation(model_of({{{{10, 10}, {20, 10}}, {}}})),
            "footprints with fewer than 3 vertices");
  const CityCheck crossing =
      check_city(model_of({rectangle(10, 10, 30, 30), rectangle(20, 20, 40, 40)}), 1.0);
  EXPECT_TRUE(std::any_of(crossing.violations.begin(), crossing.violations.end(),
                          [](const Violation& v) { return v.what == "rings that cross"; }));
}

TEST(CheckCity, SeesSharedCornersAndTheDomainsBoundary) {
  EXPECT_EQ(check_city(model_of({rectangle(10, 10, 20, 20), rectangle(20, 20, 30, 30)}), 1.0)
                .min_clearance,
            0);
  EXPECT_EQ(first_violation(model_of({rectangle(0.5, 10, 20, 20)})),
            "footprints too close to the domain's boundary");
}

TEST(CheckCity, RawModelsMayTouchAndOverlap) {
  EXPECT_EQ(first_violation(model_of({rectangle(10, 10, 30, 30), rectangle(20, 20, 40, 40),
                                      rectangle(40, 20, 50, 40)}),
                            std::nullopt),
            "");
}

TEST(CheckCity, SeesHeightsAndAccounts) {
  CityModel city = model_of({rectangle(10, 10, 20, 20), rectangle(30, 10, 40, 20)});
  city.buildings[1].h_roof = city.buildings[1].h_ground;
  EXPECT_EQ(first_violation(city), "roofs not above the ground");
  city = model_of({rectangle(10, 10, 20, 20), rectangle(30, 10, 40, 20)});
  city.dropped.push_back({"s1", "too small"});
  EXPECT_EQ(first_violation(city), "input features accounted for more than once");
  city.dropped.clear();
  city.buildings[0].source_ids.clear();
  EXPECT_EQ(first_violation(city), "buildings without source");
}

/// `outer` with rectangular holes.
Polygon with_holes(Polygon outer, const std::vector<Polygon>& holes) {
  for (const Polygon& hole : holes)
    outer.holes.emplace_back(hole.outer.rbegin(), hole.outer.rend());
  return outer;
}

TEST(CheckCity, SeesFootprintsInsideOthersButNotInTheirCourtyards) {
  const Polygon block = rectangle(10, 10, 60, 60), inner = rectangle(20, 20, 50, 50);
  const Polygon ring = with_holes(block, {inner});
  for (const bool swapped : {false, true}) {
    const auto violation = [&](const Polygon& a, const Polygon& b) {
      return first_violation(model_of(swapped ? std::vector{b, a} : std::vector{a, b}));
    };
    EXPECT_EQ(violation(block, rectangle(30, 30, 40, 40)), "footprints that overlap");
    EXPECT_EQ(violation(block, with_holes(inner, {rectangle(30, 30, 40, 40)})),
              "footprints that overlap");
    EXPECT_EQ(violation(ring, rectangle(30, 30, 40, 40)), "");
    EXPECT_EQ(violation(ring, rectangle(12, 12, 18, 18)), "footprints that overlap");
    // In the yard of what stands in the yard.
    EXPECT_EQ(violation(ring, with_holes(rectangle(22, 22, 48, 48), {rectangle(25, 25, 45, 45)})),
              "");
  }
  EXPECT_EQ(first_violation(model_of({block, rectangle(30, 30, 40, 40)}), std::nullopt), "");
  // Without any clearance asked for, footprints may touch, also in corners and along edges.
  EXPECT_EQ(first_violation(model_of({block, rectangle(60, 10, 70, 60), rectangle(60, 60, 70, 70),
                                      rectangle(15, 0, 30, 10)}),
                            0.0),
            "");
  EXPECT_EQ(first_violation(model_of({block, rectangle(10, 10, 60, 30)}), 0.0),
            "footprints that overlap");
}

TEST(CheckCity, SeesHolesOutsideTheirFootprintAndInsideOneAnother) {
  const Polygon block = rectangle(10, 10, 60, 60);
  for (const auto distance : {std::optional<double>(1.0), std::optional<double>()}) {
    const auto violation = [&](const std::vector<Polygon>& holes) {
      return first_violation(model_of({with_holes(block, holes)}), distance);
    };
    EXPECT_EQ(violation({rectangle(20, 20, 30, 30), rectangle(40, 20, 50, 30)}), "");
    EXPECT_EQ(violation({rectangle(20, 20, 30, 30), rectangle(70, 20, 80, 30)}),
              "holes outside their footprint");
    EXPECT_EQ(violation({rectangle(5, 5, 65, 65)}), "holes outside their footprint");
    EXPECT_EQ(violation({rectangle(20, 20, 50, 50), rectangle(30, 30, 40, 40)}),
              "holes inside one another");
    EXPECT_EQ(violation({rectangle(30, 30, 40, 40), rectangle(20, 20, 50, 50)}),
              "holes inside one another");
  }
  // Raw holes may touch the outline and each other in a point.
  Polygon touching = block;
  touching.holes = {{{10, 40}, {20, 50}, {30, 40}, {20, 30}},
                    {{60, 40}, {45, 25}, {30, 40}, {45, 55}}};
  EXPECT_EQ(first_violation(model_of({touching}), std::nullopt), "");
}

TEST(CheckCity, SeesCoordinatesThatAreNotFinite) {
  for (const double value : {std::nan(""), std::numeric_limits<double>::infinity()})
    for (const bool in_hole : {false, true}) {
      CityModel city = model_of({with_holes(rectangle(10, 10, 60, 60), {rectangle(20, 20, 50, 50)}),
                                 rectangle(70, 70, 80, 80)});
      Polygon& polygon = city.buildings[0].footprint;
      (in_hole ? polygon.holes[0] : polygon.outer)[1].x = value;
      const CityCheck check = check_city(city, 1.0);
      EXPECT_TRUE(std::any_of(
          check.violations.begin(), check.violations.end(),
          [](const Violation& v) { return v.what == "coordinates that are not finite"; }));
    }
}

TEST(CheckCity, EmptyRingsAreViolationsAndNothingElse) {
  CityModel city = model_of({Polygon{}, rectangle(10, 10, 20, 20)});
  city.buildings[1].footprint.holes.emplace_back();
  EXPECT_EQ(first_violation(city), "footprints with fewer than 3 vertices");
  EXPECT_TRUE(std::isinf(check_city(CityModel{}, 1.0).min_clearance));
  EXPECT_EQ(first_violation(CityModel{}), "");
}

/// What check_city says about pairs of edges, with all pairs looked at.
struct Pairs {
  double min_clearance = std::numeric_limits<double>::infinity();
  std::int64_t crossings = 0;
};

Pairs all_pairs(const CityModel& city, bool may_touch) {
  struct Side {
    Point2 a, b;
    std::size_t building;
    int ring, number, count;
  };
  std::vector<Side> sides;
  int rings = 0;
  for (std::size_t b = 0; b < city.buildings.size(); ++b) {
    std::vector<Ring> all = city.buildings[b].footprint.holes;
    all.push_back(city.buildings[b].footprint.outer);
    for (const Ring& ring : all) {
      ++rings;
      for (std::size_t i = 0; i < ring.size(); ++i)
        sides.push_back({ring[i], ring[(i + 1) % ring.size()], b, rings, static_cast<int>(i),
                         static_cast<int>(ring.size())});
    }
  }
  const auto turn = [](Point2 a, Point2 b, Point2 c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  };
  const auto apart = [](double s, double t) { return (s > 0 && t < 0) || (s < 0 && t > 0); };
  Pairs found;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Side& e = sides[i];
    found.min_clearance = std::min(found.min_clearance, std::hypot(e.a.x - e.b.x, e.a.y - e.b.y));
    for (std::size_t j = 0; j < i; ++j) {
      const Side& f = sides[j];
      if (may_touch && e.building != f.building) continue;
      if (apart(turn(e.a, e.b, f.a), turn(e.a, e.b, f.b)) &&
          apart(turn(f.a, f.b, e.a), turn(f.a, f.b, e.b)))
        ++found.crossings;
      const int step = std::abs(e.number - f.number);
      const bool neighbours = e.ring == f.ring && (step == 1 || step + 1 == e.count);
      const auto look = [&](Point2 p, const Side& s) {
        if (neighbours && (p == s.a || p == s.b)) return;
        found.min_clearance = std::min(found.min_clearance, distance_to_segment(p, s.a, s.b));
      };
      look(e.a, f);
      look(e.b, f);
      look(f.a, e);
      look(f.b, e);
    }
  }
  return found;
}

/// Compares check_city with all pairs; returns how many cross.
std::int64_t expect_all_pairs(const CityModel& city) {
  std::int64_t crossings = 0;
  for (const bool may_touch : {false, true}) {
    const Pairs expected = all_pairs(city, may_touch);
    crossings += expected.crossings;
    std::vector<std::string> places;
    for (const int threads : {1, 2}) {
      const ThreadLimit limit(threads);
      const CityCheck check =
          check_city(city, may_touch ? std::nullopt : std::optional<double>(1.0));
      if (std::isinf(expected.min_clearance))
        EXPECT_TRUE(std::isinf(check.min_clearance));
      else
        EXPECT_NEAR(check.min_clearance, expected.min_clearance, 1e-9);
      std::int64_t found = 0;
      std::vector<std::string> firsts;
      for (const Violation& violation : check.violations) {
        if (violation.what == "rings that cross") found += violation.count;
        firsts.push_back(violation.first);
      }
      EXPECT_EQ(found, expected.crossings);
      if (threads == 1) places = firsts;
      EXPECT_EQ(firsts, places);
    }
  }
  return crossings;
}

TEST(CheckCity, PairsOfEdgesAreThoseOfAllPairsOnRandomCities) {
  std::mt19937 random(testing::test_seed());
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::int64_t crossings = 0;
  for (int round = 0; round < 300; ++round) {
    SCOPED_TRACE("seed " + std::to_string(testing::test_seed()) + ", round " +
                 std::to_string(round));
    // Squares, corridors, and points far away; edges of all lengths; vertices in few places.
    const double width = std::pow(10, uniform(1, 4)), height = std::pow(10, uniform(1, 4));
    const double step = round % 3 == 0 ? width / 20 : 0;
    std::vector<Polygon> footprints;
    const int buildings = std::uniform_int_distribution<int>(0, 40)(random);
    for (int b = 0; b < buildings; ++b) {
      const double size = std::pow(10, uniform(-1, round % 2 == 0 ? 1 : 4));
      const Point2 centre{uniform(0, width), uniform(0, height)};
      const auto ring = [&](int corners) {
        Ring points;
        for (int i = 0; i < corners; ++i) {
          Point2 p{centre.x + uniform(-size, size), centre.y + uniform(-size, size)};
          if (step > 0) p = {std::round(p.x / step) * step, std::round(p.y / step) * step};
          points.push_back(p);
        }
        return points;
      };
      Polygon polygon{ring(std::uniform_int_distribution<int>(0, 8)(random)), {}};
      if (b % 3 == 0) polygon.holes.push_back(ring(4));
      footprints.push_back(polygon);
    }
    if (round % 7 == 0) footprints.push_back(rectangle(1e8, 1e8, 1e8 + 10, 1e8 + 10));
    crossings += expect_all_pairs(model_of(footprints));
  }
  EXPECT_GT(crossings, 1000);
}

TEST(CheckCity, ClearanceIsThatOfAllPairsWhereBuildingsStandApart) {
  std::mt19937 random(testing::test_seed());
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int round = 0; round < 100; ++round) {
    SCOPED_TRACE("seed " + std::to_string(testing::test_seed()) + ", round " +
                 std::to_string(round));
    const int columns = std::uniform_int_distribution<int>(1, 20)(random);
    const double step = uniform(5, 50), gap = uniform(0.01, 0.3) * step;
    std::vector<Polygon> footprints;
    for (int b = 0; b < 100; ++b) {
      const double x = step * (b % columns) + uniform(0, gap);
      const double y = step * (b / columns) + uniform(0, gap);
      footprints.push_back(rectangle(x, y, x + step - 2 * gap, y + step - 2 * gap));
    }
    EXPECT_EQ(expect_all_pairs(model_of(footprints)), 0);
  }
}

}  // namespace
}  // namespace tetropolis
