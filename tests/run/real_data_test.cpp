// The pipeline on the real cities, with the figures that are known of them.
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/run/run.h"

#include "support/guarantees.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

struct RealCase {
  const char* name;
  const char* footprints;
  std::vector<const char*> points;
  const char* points_crs;
  std::int64_t points_read;
  std::int64_t footprints_read;
  bool has_building_class;
  double most_area_moved;  // by simplification, as a share; measured, rounded up
};

void PrintTo(const RealCase& city, std::ostream* out) { *out << city.name; }

const RealCase kCases[] = {
    {"Delft",
     "delft_3dfier/footprints.shp",
     {"delft_3dfier/ahn3_cropped_1.laz", "delft_3dfier/ahn3_cropped_2.laz"},
     "",
     848942,
     160,
     true,
     0.016},
    {"AmsterdamAhn3",
     "amsterdam_south/footprints.shp",
     {"amsterdam_south/ahn3"},
     "",
     798958,
     800,
     true,
     0.003},
    {"AmsterdamAhn2",
     "amsterdam_south/footprints.gpkg",
     {"amsterdam_south/ahn2"},
     "",
     873656,
     800,
     false,
     0.003},
    {"AmsterdamSparse",
     "amsterdam_south/footprints.gpkg",
     {"amsterdam_south/ahn3_sparse/c_25gn1_b.laz"},
     "",
     166586,
     800,
     true,
     0.003},
    {"Alexandria",
     "alexandria_dsm_dtm/buildings_wgs84.shp",
     {"alexandria_dsm_dtm/pseudo_points_from_dsm_dtm.las"},
     "EPSG:26918",
     73021,
     84,
     false,
     0.0014},
    {"DtccMinimal",
     "dtcc_small/MinimalCase_PropertyMap.shp",
     {"dtcc_small/MinimalCase_pointcloud.las"},
     "",
     8148,
     3,
     false,
     0.04},
};

class RealData : public ::testing::TestWithParam<RealCase> {};

TEST_P(RealData, BuildsAMeshThatHoldsEveryGuarantee) {
  const RealCase& real = GetParam();
  TETROPOLIS_REQUIRE_DATA(footprints, real.footprints);
  const testing::TemporaryFolder scratch;
  Config config;
  config.footprints = {footprints.string()};
  for (const char* points : real.points)
    config.points.push_back(testing::data_path(points).string());
  config.points_crs = real.points_crs;
  config.out = (scratch / "out").string();
  const Report report = run_build(config);
  testing::expect_guarantees(config.out);
  EXPECT_EQ(report.input->points_read, real.points_read);
  EXPECT_EQ(report.input->footprints_read, real.footprints_read);
  bool by_exclusion = false;
  for (const Warning& warning : report.warnings)
    by_exclusion |= warning.code == "no_building_class";
  EXPECT_EQ(by_exclusion, !real.has_building_class);
  const CityModel city = read_city(scratch / "out/city.city.json");
  std::size_t accounted = city.dropped.size();
  for (const Building& building : city.buildings) accounted += building.source_ids.size();
  EXPECT_EQ(static_cast<std::int64_t>(accounted), report.input->footprint_parts);
  EXPECT_GE(report.city->min_clearance, 1.0 - 1e-9);
  // Simplification moves little of what was there.
  EXPECT_LT(report.city->area_moved, real.most_area_moved * report.city->area_before)
      << report.city->area_moved / report.city->area_before;
}

INSTANTIATE_TEST_SUITE_P(Cities, RealData, ::testing::ValuesIn(kCases),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace tetropolis
