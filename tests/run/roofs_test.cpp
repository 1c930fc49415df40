// Roofs of real cities: their guarantees by brute force, and how well they fit.
#include "tetropolis/city/roofs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/run/in_memory.h"

#include "support/test_data.h"

namespace tetropolis {
namespace {

struct Target {
  const char* name;
  const char* footprints;
  std::vector<const char*> points;
  Lod lod;
  double rmse_median, rmse_p90;  ///< Metres, at most.
  double volume;                 ///< Off the points', share, at most.
};

void PrintTo(const Target& target, std::ostream* out) { *out << target.name; }

CityModel city_of(const Target& target, int threads, RoofFacts& facts) {
  Config config;
  config.footprints = {testing::data_path(target.footprints).string()};
  for (const char* points : target.points)
    config.points.push_back(testing::data_path(points).string());
  config.lod = target.lod;
  config.threads = threads;
  CityInMemory made = make_city(config);
  facts = made.built.facts.roofs;
  return std::move(made.built.city);
}

using Vertex = std::pair<double, double>;
using Side = std::pair<Vertex, Vertex>;

/// All sides of all rings of all parts and footprints, each once.
struct Lines {
  std::set<Vertex> vertices;
  std::set<Side> sides;
  void add(const Polygon& polygon) {
    for_each_edge(polygon, [&](Point2 a, Point2 b) {
      const Vertex p{a.x, a.y}, q{b.x, b.y};
      vertices.insert(p);
      sides.insert(std::minmax(p, q));
    });
  }
};

double least_distance(const Lines& lines, double reach) {
  double least = reach;
  for (const auto& [p, q] : lines.sides) {
    const double west = std::min(p.first, q.first) - reach,
                 east = std::max(p.first, q.first) + reach;
    for (auto v = lines.vertices.lower_bound({west, -1e9}); v != lines.vertices.end(); ++v) {
      if (v->first > east) break;
      if (*v == p || *v == q) continue;
      least = std::min(least, distance_to_segment({v->first, v->second}, {p.first, p.second},
                                                  {q.first, q.second}));
    }
  }
  return least;
}

class RealRoofs : public ::testing::TestWithParam<Target> {};

TEST_P(RealRoofs, KeepTheirGuaranteesAndFit) {
  const Target& target = GetParam();
  TETROPOLIS_REQUIRE_DATA(folder, target.footprints);
  RoofFacts facts, again;
  const CityModel city = city_of(target, 1, facts);
  EXPECT_TRUE(part_defects(city.buildings, 1).empty()) << part_defects(city.buildings, 1).front();

  Lines lines;
  for (const Building& building : city.buildings) {
    lines.add(building.footprint);
    double sum = 0;
    for (const RoofPart& part : building.parts) {
      lines.add(part.outline);
      sum += area(part.outline);
      EXPECT_GE(area(part.outline), 2);
      for (const Point2 p : part.outline.outer)
        EXPECT_GE(part.roof(p), building.h_ground + 2.5 - 0.002) << building.id;
    }
    EXPECT_NEAR(sum, area(building.footprint), 1e-9 * sum) << building.id;
  }
  EXPECT_GE(least_distance(lines, 2), 1 - 1e-9);
  for (const auto& [x, y] : lines.vertices)
    EXPECT_GE(city.domain.distance_to_boundary({x, y}), 1 - 1e-9);

  EXPECT_EQ(facts.undivided, 0);
  EXPECT_LT(facts.rmse_median, target.rmse_median);
  EXPECT_LT(facts.rmse_p90, target.rmse_p90);
  EXPECT_LT(std::abs(facts.volume / facts.volume_of_points - 1), target.volume);
  EXPECT_LE(static_cast<double>(facts.fallbacks), 0.05 * static_cast<double>(facts.parts));

  const CityModel other = city_of(target, 4, again);
  ASSERT_EQ(other.buildings.size(), city.buildings.size());
  for (const BuildingIndex b : city.buildings.indices()) {
    const Building& one = city.buildings[b];
    const Building& two = other.buildings[b];
    EXPECT_EQ(one.footprint, two.footprint);
    ASSERT_EQ(one.parts.size(), two.parts.size());
    for (std::size_t k = 0; k < one.parts.size(); ++k) {
      EXPECT_EQ(one.parts[k].outline, two.parts[k].outline);
      EXPECT_EQ(one.parts[k].roof, two.parts[k].roof);
      EXPECT_EQ(one.parts[k].source_id, two.parts[k].source_id);
    }
  }
}

constexpr const char* kDelft = "roofs/delft/footprints.gpkg";
constexpr const char* kAmsterdam = "roofs/amsterdam_south/footprints.gpkg";
const std::vector<const char*> kDelftPoints{"delft_3dfier/ahn3_cropped_1.laz",
                                            "delft_3dfier/ahn3_cropped_2.laz"};

// Measured, rounded up.
INSTANTIATE_TEST_SUITE_P(
    Cities, RealRoofs,
    ::testing::Values(
        Target{"Delft12", kDelft, kDelftPoints, Lod::k1_2, 1.7, 3.0, 0.12},
        Target{"Delft13", kDelft, kDelftPoints, Lod::k1_3, 0.85, 1.45, 0.05},
        Target{"Delft22", kDelft, kDelftPoints, Lod::k2_2, 0.46, 1.1, 0.03},
        Target{"Amsterdam22", kAmsterdam, {"amsterdam_south/ahn3"}, Lod::k2_2, 1.2, 2.3, 0.06}),
    [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace tetropolis
