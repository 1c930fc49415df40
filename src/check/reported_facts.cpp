#include "reported_facts.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "tetropolis/core/error.h"
#include "tetropolis/core/units.h"
#include "tetropolis/io/crs/crs.h"

#include "run/earlier_results.h"
#include "run/folders.h"
#include "run/result_files.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::json;

/// In the local frame. Earlier versions had one slope for all.
ExcavationSources excavated_of(const Json& report) {
  ExcavationSources excavated;
  const Json volume = report.value("volume_mesh", Json::object());
  const Json config = report.value("config", Json::object());
  const double slope = volume.value("cut_slope_deg", config.value("cut_slope", Config{}.cut_slope));
  const auto slopes_of = [&](const char* name, std::size_t sources) {
    auto slopes = volume.value(name, std::vector<double>(sources, slope));
    if (slopes.size() != sources) throw std::out_of_range(name);
    return slopes;
  };
  excavated.roofs = volume.value("roofs_cut_back", std::vector<BuildingIndex>());
  excavated.roof_slopes_deg = slopes_of("roof_cut_slopes_deg", excavated.roofs.size());
  for (const Point3& toe : volume.value("feet_cut_back", std::vector<Point3>())) {
    const auto origin = report.at("origin").get<std::array<double, 2>>();
    excavated.toes.push_back({toe[0] - origin[0], toe[1] - origin[1], toe[2]});
  }
  excavated.toe_slopes_deg = slopes_of("foot_cut_slopes_deg", excavated.toes.size());
  std::vector<double> slopes{slope};
  for (const auto* own : {&excavated.roof_slopes_deg, &excavated.toe_slopes_deg})
    slopes.insert(slopes.end(), own->begin(), own->end());
  for (const double degrees : slopes)
    if (!(degrees > 0 && degrees <= 90)) throw std::out_of_range("cut_slope");
  return excavated;
}

ReportedCity city_of(const Json& report) {
  ReportedCity city{.raw_buildings = report.value("raw_buildings", std::int64_t{-1}),
                    .buildings = report.value("buildings", std::int64_t{-1}),
                    .merged_groups = report.value("merged_groups", std::int64_t{-1}),
                    .dropped = {},
                    .flags = report.value("flags", std::map<std::string, std::int64_t>()),
                    .min_clearance = std::nullopt,
                    .area = report.value("area_after", -1.0),
                    .max_distance = std::nullopt};
  for (const Json& dropped : report.value("dropped", Json::array()))
    city.dropped.emplace_back(dropped.value("source_id", std::string()),
                              dropped.value("reason", std::string()));
  std::sort(city.dropped.begin(), city.dropped.end());
  // None, without buildings.
  if (report.contains("min_clearance") && !report["min_clearance"].is_null())
    city.min_clearance = report["min_clearance"].get<double>();
  if (report.contains("max_distance")) city.max_distance = report["max_distance"].get<double>();
  return city;
}

std::map<std::string, double> numbers_of(const Json& volume, const char* measure) {
  return volume.value(measure, std::map<std::string, double>());
}

double greatest(const Json& volume, const char* measure) {
  return volume.value(measure, Json::object()).value("max", -1.0);
}

/// What a report of its command has, and this one has not. Without `command` it is no report of a
/// run at all.
std::vector<std::string> missing_members(const Json& report) {
  const std::string command = report.value("command", std::string());
  const bool makes_city = command == "build" || command == "city";
  const bool makes_mesh = command == "build" || command == "mesh";
  if (!makes_city && !makes_mesh) return {};
  std::vector<std::string> names{"/origin", "/crs", "/domain", "/files"};
  if (makes_city)
    names.insert(names.end(), {"/input/footprint_parts", "/city/raw_buildings", "/city/buildings",
                               "/city/merged_groups", "/city/dropped", "/city/flags",
                               "/city/min_clearance", "/city/area_after", "/city/max_distance"});
  if (makes_mesh)
    names.insert(names.end(), {"/ground_mesh", "/volume_mesh/roofs_cut_back",
                               "/volume_mesh/feet_cut_back", "/surface_mesh"});
  for (const ConfigField& field : config_fields())
    names.push_back("/config/" + std::string(field.name));
  std::erase_if(names,
                [&](const std::string& name) { return report.contains(Json::json_pointer(name)); });
  return names;
}

