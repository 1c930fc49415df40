#include "io/vector/raw_vector.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/io/vector/vector.h"

#include "support/bytes.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;
using testing::TemporaryFolder;

constexpr Point2 kRawOrigin{319000, 6396000};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A closed square, clockwise as shapefiles want outer rings.
RawRing square(double west, double south, double side, bool clockwise = true) {
  RawRing ring{{west, south, 1},
               {west, south + side, 2},
               {west + side, south + side, 3},
               {west + side, south, 4},
               {west, south, 1}};
  if (!clockwise) std::reverse(ring.begin(), ring.end());
  return ring;
}

std::vector<RawFeature> sample() {
  RawRing broken = square(60, 0, 10);
  broken[2].x = kNan;
  RawRing far = square(80, 0, 10);
  far[1].y = 1e300;
  RawRing open = square(100, 0, 10);
  open.pop_back();
  return {{"plain", 7.25, {{square(0, 0, 10)}}},
          {"yard", kNan, {{square(20, 0, 10), square(23, 3, 4, false)}}},
          {"two parts", 3, {{square(40, 0, 5)}, {square(50, 0, 5)}}},
          {"nothing", kNan, {}},
          {"nan", kNan, {{broken}}},
          {"far", kNan, {{far}}},
          {"open", kNan, {{open}}},
          {"line", kNan, {{{{0, 0, 0}, {1, 1, 0}}}}}};
}

class RawVector : public ::testing::TestWithParam<const char*> {
 protected:
  fs::path write(const std::string& stem, bool with_z) {
    const fs::path path = folder / (stem + GetParam());
    write_raw_features(path, sample(), kRawOrigin, "EPSG:3006", with_z);
    return path;
  }
  TemporaryFolder folder;
};

TEST_P(RawVector, TheReaderFindsWhatIsSoundAndDropsTheRestByName) {
  for (const bool with_z : {false, true}) {
    ReadFootprintsOptions options;
    options.id_attribute = "id";
    options.height_attribute = "height";
    const FootprintsInput input = read_footprints(write("a", with_z), options);
    EXPECT_EQ(input.crs, "EPSG:3006");
    EXPECT_EQ(input.features_read, 8);
    std::map<std::string, const Footprint*> found;
    for (const Footprint& feature : input.features) found[feature.source_id] = &feature;
    std::map<std::string, std::string> dropped;
    for (const Dropped& feature : input.dropped) dropped[feature.source_id] = feature.reason;
    ASSERT_TRUE(found.contains("plain") && found.contains("yard") && found.contains("open"));
    EXPECT_TRUE(found.contains("two parts") && found.contains("two parts#2"));
    EXPECT_EQ(found["plain"]->height, 7.25);
    EXPECT_TRUE(std::isnan(found["yard"]->height));
    ASSERT_EQ(found["plain"]->polygon.outer.size(), 4U);
    for (const Point2 p : found["plain"]->polygon.outer) {
      EXPECT_TRUE(p.x == kRawOrigin.x || p.x == kRawOrigin.x + 10) << p.x;
      EXPECT_TRUE(p.y == kRawOrigin.y || p.y == kRawOrigin.y + 10) << p.y;
    }
    EXPECT_EQ(found["yard"]->polygon.holes.size(), 1U);
    EXPECT_EQ(found["open"]->polygon.outer.size(), 4U);
    EXPECT_TRUE(dropped.contains("nothing") && dropped.contains("line"));
    // Vertices that are not finite, or far away, are there for the next step to see.
    for (const char* name : {"nan", "far"})
      EXPECT_TRUE(found.contains(name) || dropped.contains(name));
    EXPECT_EQ(found.size() + dropped.size(), 9U);
  }
}

TEST_P(RawVector, TheSameInputGivesTheSameBytes) {
  const fs::path one = write("a", true);
  const fs::path two = write("b", true);
  EXPECT_EQ(bytes_of(one), bytes_of(two));
  EXPECT_GT(bytes_of(one).size(), 1000U);
  for (const char* side : {".shx", ".dbf", ".prj"})
    EXPECT_EQ(bytes_of(fs::path(one).replace_extension(side)),
              bytes_of(fs::path(two).replace_extension(side)));
}

INSTANTIATE_TEST_SUITE_P(Formats, RawVector, ::testing::Values(".shp", ".geojson"),
                         [](const auto& parameter) { return std::string(parameter.param + 1); });

