#include "mistaken_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/crs.h"

namespace tetropolis {

namespace {

namespace fs = std::filesystem;

bool ends_with_any(const fs::path& path, std::initializer_list<std::string_view> endings) {
  std::string name = path.filename().string();
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return std::any_of(endings.begin(), endings.end(),
                     [&](std::string_view ending) { return name.ends_with(ending); });
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

bool has_points_name(const fs::path& path) { return ends_with_any(path, {".las", ".laz"}); }

bool has_vector_name(const fs::path& path) {
  return ends_with_any(path, {".shp", ".gpkg", ".geojson", ".fgb", ".gml", ".kml", ".osm", ".pbf",
                              ".sqlite", ".json"});
}

bool is_cloud(const fs::path& path) {
  std::array<char, 4> start{};
  std::ifstream file(path, std::ios::binary);
  return file.read(start.data(), start.size()) &&
         std::string_view(start.data(), start.size()) == "LASF";
}

/// Whether it is a point cloud, or a folder of point clouds without a vector file.
bool holds_points_only(const fs::path& path) {
  if (is_file(path)) return is_cloud(path);
  bool points = false;
  std::error_code error;
  for (fs::directory_iterator at(path, error), end; !error && at != end; at.increment(error)) {
    if (has_vector_name(at->path())) return false;
    points = points || has_points_name(at->path());
  }
  return points;
}

bool is_vector(const fs::path& path) {
  return is_file(path) && has_vector_name(path) && !is_cloud(path);
}

[[noreturn]] void fail(const std::string& path, const char* what, const char* setting, bool swapped,
                       const char* other) {
  throw Error(ErrorKind::kUsage,
              fmt::format("{}: is a {}, but given as `{}`; {}", path, what, setting,
                          swapped ? fmt::format("swap `{}` and `{}`", setting, other)
                                  : fmt::format("name it as `{}`", other)));
}

}  // namespace

void refuse_swapped_input(const Config& config) {
  const auto vector = std::find_if(config.points.begin(), config.points.end(),
                                   [](const std::string& path) { return is_vector(path); });
  const bool has_vector = vector != config.points.end();
  if (!config.footprints.empty() && holds_points_only(config.footprints))
    fail(config.footprints, is_file(config.footprints) ? "point cloud" : "folder of point clouds",
         "footprints", has_vector, "points");
  if (has_vector) fail(*vector, "vector file", "points", false, "footprints");
  const auto is_terrain = [](const std::string& path) {
    return is_file(path) && ends_with_any(path, {".tif", ".tiff"});
  };
  const auto is_model = [](const std::string& path) {
    return is_file(path) && ends_with_any(path, {".json", ".cityjson"});
  };
  if (is_terrain(config.city)) fail(config.city, "raster", "city", is_model(config.dtm), "dtm");
  if (is_model(config.dtm)) fail(config.dtm, "JSON file", "dtm", false, "city");
}

void refuse_degree_bounds(const Config& config, const std::string& crs, const Bounds2& data) {
  if (config.bounds.size() != 4 || crs.empty() || data.empty() || is_geographic(crs)) return;
  const Bounds2 given{config.bounds[0], config.bounds[1], config.bounds[2], config.bounds[3]};
  if (given.intersects(data)) return;
  constexpr Bounds2 kGlobe{-180, -90, 180, 90};
  for (const Bounds2& degrees : {given, Bounds2{given.ymin, given.xmin, given.ymax, given.xmax}}) {
    if (!kGlobe.covers(degrees)) continue;
    std::vector<Point2> rim;
    for (const double x : {0.0, 0.5, 1.0})
      for (const double y : {0.0, 0.5, 1.0})
        rim.push_back({degrees.xmin + x * degrees.width(), degrees.ymin + y * degrees.height()});
    Bounds2 box = Bounds2::nothing();
    for (const Point2 p : reproject(rim, "EPSG:4326", crs))
      if (!std::isnan(p.x)) box.extend(p);
    if (box.empty() || !box.intersects(data)) continue;
    throw Error(ErrorKind::kUsage,
                fmt::format("`bounds`: {}, {}, {}, {} look like degrees{}, but the data are in {}; "
                            "give `bounds` = {:.0f},{:.0f},{:.0f},{:.0f}",
                            given.xmin, given.ymin, given.xmax, given.ymax,
                            degrees == given ? "" : " (latitude first)", crs_name(crs),
                            std::floor(box.xmin), std::floor(box.ymin), std::ceil(box.xmax),
                            std::ceil(box.ymax)));
  }
}

}  // namespace tetropolis
