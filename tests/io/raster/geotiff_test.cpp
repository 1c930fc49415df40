#include "tetropolis/io/raster/geotiff.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/error.h"

#include "io/limited_memory.h"
#include "support/bytes.h"
#include "support/errors.h"
#include "support/sanitized.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;
using testing::TemporaryFolder;

/// What a command prints, "" if it cannot be run.
std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen((command + " 2>/dev/null").c_str(), "r"),
                                                   ::pclose);
  std::string text;
  std::array<char, 4096> buffer{};
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe.get()))
    text.append(buffer.data(), n);
  return text;
}

Raster random_raster(std::int32_t nx, std::int32_t ny, double x0, double y0, double step) {
  std::mt19937 random(testing::test_seed());
  std::uniform_real_distribution<double> height(-10, 90);
  Raster raster{nx, ny, snap_coordinate(x0), snap_coordinate(y0), step, {}};
  for (std::int32_t i = 0; i < nx * ny; ++i) raster.values.push_back(height(random));
  return raster;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

std::string input_error(const fs::path& path) {
  return testing::input_error(path, [&] { read_raster(path, {}); });
}

TEST(GeoTiff, RoundTripKeepsEveryBit) {
  SCOPED_TRACE(testing::test_seed());
  const TemporaryFolder folder;
  const fs::path path = folder / "dtm.tif";
  for (const double step : {1.0, 0.5, 2.0, 0.3, 1.0 / 3.0}) {
    for (const Point2 origin :
         {Point2{84800, 447400}, Point2{6'400'123, -3'000'017}, Point2{0, 0}}) {
      const Raster raster = random_raster(37, 53, -12.3456, 7.0001, step);
      const Bounds2 domain{-12.3456, 0.0001, 100.2, 99.9999};
      write_raster(path, raster, origin, "EPSG:28992", domain);
      const RasterInput back = read_raster(path, origin);
      EXPECT_EQ(back.raster.nx, raster.nx);
      EXPECT_EQ(back.raster.ny, raster.ny);
      EXPECT_EQ(back.raster.step, raster.step);
      EXPECT_EQ(back.raster.x0, raster.x0);
      EXPECT_EQ(back.raster.y0, raster.y0);
      EXPECT_TRUE(same_bits(back.raster.values, raster.values));
      EXPECT_EQ(back.crs, "EPSG:28992");
      ASSERT_TRUE(back.domain.has_value());
      EXPECT_EQ(*back.domain, (Bounds2{snap_coordinate(-12.3456), snap_coordinate(0.0001),
                                       snap_coordinate(100.2), snap_coordinate(99.9999)}));
      EXPECT_EQ(back.filled, 0);
      EXPECT_TRUE(back.warnings.empty());
    }
  }
}

TEST(GeoTiff, LevelGroundIsSmallInFiles) {
  const TemporaryFolder folder;
  Raster raster = random_raster(1000, 1000, 0, 0, 1);
  std::fill(raster.values.begin(), raster.values.end(), 12.5);
  write_raster(folder / "level.tif", raster, {}, "EPSG:28992");
  EXPECT_LT(fs::file_size(folder / "level.tif"), 200'000U);  // of 8 MB
  EXPECT_TRUE(same_bits(read_raster(folder / "level.tif", {}).raster.values, raster.values));
}

TEST(GeoTiff, FourBytesANodeWhereSinglePrecisionHasAllValues) {
  const TemporaryFolder folder;
  Raster raster = random_raster(1000, 1000, 0, 0, 1);
  const auto bytes_per_node = [&] {
    write_raster(folder / "a.tif", raster, {}, "EPSG:28992");
    EXPECT_TRUE(same_bits(read_raster(folder / "a.tif", {}).raster.values, raster.values));
    return static_cast<double>(fs::file_size(folder / "a.tif")) / 1e6;
  };
  EXPECT_NEAR(bytes_per_node(), 8, 0.1);
  round_to_single(raster);
  EXPECT_NEAR(bytes_per_node(), 4, 0.1);
  raster.values[123456] = 0.1;
  EXPECT_NEAR(bytes_per_node(), 8, 0.1);
  raster.values[123456] = 1e39;  // beyond single precision
  EXPECT_NEAR(bytes_per_node(), 8, 0.1);
}

TEST(GeoTiff, OtherSoftwareSeesTheSame) {
  if (output_of("gdalinfo --version").empty()) GTEST_SKIP() << "needs gdalinfo";
  const TemporaryFolder folder;
  const fs::path path = folder / "dtm.tif";
  Raster raster{3, 2, 10, 20, 2, {1, 2, 3, 4, 5, std::nan("")}};
  write_raster(path, raster, {1000, 5000}, "EPSG:3006", Bounds2{0, 1, 2, 3});
  const nlohmann::json info =
      nlohmann::json::parse(output_of("gdalinfo -json -stats '" + path.string() + "'"));
  EXPECT_EQ(info["size"], (std::vector<int>{3, 2}));
  // Pixel centres at x 1010, 1012, 1014 and y 5022 (first row), 5020.
  EXPECT_EQ(info["geoTransform"], (std::vector<double>{1009, 2, 0, 5023, 0, -2}));
  EXPECT_EQ(info["bands"][0]["type"], "Float32");
  EXPECT_EQ(info["bands"][0]["noDataValue"], -9999);
  EXPECT_EQ(info["bands"][0]["maximum"], 5);  // The NaN became nodata.
  EXPECT_EQ(info["metadata"][""]["TETROPOLIS_DOMAIN"], "1000,5001,1002,5003");
  EXPECT_FALSE(info["metadata"]["IMAGE_STRUCTURE"].contains("COMPRESSION"));
  EXPECT_NE(info["coordinateSystem"]["wkt"].get<std::string>().find("SWEREF99 TM"),
            std::string::npos);
  EXPECT_EQ(output_of("gdallocationinfo -valonly -geoloc '" + path.string() + "' 1012 5022"),
            "5\n");
  EXPECT_EQ(output_of("gdallocationinfo -valonly -geoloc '" + path.string() + "' 1010 5020"),
            "1\n");
}

TEST(GeoTiff, TheSameBytesAgainAndNothingBeside) {
  const TemporaryFolder folder;
  const Raster raster = random_raster(200, 150, 0, 0, 1);
  write_raster(folder / "a.tif", raster, {84800, 447400}, "28992");
  write_raster(folder / "b.tif", raster, {84800, 447400}, "EPSG:7415");
  EXPECT_TRUE(bytes_of(folder / "a.tif") == bytes_of(folder / "b.tif"));
  read_raster(folder / "a.tif", {});
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 2);
}

TEST(GeoTiff, ReadsTheRealRasters) {
  TETROPOLIS_REQUIRE_DATA(alexandria, "alexandria_dsm_dtm");
  const RasterInput dtm = read_raster(alexandria / "dtm.tif", {321000, 4297000});
  EXPECT_EQ(dtm.raster.nx, 283);
  EXPECT_EQ(dtm.raster.ny, 259);
  EXPECT_EQ(dtm.raster.step, 2);
  EXPECT_EQ(dtm.crs, "EPSG:26918");
  EXPECT_EQ(dtm.filled, 276);
  EXPECT_FALSE(dtm.domain.has_value());
  ASSERT_EQ(dtm.warnings.size(), 1U);
  EXPECT_EQ(dtm.warnings[0].code, "raster_filled");
  EXPECT_EQ(dtm.warnings[0].count, 276);
  for (const double height : dtm.raster.values) {
    EXPECT_GT(height, 6.8);
    EXPECT_LT(height, 22.2);
  }
  TETROPOLIS_REQUIRE_DATA(small, "dtcc_small");
  const RasterInput dem = read_raster(small / "test_dem.tif", {});
  EXPECT_EQ(dem.raster.nx * dem.raster.ny, 800);
  EXPECT_EQ(dem.raster.step, 2);
  EXPECT_EQ(dem.crs, "");
  // Four tiles make the whole.
  const RasterInput whole = read_raster(small / "testraster.tif", {});
  EXPECT_EQ(whole.raster.nx, 50);
  for (const char* name :
       {"testraster_0_0.tif", "testraster_0_1.tif", "testraster_1_0.tif", "testraster_1_1.tif"}) {
    const Raster tile = read_raster(small / name, {}).raster;
    for (std::int32_t j = 0; j < tile.ny; ++j)
      for (std::int32_t i = 0; i < tile.nx; ++i) {
        const double column = (tile.x0 - whole.raster.x0) / tile.step + i;
        const double row = (tile.y0 - whole.raster.y0) / tile.step + j;
        ASSERT_EQ(column, std::round(column));
        EXPECT_EQ(tile.at(i, j), whole.raster.at(static_cast<std::int32_t>(column),
                                                 static_cast<std::int32_t>(row)))
            << name;
      }
  }
}

TEST(GeoTiff, VoidsTakeTheNearestValue) {
  SCOPED_TRACE(testing::test_seed());
  const TemporaryFolder folder;
  Raster raster = random_raster(40, 30, 0, 0, 1);
  const Raster full = raster;
  std::mt19937 random(testing::test_seed());
  for (double& value : raster.values)
    if (random() % 10 != 0) value = std::nan("");
  write_raster(folder / "a.tif", raster, {}, "");
  const RasterInput back = read_raster(folder / "a.tif", {});
  EXPECT_GT(back.filled, 900);
  for (std::int32_t j = 0; j < 30; ++j)
    for (std::int32_t i = 0; i < 40; ++i) {
      if (!std::isnan(raster.at(i, j))) {
        EXPECT_EQ(back.raster.at(i, j), full.at(i, j));
        continue;
      }
      // Brute force: the value comes from one of the nodes at the smallest distance.
      int nearest = 1000;
      bool found = false;
      for (std::int32_t v = 0; v < 30; ++v)
        for (std::int32_t u = 0; u < 40; ++u) {
          if (std::isnan(raster.at(u, v))) continue;
          const int distance = std::max(std::abs(u - i), std::abs(v - j));
          if (distance < nearest) found = false;
          nearest = std::min(nearest, distance);
          if (distance == nearest) found = found || back.raster.at(i, j) == full.at(u, v);
        }
      EXPECT_TRUE(found) << i << ' ' << j;
    }
}

TEST(GeoTiff, WhatSideCarsSayHoldsAndNoneIsWritten) {
  const TemporaryFolder folder;
  // Without nodata, unit and reference system of its own.
  const fs::path path = folder / "a.tif";
  std::ofstream(folder / "a.asc") << "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n"
                                     "50 0 52\n53 54 55\n";
  const std::string convert = "gdal_translate -q '" + (folder / "a.asc").string() + "' '";
  ASSERT_EQ(output_of(convert + path.string() + "'"), "");
  const auto files = [&] {
    return std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator());
  };
  const RasterInput bare = read_raster(path, {});
  EXPECT_EQ(bare.filled, 0);
  EXPECT_EQ(bare.height_unit, 1);
  EXPECT_EQ(bare.crs, "");
  EXPECT_EQ(files(), 2);
  const std::string side_car =
      "<PAMDataset><SRS>EPSG:28992</SRS><PAMRasterBand band=\"1\"><NoDataValue>0</NoDataValue>"
      "<UnitType>ft</UnitType><Scale>2</Scale></PAMRasterBand></PAMDataset>";
  std::ofstream(folder / "a.tif.aux.xml") << side_car;
  const RasterInput input = read_raster(path, {});
  EXPECT_EQ(input.filled, 1);
  EXPECT_EQ(input.height_unit, 0.3048);
  EXPECT_EQ(input.crs, "EPSG:28992");
  EXPECT_EQ(input.raster.values[0], 106);
  EXPECT_EQ(files(), 3);
  EXPECT_EQ(bytes_of(folder / "a.tif.aux.xml"), side_car);
}