/// Little-endian number at a byte.
template <typename Number>
Number number_at(const std::string& bytes, std::size_t at) {
  Number value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

TEST(RawVectorBytes, ShapefilesKeepOpenRingsAndOddNumbers) {
  const TemporaryFolder folder;
  const double nan = kNan;
  write_raw_features(folder / "a.shp",
                     std::vector<RawFeature>{{"a", 1, {{{{0, 0, 0}, {5, 0, 0}, {5, nan, 0}}}}}},
                     {100, 200}, "", false);
  const std::string bytes = bytes_of(folder / "a.shp");
  // Header 100, record header 8, type 4, box 32, counts 8, first part 4.
  EXPECT_EQ(number_at<std::int32_t>(bytes, 108), 5);
  EXPECT_EQ(number_at<std::int32_t>(bytes, 144), 1);
  EXPECT_EQ(number_at<std::int32_t>(bytes, 148), 3);
  EXPECT_EQ(number_at<double>(bytes, 156), 100);
  EXPECT_EQ(number_at<double>(bytes, 172), 105);
  EXPECT_TRUE(std::isnan(number_at<double>(bytes, 196)));
  EXPECT_EQ(bytes.size(), 204U);
  EXPECT_FALSE(fs::exists(folder / "a.prj"));
}

TEST(RawVectorBytes, GeoJsonKeepsOpenRings) {
  const TemporaryFolder folder;
  write_raw_features(folder / "a.geojson", sample(), kRawOrigin, "EPSG:3006", false);
  std::string text = bytes_of(folder / "a.geojson");
  text.replace(text.find("NaN"), 3, "0.0");  // The only thing that is not JSON.
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["features"][6]["geometry"]["coordinates"][0].size(), 4U);
  EXPECT_TRUE(json["features"][3]["geometry"].is_null());
  EXPECT_EQ(json["features"][5]["geometry"]["coordinates"][0][1][1], 1e300);
}

TEST(RawVectorBytes, AnotherExtensionIsRefused) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_raw_features(folder / "a.gpkg", sample(), kRawOrigin, "EPSG:3006"), Error);
}

// Found by the survey: with every ring turned the wrong way, GDAL's first ring is the yard.
TEST(RawVectorBytes, ShapefilesTurnedTheWrongWayKeepTheirCourtyards) {
  const TemporaryFolder folder;
  for (const bool wrong : {false, true}) {
    const fs::path path = folder / (wrong ? "wrong.shp" : "right.shp");
    std::vector<RawFeature> features{
        {"yard", 1, {{square(0, 0, 30, !wrong), square(3, 3, 5, wrong)}}},
        {"yards",
         1,
         {{square(40, 0, 30, !wrong), square(43, 3, 5, wrong), square(60, 20, 6, wrong)}}},
        {"pavilion in one of two yards",
         1,
         {{square(80, 0, 30, !wrong), square(83, 3, 9, wrong), square(100, 20, 6, wrong)},
          {square(85, 5, 4, !wrong)}}}};
    write_raw_features(path, features, kRawOrigin, "EPSG:3006");
    const FootprintsInput input = read_footprints(path);
    std::map<std::string, double> areas;
    for (const Footprint& feature : input.features)
      areas[feature.source_id] = area(feature.polygon);
    EXPECT_EQ(areas, (std::map<std::string, double>{
                         {"0", 900 - 25}, {"1", 900 - 25 - 36}, {"2", 900 - 81 - 36}, {"2#2", 16}}))
        << wrong;
  }
}

TEST(RawVectorBytes, ShapefilesWhoseRingsAllTurnAsHolesKeepTheirCourtyards) {
  const TemporaryFolder folder;
  const std::vector<RawFeature> features{
      {"yard", 1, {{square(0, 0, 30, false), square(3, 3, 24, false)}}},
      {"hut", 1, {{square(48, 8, 4, false), square(43, 3, 20, false), square(40, 0, 30, false)}}},
      {"apart", 1, {{square(80, 0, 30, false), square(120, 3, 5, false)}}},
      {"over each other", 1, {{square(160, 0, 30)}, {square(163, 3, 24)}}}};
  write_raw_features(folder / "a.shp", features, kRawOrigin, "EPSG:3006");
  std::multiset<double> areas;
  for (const Footprint& feature : read_footprints(folder / "a.shp").features)
    areas.insert(area(feature.polygon));
  EXPECT_EQ(areas, (std::multiset<double>{900 - 576, 16, 900 - 400, 900, 25, 900, 576}));
}

