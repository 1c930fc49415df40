#include "tetropolis/io/las/las.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <laszip/laszip_api.h>

#include "tetropolis/core/threads.h"
#include "tetropolis/io/crs/crs.h"

#include "io/las/las_decode.h"
#include "io/las/las_header.h"
#include "las_support.h"
#include "support/bytes.h"
#include "support/errors.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;
using testing::all_points;
using testing::bytes_of;
using testing::input_error;
using testing::random_cloud;
using testing::read_error;
using testing::read_one;
using testing::same;
using testing::TemporaryFolder;
using testing::write_bytes;

struct Sample {
  const char* path;
  int version_minor;
  int format;
  bool compressed;
  std::map<int, std::int64_t> classes;
};

// Counts from the data's README, which were made with other software.
const std::vector<Sample> kSamples = {
    {"laspy/1_4_w_evlr.las", 4, 6, false, {{2, 1000}}},
    {"laspy/1_4_w_evlr.laz", 4, 6, true, {{2, 1000}}},
    {"laspy/extra.laz", 4, 3, true, {{1, 789}, {2, 276}}},
    {"laspy/simple.copc.laz", 4, 7, true, {{1, 789}, {2, 276}}},
    {"laspy/simple.las", 2, 3, false, {{1, 789}, {2, 276}}},
    {"laspy/simple.laz", 2, 3, true, {{1, 789}, {2, 276}}},
    {"laspy/simple1_1.las", 1, 1, false, {{1, 789}, {2, 276}}},
    {"laspy/simple1_3.las", 3, 4, false, {{1, 999}}},
    {"laspy/simple1_4.las", 4, 7, false, {{0, 22600}}},
    {"lazperf/no-points-1.3.las", 3, 0, false, {}},
    {"lazperf/no-points-1.3.laz", 3, 0, true, {}},
    {"lazperf/point-color-time.las", 2, 3, false, {{1, 789}, {2, 276}}},
    {"lazperf/point-color-time.las.laz", 2, 3, true, {{1, 789}, {2, 276}}},
    {"lazperf/point-color.las", 2, 2, false, {{1, 789}, {2, 276}}},
    {"lazperf/point-color.las.laz", 2, 2, true, {{1, 789}, {2, 276}}},
    {"lazperf/point-time-1.4.las.laz", 4, 1, true, {{1, 789}, {2, 276}}},
    {"lazperf/point-time.las", 2, 1, false, {{1, 789}, {2, 276}}},
    {"lazperf/point-time.las.laz", 2, 1, true, {{1, 789}, {2, 276}}},
    {"lazperf/point10-1.0.las", 0, 0, false, {{5, 1}}},
    {"lazperf/point10-1.0.laz", 0, 0, true, {{5, 1}}},
    {"lazperf/point10-1.1.las", 1, 0, false, {{5, 1}}},
    {"lazperf/point10-1.1.laz", 1, 0, true, {{5, 1}}},
    {"lazperf/point10.las", 2, 0, false, {{1, 789}, {2, 276}}},
    {"lazperf/point10.las.laz", 2, 0, true, {{1, 789}, {2, 276}}},
    {"pdal/autzen__autzen-bmx-2023.las", 4, 7, false, {{2, 687}}},
    {"pdal/copc__1.2-with-color.copc.laz", 4, 7, true, {{1, 789}, {2, 276}}},
    {"pdal/las__1.2-with-color.las", 2, 3, false, {{1, 789}, {2, 276}}},
    {"pdal/las__autzen_class.las", 2, 3, false, {{1, 3499}, {2, 3147}, {5, 36768}, {6, 66586}}},
    {"pdal/las__extrabytes.las", 4, 3, false, {{1, 789}, {2, 276}}},
    {"pdal/las__interesting.las", 2, 3, false, {{1, 789}, {2, 276}}},
    {"pdal/las__lots_of_vlr.las", 1, 1, false, {{1, 1}}},
    {"pdal/las__mvk-thin.las",
     2,
     1,
     false,
     {{1, 129}, {2, 1693}, {4, 141}, {5, 578}, {9, 37}, {12, 3702}}},
    {"pdal/las__no-points.las", 2, 3, false, {}},
    {"pdal/las__permutations__1.0_0.las", 0, 0, false, {{2, 1}}},
    {"pdal/las__permutations__1.0_1.las", 0, 1, false, {{2, 1}}},
    {"pdal/las__permutations__1.1_0.las", 1, 0, false, {{2, 1}}},
    {"pdal/las__permutations__1.1_1.las", 1, 1, false, {{2, 1}}},
    {"pdal/las__permutations__1.2_0.las", 2, 0, false, {{2, 1}}},
    {"pdal/las__permutations__1.2_1.las", 2, 1, false, {{2, 1}}},
    {"pdal/las__permutations__1.2_2.las", 2, 2, false, {{2, 1}}},
    {"pdal/las__permutations__1.2_3.las", 2, 3, false, {{2, 1}}},
    {"pdal/las__test1_4.las", 4, 6, false, {{2, 1000}}},
    {"pdal/las__warsaw_small.las", 2, 3, false, {{0, 433}, {2, 1381}, {3, 257}, {4, 27}, {5, 902}}},
    {"pdal/laz__autzen_trim.laz", 2, 3, true, {{1, 83893}, {2, 26107}}},
    {"pdal/laz__simple-laszip-compressor-version-1.2r0.laz", 2, 3, true, {{1, 789}, {2, 276}}},
    {"pdal/laz__simple.laz", 2, 3, true, {{1, 789}, {2, 276}}},
};

