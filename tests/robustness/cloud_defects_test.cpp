// Point clouds with one defect each, through the pipeline: the outcome of each is stated. How the
// reader words what is wrong with a file is tested in io/las_broken_test.cpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/terrain/raster.h"

#include "cloud_city.h"

namespace tetropolis {
namespace {

using testing::append;
using testing::CloudCity;
using testing::CloudOutcome;
using testing::filtered;

constexpr std::size_t kHeader = 227;  // bytes before the first point in what write() writes
constexpr std::size_t kRecord = 28;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <typename Number>
std::string patched(std::string bytes, std::size_t at, Number value) {
  std::array<char, sizeof value> number;
  std::memcpy(number.data(), &value, sizeof value);
  return bytes.replace(at, sizeof value, number.data(), sizeof value);
}

/// The city as it is, run once.
struct Undamaged {
  CloudCity city;
  CloudOutcome outcome;
  std::string las;  ///< Bytes of the cloud.
  std::string laz;

  Undamaged() {
    laz = city.write("a.laz");
    std::filesystem::remove(city.folder() / "a.laz");
    las = city.write("a.las");
    outcome = city.run();
  }
};

const Undamaged& undamaged() {
  static const Undamaged instance;
  return instance;
}

enum class Expected {
  kMinimum,  ///< All buildings have the minimum height and say so; their ground is as with kNear.
  kSame,     ///< Byte for byte the result of the undamaged city.
  kNear,     ///< Heights of all buildings within `tolerance` of the undamaged city's.
  kError,    ///< Exit code 3, one line that names the cloud and holds `words`.
};

struct Defect {
  const char* name;
  /// Puts files into the city's folder.
  std::function<void(const CloudCity&)> damage;
  Expected expected;
  std::string words;  ///< Of the error; otherwise the code of a warning that must come, or empty.
  double tolerance = 0;
};

void PrintTo(const Defect& defect, std::ostream* out) { *out << defect.name; }

/// Bytes of the good cloud through `change`.
std::function<void(const CloudCity&)> las(std::function<std::string(std::string)> change,
                                          const char* name = "a.las") {
  return [=](const CloudCity& city) { city.write_bytes(name, change(undamaged().las)); };
}

std::function<void(const CloudCity&)> laz(std::function<std::string(std::string)> change,
                                          const char* name = "a.laz") {
  return [=](const CloudCity& city) { city.write_bytes(name, change(undamaged().laz)); };
}

/// The good cloud through `change`, written as it should be.
std::function<void(const CloudCity&)> points(std::function<void(PointCloud&)> change,
                                             int format = 1) {
  return [=](const CloudCity& city) {
    PointCloud cloud = city.cloud;
    change(cloud);
    city.write("a.las", cloud, format);
  };
}

std::function<void(const CloudCity&)> classes(std::function<int(int)> change, int format = 1) {
  return points(
      [=](PointCloud& cloud) {
        for (std::uint8_t& code : cloud.classification)
          code = static_cast<std::uint8_t>(change(code));
      },
      format);
}

std::function<void(const CloudCity&)> cut(std::size_t size) {
  return las([=](std::string bytes) { return bytes.substr(0, size); });
}

template <typename Number>
std::function<void(const CloudCity&)> number(std::size_t at, Number value) {
  return las([=](std::string bytes) { return patched(bytes, at, value); });
}

/// A box other than the true one: xmax, xmin, ymax, ymin at bytes 179, 187, 195, 203.
std::function<void(const CloudCity&)> header_box(double xmin, double xmax, double ymin,
                                                 double ymax) {
  return las([=](std::string bytes) {
    bytes = patched(patched(bytes, 179, xmax), 187, xmin);
    return patched(patched(bytes, 195, ymax), 203, ymin);
  });
}

/// Records with `extra` bytes behind each.
std::string with_extra_bytes(const std::string& bytes, std::size_t extra) {
  std::string result =
      patched(bytes.substr(0, kHeader), 105, static_cast<std::uint16_t>(kRecord + extra));
  for (std::size_t at = kHeader; at < bytes.size(); at += kRecord)
    result += bytes.substr(at, kRecord) + std::string(extra, 'x');
  return result;
}

/// Bits above the class of the records chosen.
std::function<void(const CloudCity&)> flags(int bits, std::size_t every) {
  return las([=](std::string bytes) {
    for (std::size_t at = kHeader + 15; at < bytes.size(); at += kRecord * every) {
      const char byte = static_cast<char>(bytes[at] | bits);
      bytes = patched(std::move(bytes), at, byte);
    }
    return bytes;
  });
}

/// Adds stray points of one class, three high above the ground and three deep below it.
std::function<void(const CloudCity&)> strays(int code) {
  return points([=](PointCloud& cloud) {
    append(cloud, 10, 10, 100000, code);
    append(cloud, 70, 50, 92, code);
    append(cloud, 42, 25, 21.5, code);
    append(cloud, 115, 95, -60, code);
    append(cloud, 65, 30, 2, code);
    append(cloud, 15, 100, -5, code);
  });
}

int blank(int) { return 0; }

bool in_void(const PointCloud& cloud, std::size_t p) {
  return cloud.x[p] > 45 && cloud.x[p] < 70 && cloud.y[p] > 15 && cloud.y[p] < 40;
}

/// The city in two files by x.
std::function<void(const CloudCity&)> tiles(double end_of_west, double start_of_east) {
  return [=](const CloudCity& city) {
    const PointCloud& cloud = city.cloud;
    city.write("west.las",
               filtered(cloud, [&](std::size_t p) { return cloud.x[p] < end_of_west; }));
    city.write("east.las",
               filtered(cloud, [&](std::size_t p) { return cloud.x[p] >= start_of_east; }));
  };
}

/// The city in two files by x, of which the western one has other classes.
std::function<void(const CloudCity&)> half_with(const std::function<int(int)>& changed) {
  return [=](const CloudCity& city) {
    PointCloud west = filtered(city.cloud, [&](std::size_t p) { return city.cloud.x[p] < 65; });
    for (std::uint8_t& code : west.classification) code = static_cast<std::uint8_t>(changed(code));
    west.classification[0] = kWater;  // One stray is no class.
    city.write("west.las", west);
    city.write("east.las",
               filtered(city.cloud, [&](std::size_t p) { return city.cloud.x[p] >= 65; }));
  };
}

/// The city in a file per class.
void files_of_classes(const CloudCity& city) {
  for (const std::uint8_t code :
       std::set<std::uint8_t>(city.cloud.classification.begin(), city.cloud.classification.end()))
    city.write("class" + std::to_string(code) + ".las", filtered(city.cloud, [&](std::size_t p) {
                 return city.cloud.classification[p] == code;
               }));
}

std::vector<Defect> defects() {
  const auto as_is = [](std::string bytes) { return bytes; };
  constexpr std::uint32_t n = 10000;
  constexpr std::size_t size = kHeader + kRecord * n;
  return {
      // --- files that are cut ---
      {"Empty", cut(0), Expected::kError, "a.las: the file is empty"},
      {"CutInSignature", cut(3), Expected::kError, "a.las: is not a LAS or LAZ file"},
      {"CutInHeader", cut(100), Expected::kError, "ends at byte 100 within its header"},
      {"CutBehindHeader", cut(kHeader), Expected::kError, "ends at point 0 of 10000"},
      {"CutInFirstPoint", cut(kHeader + 5), Expected::kError, "ends at point 0 of 10000"},
      {"CutBetweenPoints", cut(kHeader + 4000 * kRecord), Expected::kError,
       "ends at point 4000 of 10000"},
      {"CutInLastPoint", cut(size - 1), Expected::kError, "ends at point 9999 of 10000"},
      {"LazCutInMiddle", laz([](std::string b) { return b.substr(0, b.size() / 2); }),
       Expected::kError, "the file is cut"},
      // --- numbers of the header ---
      {"CountTooLarge", number(107, n + 1000), Expected::kError, "ends at point 10000 of 11000"},
      {"CountZero", number(107, std::uint32_t{0}), Expected::kSame, "las_count_missing"},
      {"CountFourBillion", number(107, std::uint32_t{4294967295U}), Expected::kError,
       "ends at point 10000 of 4294967295"},
      {"CountTooSmall", number(107, n - 100), Expected::kNear, "las_count_small", 0.1},
      {"LazCountTooLarge", laz([=](std::string b) { return patched(b, 107, n + 1000); }),
       Expected::kError, "a.laz: "},
      {"LazCountZero", laz([](std::string b) { return patched(b, 107, std::uint32_t{0}); }),
       Expected::kError, "counts 0 points, but"},
      {"TwoTilesThatLookAlike",
       [](const CloudCity& city) {
         // Halves of the cloud, each with the box of the whole and as many points.
         std::array<PointCloud, 2> half;
         for (std::size_t p = 0; p < city.cloud.size(); ++p)
           append(half[p % 2], city.cloud.x[p], city.cloud.y[p], city.cloud.z[p],
                  city.cloud.classification[p]);
         for (const int i : {0, 1}) {
           std::string bytes =
               city.write(i == 0 ? "a.las" : "b.las", half[static_cast<std::size_t>(i)]);
           for (std::size_t at = 179; at < 227; ++at) bytes[at] = undamaged().las[at];
           city.write_bytes(i == 0 ? "a.las" : "b.las", bytes);
         }
       },
       Expected::kNear, "", 1e-6},
      {"BoxElsewhere", header_box(1e6, 2e6, 1e6, 2e6), Expected::kNear, "las_box_untrusted", 1e-6},
      {"BoxInsideOut", header_box(85130, 85000, 447110, 447000), Expected::kNear,
       "las_box_untrusted", 1e-6},
      {"BoxNan", header_box(kNan, kNan, kNan, kNan), Expected::kNear, "las_box_untrusted", 1e-6},
      {"BoxTooLarge", header_box(-1e7, 1e7, -1e7, 1e7), Expected::kNear, "", 1e-6},
      {"BoxTooSmall", header_box(85060, 85061, 447050, 447051), Expected::kNear,
       "las_points_outside_box", 1e-6},
      {"PointsBeyondFile", number(96, static_cast<std::uint32_t>(size + 10)), Expected::kError,
       "before its points start"},
      {"PointsAtEnd", number(96, static_cast<std::uint32_t>(size)), Expected::kError,
       "ends at point 0 of 10000"},
      {"PointsInsideHeader", number(96, std::uint32_t{10}), Expected::kError, "byte 96"},
      {"PointsStartLate", number(96, std::uint32_t{kHeader + 5}), Expected::kError,
       "ends at point 9999 of 10000"},
      {"ScaleZero", number(139, 0.0), Expected::kError, "byte 139"},
      {"ScaleTiny", number(147, 1e-300), Expected::kError, "byte 147 gives scale 1e-300"},
      {"ScaleNegative", number(131, -0.001), Expected::kError, "byte 131"},
      {"ScaleNan", number(131, kNan), Expected::kError, "byte 131"},
      {"OffsetInfinite", number(155, std::numeric_limits<double>::infinity()), Expected::kError,
       "offset inf"},
      {"OffsetElsewhere", number(155, 500000.0), Expected::kError,
       "none of 10000 points is usable in the domain"},
      {"RecordTooShort", number(105, std::uint16_t{20}), Expected::kError, "byte 105"},
      {"RecordTooLong", number(105, std::uint16_t{29}), Expected::kError, "the file is cut"},
      {"FormatUnknown", number(104, std::uint8_t{17}), Expected::kError, "byte 104"},
      // --- bytes that are there or are not ---
      {"ExtraBytesInRecords", las([](std::string b) { return with_extra_bytes(b, 7); }),
       Expected::kSame, ""},
      {"FewBytesBehindPoints", las([](std::string b) { return b + "0123456789"; }), Expected::kSame,
       ""},
      {"ManyBytesBehindPoints", las([](std::string b) { return b + std::string(5000, '\x07'); }),
       Expected::kSame, "las_count_small"},
      {"CompressedUnderLas", laz(as_is, "a.las"), Expected::kSame, ""},
      {"PlainUnderLaz", las(as_is, "a.laz"), Expected::kSame, ""},
      {"ExtensionInCapitals", las(as_is, "A.LAS"), Expected::kSame, ""},
      {"SameCloudAsLasAndLaz",
       [](const CloudCity& city) {
         city.write_bytes("a.las", undamaged().las);
         city.write_bytes("a.laz", undamaged().laz);
       },
       Expected::kSame, "las_twin"},
      {"SameCloudBeforeAndAfterItWasClassified",
       [](const CloudCity& city) {
         PointCloud cloud = city.cloud;
         std::fill(cloud.classification.begin(), cloud.classification.end(), kUnclassified);
         city.write("a.las", cloud);
         city.write_bytes("b.las", undamaged().las);
       },
       Expected::kSame, "las_twin"},
      {"RotInsidePlainFile", las([](std::string b) {
         for (std::size_t k = 0; k < 40; ++k)
           b = patched(std::move(b), kHeader + (100 + 200 * k) * kRecord,
                       std::uint32_t{0x5A5A5A5A});
         return b;
       }),
       Expected::kNear, "las_points_outside_box", 0.1},
      // --- flags and classes ---
      {"SyntheticFlag", flags(0x20, 3), Expected::kSame, ""},
      {"KeyPointFlag", flags(0x40, 3), Expected::kSame, ""},
      {"WithheldFlag", flags(0x80, 10), Expected::kNear, "", 0.1},
      {"AllWithheld", flags(0x80, 1), Expected::kError, "withheld"},
      {"OverlapFlag",
       [](const CloudCity& city) {
         std::string bytes = city.write("a.las", city.cloud, 6);
         for (std::size_t at = bytes.size() - 30 * 10000 + 15; at < bytes.size(); at += 90) {
           const char byte = static_cast<char>(bytes[at] | 0x08);
           bytes = patched(std::move(bytes), at, byte);
         }
         city.write_bytes("a.las", bytes);
       },
       Expected::kSame, ""},
      {"ClassAbove31", classes([](int c) { return c == kUnclassified ? 200 : c; }, 6),
       Expected::kSame, ""},
      {"AllClassZero", classes(blank), Expected::kNear, "ground_filtered", 0.15},
      {"ClassesZeroAndOne", classes([](int c) { return c == kGround ? 0 : 1; }), Expected::kNear,
       "ground_filtered", 0.15},
      {"GroundUnclassified", classes([](int c) { return c == kGround ? 1 : c; }), Expected::kNear,
       "ground_filtered", 0.15},
      {"BuildingsUnclassified", classes([](int c) { return c == kBuildingClass ? 1 : c; }),
       Expected::kNear, "no_building_class", 0.05},
      {"OneStrayBuildingPoint", points([](PointCloud& cloud) {
         bool first = true;
         for (std::uint8_t& code : cloud.classification)
           if (code == kBuildingClass && !std::exchange(first, false)) code = kUnclassified;
       }),
       Expected::kNear, "no_building_class", 0.05},
      {"OneStrayGroundPoint", points([](PointCloud& cloud) {
         bool first = true;
         for (std::uint8_t& code : cloud.classification)
           if (code == kGround && !std::exchange(first, false)) code = kUnclassified;
       }),
       Expected::kNear, "ground_filtered", 0.15},
      {"OnlyBuildings", points([](PointCloud& cloud) {
         cloud = filtered(cloud,
                          [&](std::size_t p) { return cloud.classification[p] == kBuildingClass; });
       }),
       Expected::kError, "no ground among the points, only class 6"},
      {"OnlyGround", points([](PointCloud& cloud) {
         cloud = filtered(cloud, [&](std::size_t p) { return cloud.classification[p] == kGround; });
       }),
       Expected::kMinimum, "no_roof_points", 1e-6},
      {"AllVegetation", classes([](int) { return 5; }), Expected::kError,
       "no ground among the points, only class 5 (10000 points)"},
      {"AllNoise", classes([](int) { return 7; }), Expected::kError, "all are noise"},
      // --- points ---
      {"EveryPointTwice", points([](PointCloud& cloud) {
         const PointCloud once = cloud;
         for (std::size_t p = 0; p < once.size(); ++p)
           append(cloud, once.x[p], once.y[p], once.z[p], once.classification[p]);
       }),
       Expected::kNear, "", 0.02},
      {"BirdsAndPitsInNoiseClass", strays(kHighNoise), Expected::kNear, "", 1e-6},
      {"BirdsAndPitsInGroundClass", strays(kGround), Expected::kNear, "ground_outliers", 1e-6},
      {"BirdsAndPitsUnclassified", strays(kUnclassified), Expected::kNear, "", 1e-6},
      {"BirdsAndPitsInBuildingClass", strays(kBuildingClass), Expected::kNear, "", 1e-6},
      {"BirdAndPitOverRoof", points([](PointCloud& cloud) {
         append(cloud, 28, 26, 100000, kBuildingClass);
         append(cloud, 29, 27, -60, kBuildingClass);
       }),
       Expected::kNear, "", 0.1},
      {"NoPoints", points([](PointCloud& cloud) { cloud = {}; }), Expected::kError,
       "the point cloud has no points"},
      {"OnePoint", points([](PointCloud& cloud) {
         cloud = filtered(cloud, [](std::size_t p) { return p == 5000; });
       }),
       Expected::kError, "the domain is 0.000 m x 0.000 m (points in it: 1)"},
      {"CollinearPoints",
       points([](PointCloud& cloud) { std::fill(cloud.y.begin(), cloud.y.end(), 50.0); }),
       Expected::kError, "m x 0.000 m (points in it: "},
      {"CollinearOnASlant", points([](PointCloud& cloud) { cloud.y = cloud.x; }), Expected::kNear,
       "terrain_mostly_filled", std::numeric_limits<double>::infinity()},
      {"AllPointsAtOnePlace", points([](PointCloud& cloud) {
         std::fill(cloud.x.begin(), cloud.x.end(), 50.0);
         std::fill(cloud.y.begin(), cloud.y.end(), 50.0);
       }),
       Expected::kError, "too small"},
      {"VoidOf25Metres", points([](PointCloud& cloud) {
         cloud = filtered(cloud, [&](std::size_t p) { return !in_void(cloud, p); });
       }),
       Expected::kNear, "", 0.7},
      {"TilesThatTouch", tiles(65, 65), Expected::kNear, "", 1e-6},
      {"TilesThatOverlap", tiles(75, 55), Expected::kNear, "", 0.1},
      {"TilesWithAGap", tiles(63, 68), Expected::kNear, "", 0.05},
      {"OneTileUnclassified", half_with([](int) { return 1; }), Expected::kNear,
       "building_class_partly", 0.15},
      {"OneTileWithoutBuildings", half_with([](int c) { return c == kBuildingClass ? 1 : c; }),
       Expected::kNear, "building_class_partly", 0.05},
      {"OneTileWithoutGround", half_with([](int c) { return c == kGround ? 1 : c; }),
       Expected::kNear, "ground_filtered", 0.15},
      {"OneTileWithAnotherCodeForBuildings", half_with([](int c) {
         return c == kBuildingClass ? 26 : c == 1 ? 5 : c;
       }),
       Expected::kNear, "building_class_partly", 0.05},
      {"AFilePerClass", files_of_classes, Expected::kNear, "", 1e-6},
  };
}

class CloudDefects : public ::testing::TestWithParam<Defect> {};

void expect_error(const Defect& defect, const CloudOutcome& outcome, const CloudCity& city) {
  ASSERT_TRUE(outcome.failed);
  EXPECT_EQ(outcome.kind, ErrorKind::kInput) << outcome.message;
  EXPECT_NE(outcome.message.find(defect.words), std::string::npos) << outcome.message;
  EXPECT_NE(outcome.message.find(city.folder().string()), std::string::npos) << outcome.message;
  EXPECT_EQ(outcome.message.find('\n'), std::string::npos) << outcome.message;
}

void expect_near(const CloudOutcome& outcome, double tolerance) {
  const CityModel& expected = undamaged().outcome.raw;
  if (std::isinf(tolerance)) return;
  ASSERT_EQ(outcome.raw.buildings.size(), expected.buildings.size());
  for (std::size_t b = 0; b < expected.buildings.size(); ++b) {
    const Building& building = outcome.raw.buildings[b];
    EXPECT_NEAR(building.h_ground, expected.buildings[b].h_ground, tolerance) << b;
    EXPECT_NEAR(building.h_roof, expected.buildings[b].h_roof, tolerance) << b;
  }
}

void expect_minimum(const CloudOutcome& outcome, double tolerance) {
  const CityModel& expected = undamaged().outcome.raw;
  ASSERT_EQ(outcome.raw.buildings.size(), expected.buildings.size());
  for (std::size_t b = 0; b < expected.buildings.size(); ++b) {
    const Building& building = outcome.raw.buildings[b];
    EXPECT_NEAR(building.h_ground, expected.buildings[b].h_ground, tolerance) << b;
    EXPECT_NEAR(building.h_roof, building.h_ground + Config{}.min_building_height, 1e-9) << b;
    EXPECT_TRUE((building.flags & kNoRoofPoints) != 0) << b;
  }
}

/// How far the terrain is from the bare ground, at worst.
double terrain_error(const CloudOutcome& outcome, const CloudCity& city) {
  double worst = 0;
  for (std::int32_t j = 0; j < outcome.dtm.ny; ++j)
    for (std::int32_t i = 0; i < outcome.dtm.nx; ++i) {
      const double x = outcome.dtm.x0 + i + outcome.raw.origin.x - city.origin.x;
      const double y = outcome.dtm.y0 + j + outcome.raw.origin.y - city.origin.y;
      worst = std::max(worst, std::abs(outcome.dtm.at(i, j) - CloudCity::ground(x, y)));
    }
  return worst;
}

/// The points of the city name no reference system; some defects take that of the footprints.
bool is_of_reference_system(const Warning& warning) {
  return warning.code == "footprints_crs_unknown" || warning.code == "points_crs_unknown";
}

TEST_P(CloudDefects, HaveTheOutcomeStated) {
  const Defect& defect = GetParam();
  const CloudCity city;
  defect.damage(city);
  const CloudOutcome outcome = city.run();
  if (defect.expected == Expected::kError) {
    expect_error(defect, outcome, city);
    return;
  }
  ASSERT_FALSE(outcome.failed) << outcome.message;
  if (!defect.words.empty()) {
    EXPECT_TRUE(outcome.warned(defect.words)) << defect.words;
  } else {
    for (const Warning& warning : outcome.report.warnings)
      EXPECT_TRUE(is_of_reference_system(warning)) << warning.message;
  }
  if (defect.expected == Expected::kSame)
    EXPECT_TRUE(outcome.bytes == undamaged().outcome.bytes);
  else if (defect.expected == Expected::kMinimum)
    expect_minimum(outcome, defect.tolerance);
  else
    expect_near(outcome, defect.tolerance);
  // Whatever was wrong: no hill and no hole that is not there.
  if (!std::isinf(defect.tolerance)) {
    EXPECT_LT(terrain_error(outcome, city), 0.6);
  }
}

INSTANTIATE_TEST_SUITE_P(All, CloudDefects, ::testing::ValuesIn(defects()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(CloudCity, HasTheHeightsItWasMadeOf) {
  const Undamaged& good = undamaged();
  ASSERT_FALSE(good.outcome.failed) << good.outcome.message;
  for (const Warning& warning : good.outcome.report.warnings)
    EXPECT_TRUE(is_of_reference_system(warning)) << warning.message;
  ASSERT_EQ(good.outcome.raw.buildings.size(), good.city.footprints.size());
  EXPECT_EQ(good.outcome.report.input->points_read, 10000);
}

TEST(CloudDefect, CutLazNeverPassesForAWholeOne) {
  const std::string& good = undamaged().laz;
  const CloudCity city;
  for (std::size_t size = 0; size < good.size(); size += good.size() / 23 + 1) {
    SCOPED_TRACE(size);
    city.write_bytes("a.laz", good.substr(0, size));
    const CloudOutcome outcome = city.run();
    ASSERT_TRUE(outcome.failed);
    EXPECT_EQ(outcome.kind, ErrorKind::kInput);
    EXPECT_NE(outcome.message.find("a.laz: "), std::string::npos) << outcome.message;
  }
}

// LAZ has no checksums. Rot shows as an error of the decoder or as points that cannot be; single
// wrong numbers that are plausible cannot be told.
TEST(CloudDefect, RotInsideAChunkIsAnErrorOrAWarning) {
  const CloudCity city;
  for (const int format : {1, 6}) {
    const std::string good = city.write("a.laz", city.cloud, format);
    int runs = 0, seen = 0;
    for (std::size_t at = good.size() / 50; at < good.size() - 100; at += good.size() / 20) {
      SCOPED_TRACE(at);
      std::string bytes = good;
      for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = static_cast<char>(bytes[at + k] ^ 0x5A);
      city.write_bytes("a.laz", bytes);
      const CloudOutcome outcome = city.run();
      if (outcome.failed) {
        EXPECT_EQ(outcome.kind, ErrorKind::kInput);
        EXPECT_NE(outcome.message.find("a.laz: "), std::string::npos) << outcome.message;
      }
      ++runs;
      seen += outcome.failed || outcome.warned("las_points_outside_box") ? 1 : 0;
    }
    EXPECT_EQ(seen, runs) << format;
  }
}

// What misread points lead to is blamed on the domain, the classes, the memory or the footprints.
TEST(CloudDefect, ErrorsOfMisreadPointsNameTheirFile) {
  const auto scaled = [](double scale) {
    std::string bytes = undamaged().las;
    for (const std::size_t axis : {0, 1, 2}) bytes = patched(bytes, 131 + 8 * axis, scale);
    return bytes;
  };
  const auto no_bounds = [](Config& config) { config.bounds.clear(); };
  const auto terrain_only = [](Config& config) {
    config.footprints.clear();
    config.terrain_only = true;
    config.bounds.clear();
  };
  std::string inserted = undamaged().las;
  inserted.insert(kHeader, "abc");
  const CloudCity city;
  for (const std::string& bytes :
       {scaled(1), scaled(1000), inserted, patched(undamaged().las, 155, 5e5)}) {
    city.write_bytes("a.las", bytes);
    for (const std::function<void(Config&)>& change :
         {std::function<void(Config&)>(no_bounds), std::function<void(Config&)>(terrain_only)}) {
      const CloudOutcome outcome = city.run(change);
      if (!outcome.failed) continue;  // the terrain of wrong points, with a warning
      const std::size_t hint =
          outcome.message.find((city.folder() / "a.las").string() +
                               ": 10000 of 10000 points lie outside the header's box");
      EXPECT_NE(hint, std::string::npos) << outcome.message;
    }
    EXPECT_TRUE(city.run(no_bounds).failed);
  }
  // Not of others.
  std::string few = undamaged().las;
  for (std::size_t k = 0; k < 40; ++k)
    few = patched(std::move(few), kHeader + (100 + 200 * k) * kRecord, std::uint32_t{0x5A5A5A5A});
  city.write_bytes("a.las", few);
  const CloudOutcome outcome = city.run([](Config& config) { config.bounds = {0, 0, 10, 10}; });
  ASSERT_TRUE(outcome.failed);
  EXPECT_EQ(outcome.message.find("lie outside the header's box"), std::string::npos)
      << outcome.message;
}

/// Without bounds and footprints only the points themselves tell where the terrain is.
TEST(CloudDefect, HeadersThatLieDoNotMoveTheTerrain) {
  const auto terrain_only = [](Config& config) {
    config.footprints.clear();
    config.terrain_only = true;
  };
  const CloudCity city;
  city.write("a.las");
  const CloudOutcome sound = city.run(terrain_only);
  ASSERT_FALSE(sound.failed) << sound.message;
  EXPECT_EQ(sound.raw.origin, city.origin);
  int boxes = 0;
  for (const Defect& defect : defects()) {
    if (!std::string_view(defect.name).starts_with("Box")) continue;
    SCOPED_TRACE(defect.name);
    ++boxes;
    defect.damage(city);
    const CloudOutcome outcome = city.run(terrain_only);
    ASSERT_FALSE(outcome.failed) << outcome.message;
    EXPECT_EQ(outcome.report.input->points_kept, sound.report.input->points_kept);
    EXPECT_TRUE(outcome.bytes == sound.bytes);
  }
  EXPECT_EQ(boxes, 5);
}

TEST(CloudDefect, TheSameWithAnyNumberOfThreads) {
  const CloudCity city;
  PointCloud cloud = city.cloud;
  std::fill(cloud.classification.begin(), cloud.classification.end(), kUnclassified);
  city.write("a.laz", cloud);
  const CloudOutcome one = city.run([](Config& config) { config.threads = 1; });
  const CloudOutcome four = city.run([](Config& config) { config.threads = 4; });
  EXPECT_GT(one.report.input->ground_filtered, 5000);
  EXPECT_TRUE(one.bytes == four.bytes);
}

TEST(CloudDefect, TheGroundFilterRunsWhenItIsAskedTo) {
  const CloudCity city;
  city.write("a.las");
  const CloudOutcome always =
      city.run([](Config& config) { config.ground_filter = GroundFilter::kAlways; });
  EXPECT_TRUE(always.warned("ground_filtered"));
  EXPECT_LT(terrain_error(always, city), 0.6);
  PointCloud cloud = city.cloud;
  std::fill(cloud.classification.begin(), cloud.classification.end(), kUnclassified);
  city.write("a.las", cloud);
  const CloudOutcome never =
      city.run([](Config& config) { config.ground_filter = GroundFilter::kNever; });
  ASSERT_TRUE(never.failed);
  EXPECT_NE(never.message.find("only class 1 (10000 points)"), std::string::npos) << never.message;
}

}  // namespace
}  // namespace tetropolis