/// Of the footprints, by id.
std::map<std::string, double> areas_in(const fs::path& path) {
  std::map<std::string, double> areas;
  ReadFootprintsOptions options;
  options.id_attribute = "id";
  for (const Footprint& feature : read_footprints(path, options).features)
    areas[feature.source_id] = area(feature.polygon);
  return areas;
}

// The same in a multipolygon: a hut in the yard stays a building, and so does what merely overlaps.
TEST(RawVectorBytes, PartsTurnedAgainstThePartAroundThemAreItsYards) {
  const TemporaryFolder folder;
  const std::vector<RawFeature> features{
      {"hut", 1, {{square(10, 10, 4, false)}, {square(3, 3, 20)}, {square(0, 0, 30, false)}}},
      {"over each other", 1, {{square(40, 0, 30, false)}, {square(43, 3, 5, false)}}},
      {"apart", 1, {{square(80, 0, 30, false)}, {square(120, 3, 5)}}}};
  write_raw_features(folder / "a.geojson", features, kRawOrigin, "EPSG:3006");
  EXPECT_EQ(areas_in(folder / "a.geojson"),
            (std::map<std::string, double>{{"hut", 16},
                                           {"hut#2", 500},
                                           {"over each other", 900},
                                           {"over each other#2", 25},
                                           {"apart", 900},
                                           {"apart#2", 25}}));
}

// Within the outline of the other part, but not within its walls.
TEST(RawVectorBytes, PartsInTheYardOfAnotherPartStayBuildingsWhateverTheirTurn) {
  const TemporaryFolder folder;
  const auto around_a_yard = [](double west) {
    return std::vector<RawRing>{square(west, 0, 30), square(west + 5, 5, 20, false)};
  };
  const std::vector<RawFeature> features{
      {"hut", 1, {around_a_yard(0), {square(10, 10, 4, false)}}},
      {"with a yard", 1, {around_a_yard(40), {square(48, 8, 14, false), square(50, 10, 6)}}},
      {"touching", 1, {around_a_yard(80), {square(85, 10, 4, false)}}},
      {"roof", 1, {around_a_yard(120), {square(125, 5, 20, false)}}},
      {"wider roof", 1, {around_a_yard(160), {square(164, 4, 22, false)}}},
      {"yard beside a yard",
       1,
       {{square(200, 0, 30), square(205, 5, 8, false)}, {square(220, 5, 6, false)}}}};
  write_raw_features(folder / "a.geojson", features, kRawOrigin, "EPSG:3006");
  EXPECT_EQ(areas_in(folder / "a.geojson"),
            (std::map<std::string, double>{{"hut", 500},
                                           {"hut#2", 16},
                                           {"with a yard", 500},
                                           {"with a yard#2", 196 - 36},
                                           {"touching", 500},
                                           {"touching#2", 16},
                                           {"roof", 500},
                                           {"roof#2", 400},
                                           {"wider roof", 500},
                                           {"wider roof#2", 484},
                                           {"yard beside a yard", 900 - 64 - 36}}));
}

TEST(PointFlags, GoIntoTheFileAndWithheldPointsAreLeftOut) {
  const TemporaryFolder folder;
  PointCloud cloud;
  std::vector<std::uint8_t> flags;
  for (int i = 0; i < 16; ++i) {
    cloud.push_back(i, 2 * i, 3 * i, 2);
    flags.push_back(static_cast<std::uint8_t>(i));  // Every combination.
  }
  for (const int format : {1, 6}) {
    WritePointsOptions options;
    options.point_format = format;
    options.flags = flags;
    const fs::path path = folder / (format == 1 ? "a.las" : "b.las");
    write_points(path, cloud, kRawOrigin, options);
    const std::string bytes = bytes_of(path);
    const auto first = number_at<std::uint32_t>(bytes, 96);
    const std::size_t record = format == 1 ? 28 : 30;
    for (std::size_t i = 0; i < 16; ++i) {
      // Byte 15: in formats 0 to 5 class and flags, in 6 and above the flags.
      const auto byte = number_at<std::uint8_t>(bytes, first + i * record + 15);
      EXPECT_EQ(format == 1 ? byte >> 5 : byte & 0x0F, format == 1 ? i & 7 : i) << format;
    }
    const std::vector<fs::path> paths{path};
    const PointsInput input = read_points(paths);
    EXPECT_EQ(input.points_kept, 8);
    for (const double x : input.points.x)
      EXPECT_EQ(static_cast<int>(x + input.origin.x - kRawOrigin.x) & kWithheldPoint, 0);
  }
}

}  // namespace
}  // namespace tetropolis
