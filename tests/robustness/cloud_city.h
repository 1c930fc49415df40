// A small city whose clouds the tests damage, one defect at a time.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/error.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/run/run.h"
#include "tetropolis/terrain/raster.h"

#include "support/test_data.h"

namespace tetropolis::testing {

/// What came of one run.
struct CloudOutcome {
  bool failed = false;
  ErrorKind kind{};
  std::string message;  ///< Of the error.
  Report report;
  CityModel raw;  ///< Before simplification.
  Raster dtm;
  std::string bytes;  ///< Of city_raw.city.json, city.city.json and dtm.tif together.

  bool warned(const std::string& code) const;
};

/// 130 m x 110 m of ground that slopes by 4 %, five buildings, one of them with a courtyard, a row
/// of trees. About ten thousand points, classes 1, 2 and 6, noise of a few centimetres.
class CloudCity {
 public:
  CloudCity();

  /// Local coordinates; `origin` are those of EPSG:28992.
  PointCloud cloud;
  Point2 origin{85000, 447000};
  std::vector<Polygon> footprints;
  std::vector<double> roofs;  ///< Height of each building above the ground at its centre.

  /// Elevation of the bare ground.
  static double ground(double x, double y) { return 10 + 0.03 * x + 0.025 * y; }

  std::filesystem::path folder() const { return scratch_ / "points"; }
  /// Writes a cloud and returns its bytes.
  std::string write(const std::string& name, const PointCloud& points, int format = 1) const;
  std::string write(const std::string& name) const { return write(name, cloud); }
  void write_bytes(const std::string& name, const std::string& bytes) const;
  /// Steps 1.1 to 2.4 on all that is in the folder.
  CloudOutcome run(const std::function<void(Config&)>& change = {}) const;

 private:
  TemporaryFolder scratch_;
};

/// Points of `cloud` for which keep(index) holds.
PointCloud filtered(const PointCloud& cloud, const std::function<bool(std::size_t)>& keep);
void append(PointCloud& cloud, double x, double y, double z, int code);

}  // namespace tetropolis::testing