TEST(Las, ReadsEverySampleWithItsClassCounts) {
  TETROPOLIS_REQUIRE_DATA(folder, "las_samples");
  for (const Sample& sample : kSamples) {
    SCOPED_TRACE(sample.path);
    const LasInfo info = inspect_las(folder / sample.path);
    EXPECT_EQ(info.version_major, 1);
    EXPECT_EQ(info.version_minor, sample.version_minor);
    EXPECT_EQ(info.point_format, sample.format);
    EXPECT_EQ(info.compressed, sample.compressed);
    EXPECT_EQ(info.copc, std::string(sample.path).find("copc") != std::string::npos);
    const PointsInput input = read_one(folder / sample.path, all_points());
    EXPECT_EQ(input.points_by_class, sample.classes);
    EXPECT_EQ(input.points_read, info.point_count);
    EXPECT_EQ(input.points_kept, static_cast<std::int64_t>(input.points.size()));
    EXPECT_EQ(input.points.z.size(), input.points.size());
    // Header boxes are right to a few units of the scale, but for a piece of a larger file and one
    // whose box is off by a factor of a thousand.
    const std::string name = sample.path;
    if (input.points_kept > 1 && name.find("bmx") == name.npos && name.find("1_3") == name.npos) {
      EXPECT_NEAR(input.extent.xmin + input.origin.x, info.min[0], 0.02);
      EXPECT_NEAR(input.extent.ymax + input.origin.y, info.max[1], 0.02);
      const auto [zmin, zmax] = std::minmax_element(input.points.z.begin(), input.points.z.end());
      EXPECT_NEAR(*zmin, info.min[2], 0.02);
      EXPECT_NEAR(*zmax, info.max[2], 0.02);
    }
  }
}

// Chunks of different sizes: LASzip finds where to begin.
TEST(Las, CopcCanBeEnteredAnywhere) {
  TETROPOLIS_REQUIRE_DATA(folder, "las_samples");
  for (const char* name : {"laspy/simple.copc.laz", "pdal/copc__1.2-with-color.copc.laz"}) {
    SCOPED_TRACE(name);
    LasSystems systems;
    const LasLayout layout = read_las_layout(folder / name, systems);
    ASSERT_TRUE(layout.variable_chunks);
    const auto records_from = [&](std::int64_t first, std::int64_t count) {
      std::vector<std::array<std::int32_t, 4>> records;
      decode_points(folder / name, layout, first, count, [&](const LasBlock& block) {
        for (std::size_t i = 0; i < block.size(); ++i)
          records.push_back({block.x[i], block.y[i], block.z[i], block.classification[i]});
      });
      return records;
    };
    const auto all = records_from(0, layout.info.point_count);
    ASSERT_EQ(std::ssize(all), layout.info.point_count);
    for (std::int64_t first = 0; first < layout.info.point_count; first += 41) {
      const std::int64_t count = std::min<std::int64_t>(100, layout.info.point_count - first);
      const auto part = records_from(first, count);
      ASSERT_TRUE(
          std::equal(part.begin(), part.end(), all.begin() + first, all.begin() + first + count))
          << first;
    }
  }
}

TEST(Las, CompressedAndPlainTwinsAgree) {
  TETROPOLIS_REQUIRE_DATA(folder, "las_samples");
  for (const auto& [plain, packed] : std::vector<std::pair<const char*, const char*>>{
           {"laspy/simple.las", "laspy/simple.laz"},
           {"laspy/1_4_w_evlr.las", "laspy/1_4_w_evlr.laz"},
           {"lazperf/point-color-time.las", "lazperf/point-color-time.las.laz"},
           {"lazperf/point-color.las", "lazperf/point-color.las.laz"},
           {"lazperf/point-time.las", "lazperf/point-time.las.laz"},
           {"lazperf/point10.las", "lazperf/point10.las.laz"},
           {"pdal/las__extrabytes.las", "laspy/extra.laz"}}) {
    SCOPED_TRACE(plain);
    EXPECT_TRUE(same(read_one(folder / plain, all_points()).points,
                     read_one(folder / packed, all_points()).points));
  }
}