TEST(GeoTiff, WhatAMaskHidesIsNoTerrain) {
  for (const char* internal : {"YES", "NO"}) {  // in the file, or in a side-car .msk
    SCOPED_TRACE(internal);
    const TemporaryFolder folder;
    const std::string head = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
    std::ofstream(folder / "z.asc") << head << "50 0 52\n53 54 55\n";
    std::ofstream(folder / "mask.asc") << head << "255 0 255\n255 255 255\n";
    const fs::path vrt = folder / "both.vrt", path = folder / "masked.tif";
    ASSERT_EQ(output_of("gdalbuildvrt -q -separate '" + vrt.string() + "' '" +
                        (folder / "z.asc").string() + "' '" + (folder / "mask.asc").string() + "'"),
              "");
    ASSERT_EQ(output_of("gdal_translate -q -b 1 -mask 2 --config GDAL_TIFF_INTERNAL_MASK " +
                        std::string(internal) + " '" + vrt.string() + "' '" + path.string() + "'"),
              "");
    const RasterInput input = read_raster(path, {});
    EXPECT_EQ(input.filled, 1);
    for (const double z : input.raster.values) EXPECT_GE(z, 50);
  }
}

TEST(GeoTiff, RastersLargerThanTheMemoryAreRefused) {
  if (TETROPOLIS_SANITIZED) GTEST_SKIP() << "the sanitizers need more address space than any limit";
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  const TemporaryFolder folder;
  const fs::path path = folder / "a.vrt";
  // The values alone would fit.
  std::ofstream(path) << R"(<VRTDataset rasterXSize="18000" rasterYSize="18000"><GeoTransform>)"
                      << "0,1,0,0,0,-1</GeoTransform>"
                      << R"(<VRTRasterBand dataType="Float64" band="1"/></VRTDataset>)";
  EXPECT_EXIT(testing::read_in_four_gigabytes([&] { read_raster(path, {}); }),
              ::testing::ExitedWithCode(3),
              "a.vrt: to read 18000 x 18000 pixels takes about 5.2 GB.*cut it to the domain");
}

