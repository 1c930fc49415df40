#include "tetropolis/terrain/ground_filter.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/threads.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/synth/synthetic_city.h"

#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::test_seed;

Polygon box(double x0, double y0, double x1, double y1) {
  return {{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, {}};
}

void add(PointCloud& cloud, double x, double y, double z, std::uint8_t code = kUnclassified) {
  cloud.push_back(x, y, z, code);
}

/// Unclassified points on ground(x, y), or `height` above it inside the buildings.
PointCloud scan(double size, double per_m2, const std::vector<Polygon>& buildings, double height,
                const std::function<double(double, double)>& ground) {
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> along(0, size);
  std::normal_distribution<double> noise(0, 0.03);
  PointCloud cloud;
  for (int k = 0; k < static_cast<int>(size * size * per_m2); ++k) {
    const double x = along(random), y = along(random);
    const bool inside = std::any_of(buildings.begin(), buildings.end(), [&](const Polygon& b) {
      return contains(b, {x, y});
    });
    add(cloud, x, y, ground(x, y) + noise(random) + (inside ? height : 0));
  }
  return cloud;
}

/// Share of points wrongly left out, and wrongly taken, of all that are and are not ground.
struct Mistakes {
  double missed = 0;
  double taken = 0;
};

Mistakes mistakes(const PointCloud& cloud, const std::vector<std::uint8_t>& found,
                  const std::function<bool(std::size_t)>& is_ground) {
  double ground = 0, other = 0, missed = 0, taken = 0;
  for (std::size_t p = 0; p < cloud.size(); ++p) {
    (is_ground(p) ? ground : other) += 1;
    if (is_ground(p) && found[p] == 0) missed += 1;
    if (!is_ground(p) && found[p] != 0) taken += 1;
  }
  return {missed / std::max(ground, 1.0), taken / std::max(other, 1.0)};
}

/// A rock wall far away neither moves nor shrinks the cells, nor tilts the terrain here.
TEST(GroundFilter, WithMeasuresGivenDoesNotDependOnFarPoints) {
  SCOPED_TRACE(test_seed());
  std::vector<Polygon> houses;
  for (double x = 10; x < 230; x += 40)
    for (double y = 10; y < 110; y += 40) houses.push_back(box(x, y, x + 15, y + 12));
  const auto hill = [](double x, double y) { return 0.02 * x + 2 * std::sin(0.05 * y); };
  PointCloud here = scan(240, 0.3, houses, 6, hill);
  std::mt19937 random(test_seed());
  std::uniform_real_distribution<double> bush(0, 2);
  for (std::size_t p = 0; p < here.size(); p += 3) here.z[p] = here.z[p] + bush(random);
  PointCloud whole = here;
  const PointCloud there = scan(240, 3, {}, 0, [](double x, double) { return x > 60 ? 60.0 : 4; });
  for (std::size_t p = 0; p < there.size(); ++p)
    add(whole, there.x[p] + 240, there.y[p] - 30.3, there.z[p]);
  GroundFilterOptions options;
  options.anchor = Point2{1000, -1000};
  options.spacing = 1.8;
  options.tilt = Point2{0.02, 0};
  const auto differing = [&](const GroundFilterOptions& with) {
    const auto alone = filter_ground(here, {}, with), beside = filter_ground(whole, {}, with);
    std::size_t count = 0;
    for (std::size_t p = 0; p < here.size(); ++p)
      if (here.x[p] < 140 && alone[p] != beside[p]) ++count;
    return count;
  };
  EXPECT_EQ(differing(options), 0u);
  EXPECT_GT(differing({}), 0u) << "this far wall would not have mattered anyway";
}

TEST(GroundFilter, FindsTheGroundOfACityOfBlocks) {
  for (const double density : {1.0, 4.0}) {
    BlockCityOptions options;
    options.seed = test_seed();
    options.points_per_m2 = density;
    SyntheticCity city = synthetic_block_city(options);
    const auto truth = city.points.classification;
    std::fill(city.points.classification.begin(), city.points.classification.end(),
              kNeverClassified);
    const auto found = filter_ground(city.points, city.footprints);
    const Mistakes wrong = mistakes(city.points, found, [&](std::size_t p) {
      return truth[p] == kGround || truth[p] == kWater;
    });
    EXPECT_LT(wrong.missed, 0.05) << density;
    EXPECT_LT(wrong.taken, 0.07) << density;
  }
}

TEST(GroundFilter, HillsStayAndBuildingsGoOnSlopes) {
  const auto hills = [](double x, double y) {
    return 80 + 6 * std::sin(x / 30) + 5 * std::cos(y / 26);  // up to 15 degrees
  };
  const std::vector<Polygon> buildings = {box(20, 20, 40, 50), box(60, 30, 90, 55),
                                          box(100, 90, 112, 130)};
  const PointCloud cloud = scan(160, 3, buildings, 8, hills);
  const auto found = filter_ground(cloud, {});
  const Mistakes wrong = mistakes(
      cloud, found, [&](std::size_t p) { return cloud.z[p] < hills(cloud.x[p], cloud.y[p]) + 4; });
  EXPECT_LT(wrong.missed, 0.02);
  EXPECT_LT(wrong.taken, 0.001);
}

/// Narrower than the window and steeper than the slope, but no walls; houses on and beside them, in
/// no footprint, have walls and go. A bridge is held by its ends only.
TEST(GroundFilter, BanksDykesAndRidgesStayAndWhatStandsThereGoes) {
  struct Rise {
    const char* name;
    std::function<double(double, double)> height;
  };
  const auto bank = [](double crest, double top, double run) {
    return [=](double, double y) {
      return std::clamp((crest / 2 + run - std::abs(y - 80)) / run * top, 0.0, top);
    };
  };
  const std::vector<Rise> rises = {
      {"bank", bank(12, 4, 8)},
      {"dyke", bank(20, 5, 10)},
      {"ridge", bank(0, 15, 30)},
      {"cone",
       [](double x, double y) { return std::max(0.0, 15 - 0.5 * std::hypot(x - 80, y - 80)); }},
  };
  const std::vector<Polygon> houses = {box(20, 75, 32, 85), box(60, 30, 75, 45),
                                       box(110, 73, 118, 84)};
  for (const Rise& rise : rises) {
    SCOPED_TRACE(::testing::Message() << rise.name << ", seed " << test_seed());
    const auto ground = [&](double x, double y) { return 3 + rise.height(x, y); };
    const PointCloud cloud = scan(160, 4, houses, 6, ground);
    const auto found = filter_ground(cloud, {});
    const Mistakes wrong = mistakes(cloud, found, [&](std::size_t p) {
      return cloud.z[p] < ground(cloud.x[p], cloud.y[p]) + 3;
    });
    EXPECT_LT(wrong.missed, 0.03);
    EXPECT_LT(wrong.taken, 0.01);
  }
  // A hedge, a row of cars, a terrace: no step that a slope has not, but no rise within either.
  const std::vector<Polygon> low = {box(30, 30, 90, 33), box(100, 40, 112, 52)};
  const PointCloud flat = scan(160, 4, low, 1.3, [](double, double) { return 3.0; });
  const Mistakes off =
      mistakes(flat, filter_ground(flat, {}), [&](std::size_t p) { return flat.z[p] < 3.6; });
  EXPECT_LT(off.missed, 0.01);
  EXPECT_LT(off.taken, 0.01);
  // A deck of 8 m width, 5 m above a canal, level with its banks.
  const std::vector<Polygon> deck = {box(76, 60, 84, 100)};
  const auto canal = [](double, double y) { return y > 60 && y < 100 ? -5.0 : 0.0; };
  const PointCloud cloud = scan(160, 4, deck, 5, canal);
  const auto found = filter_ground(cloud, {});
  const Mistakes wrong = mistakes(cloud, found, [&](std::size_t p) {
    return !contains(deck[0], {cloud.x[p], cloud.y[p]});
  });
  EXPECT_LT(wrong.taken, 0.2);  // its ends, level with the banks
}

/// What is low and narrow, closer to the next such place than the window is wide, makes no object
/// of the ground between.
TEST(GroundFilter, LightWellsStairsAreawaysAndDitchesLeaveTheGroundAround) {
  struct Hollow {
    const char* name;
    double per_m2;
    std::function<bool(double, double)> here;
    double depth;
  };
  const auto every = [](double x, double pitch, double width) {
    return std::fmod(x, pitch) < width;
  };
  std::vector<Polygon> row;
  for (int k = 0; k < 6; ++k) row.push_back(box(12 + 24 * k, 20, 34 + 24 * k, 30));
  const auto at_row = [](double x, double y) {
    return x > 12 && x < 154 && ((y > 18 && y < 20) || (y > 30 && y < 32));
  };
  const std::vector<Hollow> hollows = {
      {"light wells", 8, [&](double x, double y) { return every(x, 22, 2) && every(y, 25, 2); }, 3},
      {"basement stairs", 8,
       [&](double x, double y) { return every(x, 18, 4) && every(y, 25, 1.4); }, 2.6},
      {"ditches", 2, [&](double x, double) { return every(x, 26, 3); }, 2.5},
      {"areaways", 8, at_row, 3},
  };
  for (const Hollow& hollow : hollows) {
    SCOPED_TRACE(hollow.name);
    const auto ground = [&](double x, double y) {
      return 10 + 0.01 * x - (hollow.here(x, y) ? hollow.depth : 0);
    };
    const bool houses = std::string(hollow.name) == "areaways";
    const std::vector<Polygon> footprints = houses ? row : std::vector<Polygon>{};
    const PointCloud cloud = scan(160, hollow.per_m2, footprints, 8, ground);
    const auto found = filter_ground(cloud, footprints);
    const Mistakes wrong = mistakes(cloud, found, [&](std::size_t p) {
      return cloud.z[p] < 14 && !hollow.here(cloud.x[p], cloud.y[p]);
    });
    EXPECT_LT(wrong.missed, 0.05);
  }
}

/// The ground between them is low and narrow, too, but it is most of what there is.
TEST(GroundFilter, FieldsOfLowObjectsInNoFootprintAreNoGround) {
  struct Field {
    const char* name;
    double per_m2;
    double height;
    std::function<bool(double, double)> here;
  };
  const auto within = [](double v, double pitch, double width) {
    return v > 0 && v < 120 && std::fmod(v, pitch) < width;
  };
  const std::vector<Field> fields = {
      {"garages", 8, 2.6,
       [&](double x, double y) { return within(x, 121, 120) && within(y, 12, 6); }},
      {"sheds", 8, 2.5, [&](double x, double y) { return within(x, 7, 4) && within(y, 7, 4); }},
      {"hedges", 8, 2, [&](double x, double y) { return within(x, 121, 120) && within(y, 3, 1); }},
      {"greenhouses", 4, 3.2,
       [&](double x, double y) { return within(x, 33, 30) && within(y, 11, 8); }},
  };
  for (const Field& field : fields) {
    SCOPED_TRACE(field.name);
    const auto ground = [](double x, double y) { return 10 + 0.01 * x - 0.02 * y; };
    const auto is_object = [&](double x, double y) { return field.here(x - 20, y - 20); };
    const PointCloud cloud = scan(160, field.per_m2, {}, 0, [&](double x, double y) {
      return ground(x, y) + (is_object(x, y) ? field.height : 0);
    });
    const auto found = filter_ground(cloud, {});
    const Mistakes wrong =
        mistakes(cloud, found, [&](std::size_t p) { return !is_object(cloud.x[p], cloud.y[p]); });
    EXPECT_LT(wrong.taken, 0.02);
    EXPECT_LT(wrong.missed, 0.02);
  }
}

TEST(GroundFilter, SteepRidgesStayWithTheHousesOnThem) {
  for (const double per_m2 : {0.5, 2.0, 8.0}) {
    SCOPED_TRACE(per_m2);
    // 45 degrees where points are dense enough for that.
    const double run = per_m2 < 1 ? 30 : 20;
    const auto ridge = [&](double x, double) {
      return std::clamp(20 - (std::abs(x - 100) - 10) * 20 / run, 0.0, 20.0);
    };
    std::vector<Polygon> houses;
    for (int k = 0; k < 8; ++k) houses.push_back(box(95, 6 + 24 * k, 104, 18 + 24 * k));
    const PointCloud cloud = scan(200, per_m2, houses, 6, ridge);
    const auto found = filter_ground(cloud, houses);
    const Mistakes wrong = mistakes(cloud, found, [&](std::size_t p) {
      return cloud.z[p] < ridge(cloud.x[p], cloud.y[p]) + 3;
    });
    EXPECT_LT(wrong.missed, per_m2 < 1 ? 0.4 : 0.12);
    EXPECT_LT(wrong.taken, 0.02);
  }
}

/// A podium of one storey between houses with footprints: these say nothing, and the openings
/// leave what is near their walls.
TEST(GroundFilter, APodiumBetweenFootprintsIsNoGround) {
  SCOPED_TRACE(test_seed());
  const std::vector<Polygon> houses = {box(40, 40, 100, 58), box(40, 66, 100, 84),
                                       box(40, 58, 62, 66), box(68, 58, 100, 66)};
  const Polygon podium = box(62, 58, 68, 66);
  PointCloud cloud = scan(140, 4, houses, 12, [](double, double) { return 1; });
  for (std::size_t p = 0; p < cloud.size(); ++p)
    if (contains(podium, {cloud.x[p], cloud.y[p]})) cloud.z[p] = cloud.z[p] + 3;
  const auto found = filter_ground(cloud, houses);
  const Mistakes wrong = mistakes(cloud, found, [&](std::size_t p) { return cloud.z[p] < 2; });
  EXPECT_EQ(wrong.taken, 0);
  EXPECT_EQ(wrong.missed, 0);
}

/// On a slope most of the ground near a small yard may lie lower.
TEST(GroundFilter, YardsOnSlopesAreGround) {
  SCOPED_TRACE(test_seed());
  const Polygon block{{{50, 60}, {110, 60}, {110, 90}, {50, 90}},
                      {{{74, 68}, {74, 76}, {80, 76}, {80, 68}}}};
  for (const double slope : {0.15, 0.3}) {
    const PointCloud cloud = scan(160, 4, {block}, 9, [&](double, double y) { return slope * y; });
    const auto found = filter_ground(cloud, std::vector<Polygon>{block});
    std::ptrdiff_t yard = 0, kept = 0;
    for (std::size_t p = 0; p < cloud.size(); ++p) {
      if (!(cloud.x[p] > 74 && cloud.x[p] < 80 && cloud.y[p] > 68 && cloud.y[p] < 76)) continue;
      ++yard;
      kept += found[p];
    }
    EXPECT_GT(kept, 0.95 * static_cast<double>(yard)) << slope;
  }
}

/// Cells without points cut slopes into pieces that are no scraps.
TEST(GroundFilter, HillsStayInSparseClouds) {
  SCOPED_TRACE(test_seed());
  const auto hill = [](double x, double y) {
    return std::max(0.0, 12 - 0.2 * std::hypot(x - 80, y - 80));
  };
  const PointCloud cloud = scan(160, 0.4, {}, 0, hill);
  const auto found = filter_ground(cloud, {});
  EXPECT_LT(mistakes(cloud, found, [](std::size_t) { return true; }).missed, 0.01);
}

/// Two flats with a wall between them slope as a whole, the more the smaller the domain is.
TEST(GroundFilter, TopsOfRockWallsStay) {
  const std::vector<Polygon> houses = {box(25, 50, 35, 60), box(64, 50, 72, 60)};
  for (const double size : {120.0, 200.0}) {
    for (const double height : {12.0, 24.0}) {
      for (const double per_m2 : {2.0, 8.0}) {
        SCOPED_TRACE(::testing::Message() << size << " m, wall of " << height << " m, " << per_m2
                                          << " points/m2, seed " << test_seed());
        const auto ground = [&](double x, double) { return std::clamp(x - 60, 0.0, 1.0) * height; };
        const PointCloud cloud = scan(size, per_m2, houses, 7, ground);
        const auto found = filter_ground(cloud, houses);
        const auto is_top = [&](std::size_t p) {
          return cloud.x[p] > 61 && std::abs(cloud.z[p] - height) < 1;
        };
        double top = 0, missed = 0;
        for (std::size_t p = 0; p < cloud.size(); ++p) {
          if (!is_top(p)) continue;
          top += 1;
          missed += found[p] == 0 ? 1 : 0;
        }
        EXPECT_LT(missed / top, 0.04);
      }
    }
  }
}

/// The uphill rim has nothing higher beside it that an opening could come down from.
TEST(GroundFilter, SlopesStayWholeUpToTheirRim) {
  for (const double slope : {0.3, 1.0}) {
    const PointCloud cloud =
        scan(200, 2, {}, 0, [&](double x, double y) { return slope * (0.8 * x + 0.6 * y); });
    const auto found = filter_ground(cloud, {});
    const auto left_out = std::count(found.begin(), found.end(), std::uint8_t{0});
    EXPECT_LT(left_out, static_cast<std::ptrdiff_t>(cloud.size() / 100)) << slope;
  }
}

TEST(GroundFilter, WindowOrFootprintsDecideAboutWideHalls) {
  const std::vector<Polygon> hall = {box(60, 60, 180, 180)};
  const auto flat = [](double x, double) { return 0.01 * x; };
  const PointCloud cloud = scan(240, 1, hall, 9, flat);
  const auto taken = [&](const std::vector<std::uint8_t>& found) {
    return mistakes(cloud, found, [&](std::size_t p) { return cloud.z[p] < 5; }).taken;
  };
  GroundFilterOptions wide;
  wide.window = 80;
  EXPECT_GT(taken(filter_ground(cloud, {})), 0.5) << "no filter knows a mesa from a hall";
  EXPECT_EQ(taken(filter_ground(cloud, {}, wide)), 0);
  EXPECT_EQ(taken(filter_ground(cloud, hall)), 0);
}

TEST(GroundFilter, AnUndergroundStationIsGround) {
  const std::vector<Polygon> station = {box(40, 20, 60, 110)};
  const PointCloud cloud = scan(130, 2, {}, 0, [](double x, double) { return 2 + 0.02 * x; });
  const auto found = filter_ground(cloud, station);
  EXPECT_EQ(std::count(found.begin(), found.end(), 1), static_cast<std::ptrdiff_t>(cloud.size()));
}

TEST(GroundFilter, FootprintsOverEverythingAreNotBelieved) {
  const std::vector<Polygon> all = {box(-100, -100, 300, 300)};
  const PointCloud cloud = scan(50, 2, {}, 0, [](double, double) { return 2; });
  const auto found = filter_ground(cloud, all);
  EXPECT_EQ(std::count(found.begin(), found.end(), 1), static_cast<std::ptrdiff_t>(cloud.size()));
}

/// Differences of coordinates overflow there, and what comes of it is no place in a row of cells.
TEST(GroundFilter, FootprintsWithAbsurdCoordinatesDoNoHarm) {
  const PointCloud cloud = scan(60, 2, {}, 0, [](double, double) { return 0.0; });
  const auto plain = filter_ground(cloud, {});
  constexpr double inf = std::numeric_limits<double>::infinity();
  for (const double far : {1e300, 1e307, 1e308, 1.7e308, inf, std::nan("")}) {
    SCOPED_TRACE(far);
    const std::vector<Polygon> footprints = {
        {{{far, -far}, {-far, far}, {0, far / 2}}, {}},
        {{{-far, -far}, {far, far}, {-far, far / 3}}, {}},
        {{{0, -far}, {0, far}, {far, 0}, {-far, 10}}, {}},
        {{{far, -far}, {far, far}, {-far, far}, {-far, -far}}, {{{10, 10}, {far, 20}, {20, 10}}}}};
    EXPECT_EQ(filter_ground(cloud, footprints), plain);
  }
}

TEST(GroundFilter, BuildingsAtTheWaterAndAtTheRimDoNotLeanOnVoids) {
  // A canal without returns along x = 60..80, houses right at it and at the rim of the cloud.
  const std::vector<Polygon> houses = {box(42, 20, 60, 100), box(80, 30, 95, 90), box(0, 0, 25, 18),
                                       box(125, 50, 140, 80)};
  PointCloud all = scan(140, 3, houses, 10, [](double, double) { return 1; });
  PointCloud cloud;
  for (std::size_t p = 0; p < all.size(); ++p)
    if (all.x[p] < 60 || all.x[p] > 80) add(cloud, all.x[p], all.y[p], all.z[p]);
  const auto found = filter_ground(cloud, {});
  const Mistakes wrong = mistakes(cloud, found, [&](std::size_t p) { return cloud.z[p] < 5; });
  EXPECT_EQ(wrong.taken, 0);
  EXPECT_LT(wrong.missed, 0.001);
}

TEST(GroundFilter, PitsAndBirdsPullNothing) {
  PointCloud cloud =
      scan(100, 2, {box(30, 30, 50, 60)}, 7, [](double x, double) { return x / 50; });
  const auto good = filter_ground(cloud, {});
  const std::size_t before = cloud.size();
  add(cloud, 20, 20, -60);
  add(cloud, 40, 45, -5);  // within the building
  add(cloud, 70.2, 70.2, -3);
  add(cloud, 70.9, 70.8, -3.4);
  add(cloud, 80, 20, 1e5);
  auto found = filter_ground(cloud, {});
  for (std::size_t p = before; p < cloud.size(); ++p) EXPECT_EQ(found[p], 0) << p;
  found.resize(before);
  EXPECT_EQ(found, good);
}

/// Points below the ground as multiple echoes leave them, some by two and three; returns the index
/// of the first.
std::size_t add_pits(PointCloud& cloud, double size, double per_100_m2, double deepest,
                     const std::function<double(double, double)>& ground) {
  std::mt19937 random(test_seed() + 1);
  std::uniform_real_distribution<double> along(0, size), depth(2, deepest), near(-1, 1);
  std::discrete_distribution<int> more({8, 1, 1});
  const std::size_t before = cloud.size();
  const auto all = before + static_cast<std::size_t>(per_100_m2 * size * size / 100);
  while (cloud.size() < all) {
    const double x = along(random), y = along(random), down = depth(random);
    add(cloud, x, y, ground(x, y) - down);
    for (int k = more(random); k > 0; --k)
      add(cloud, x + near(random), y + near(random), ground(x, y) - down + 0.3 * near(random));
  }
  return before;
}

/// So many that within 10 m each has others at its level or below.
TEST(GroundFilter, ManyPitsPullNothing) {
  SCOPED_TRACE(test_seed());
  const auto gentle = [](double x, double y) { return 20 + 0.02 * x + 0.5 * std::sin(y / 30); };
  const std::vector<Polygon> houses = {box(30, 30, 50, 45), box(70, 30, 82, 60),
                                       box(30, 75, 60, 87)};
  for (const double per_m2 : {2.0, 8.0, 20.0}) {
    for (const double deepest : {20.0, 100.0}) {
      for (const double pits : {1.3, 5.0}) {
        for (const bool known : {true, false}) {
          PointCloud cloud = scan(110, per_m2, houses, 7, gentle);
          const std::size_t first = add_pits(cloud, 110, pits, deepest, gentle);
          const auto found = filter_ground(cloud, known ? houses : std::vector<Polygon>{});
          double missed = 0, ground = 0;
          for (std::size_t p = 0; p < first; ++p) {
            if (cloud.z[p] > gentle(cloud.x[p], cloud.y[p]) + 3) continue;
            ground += 1;
            missed += found[p] == 0 ? 1 : 0;
          }
          const auto taken = std::count(found.begin() + static_cast<std::ptrdiff_t>(first),
                                        found.end(), std::uint8_t{1});
          const std::string name = "points " + std::to_string(per_m2) + ", deepest " +
                                   std::to_string(deepest) + ", pits " + std::to_string(pits);
          EXPECT_LT(missed / ground, 0.02) << name;
          EXPECT_LT(static_cast<double>(taken), 0.06 * static_cast<double>(cloud.size() - first))
              << name;
        }
      }
    }
  }
}

/// What is low and narrow is no pit.
TEST(GroundFilter, LowPlacesAreGround) {
  SCOPED_TRACE(test_seed());
  struct Place {
    const char* name;
    double low;  ///< What is lower counts.
    std::function<double(double, double)> ground;
  };
  const auto within = [](double v, double from, double to) { return v > from && v < to; };
  const std::vector<Place> places = {
      {"shaft", -7, [](double x, double y) { return std::hypot(x - 60, y - 60) < 4 ? -8.0 : 0; }},
      {"quarry", -4, [](double x, double) { return x < 61.3 ? 0.0 : -20; }},
      {"canal", -2, [&](double x, double y) { return within(x - 0.3 * y, 40, 44) ? -3.0 : 0; }},
      {"underpass", -2,
       [&](double x, double y) {
         return within(y, 55, 62) ? -std::clamp(6 - std::abs(x - 60) / 8, 0.0, 5.0) : 0;
       }},
      {"lane", 2, [&](double x, double y) { return within(x, 60, 62) || y < 20 ? 0.0 : 9; }},
      {"hillside", 200, [](double x, double y) { return 0.8 * x + 0.6 * y; }},
      {"valley", 200, [](double x, double y) { return std::abs(0.12 * x + 0.09 * y - 12); }},
  };
  for (const Place& place : places) {
    for (const double per_m2 : {0.5, 2.0, 20.0}) {
      const PointCloud cloud = scan(120, per_m2, {}, 0, place.ground);
      const auto found = filter_ground(cloud, {});
      double missed = 0, low = 0;
      for (std::size_t p = 0; p < cloud.size(); ++p) {
        if (cloud.z[p] > place.low) continue;
        low += 1;
        missed += found[p] == 0 ? 1 : 0;
      }
      EXPECT_LT(missed / low, per_m2 < 1 ? 0.06 : 0.03) << place.name << ", " << per_m2;
    }
  }
}

TEST(GroundFilter, LooksAtTheClassesGivenOnly) {
  PointCloud cloud;
  const std::uint8_t codes[] = {0, 1, 2, 5, 6, 12, 17, 64};
  for (int k = 0; k < 800; ++k) add(cloud, k % 40, k / 40, 1, codes[k % 8]);
  const auto found = filter_ground(cloud, {});
  for (std::size_t p = 0; p < cloud.size(); ++p) {
    const int code = cloud.classification[p];
    EXPECT_EQ(found[p], code == 0 || code == 1 || code == 12 ? 1 : 0) << code;
  }
}

TEST(GroundFilter, AHandfulOfPointsIsNoReasonToFail) {
  PointCloud cloud;
  EXPECT_TRUE(filter_ground(cloud, {}).empty());
  add(cloud, 5, 5, 3);
  EXPECT_EQ(filter_ground(cloud, {}), std::vector<std::uint8_t>{1});
  add(cloud, 500, 900, 3);
  EXPECT_EQ(filter_ground(cloud, {}), (std::vector<std::uint8_t>{1, 1}));
}

TEST(GroundFilter, TheSameForAnyNumberOfThreadsAndStopsWhenAsked) {
  const PointCloud cloud = scan(150, 2, {box(30, 30, 50, 60)}, 7, [](double x, double y) {
    return std::sin(x / 20) * std::sin(y / 20);
  });
  std::vector<std::uint8_t> one;
  {
    const ThreadLimit limit(1);
    one = filter_ground(cloud, {});
  }
  const ThreadLimit limit(4);
  double last = -1;
  EXPECT_EQ(filter_ground(cloud, {}, {},
                          {[&](double fraction) {
                             EXPECT_GE(fraction, last);
                             last = fraction;
                           },
                           {}}),
            one);
  EXPECT_EQ(last, 1);
  EXPECT_THROW(filter_ground(cloud, {}, {}, {{}, [] { return true; }}), Cancelled);
}

}  // namespace
}  // namespace tetropolis