TEST(Las, StatesTheReferenceSystem) {
  TETROPOLIS_REQUIRE_DATA(folder, "las_samples");
  const auto crs = [&](const char* name) { return inspect_las(folder / name).crs; };
  EXPECT_EQ(crs("laspy/simple.las"), "");
  EXPECT_EQ(crs("pdal/las__permutations__1.2_1.las"), "EPSG:26915");  // GeoTIFF keys.
  EXPECT_EQ(crs("lazperf/point10.las.laz"), "EPSG:26910");
  EXPECT_EQ(crs("pdal/las__autzen_class.las"), "EPSG:2994");  // WKT and keys.
  EXPECT_EQ(crs("laspy/simple.copc.laz"), "EPSG:2991");       // WKT in LAS 1.4.
  EXPECT_EQ(crs("laspy/simple1_4.las"), "EPSG:4326");
  EXPECT_EQ(crs("laspy/1_4_w_evlr.las"), "EPSG:2903");
  // User-defined in GeoTIFF keys: no code, but a system in feet.
  const std::string defined = crs("pdal/las__interesting.las");
  EXPECT_EQ(defined.substr(0, 8), "PROJCRS[");
  EXPECT_DOUBLE_EQ(linear_unit_metres(defined), 0.3048);
  // A unit code in the place of a projection's, and a WKT of two quotes.
  for (const char* name : {"laspy/simple1_3.las", "pdal/las__warsaw_small.las"}) {
    const LasInfo info = inspect_las(folder / name);
    EXPECT_EQ(info.crs, "");
    ASSERT_EQ(info.warnings.size(), 1U);
    EXPECT_EQ(info.warnings[0].code, "las_crs_unknown");
  }
  TETROPOLIS_REQUIRE_DATA(seville, "las_only/sevilla_plaza_nueva.laz");
  EXPECT_TRUE(same_horizontal_crs(inspect_las(seville).crs, "EPSG:25830"));
}

TEST(Las, BrokenSamplesFailInOneLine) {
  TETROPOLIS_REQUIRE_DATA(folder, "las_samples");
  EXPECT_NE(read_error(folder / "laszip/data__broken_coder.laz").find("coder 15"),
            std::string::npos);
  read_error(folder / "laszip/data__broken_size.laz");
  EXPECT_NE(read_error(folder / "pdal/las__permutations__1.2-no-points.las")
                .find("ends at point 0 of 1065"),
            std::string::npos);
}

TEST(Las, ReadsTheCityClouds) {
  TETROPOLIS_REQUIRE_DATA(delft, "delft_3dfier");
  const PointsInput input = read_points(
      expand_point_paths(std::vector<std::string>{(delft / "*.laz").string()}), all_points());
  EXPECT_EQ(input.points_kept, 848942);
  EXPECT_EQ(
      input.points_by_class,
      (std::map<int, std::int64_t>{{1, 282445}, {2, 283118}, {6, 280065}, {9, 835}, {26, 2479}}));
  EXPECT_EQ(input.crs, "");
  TETROPOLIS_REQUIRE_DATA(amsterdam, "amsterdam_south");
  for (const auto& [name, files, classes] :
       std::vector<std::tuple<const char*, std::size_t, std::map<int, std::int64_t>>>{
           {"ahn3", 8, {{1, 122640}, {2, 259138}, {6, 407719}, {9, 359}, {26, 9102}}},
           {"ahn2", 8, {{1, 586993}, {2, 286663}}}}) {
    const auto paths = expand_point_paths(std::vector<std::string>{(amsterdam / name).string()});
    EXPECT_EQ(paths.size(), files);
    EXPECT_EQ(read_points(paths).points_by_class, classes);
  }
  for (const fs::directory_entry& sparse : fs::directory_iterator(amsterdam / "ahn3_sparse"))
    EXPECT_EQ(read_one(sparse.path()).points_by_class,
              (std::map<int, std::int64_t>{{2, 64726}, {6, 101860}}));
  TETROPOLIS_REQUIRE_DATA(alexandria, "alexandria_dsm_dtm/pseudo_points_from_dsm_dtm.las");
  EXPECT_EQ(read_one(alexandria).points_by_class,
            (std::map<int, std::int64_t>{{1, 39917}, {2, 33104}}));
}

