#include "mistaken_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/raster/elevation.h"

#include "core/files.h"
#include "core/text.h"
#include "io/las/text_points.h"
#include "io/vector/merge_footprints.h"

namespace tetropolis {

namespace {

namespace fs = std::filesystem;

bool ends_with_any(const fs::path& path, std::initializer_list<std::string_view> endings) {
  const std::string name = lower_case(path.filename().string());
  return std::any_of(endings.begin(), endings.end(),
                     [&](std::string_view ending) { return name.ends_with(ending); });
}

bool has_points_name(const fs::path& path) { return ends_with_any(path, {".las", ".laz"}); }

bool has_vector_name(const fs::path& path) {
  return kVectorFiles.has(path) || ends_with_any(path, {".json"});
}

bool has_model_name(const fs::path& path) {
  return ends_with_any(path, {".city.json", ".cityjson"});
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

/// Or part of one, as a pattern names them all.
bool is_vector(const fs::path& path) {
  return is_file(path) &&
         (has_vector_name(path) || ends_with_any(path, {".shx", ".dbf", ".prj", ".cpg"})) &&
         !has_model_name(path) && !is_cloud(path);
}

/// Of the names of rasters, some are those of points (.xyz) or of vector files (.vrt), too.
bool is_raster(const fs::path& path) {
  return is_file(path) && is_raster_name(path) && !is_plain_points(path) &&
         !ends_with_any(path, {".vrt"});
}

void refuse_model(const fs::path& path) {
  if (is_file(path) && has_model_name(path))
    throw Error(
        ErrorKind::kUsage,
        fmt::format("{}: is a city model; 'tetropolis mesh' makes a mesh of it", path.string()));
}

[[noreturn]] void fail(const std::string& path, const char* what, const char* setting, bool swapped,
                       const char* other) {
  throw Error(ErrorKind::kUsage,
              fmt::format("{}: is a {}, but given as `{}`; {}", path, what, setting,
                          swapped ? fmt::format("swap `{}` and `{}`", setting, other)
                                  : fmt::format("name it as `{}`", other)));
}

}  // namespace

void refuse_mistaken_files(const Config& config) {
  for (const std::string& path : config.points) refuse_model(path);
  if (!config.points.empty() && !config.dsm.empty())
    throw Error(ErrorKind::kUsage, "`points` and `dsm`: both tell of roofs; give one of them");
  const auto vector = std::find_if(config.points.begin(), config.points.end(),
                                   [](const std::string& path) { return is_vector(path); });
  const bool has_vector = vector != config.points.end();
  for (const std::string& path : config.footprints)
    if (holds_points_only(path))
      fail(path, is_file(path) ? "point cloud" : "folder of point clouds", "footprints", has_vector,
           "points");
  if (has_vector) fail(*vector, "vector file", "points", false, "footprints");
  const auto is_model = [](const std::string& path) {
    return is_file(path) && ends_with_any(path, {".json", ".cityjson"});
  };
  const auto model = std::find_if(config.dtm.begin(), config.dtm.end(), is_model);
  if (is_raster(config.city)) fail(config.city, "raster", "city", model != config.dtm.end(), "dtm");
  if (model != config.dtm.end()) fail(*model, "JSON file", "dtm", false, "city");
  for (const std::string& path : config.footprints)
    if (is_raster(path)) fail(path, "raster", "footprints", false, "dtm");
  const bool has_cloud = !std::all_of(config.points.begin(), config.points.end(), is_raster);
  for (const std::string& path : config.points)
    if (is_raster(path)) fail(path, "raster", "points", false, has_cloud ? "dtm" : "dsm");
  std::error_code error;
  const bool is_file_name =
      has_points_name(config.out) || has_vector_name(config.out) ||
      ends_with_any(config.out, {".tif", ".vtu", ".vtp", ".xdmf", ".msh", ".vtkhdf", ".cgns",
                                 ".su2", ".stl", ".obj", ".ply", ".glb", ".html"});
  if (is_file_name && !fs::is_directory(config.out, error))
    throw Error(ErrorKind::kUsage,
                fmt::format("{}: is given as `out`, the folder for the results; name a folder",
                            config.out));
}

void refuse_degree_bounds(const Config& config, const std::string& crs, const Bounds2& data) {
  if (config.bounds.size() != 4 || crs.empty() || data.empty() || is_geographic(crs)) return;
  const Bounds2 given{config.bounds[0], config.bounds[1], config.bounds[2], config.bounds[3]};
  if (given.intersects(data)) return;
  constexpr Bounds2 kGlobe{-180, -90, 180, 90};
  std::string elsewhere;
  for (const Bounds2& degrees : {given, Bounds2{given.ymin, given.xmin, given.ymax, given.xmax}}) {
    if (!kGlobe.covers(degrees)) continue;
    const Bounds2 box = reproject_box(degrees, "EPSG:4326", crs);
    if (box.empty()) continue;
    const std::string sides =
        fmt::format("{:.0f},{:.0f},{:.0f},{:.0f}", std::floor(box.xmin), std::floor(box.ymin),
                    std::ceil(box.xmax), std::ceil(box.ymax));
    if (!box.intersects(data)) {
      if (elsewhere.empty()) elsewhere = sides;
      continue;
    }
    throw Error(ErrorKind::kUsage,
                fmt::format("`bounds`: {} look like degrees{}, but the data are in {}; give "
                            "`bounds` = {}",
                            fmt::join(config.bounds, ","),
                            degrees == given ? "" : " (latitude first)", crs_name(crs), sides));
  }
  // Of another place than that of the data. Whole numbers may be metres of a small model.
  const bool whole = std::all_of(config.bounds.begin(), config.bounds.end(),
                                 [](double side) { return side == std::floor(side); });
  if (!elsewhere.empty() && !whole)
    throw Error(
        ErrorKind::kUsage,
        fmt::format("`bounds`: {} look like degrees; in {} they are {}, but the data are at "
                    "{:.0f},{:.0f},{:.0f},{:.0f}",
                    fmt::join(config.bounds, ","), crs_name(crs), elsewhere, data.xmin, data.ymin,
                    data.xmax, data.ymax));
}

}  // namespace tetropolis
