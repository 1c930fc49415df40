#include "tetropolis/io/raster/elevation.h"

#include <algorithm>
#include <array>
#include <vector>

#include <gdal.h>
#include <gtest/gtest.h>
#include <ogr_srs_api.h>

#include "support/test_data.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;

/// Heights of 30, whatever that is. `unit`: of the band, or empty.
void write_heights(const fs::path& path, const char* crs, const char* unit) {
  GDALAllRegister();
  GDALDatasetH file =
      GDALCreate(GDALGetDriverByName("GTiff"), path.c_str(), 8, 8, 1, GDT_Float32, nullptr);
  ASSERT_NE(file, nullptr);
  OGRSpatialReferenceH srs = OSRNewSpatialReference(nullptr);
  ASSERT_EQ(OSRSetFromUserInput(srs, crs), OGRERR_NONE);
  GDALSetSpatialRef(file, srs);
  OSRDestroySpatialReference(srs);
  std::array<double, 6> transform{980'000, 3, 0, 200'000, 0, -3};
  GDALSetGeoTransform(file, transform.data());
  std::vector<float> values(64, 30);
  GDALRasterBandH band = GDALGetRasterBand(file, 1);
  ASSERT_EQ(GDALRasterIO(band, GF_Write, 0, 0, 8, 8, values.data(), 8, 8, GDT_Float32, 0, 0),
            CE_None);
  if (*unit != '\0') GDALSetRasterUnitType(band, unit);
  GDALClose(file);
}

TEST(Elevation, UnitsOfHeightsAreThoseStatedOrThoseOfTheCoordinates) {
  const testing::TemporaryFolder folder;
  const fs::path path = folder / "dtm.tif";
  struct Case {
    const char* crs;
    const char* unit;
    double height;
    bool warns;
  };
  constexpr double kFoot = 1200.0 / 3937;
  for (const Case& c : {Case{"EPSG:2263+5703", "", 30, false},         // NAVD88, metres
                        Case{"EPSG:2263", "metre", 30, false},         // stated for the band
                        Case{"EPSG:2263+6360", "", 30 * kFoot, true},  // NAVD88, feet
                        Case{"EPSG:2263", "", 30 * kFoot, true},       // nothing stated
                        Case{"EPSG:3006", "", 30, false}}) {
    write_heights(path, c.crs, c.unit);
    const Elevations read = read_elevations(std::array{path}, {});
    for (const double z : read.raster.values) ASSERT_NEAR(z, c.height, 1e-4) << c.crs << c.unit;
    const bool warns = std::any_of(read.warnings.begin(), read.warnings.end(),
                                   [](const Warning& w) { return w.code == "raster_units"; });
    EXPECT_EQ(warns, c.warns) << c.crs << c.unit;
    fs::remove(path);
  }
}

}  // namespace
}  // namespace tetropolis