TEST(Las, LeavesNoiseOutButNotOverlap) {
  TETROPOLIS_REQUIRE_DATA(seville, "las_only/sevilla_plaza_nueva.laz");
  const PointsInput input = read_one(seville);
  EXPECT_EQ(input.points_read, 102565);
  EXPECT_EQ(input.points_kept, 102565 - 72);
  EXPECT_EQ(input.points_by_class.at(12), 51017);
  EXPECT_EQ(input.points_by_class.count(7), 0U);
  EXPECT_EQ(read_one(seville, all_points()).points_by_class.at(7), 72);
  TETROPOLIS_REQUIRE_DATA(lyon, "las_only/lyon_dense_vegetation.las");
  EXPECT_EQ(read_one(lyon).points_by_class,
            (std::map<int, std::int64_t>{{1, 877}, {2, 4040}, {5, 5268}}));
}

// What the decoder gives, one point at a time, is the reference.
PointCloud decode_alone(const fs::path& path, Point2 origin) {
  laszip_POINTER reader = nullptr;
  laszip_BOOL compressed = 0;
  laszip_header_struct* header = nullptr;
  laszip_point_struct* point = nullptr;
  laszip_create(&reader);
  EXPECT_EQ(laszip_open_reader(reader, path.c_str(), &compressed), 0);
  laszip_get_header_pointer(reader, &header);
  laszip_get_point_pointer(reader, &point);
  PointCloud cloud;
  for (laszip_U32 i = 0; i < header->number_of_point_records; ++i) {
    double xyz[3];
    laszip_read_point(reader);
    laszip_get_coordinates(reader, xyz);
    cloud.push_back(xyz[0] - origin.x, xyz[1] - origin.y, xyz[2], point->classification);
  }
  laszip_close_reader(reader);
  laszip_destroy(reader);
  return cloud;
}

TEST(Las, AgreesWithTheDecoderForAnyNumberOfThreads) {
  TETROPOLIS_REQUIRE_DATA(tile, "delft_3dfier/ahn3_cropped_1.laz");
  ReadPointsOptions options = all_points();
  options.origin = Point2{84'000, 447'000};
  const PointCloud expected = decode_alone(tile, *options.origin);
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    EXPECT_TRUE(same(read_one(tile, options).points, expected)) << threads;
  }
}

TEST(Las, ClassesOfFilesAreThoseOfAllTheirPoints) {
  const TemporaryFolder scratch;
  const std::array names{"tile.las", "bare.las", "noise.laz", "away.las"};
  const std::array<std::vector<int>, 4> codes{
      {{1, 1, 2}, {0, 1, 12}, {1, 7, 18}, {2, 2, 2}}};  // the third point of each is cropped
  std::vector<fs::path> paths;
  for (std::size_t f = 0; f < names.size(); ++f) {
    PointCloud cloud;
    for (std::size_t k = 0; k < 3; ++k) {
      const bool away = k == 2 || f == 3;
      cloud.push_back(away ? 5000.0 + static_cast<double>(k) : 10.0 + static_cast<double>(k), 10,
                      static_cast<double>(f), static_cast<std::uint8_t>(codes[f][k]));
    }
    paths.push_back(scratch / names[f]);
    write_points(paths.back(), cloud, {}, {});
  }
  ReadPointsOptions options;
  options.crop = Bounds2{0, 0, 100, 100};
  const PointsInput input = read_points(paths, options);
  ASSERT_EQ(input.files.size(), 4U);
  const std::array<std::size_t, 4> kept{2, 2, 1, 0};
  std::size_t end = 0;
  for (std::size_t f = 0; f < 4; ++f) {
    SCOPED_TRACE(names[f]);
    std::map<int, std::int64_t> expected;
    for (const int code : codes[f]) ++expected[code];
    EXPECT_EQ(input.files[f].by_class, f == 3 ? (std::map<int, std::int64_t>{}) : expected)
        << "the last file's box is outside: not read";
    EXPECT_EQ(input.files[f].kept.end - input.files[f].kept.begin, kept[f]);
    for (std::size_t p = input.files[f].kept.begin; p < input.files[f].kept.end; ++p)
      EXPECT_EQ(input.points.z[p], static_cast<double>(f));
    end = std::max(end, input.files[f].kept.end);
  }
  EXPECT_EQ(end, input.points.size());
}

