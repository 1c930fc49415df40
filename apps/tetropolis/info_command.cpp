#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tetropolis/city/roof_summary.h"
#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/io/mesh/stl.h"
#include "tetropolis/io/mesh/vtk.h"
#include "tetropolis/io/mesh/xdmf.h"
#include "tetropolis/io/raster/elevation.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/run/output_folder.h"

#include "commands.h"
#include "console.h"

namespace tetropolis::app {

namespace {

std::string crs_text(const std::string& crs) {
  if (crs.empty()) return "not stated";
  if (is_geographic(crs)) return crs + " (degrees)";
  const double unit = linear_unit_metres(crs);
  return is_metre(unit) ? crs : fmt::format("{} (units of {:.7g} m)", crs, unit);
}

/// What files say of their heights: the name of the system, the unit, both or nothing.
std::string heights_text(const LasInfo& info) {
  std::string text = info.vertical_crs;
  if (info.vertical_unit < 0)
    text += text.empty() ? "counted downwards" : ", counted downwards";
  else if (!is_metre(info.vertical_unit))
    text += fmt::format("{}in units of {:.7g} m", text.empty() ? "" : ", ", info.vertical_unit);
  return text;
}

/// Square metres in a square unit of a system; 0 where there are none.
double square_metres(const std::string& crs) {
  if (crs.empty()) return 1;
  return is_geographic(crs) ? 0 : std::pow(linear_unit_metres(crs), 2);
}

/// To a millimetre, but for what only a broken header holds.
std::string coordinate(double value) {
  constexpr double kBeyondEarth = 1e12;
  return std::abs(value) < kBeyondEarth ? fmt::format("{:.3f}", value) : fmt::format("{:g}", value);
}

/// A line that quotes what a file says.
void print_line(const std::string& text) { put(stdout, one_line(text) + "\n"); }

void print_warnings(const std::vector<Warning>& warnings) {
  for (const Warning& warning : warnings) print_line("  note: " + warning.message);
}

void info_points(const std::string& path) {
  const LasInfo info = inspect_las(path);
  put(stdout, fmt::format("{}: {} {}.{}, point format {} ({} bytes){}\n", path,
                          info.compressed ? "LAZ" : "LAS", info.version_major, info.version_minor,
                          info.point_format, info.record_length, info.copc ? ", COPC" : ""));
  put(stdout, fmt::format("  points: {}\n  CRS: {}\n", info.point_count, crs_text(info.crs)));
  if (const std::string heights = heights_text(info); !heights.empty())
    print_line("  heights: " + heights);
  put(stdout,
      fmt::format("  header box: x {} .. {}, y {} .. {}, z {} .. {}\n", coordinate(info.min[0]),
                  coordinate(info.max[0]), coordinate(info.min[1]), coordinate(info.max[1]),
                  coordinate(info.min[2]), coordinate(info.max[2])));
  const PointsSummary summary = summarise_points(path);
  for (const auto& [code, count] : summary.points_by_class)
    put(stdout, fmt::format("  class {}: {}\n", code, count));
  const double box = summary.extent.empty() ? 0
                                            : summary.extent.width() * summary.extent.height() *
                                                  square_metres(info.crs);
  if (box > 0)
    put(stdout, fmt::format("  density: {:.2f} points/m2 of the points' box\n",
                            static_cast<double>(summary.points) / box));
  print_warnings(summary.warnings);
}

void info_city(const std::string& path) {
  std::vector<Warning> warnings;
  const CityModel city = read_city(path, &warnings, BrokenObjects::kDrop);
  double total = 0, lowest = 0, highest = 0;
  for (const Building& building : city.buildings) {
    total += area(building.footprint);
    const double height = highest_roof(building) - building.h_ground;
    lowest = &building == &city.buildings.front() ? height : std::min(lowest, height);
    highest = std::max(highest, height);
  }
  put(stdout,
      fmt::format("{}: city model\n  buildings: {}, {:.1f} m2, heights {:.1f} .. {:.1f} m\n", path,
                  city.buildings.size(), total, lowest, highest));
  std::size_t parts = 0, in_parts = 0;
  for (const Building& building : city.buildings) {
    parts += building.parts.size();
    in_parts += building.parts.empty() ? 0 : 1;
  }
  if (parts > 0)
    put(stdout, fmt::format("  roofs in parts: {} parts of {} buildings\n", parts, in_parts));
  put(stdout,
      fmt::format("  dropped features: {}\n  CRS: {}\n", city.dropped.size(), crs_text(city.crs)));
  print_warnings(warnings);
}

/// The first of them, which are enough to see what is wrong.
void print_dropped(const std::vector<UnusableFootprint>& dropped) {
  constexpr std::size_t kMost = 10;
  for (std::size_t i = 0; i < std::min(kMost, dropped.size()); ++i)
    print_line(fmt::format("  dropped: {}: {}", dropped[i].source_id, dropped[i].reason));
  if (dropped.size() > kMost)
    put(stdout, fmt::format("  dropped: {} more\n", dropped.size() - kMost));
}

void info_layer(const std::string& path, const FootprintsInput& input,
                const std::vector<VectorLayer>& layers) {
  double total = 0;
  std::int64_t holes = 0;
  for (const Footprint& feature : input.features) {
    total += area(feature.polygon);
    holes += static_cast<std::int64_t>(feature.polygon.holes.size());
  }
  put(stdout,
      fmt::format("{}: vector file, layer {}\n  features: {}, polygons: {}, holes: {}\n  CRS: {}\n",
                  path, input.layer, input.features_read, input.features.size(), holes,
                  crs_text(input.crs)));
  const double square = square_metres(input.crs);
  if (!input.bounds.empty())
    put(stdout,
        fmt::format("  box: x {0:.{4}f} .. {1:.{4}f}, y {2:.{4}f} .. {3:.{4}f}{5}\n",
                    input.bounds.xmin, input.bounds.xmax, input.bounds.ymin, input.bounds.ymax,
                    square > 0 ? 3 : 7,
                    square > 0 ? fmt::format("; sum of areas {:.1f} m2", total * square) : ""));
  for (const VectorLayer& layer : layers)
    if (layer.name == input.layer && !layer.attributes.empty())
      print_line(fmt::format("  attributes: {}", fmt::join(layer.attributes, ", ")));
  print_dropped(input.dropped);
  print_warnings(input.warnings);
}

/// Every layer that may be named by --layer; the others in a line.
void info_vector(const std::string& path) {
  const std::vector<VectorLayer> layers = list_layers(path);
  std::vector<std::string> with_polygons, others;
  for (const VectorLayer& layer : layers)
    if (layer.holds_polygons)
      with_polygons.push_back(layer.name);
    else
      others.push_back(layer.features < 0 ? fmt::format("{} ({})", layer.name, layer.geometry)
                                          : fmt::format("{} ({}, {} features)", layer.name,
                                                        layer.geometry, layer.features));
  if (with_polygons.size() < 2) {
    info_layer(path, read_footprints(path), layers);
  } else {
    ReadFootprintsOptions options;
    for (const std::string& name : with_polygons) {
      options.layer = name;
      info_layer(path, read_footprints(path, options), layers);
    }
    print_line("  choose one of these layers by --layer");
  }
  if (!others.empty() && !with_polygons.empty())
    print_line(fmt::format("  layers without polygons: {}", fmt::join(others, ", ")));
}

void info_raster(const std::string& path) {
  const RasterHeader header = inspect_raster(path);
  const std::vector<std::filesystem::path> paths{path};
  const Elevations read = read_elevations(paths);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : read.raster.values)
    if (!std::isnan(value)) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  const bool square = std::abs(header.step_x - header.step_y) <= 1e-6 * header.step_x;
  put(stdout,
      fmt::format("{}: raster, {} x {} pixels of {:.7g}{}\n  CRS: {}\n", path, header.nx, header.ny,
                  header.step_x, square ? "" : fmt::format(" x {:.7g}", header.step_y),
                  crs_text(header.crs)));
  const int digits = square_metres(header.crs) > 0 ? 3 : 7;
  put(stdout,
      fmt::format("  box: x {0:.{4}f} .. {1:.{4}f}, y {2:.{4}f} .. {3:.{4}f}\n", header.box.xmin,
                  header.box.xmax, header.box.ymin, header.box.ymax, digits));
  put(stdout, fmt::format("  heights: {:.3f} .. {:.3f} m; without a value: {} pixels\n", low, high,
                          read.missing));
  print_warnings(read.warnings);
}

void print_volume(const std::string& path, const TetMesh& mesh) {
  put(stdout, path + ": volume mesh\n");
  std::map<std::int32_t, std::int64_t> over;
  for (const std::int32_t region : mesh.region) ++over[region];
  const std::string prisms =
      mesh.wedges.empty() ? "" : fmt::format(", prisms: {}", mesh.wedges.size());
  put(stdout,
      fmt::format(
          "  vertices: {}, tets: {}{}\n  cells over {} buildings: {}\n", mesh.points.size(),
          mesh.cells.size(), prisms, over.size() - over.count(-1),
          static_cast<std::int64_t>(mesh.cell_count()) - (over.contains(-1) ? over[-1] : 0)));
}

void print_surface(const std::string& path, const SurfaceMesh& surface) {
  put(stdout, fmt::format("{}: surface\n  vertices: {}, triangles: {}\n", path,
                          surface.points.size(), surface.triangles.size()));
  for (const auto& [name, faces] : count_by_patch(surface))
    put(stdout, fmt::format("  {}: {}\n", name, faces));
}

void info_stl(const std::string& path) {
  const StlMesh surface = read_stl(path);
  std::array<double, 3> low, high;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  for (const auto& corners : surface.triangles)
    for (const auto& corner : corners)
      for (std::size_t c = 0; c < 3; ++c) {
        low[c] = std::min(low[c], static_cast<double>(corner[c]));
        high[c] = std::max(high[c], static_cast<double>(corner[c]));
      }
  put(stdout,
      fmt::format("{}: surface, binary STL\n  triangles: {}\n", path, surface.triangles.size()));
  if (!surface.triangles.empty())
    put(stdout, fmt::format("  box: x {:.3f} .. {:.3f}, y {:.3f} .. {:.3f}, z {:.3f} .. {:.3f}\n",
                            low[0], high[0], low[1], high[1], low[2], high[2]));
  if (surface.origin)
    put(stdout, fmt::format("  origin: {} {} {}\n", (*surface.origin)[0], (*surface.origin)[1],
                            (*surface.origin)[2]));
}

void info_xdmf(const std::string& path) {
  const auto mesh = read_xdmf(path);
  if (const auto* volume = std::get_if<TetMesh>(&mesh))
    print_volume(path, *volume);
  else
    print_surface(path, std::get<SurfaceMesh>(mesh));
}

using Json = nlohmann::json;

/// "id: reason" of what was left out, a few of many.
void print_dropped(const Json& dropped) {
  constexpr std::size_t kShown = 10;
  for (std::size_t i = 0; i < dropped.size() && i < kShown; ++i)
    print_line(fmt::format("  dropped: {}: {}", dropped[i].value("source_id", ""),
                           dropped[i].value("reason", "")));
  if (dropped.size() > kShown)
    put(stdout, fmt::format("  dropped: {} more, see the file\n", dropped.size() - kShown));
}

void print_report(const std::string& path, const Json& report) {
  const auto count = [](const Json& part, const char* key) {
    return part.value(key, std::int64_t{0});
  };
  double seconds = 0;
  for (const Json& step : report.value("steps", Json::array()))
    seconds += step.value("seconds", 0.0);
  put(stdout, fmt::format("{}: report of 'tetropolis {}', version {}, {:.1f} s, {:.0f} MB\n", path,
                          report.value("command", ""), report.value("version", ""), seconds,
                          report.value("peak_rss_bytes", 0.0) / 1e6));
  put(stdout, fmt::format("  CRS: {}\n", crs_text(report.value("crs", ""))));
  if (report.contains("input"))
    put(stdout,
        fmt::format("  input: {} points kept of {}, {} footprints\n",
                    count(report["input"], "points_kept"), count(report["input"], "points_read"),
                    count(report["input"], "footprints_read")));
  if (report.contains("city")) {
    const Json& city = report["city"];
    put(stdout, fmt::format("  city: {} buildings, {} after merging\n",
                            count(city, "raw_buildings"), count(city, "buildings")));
    print_dropped(city.value("dropped", Json::array()));
  }
  if (report.contains("volume_mesh")) {
    const Json& mesh = report["volume_mesh"];
    // Graded columns have no layers; their "layers" is what uniform ones would have been.
    const bool layered =
        report.value("config", Json::object()).value("layering", "") == std::string("uniform");
    const auto prisms = mesh.contains("prisms") ? mesh["prisms"].value("cells", 0LL) : 0;
    const auto cells = mesh.value("cells", 0LL);
    put(stdout, fmt::format("  volume: {} {}{}, {} inverted\n", count(mesh, "cells"),
                            prisms == 0       ? "tets"
                            : prisms == cells ? "prisms"
                                              : "tets and prisms",
                            layered ? fmt::format(" in {} layers", count(mesh, "layers")) : "",
                            count(mesh, "inverted")));
  }
  for (const Json& warning : report.value("warnings", Json::array()))
    print_line(fmt::format("  note: {}: {} ({})", warning.value("code", ""),
                           warning.value("message", ""), count(warning, "count")));
}

void info_report(const std::string& path) {
  std::ifstream file(path);
  const Json report = Json::parse(file, nullptr, false);
  try {
    if (report.is_object() && report.contains("version") && report.contains("command"))
      return print_report(path, report);
  } catch (const Json::exception&) {  // members of other types than a report's
  }
  throw Error(ErrorKind::kInput, path + ": not a report of tetropolis, or cut; run it again");
}

/// What a JSON document is, by the members of its root, also if it is cut.
struct JsonRoot {
  std::string type;
  bool has_command = false, has_version = false;
};

JsonRoot read_root(const std::string& path) {
  JsonRoot root;
  std::string key;
  std::ifstream file(path, std::ios::binary);
  // Of objects, nothing but the type is kept in memory.
  const auto keep = [&](int depth, Json::parse_event_t event, Json& part) {
    if (depth != 1) return true;
    if (event == Json::parse_event_t::key) {
      key = part.get<std::string>();
      root.has_command = root.has_command || key == "command";
      root.has_version = root.has_version || key == "version";
      return key == "type";
    }
    if (event == Json::parse_event_t::value && key == "type" && part.is_string())
      root.type = part.get<std::string>();
    return true;
  };
  const Json rest = Json::parse(file, keep, false);
  return root;
}

/// JSON may be a city model, a report or GeoJSON, whatever its name.
void info_json(const std::string& path) {
  const JsonRoot root = read_root(path);
  if (root.type == "CityJSON" || root.type == "CityJSONFeature")
    info_city(path);
  else if (root.type.empty() && root.has_command && root.has_version)
    info_report(path);
  else
    info_vector(path);
}

/// What reads as a city model is one; other GML holds features, and other lines GeoJSON.
void info_model(const std::string& path) {
  const FootprintsInput input = read_footprints(path);
  if (input.layer == "city model")
    info_city(path);
  else
    info_vector(path);
}

bool is_point_file(const std::string& name) {
  return name.ends_with(".las") || name.ends_with(".laz");
}

bool holds_point_files(const std::filesystem::path& path) {
  std::error_code error;
  for (std::filesystem::directory_iterator entry(path, error), end; !error && entry != end;
       entry.increment(error))
    if (is_point_file(lower_case(entry->path().string()))) return true;
  return false;
}

void info_folder(const std::string& path) {
  std::error_code error;
  // A report that is none of ours may lie beside points; without them, it is at least looked at.
  const bool has_points = holds_point_files(path);
  const std::filesystem::path report = std::filesystem::path(path) / "report.json";
  if (std::filesystem::is_regular_file(report, error) && (!has_points || is_result(report)))
    return info_report(report.string());
  if (!has_points) return info_vector(path);  // a geodatabase, say
  for (const std::filesystem::path& file : expand_point_paths(std::vector{path}))
    info_points(file.string());
}

/// Results of ours in formats that are not read back.
void refuse_written_formats(const std::string& path, const std::string& name) {
  for (const char* extension : {".msh", ".vtkhdf", ".cgns", ".su2", ".obj", ".ply", ".glb", ".h5"})
    if (name.ends_with(extension))
      throw Error(ErrorKind::kInput,
                  fmt::format("{}: {} files are written but not read; give the folder, or a .vtu, "
                              ".vtp, .stl or .xdmf file",
                              path, extension));
}

void info_file(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    throw Error(ErrorKind::kInput,
                path + (error ? ": cannot be read: " + error.message() : ": no such file"));
  if (std::filesystem::is_directory(path, error)) return info_folder(path);
  if (!std::filesystem::is_regular_file(path, error))
    throw Error(ErrorKind::kInput, path + ": is not an ordinary file");
  const std::string name = lower_case(path);
  refuse_written_formats(path, name);
  if (is_point_file(name))
    info_points(path);
  else if (name.ends_with(".city.json") || name.ends_with(".jsonl") || name.ends_with(".gml"))
    info_model(path);
  else if (name.ends_with("json"))  // also .cityjson and .geojson
    info_json(path);
  else if (is_raster_name(name))
    info_raster(path);
  else if (name.ends_with(".vtu"))
    print_volume(path, read_vtu(path));
  else if (name.ends_with(".vtp"))
    print_surface(path, read_vtp(path));
  else if (name.ends_with(".stl"))
    info_stl(path);
  else if (name.ends_with(".xdmf"))
    info_xdmf(path);
  else
    info_vector(path);
}

}  // namespace

bool info(const std::vector<std::string>& files) {
  bool good = true;
  for (const std::string& path : files) {
    try {
      info_file(path);
    } catch (const Error& error) {
      std::fflush(stdout);  // in the order of the files, where both go to one place
      put(stderr, fmt::format("tetropolis: {}\n", one_line(error.what())));
      good = false;
    }
  }
  return good;
}

}  // namespace tetropolis::app
