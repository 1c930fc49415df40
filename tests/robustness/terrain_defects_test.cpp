// The same small city on ground that is steep, stepped, wet, low or high.
#include <algorithm>
#include <cmath>
#include <ostream>

#include <gtest/gtest.h>

#include "defect_city.h"
#include "support/test_data.h"

namespace tetropolis::testing {
namespace {

std::vector<std::string> ids_of(const DefectCity& city) {
  std::vector<std::string> ids;
  for (const House& house : city.houses) ids.push_back(house.id);
  return ids;
}

struct TerrainRow {
  std::string name;
  std::function<double(double, double)> ground;
  std::function<int(double, double)> ground_class = [](double, double) { return 2; };
  bool lowered = false;    ///< Some ground at walls lies above its roof.
  double h_ground = 0;     ///< Of the patient: the 10th percentile of the ground around it,
  double within = 0.5;     ///< known by hand so well.
  double roof_above = 12;  ///< Of the patient's roof above the ground at its first corner.
};

void PrintTo(const TerrainRow& row, std::ostream* out) { *out << row.name; }

bool in_water(double x, double y) {
  // A canal past the patient's northern wall, 6 m wide, and a lake around an island with the shed.
  if (y > 67 && y < 73) return true;
  const double r = std::hypot(x - 63, y - 22.5);
  return r > 6 && r < 14;
}

std::vector<TerrainRow> rows() {
  std::vector<TerrainRow> result;
  result.push_back({"SlopeOf45Degrees", [](double x, double) { return x; }});
  result.back().h_ground = 60;
  result.back().within = 2.5;
  result.back().lowered = true;  // 24 m wide, 12 m high, set into the slope
  result.push_back(
      {"SlopeOf45DegreesDiagonally", [](double x, double y) { return (x + y) / std::sqrt(2.0); }});
  result.back().h_ground = 115 / std::sqrt(2.0);
  result.back().within = 2;
  result.back().lowered = true;
  result.push_back(
      {"QuarryWallOf20MThroughABuilding", [](double x, double) { return x < 72 ? 20.0 : 40.0; }});
  result.back().h_ground = 20;
  result.back().lowered = true;  // the roof is at 32 m, the upper ground at 40 m
  result.push_back({"PitBelowABuilding", [](double x, double y) {
                      return x > 66 && x < 110 && y > 45 && y < 70 ? -15.0 : 20.0;
                    }});
  result.back().h_ground = -15;
  result.push_back({"RoofBelowTheUphillTerrain", [](double x, double y) {
                      return 20 + 60 / (1 + std::exp((y - 64) / -2)) + 0 * x;
                    }});
  result.back().h_ground = 20;
  result.back().within = 1;
  result.back().lowered = true;
  result.push_back({"IslandsAndCanals",
                    [](double x, double y) { return in_water(x, y) ? 18.5 : 20.0; },
                    [](double x, double y) { return in_water(x, y) ? 9 : 2; }});
  result.back().h_ground = 20;
  result.push_back({"CanalsWithoutPoints", [](double, double) { return 20.0; },
                    [](double x, double y) { return in_water(x, y) ? 0 : 2; }});
  result.back().h_ground = 20;
  result.push_back({"FiveMetresBelowTheSea", [](double x, double) { return -5 + 0.001 * x; }});
  result.back().h_ground = -5;
  result.push_back({"At2500Metres", [](double x, double y) { return 2500 + 0.1 * x + 0.05 * y; }});
  result.back().h_ground = 2508.5;
  result.back().within = 1;
  result.push_back({"TheDeadSea", [](double, double) { return -430.0; }});
  result.back().h_ground = -430;
  result.push_back({"PerfectlyFlatAtZero", [](double, double) { return 0.0; }});
  result.push_back(
      {"Spikes", [](double x, double y) { return std::fmod(x + 3 * y, 17) < 1 ? 45.0 : 20.0; }});
  result.back().h_ground = 20;
  result.back().lowered = true;
  return result;
}

class TerrainDefect : public ::testing::TestWithParam<TerrainRow> {};

TEST_P(TerrainDefect, GivesASoundMeshWithTheHeightsOfTheScan) {
  const TerrainRow& row = GetParam();
  const TemporaryFolder folder;
  DefectCity city = defect_city();
  city.ground = row.ground;
  city.ground_class = row.ground_class;
  write_input(city, sound_features(city), folder.path());
  const Outcome outcome = build(small_config(city, folder.path()), ids_of(city));
  ASSERT_EQ(outcome.error, "");
  EXPECT_EQ(outcome.city.buildings.size(), city.houses.size());
  EXPECT_TRUE(outcome.city.dropped.empty());
  EXPECT_EQ(outcome.report.volume_mesh->ground_lowered > 0, row.lowered);
  EXPECT_EQ(outcome.has_warning("ground_lowered"), row.lowered);
  const Building* patient = outcome.building_of("patient");
  ASSERT_NE(patient, nullptr);
  EXPECT_NEAR(patient->h_ground, row.h_ground, row.within);
  // LAS rounds to millimetres.
  EXPECT_NEAR(patient->h_roof,
              std::max(row.ground(60, 50) + row.roof_above, patient->h_ground + 2.5), 0.001);
  for (const SolverFacts& step : outcome.report.solver) EXPECT_TRUE(step.converged);
}

std::string terrain_name_of(const ::testing::TestParamInfo<TerrainRow>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(Terrains, TerrainDefect, ::testing::ValuesIn(rows()), terrain_name_of);

}  // namespace
}  // namespace tetropolis::testing