// Several tasks of several chunks.
TEST(Las, CompressedPointsAreThePlainOnes) {
  SCOPED_TRACE(testing::test_seed());
  const TemporaryFolder scratch;
  const PointCloud cloud = random_cloud(600001, 31);
  ReadPointsOptions part = all_points();
  part.crop = Bounds2{100, -50, 120, 300};
  for (const int format : {1, 6}) {
    SCOPED_TRACE(format);
    WritePointsOptions options;
    options.point_format = format;
    write_points(scratch / "plain.las", cloud, {}, options);
    write_points(scratch / "packed.laz", cloud, {}, options);
    for (const int threads : {1, 2}) {
      SCOPED_TRACE(threads);
      const ThreadLimit limit(threads);
      for (const ReadPointsOptions& wanted : {all_points(), part}) {
        const PointsInput plain = read_one(scratch / "plain.las", wanted);
        const PointsInput packed = read_one(scratch / "packed.laz", wanted);
        EXPECT_GT(plain.points.size(), 1000U);
        EXPECT_TRUE(same(packed.points, plain.points));
        EXPECT_EQ(packed.points_by_class, plain.points_by_class);
        EXPECT_TRUE(packed.warnings.empty());
      }
    }
  }
}

TEST(Las, CompressorsGoWithTheirKindOfItems) {
  // Record: compressor, ..., chunk size, ..., number of items, then type, size and version of each.
  const auto record = [](std::uint16_t compressor, std::uint16_t type, std::uint16_t size) {
    std::string data(40, '\0');
    const std::uint32_t chunk = 50'000;
    const std::uint16_t items = 1, version = 3;
    std::memcpy(data.data(), &compressor, 2);
    std::memcpy(data.data() + 12, &chunk, 4);
    std::memcpy(data.data() + 32, &items, 2);
    std::memcpy(data.data() + 34, &type, 2);
    std::memcpy(data.data() + 36, &size, 2);
    std::memcpy(data.data() + 38, &version, 2);
    return data;
  };
  LaszipRecord result;
  EXPECT_EQ(check_laszip_record(record(2, 6, 20), 20, result), "");
  EXPECT_EQ(check_laszip_record(record(3, 10, 30), 30, result), "");
  EXPECT_NE(check_laszip_record(record(3, 6, 20), 20, result), "");
  EXPECT_NE(check_laszip_record(record(2, 10, 30), 30, result), "");
  EXPECT_NE(check_laszip_record(record(2, 6, 20) + std::string(26, '\0'), 20, result), "");
}

TEST(Las, CropKeepsExactlyThePointsInTheBox) {
  TETROPOLIS_REQUIRE_DATA(delft, "delft_3dfier");
  const auto paths = expand_point_paths(std::vector<std::string>{(delft / "*.laz").string()});
  const PointsInput all = read_points(paths);
  ReadPointsOptions options;
  options.crop = Bounds2{84900, 447500, 84950.25, 447530};
  options.origin = {84900, 447500};
  const PointsInput part = read_points(paths, options);
  PointCloud expected;
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    const Point2 p{all.points.x[i] + all.origin.x, all.points.y[i] + all.origin.y};
    if (!options.crop->contains(p)) continue;
    expected.push_back(p.x - 84900, p.y - 447500, all.points.z[i], all.points.classification[i]);
  }
  ASSERT_GT(expected.size(), 1000U);
  EXPECT_TRUE(same(part.points, expected));
  // The second tile begins at x = 85000: its box misses the crop.
  EXPECT_EQ(part.files_skipped, 1);
  EXPECT_EQ(part.points_read, 640510);
  EXPECT_TRUE(part.warnings.empty());
}