/// Without "one/../", unless that leads elsewhere: the system follows links before "..".
fs::path shortened(const fs::path& path) {
  fs::path normal = path.lexically_normal();
  return real_path(normal) == real_path(path) ? normal : path;
}

ReportedFacts facts_of(const Json& report, const fs::path& folder) {
  const Json config = report.value("config", Json::object());
  ReportedFacts facts;
  facts.min_distance = config.value("min_building_distance", facts.min_distance);
  facts.absolute = config.value("coordinates", std::string("local")) == "absolute";
  if (config.contains("min_angle")) facts.min_angle = config["min_angle"].get<double>();
  facts.min_wall = config.value("min_wall_height", facts.min_wall);
  facts.excavated = excavated_of(report);
  const Json ground = report.value("ground_mesh", Json::object());
  facts.ground = {ground.value("triangles", -1.0), ground.value("min_angle_deg", -1.0),
                  ground.value("triangles_below_min_angle", -1.0)};
  if (report.contains("input")) {
    facts.footprint_parts = report["input"].value("footprint_parts", std::size_t{0});
    facts.dtm_step = config.value("dtm_step", -1.0);
  }
  if (report.contains("city")) facts.city = city_of(report["city"]);
  if (report.contains("origin"))
    facts.origin =
        Point2{report["origin"].at(0).get<double>(), report["origin"].at(1).get<double>()};
  if (report.contains("domain")) facts.domain = report["domain"].get<std::array<double, 4>>();
  if (report.contains("crs")) facts.crs = normalise_crs(report["crs"].get<std::string>());
  facts.files = names_below(report.value("files", std::vector<std::string>()));
  facts.missing = missing_members(report);
  if (report.contains("sources")) {
    const auto source = [&](const char* name) {
      return shortened(folder / report["sources"].value(name, std::string()));
    };
    facts.city_model = source("city");
    facts.terrain = source("dtm");
  }
  if (!report.contains("volume_mesh")) return facts;
  const Json& volume = report["volume_mesh"];
  const bool has_flat_top = config.value("top", std::string()) == "flat";
  const Json surface = report.value("surface_mesh", Json::object());
  facts.mesh = ReportedMesh{
      .cells = volume.value("cells", -1.0),
      .vertices = volume.value("vertices", -1.0),
      .inverted = volume.value("inverted", -1.0),
      .volume = volume.value("volume", -1.0),
      .triangles = surface.value("triangles", -1.0),
      .ground_lowered = volume.value("ground_lowered", -1.0),
      .non_orthogonality = greatest(volume, "non_orthogonality_deg"),
      .skewness = greatest(volume, "skewness"),
      .min_vertical_gap = volume.value("min_vertical_gap", -1.0),
      .top = has_flat_top ? std::optional(volume.value("top", -1.0)) : std::nullopt,
      .angles = numbers_of(volume, "dihedral_deg"),
      .aspects = numbers_of(volume, "aspect_ratio"),
      .faces_above_70 = volume.value("faces_above_70_deg", -1.0),
      .closed = surface.value("closed", false),
      .manifold = surface.value("manifold", false),
      .faces_by_patch = surface.value("faces_by_patch", std::map<std::string, std::int64_t>())};
  return facts;
}

}  // namespace

std::optional<ReportedFacts> read_report(const fs::path& folder) {
  const fs::path path = folder / results::kReport;
  std::error_code error;
  if (fs::is_fifo(path, error))  // which would be waited for
    throw Error(ErrorKind::kInput, path.string() + ": is not an ordinary file");
  std::ifstream file(path);
  if (!file) {
    const int reason = errno;
    if (!fs::exists(path, error)) return std::nullopt;
    throw Error(ErrorKind::kInput, path.string() + ": cannot be read: " + std::strerror(reason));
  }
  normalise_crs("EPSG:4326");  // Where no reference system is known, it is not the report's fault.
  try {
    const Json json = Json::parse(file);
    if (json.is_object()) return facts_of(json, folder);
  } catch (const Json::exception&) {         // no JSON, or members of other types than a report's
  } catch (const std::ios_base::failure&) {  // not even a file
  } catch (const std::out_of_range&) {       // values that no report has
  } catch (const Error&) {                   // a reference system that nobody knows
  }
  throw Error(ErrorKind::kInput, path.string() + ": not a report of tetropolis");
}

}  // namespace tetropolis
