#include "tetropolis/io/las/point_arrays.h"

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"

#include "las_support.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using Xyz = std::vector<std::array<double, 3>>;

constexpr Point2 kOrigin{85'000, 446'000};

/// The points of a cloud in CRS coordinates.
Xyz absolute(const PointCloud& cloud, Point2 origin) {
  Xyz xyz;
  for (std::size_t p = 0; p < cloud.size(); ++p)
    xyz.push_back({cloud.x[p] + origin.x, cloud.y[p] + origin.y, cloud.z[p]});
  return xyz;
}

TEST(PointArrays, AreWhatAFileWithThemIs) {
  const testing::TemporaryFolder folder;
  const PointCloud cloud = testing::random_cloud(20'000, 20);
  std::vector<std::uint8_t> flags(cloud.size()), withheld(cloud.size());
  for (std::size_t p = 0; p < cloud.size(); p += 7) {
    flags[p] = kWithheldPoint;
    withheld[p] = 1;
  }
  WritePointsOptions writing;
  writing.scale = 1e-4;
  writing.crs = "EPSG:28992";
  writing.flags = flags;
  write_points(folder / "a.las", cloud, kOrigin, writing);
  const Xyz xyz = absolute(cloud, kOrigin);
  PointArrays arrays;
  arrays.xyz = xyz;
  arrays.classification = cloud.classification;
  arrays.withheld = withheld;
  arrays.crs = "EPSG:28992";

  ReadPointsOptions cropped;
  cropped.crop = Bounds2{85'100.25, 446'050.5, 85'300.75, 446'400};
  ReadPointsOptions placed = testing::all_points();
  placed.origin = Point2{85'050, 446'010};
  for (const ReadPointsOptions& options : {ReadPointsOptions{}, cropped, placed}) {
    const PointsInput file = testing::read_one(folder / "a.las", options);
    const PointsInput taken = take_points(arrays, options);
    ASSERT_GT(file.points_kept, 0);
    EXPECT_TRUE(testing::same(taken.points, file.points));
    EXPECT_EQ(taken.points_read, file.points_read);
    EXPECT_EQ(taken.points_kept, file.points_kept);
    EXPECT_EQ(taken.points_by_class, file.points_by_class);
    EXPECT_EQ(taken.origin, file.origin);
    EXPECT_NEAR(taken.extent.xmin, file.extent.xmin, 1e-4);
    EXPECT_NEAR(taken.extent.ymax, file.extent.ymax, 1e-4);
    EXPECT_EQ(taken.crs, file.crs);
    ASSERT_EQ(taken.files.size(), 1U);
    EXPECT_EQ(taken.files[0].by_class, file.files[0].by_class);
    EXPECT_EQ(taken.files[0].kept.end, taken.points.size());
  }
}

TEST(PointArrays, WithoutClassesNoneWasClassified) {
  const Xyz xyz{{1, 2, 3}, {4, 5, 6}};
  PointArrays arrays;
  arrays.xyz = xyz;
  const PointsInput taken = take_points(arrays);
  EXPECT_EQ(taken.points_by_class, (std::map<int, std::int64_t>{{kNeverClassified, 2}}));
  EXPECT_EQ(taken.crs, "");
  arrays.xyz = {};
  EXPECT_EQ(take_points(arrays).points.size(), 0U);
}

TEST(PointArrays, WhatIsNotFiniteIsLeftOut) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Xyz xyz{{kNaN, 2, 3}, {1, 2, 3}, {1, -kInfinity, 3}, {1, 2, kNaN}};
  PointArrays arrays;
  arrays.xyz = xyz;
  const PointsInput taken = take_points(arrays);
  EXPECT_EQ(taken.points_kept, 1);
  EXPECT_EQ(taken.origin, (Point2{1, 2}));
  ASSERT_EQ(taken.warnings.size(), 1U);
  EXPECT_EQ(taken.warnings[0].code, "points_not_finite");
  EXPECT_EQ(taken.warnings[0].count, 3);
}

TEST(PointArrays, MistakesAreTold) {
  const Xyz xyz{{1, 2, 3}, {300'000, 2, 3}};
  const std::vector<std::uint8_t> one{2};
  const auto kind_of = [](const PointArrays& arrays) {
    try {
      take_points(arrays);
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("points"), std::string::npos) << error.what();
      return error.kind();
    }
    ADD_FAILURE() << "no error";
    return ErrorKind::kGuarantee;
  };
  PointArrays arrays;
  arrays.xyz = xyz;
  EXPECT_EQ(kind_of(arrays), ErrorKind::kInput);  // 300 km apart
  arrays.classification = one;
  EXPECT_EQ(kind_of(arrays), ErrorKind::kUsage);
  arrays.classification = {};
  arrays.withheld = one;
  EXPECT_EQ(kind_of(arrays), ErrorKind::kUsage);
}

}  // namespace
}  // namespace tetropolis