TEST(Las, WritesWhatItReads) {
  SCOPED_TRACE(testing::test_seed());
  const TemporaryFolder folder;
  const Point2 origin{121000, 486000};
  for (const int format : {1, 6}) {
    const PointCloud cloud = random_cloud(120'000, format == 1 ? 31 : 255);
    WritePointsOptions options;
    options.point_format = format;
    options.crs = "EPSG:28992";
    PointCloud first;
    for (const char* name : {"a.las", "a.laz"}) {
      SCOPED_TRACE(name);
      write_points(folder / name, cloud, origin, options);
      const LasInfo info = inspect_las(folder / name);
      EXPECT_EQ(info.point_format, format);
      EXPECT_EQ(info.version_minor, format == 6 ? 4 : 2);
      EXPECT_EQ(info.crs, "EPSG:28992");
      EXPECT_EQ(info.compressed, std::string(name) == "a.laz");
      EXPECT_TRUE(info.warnings.empty());
      ReadPointsOptions reading = all_points();
      reading.origin = origin;
      const PointsInput back = read_one(folder / name, reading);
      ASSERT_EQ(back.points.size(), cloud.size());
      EXPECT_EQ(back.points.classification, cloud.classification);
      double worst = 0;
      for (std::size_t i = 0; i < cloud.size(); ++i)
        worst = std::max({worst, std::abs(back.points.x[i] - cloud.x[i]),
                          std::abs(back.points.y[i] - cloud.y[i]),
                          std::abs(back.points.z[i] - cloud.z[i])});
      EXPECT_LE(worst, 0.0005 + 1e-9);
      // The header's box is that of the stored points, to the bit.
      const PointsSummary absolute = summarise_points(folder / name);
      EXPECT_EQ(absolute.extent, (Bounds2{info.min[0], info.min[1], info.max[0], info.max[1]}));
      // The same bytes again, and the same points in both packings.
      const std::string bytes = bytes_of(folder / name);
      write_points(folder / name, cloud, origin, options);
      EXPECT_TRUE(bytes_of(folder / name) == bytes);
      if (first.size() == 0) first = back.points;
      EXPECT_TRUE(same(first, back.points));
    }
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 2);
}

TEST(Las, CoordinatesAreTheNearestTenthOfAMillimetre) {
  for (const double metres : {0.0, 12.34, -12.34, 0.00004, 0.00006, -0.00006, 1e-9, 214748.0})
    EXPECT_EQ(PointCoordinate(metres), std::round(metres * 1e4) / 1e4) << metres;
  // What files state to the millimetre comes back to the bit.
  std::mt19937 random(testing::test_seed());
  std::uniform_int_distribution<std::int64_t> millimetres(-200'000'000, 200'000'000);
  for (int k = 0; k < 1000; ++k) {
    const double metres = static_cast<double>(millimetres(random)) / 1000;
    EXPECT_EQ(PointCoordinate(metres), metres) << "seed " << testing::test_seed();
  }
  EXPECT_EQ(PointCoordinate(1e9), PointCoordinate::kMost);
  EXPECT_EQ(PointCoordinate(-1e300), -PointCoordinate::kMost);
}

TEST(Las, TheFrameLiesNearThePoints) {
  const TemporaryFolder folder;
  PointCloud cloud;
  for (const double x : {0.25, 300'000.0}) {
    cloud.push_back(std::min(x, 200'000.0), x / 2, 3, kGround);
  }
  write_points(folder / "a.las", cloud, {674'000, 6'580'000}, {});
  const PointsInput near = read_one(folder / "a.las");
  EXPECT_EQ(near.origin, (Point2{674'000, 6'580'000}));
  EXPECT_EQ(near.extent, (Bounds2{0.25, 0.125, 200'000, 150'000}));
  EXPECT_EQ(near.points.x[1], 200'000);
  ReadPointsOptions options;
  options.crop = Bounds2{673'999.5, 6'579'000.75, 674'001, 6'581'000};
  EXPECT_EQ(read_one(folder / "a.las", options).origin, (Point2{673'999, 6'579'000}));
  // Farther from the origin than coordinates reach.
  options = {};
  options.origin = Point2{0, 0};
  const std::string message =
      input_error(folder / "a.las", [&] { read_one(folder / "a.las", options); });
  EXPECT_NE(message.find("6730 km from (0, 0)"), std::string::npos) << message;
}

TEST(Las, SummariesAreThoseOfThePoints) {
  TETROPOLIS_REQUIRE_DATA(path, "delft_3dfier/ahn3_cropped_1.laz");
  ReadPointsOptions all;
  all.skipped_classes = {};
  all.keep_withheld = true;
  const PointsInput points = read_points({&path, 1}, all);
  const PointsSummary summary = summarise_points(path);
  EXPECT_EQ(summary.points, points.points_kept);
  EXPECT_EQ(summary.points_by_class, points.points_by_class);
  const auto near = [](double a, double b) { return std::abs(a - b) < 1e-6; };
  EXPECT_TRUE(near(summary.extent.xmin, points.extent.xmin + points.origin.x));
  EXPECT_TRUE(near(summary.extent.ymin, points.extent.ymin + points.origin.y));
  EXPECT_TRUE(near(summary.extent.xmax, points.extent.xmax + points.origin.x));
  EXPECT_TRUE(near(summary.extent.ymax, points.extent.ymax + points.origin.y));
  EXPECT_EQ(summary.warnings.size(), points.warnings.size());
}

TEST(Las, WritesCountsByReturn) {
  const TemporaryFolder folder;
  write_points(folder / "a.las", random_cloud(77, 20), {}, {});
  std::string bytes = bytes_of(folder / "a.las");
  std::uint32_t counts[6];
  std::memcpy(counts, bytes.data() + 107, sizeof counts);
  EXPECT_EQ(counts[0], 77U);
  EXPECT_EQ(counts[1], 77U);
  EXPECT_EQ(counts[2], 0U);
  EXPECT_EQ(bytes.size(), 227U + 77U * 28U);
  WritePointsOptions options;
  options.point_format = 6;
  write_points(folder / "b.las", random_cloud(77, 20), {}, options);
  bytes = bytes_of(folder / "b.las");
  std::uint32_t legacy;
  std::uint64_t extended;
  std::memcpy(&legacy, bytes.data() + 107, sizeof legacy);
  std::memcpy(&extended, bytes.data() + 247, sizeof extended);
  EXPECT_EQ(legacy, 0U);
  EXPECT_EQ(extended, 77U);
}

TEST(Las, WritesCloudsWithoutPoints) {
  const TemporaryFolder folder;
  for (const char* name : {"a.las", "a.laz"}) {
    write_points(folder / name, {}, {}, {});
    EXPECT_EQ(read_one(folder / name).points_read, 0);
    EXPECT_TRUE(read_one(folder / name).extent.empty());
  }
}

TEST(Las, RefusesToWriteNonsense) {
  const TemporaryFolder folder;
  const auto usage = [&](const PointCloud& cloud, WritePointsOptions options) {
    EXPECT_NE(testing::error_of([&] { write_points(folder / "a.las", cloud, {}, options); },
                                ErrorKind::kUsage),
              "");
  };
  usage({{0}, {0}, {0}, {40}}, {});
  usage({{0, 2e5}, {0, 0}, {0, 0}, {1, 1}}, {1, 1e-5, ""});
  usage({}, {3, 0.001, ""});
  usage({}, {1, 0.0, ""});
  usage({}, {1, 0.001, "nowhere"});
  EXPECT_TRUE(fs::is_empty(folder.path()));
  input_error(folder / "none/a.las", [&] { write_points(folder / "none/a.las", {}, {}, {}); });
}

// --- several files ---

TEST(Las, ExpandsFoldersPatternsAndDuplicates) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "tiles");
  fs::create_directory(folder / "empty");
  for (const char* name : {"tiles/b.LAZ", "tiles/a.las", "tiles/c.txt", "tiles/._a.las", "d.las"})
    write_bytes(folder / name, "LASF");
  const auto expand = [](std::vector<std::string> arguments) {
    return expand_point_paths(arguments);
  };
  const std::string root = folder.path().string();
  const std::vector<fs::path> tiles = {folder / "tiles/a.las", folder / "tiles/b.LAZ"};
  EXPECT_EQ(expand({root + "/tiles"}), tiles);
  EXPECT_EQ(expand({root + "/tiles/[ab].*"}), tiles);
  EXPECT_EQ(expand({root + "/tiles/b.LAZ", root + "/tiles/a.las"}), tiles);
  EXPECT_EQ(expand({root + "/tiles", root + "/tiles/a.las"}).size(), 2U);
  EXPECT_EQ(expand({root + "/tiles/../tiles/a.las", root + "/tiles/a.las"}).size(), 1U);
  EXPECT_EQ(expand({root + "/d.las", root + "/tiles"}).size(), 3U);
  EXPECT_EQ(expand({root + "/d.las", root + "/tiles"}), expand({root + "/tiles", root + "/d.las"}));
  EXPECT_EQ(expand({root + "/tiles/c.txt"}).size(), 1U);
  EXPECT_EQ(expand({root + "/tiles/._a.las"}).size(), 1U) << "hidden, but named";
  EXPECT_TRUE(expand({}).empty());
  EXPECT_NE(input_error(root + "/no.las", [&] { expand({root + "/no.las"}); }).find("no such file"),
            std::string::npos);
  EXPECT_NE(input_error(root + "/empty", [&] { expand({root + "/empty"}); })
                .find("has no .las or .laz files"),
            std::string::npos);
  EXPECT_NE(
      input_error(root + "/*.laz", [&] { expand({root + "/*.laz"}); }).find("matches no file"),
      std::string::npos);
}

TEST(Las, PointFilesInSubfoldersAreNotReadWithoutAWord) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "tiles/north/old");
  for (const char* name : {"tiles/north/a.las", "tiles/north/b.laz", "tiles/north/old/a.las"})
    write_bytes(folder / name, "LASF");
  const std::vector<std::string> tiles = {(folder / "tiles").string()};
  const std::string north = (folder / "tiles/north").string();
  EXPECT_NE(input_error(folder / "tiles", [&] { expand_point_paths(tiles); })
                .find("folders in it do; name those (" + north + ")"),
            std::string::npos);
  write_bytes(folder / "tiles/c.las", "LASF");
  std::vector<Warning> warnings;
  EXPECT_EQ(expand_point_paths(tiles, &warnings).size(), 1U);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].code, "points_in_subfolders");
  EXPECT_EQ(warnings[0].count, 3);
  EXPECT_NE(warnings[0].message.find(north), std::string::npos);
  warnings.clear();
  EXPECT_EQ(expand_point_paths(std::vector{tiles[0], north, north + "/old"}, &warnings).size(), 4U);
  EXPECT_TRUE(warnings.empty()) << "all are named";
  fs::rename(folder / "tiles/north", folder / "tiles/.north");
  EXPECT_EQ(expand_point_paths(tiles, &warnings).size(), 1U);
  EXPECT_TRUE(warnings.empty()) << "hidden";
  fs::rename(folder / "tiles/.north", folder / "tiles/north");
  EXPECT_EQ(expand_point_paths(std::vector{north + "/old"}, &warnings).size(), 1U);
  EXPECT_TRUE(warnings.empty());
}

TEST(Las, ZipArchivesAreNamedAsSuch) {
  const TemporaryFolder folder;
  write_bytes(folder / "a.laz", std::string("PK\3\4", 4) + std::string(400, 'x'));
  EXPECT_NE(input_error(folder / "a.laz", [&] { inspect_las(folder / "a.laz"); })
                .find("is a ZIP archive"),
            std::string::npos);
}

TEST(Las, FilesInDifferentSystemsAreNotMixed) {
  const TemporaryFolder folder;
  WritePointsOptions options;
  options.crs = "EPSG:28992";
  write_points(folder / "a.las", random_cloud(10, 6), {}, options);
  options.crs = "EPSG:3006";
  write_points(folder / "b.las", random_cloud(10, 6), {}, options);
  write_points(folder / "c.las", random_cloud(10, 6), {}, {});
  const std::vector<fs::path> paths = {folder / "a.las", folder / "b.las", folder / "c.las"};
  const std::string message = input_error(folder / "a.las", [&] { read_points(paths); });
  EXPECT_NE(message.find((folder / "b.las").string()), std::string::npos);
  ReadPointsOptions reading;
  reading.crs = "28992";
  EXPECT_EQ(read_points(paths, reading).crs, "EPSG:28992");
  EXPECT_EQ(read_points(std::vector<fs::path>{paths[2], paths[1]}).crs, "EPSG:3006");
  EXPECT_EQ(read_points(std::vector<fs::path>{paths[2]}).crs, "");
}

TEST(Las, OfCopiesTheOneWithClassesIsRead) {
  const TemporaryFolder folder;
  PointCloud cloud = random_cloud(120'000, 6);  // three chunks
  write_points(folder / "b.laz", cloud, {}, {});
  write_points(folder / "d.las", cloud, {}, {});
  const auto codes = cloud.classification;
  // As far as the beginning tells, of the same classes.
  std::fill(cloud.classification.begin() + 10'000, cloud.classification.end(), kUnclassified);
  write_points(folder / "a.las", cloud, {}, {});
  write_points(folder / "c.laz", cloud, {}, {});
  const auto check = [&](const std::vector<const char*>& names, const PointCloud& expected,
                         std::size_t twins) {
    std::vector<fs::path> paths;
    for (const char* name : names) paths.push_back(folder / name);
    const PointsInput input = read_points(paths, all_points());
    EXPECT_EQ(input.points.classification, expected.classification) << names.front();
    EXPECT_EQ(input.warnings.size(), twins);
    for (const Warning& warning : input.warnings) EXPECT_EQ(warning.code, "las_twin");
  };
  PointCloud classified = cloud;
  classified.classification = codes;
  check({"a.las", "b.laz"}, classified, 1);
  check({"b.laz", "a.las"}, classified, 1);
  check({"a.las", "b.laz", "c.laz", "d.las"}, classified, 3);
  check({"a.las", "c.laz"}, cloud, 1);
}

TEST(Las, TheFirstBrokenFileIsReportedByAnyNumberOfThreads) {
  const TemporaryFolder folder;
  std::vector<fs::path> paths;
  for (int i = 0; i < 12; ++i) {
    paths.push_back(folder / ("f" + std::to_string(10 + i) + ".las"));
    write_points(paths.back(), random_cloud(100, 6), {}, {});
    if (i >= 4) fs::resize_file(paths.back(), 227 + 28 * 50);
  }
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    input_error(paths[4], [&] { read_points(paths); });
  }
}

TEST(Las, ReportsProgressAndStops) {
  TETROPOLIS_REQUIRE_DATA(tile, "delft_3dfier/ahn3_cropped_2.laz");
  const std::vector<fs::path> paths = {tile};
  std::vector<double> shares;
  Progress progress;
  progress.report = [&](double share) { shares.push_back(share); };
  read_points(paths, {}, progress);
  ASSERT_FALSE(shares.empty());
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1.0);
  progress.cancelled = [&] { return true; };
  EXPECT_THROW(read_points(paths, {}, progress), Cancelled);
}

}  // namespace
}  // namespace tetropolis
