// Seven buildings on a slope, measured point by point without noise: every result can be told by
// hand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/run/config.h"

#include "support/shapes.h"
#include "support/test_data.h"

namespace tetropolis::testing {

/// Local coordinates; change what is public, then write().
struct Village {
  static constexpr double kWidth = 140, kDepth = 80;
  enum Place : std::size_t { kHall, kAnnex, kShed, kBent, kWest, kEast, kUnseen };

  /// Elevation of the bare ground.
  static double ground(double x) { return 10 + 0.05 * x; }

  Point2 origin{85000, 447000};
  std::vector<Polygon> footprints{
      rectangle(15, 15, 35, 30), rectangle(35.6, 15, 45, 25),  // merges with the hall
      rectangle(60, 15, 66, 21),
      Polygon{{{60, 40}, {61, 39.985}, {70, 40}, {70, 50}, {60, 50}}, {}},
      // Their common wall is off by a millimetre: it takes long patches to join them.
      Polygon{{{26.243, 50}, {34.455, 50.499}, {33.211, 70.942}, {25, 70.442}}, {}},
      Polygon{{{34.455, 50.499}, {42.666, 50.999}, {41.773, 65.691}, {33.561, 65.192}}, {}},
      rectangle(75, 60, 85, 70),  // no point of a roof in it
  };
  std::vector<std::string> ids{"hall", "annex", "shed", "bent", "west", "east", "unseen"};
  std::vector<double> heights{12, 6, 1.5, 8, 8, 8, 9};
  std::string footprints_crs = "EPSG:28992";
  std::string points_crs = "EPSG:28992";
  int point_format = 1;
  std::string footprints_file = "footprints.shp";
  double points_scale = 0.001;
  bool points_are_local = true;  ///< Else in CRS coordinates.
  PointCloud cloud;
  std::vector<std::uint8_t> flags;  ///< Of points; empty: none.

  Village() {
    for (double y = 0.5; y < kDepth; ++y)
      for (double x = 0.5; x < kWidth; ++x) {
        double z = ground(x);
        std::uint8_t code = kGround;
        for (std::size_t b = 0; b < kUnseen; ++b) {
          if (!contains(footprints[b], {x, y})) continue;
          z += heights[b];
          if (b == kHall) z = 20 + 0.2 * (x - 15);
          code = kBuildingClass;
        }
        cloud.push_back(x, y, z, code);
      }
    for (const double x : {20.0, 30.0})
      cloud.push_back(x, 22, 60, kBuildingClass);  // masts on the hall
  }

  /// Lifts one point.
  void raise(std::size_t p, double by) { cloud.z[p] = cloud.z[p] + by; }

  /// Writes both files and names them in the settings.
  void write(const std::filesystem::path& folder, Config& config) const {
    write_footprints(folder / footprints_file, footprints, ids, heights, origin, footprints_crs);
    WritePointsOptions options;
    options.point_format = point_format;
    options.crs = points_crs;
    options.flags = flags;
    options.scale = points_scale;
    write_points(folder / "points.las", cloud, points_are_local ? origin : Point2{}, options);
    config.footprints = {(folder / footprints_file).string()};
    config.points = {(folder / "points.las").string()};
    config.out = (folder / "out").string();
    config.measured_ground = MeasuredGround::kKeep;  // the unseen stays
  }
};

}  // namespace tetropolis::testing
