#include "cloud_city.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/io/raster/geotiff.h"
#include "tetropolis/io/vector/vector.h"

#include "support/bytes.h"
#include "support/shapes.h"

namespace tetropolis::testing {

namespace fs = std::filesystem;

bool CloudOutcome::warned(const std::string& code) const {
  return std::any_of(report.warnings.begin(), report.warnings.end(),
                     [&](const Warning& warning) { return warning.code == code; });
}

PointCloud filtered(const PointCloud& cloud, const std::function<bool(std::size_t)>& keep) {
  PointCloud result;
  for (std::size_t p = 0; p < cloud.size(); ++p)
    if (keep(p)) append(result, cloud.x[p], cloud.y[p], cloud.z[p], cloud.classification[p]);
  return result;
}

void append(PointCloud& cloud, double x, double y, double z, int code) {
  // Whole millimetres, as files hold them: halves would be rounded up or down by the file's offset.
  const auto rounded = [](double metres) { return std::round(1000 * metres) / 1000; };
  cloud.push_back(rounded(x), rounded(y), rounded(z), static_cast<std::uint8_t>(code));
}

CloudCity::CloudCity() {
  footprints = {rectangle(20, 20, 36, 32), rectangle(50, 18, 62, 44), rectangle(78, 25, 108, 60),
                Polygon{{{22, 55}, {60, 55}, {60, 70}, {38, 70}, {38, 88}, {22, 88}}, {}},
                rectangle(84, 78, 96, 90)};
  footprints[2].holes = {{{86, 33}, {86, 52}, {100, 52}, {100, 33}}};
  roofs = {6, 15, 18, 9, 30};
  std::mt19937 random(1);  // always this cloud: how near results have to be is known of it
  std::uniform_real_distribution<double> share(0, 1);
  const auto noise = [&] { return 0.08 * (share(random) - 0.5); };
  for (int k = 0; k < 10000; ++k) {
    const double x = 130 * share(random), y = 110 * share(random);
    int code = kGround;
    double z = ground(x, y) + noise();
    for (std::size_t b = 0; b < footprints.size(); ++b) {
      if (!contains(footprints[b], {x, y})) continue;
      const Bounds2 around = bounds(footprints[b]);
      z = ground((around.xmin + around.xmax) / 2, (around.ymin + around.ymax) / 2) + roofs[b] +
          noise();
      code = kBuildingClass;
    }
    if (code == kGround && y > 96 && y < 102 && share(random) < 0.4) {
      z += 2 + 6 * share(random);
      code = kUnclassified;
    }
    append(cloud, x, y, z, code);
  }
  fs::create_directories(folder());
  std::vector<std::string> ids;
  for (std::size_t b = 0; b < footprints.size(); ++b) ids.push_back(std::to_string(b));
  write_footprints(scratch_ / "footprints.shp", footprints, ids, {}, origin, "EPSG:28992");
}

std::string CloudCity::write(const std::string& name, const PointCloud& points, int format) const {
  WritePointsOptions options;
  options.point_format = format;
  write_points(folder() / name, points, origin, options);
  return bytes_of(folder() / name);
}

void CloudCity::write_bytes(const std::string& name, const std::string& bytes) const {
  std::ofstream(folder() / name, std::ios::binary) << bytes;
}

CloudOutcome CloudCity::run(const std::function<void(Config&)>& change) const {
  Config config;
  config.footprints = {(scratch_ / "footprints.shp").string()};
  config.points = {folder().string()};
  config.id_attribute = "id";
  config.out = (scratch_ / "out").string();
  if (change) change(config);
  fs::remove_all(config.out);
  CloudOutcome outcome;
  try {
    outcome.report = run_city(config);
  } catch (const Error& error) {
    outcome.failed = true;
    outcome.kind = error.kind();
    outcome.message = error.what();
    EXPECT_FALSE(fs::exists(config.out)) << "a failed run left something behind";
    return outcome;
  }
  const fs::path out = config.out;
  outcome.raw = read_city(out / "city_raw.city.json");
  outcome.dtm = read_raster(out / "dtm.tif", outcome.raw.origin).raster;
  for (const char* name : {"city_raw.city.json", "city.city.json", "dtm.tif"})
    outcome.bytes += bytes_of(out / name);
  return outcome;
}

}  // namespace tetropolis::testing