TEST(GeoTiff, UnusableRastersFailInOneLine) {
  const TemporaryFolder folder;
  EXPECT_NE(input_error(folder / "none.tif").find("no such file"), std::string::npos);
  input_error(folder.path());
  const fs::path path = folder / "a.tif";
  std::ofstream(path) << "not a raster";
  input_error(path);
  write_raster(path, random_raster(300, 300, 0, 0, 1), {}, "");
  const std::string bytes = bytes_of(path);
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{4}, std::size_t{100}, bytes.size() / 2, bytes.size() - 1000}) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes.substr(0, size);
    input_error(path);
  }
  const double nan = std::nan("");
  write_raster(path, Raster{2, 1, 0, 0, 1, {nan, nan}}, {}, "");
  EXPECT_NE(input_error(path).find("none of its 2 pixels"), std::string::npos);
  const auto from_grid = [&](const std::string& text) {
    std::ofstream(folder / "a.asc", std::ios::trunc) << text;
    return folder / "a.asc";
  };
  EXPECT_NE(input_error(from_grid("ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ndx 1\ndy 2\n1 2\n"))
                .find("square"),
            std::string::npos);
  const Raster ascii =
      read_raster(from_grid("ncols 2\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 1\n1 2\n3 4\n"),
                  {10, 20})
          .raster;
  EXPECT_EQ(ascii.values, (std::vector<double>{3, 4, 1, 2}));
  EXPECT_EQ(ascii.x0, 0.5);
  EXPECT_EQ(ascii.y0, 0.5);
  EXPECT_NE(testing::error_of(
                [&] {
                  write_raster(folder / "none/a.tif", Raster{1, 1, 0, 0, 1, {0}}, {}, "");
                },
                ErrorKind::kInput),
            "");
}

}  // namespace
}  // namespace tetropolis
