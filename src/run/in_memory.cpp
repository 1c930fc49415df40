#include "tetropolis/run/in_memory.h"

#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/city/roof_summary.h"
#include "tetropolis/core/error.h"
#include "tetropolis/core/system_memory.h"
#include "tetropolis/core/threads.h"

#include "core/step_clock.h"
#include "foreign_model.h"
#include "make_in_memory.h"
#include "mistaken_input.h"
#include "options_of.h"
#include "pipeline/elevations.h"
#include "pipeline/require_terrain.h"
#include "preflight_line.h"
#include "read_canopies.h"
#include "read_input.h"
#include "read_meshable.h"
#include "read_size_regions.h"
#include "read_surfaces.h"
#include "run_frame.h"
#include "write_page.h"

namespace tetropolis {

namespace {

void add_warnings(const std::vector<Warning>& warnings, Report& report) {
  report.warnings.insert(report.warnings.end(), warnings.begin(), warnings.end());
}

void add_steps(const std::vector<StepTime>& steps, Report& report) {
  for (const StepTime& step : steps) add_time(step, report.steps);
}

/// Of what may have been edited.
void require_heights(const BuiltCity& city) {
  for (const Building& building : city.city.buildings) {
    if (!is_elevation(building.h_ground) || !is_elevation(building.h_roof))
      throw Error(
          ErrorKind::kInput,
          fmt::format("building {} reaches from {:.6g} to {:.6g} m, which are no elevations",
                      building.id, building.h_ground, building.h_roof));
    if (building.h_roof <= building.h_ground)
      throw Error(
          ErrorKind::kInput,
          fmt::format("building {} has its roof at {:.6g} m, not above its ground at {:.6g} "
                      "m; raise h_roof",
                      building.id, building.h_roof, building.h_ground));
    for (const RoofPart& part : building.parts)
      if (const double low = range_of(part).low; !(low > building.h_ground))
        throw Error(
            ErrorKind::kInput,
            fmt::format(
                "building {} has a roof that goes down to {:.6g} m, not above its ground at "
                "{:.6g} m; raise h_roof",
                building.id, low, building.h_ground));
  }
  require_raster(city.terrain, "terrain");
}

}  // namespace

BuiltCity make_city(const Config& config, Next next, const InputInMemory& given,
                    const RunHooks& hooks, Report& report, bool canopy_heights) {
  StepClock clock(hooks, report.steps);
  RunInput input = read_input(config, next, clock, report.warnings, given);
  BuildCityOptions options = city_options(config);
  options.domain.given = read_domain(
      config, input.points.crs.empty() ? input.footprints.crs : input.points.crs, report.warnings);
  options.canopy_heights = canopy_heights;
  report.preflight = preflight(input.points, input.footprints, options.bounds);
  if (hooks.tell) hooks.tell(preflight_line(*report.preflight, input));
  BuiltCity built = build_city(std::move(input), options, hooks);
  add_steps(built.steps, report);
  add_warnings(built.warnings, report);
  report.input = built.input;
  report.city = built.facts;
  keep_domain(built.city, report);
  return built;
}

BuiltCity load_city(const Config& config, const StepHooks& hooks, Report& report) {
  StepClock clock(hooks, report.steps);
  MeshableInput input = clock.run("1.2", "read city and terrain", [&](const Progress&) {
    return read_meshable(config, report.warnings);
  });
  report.city = input.facts;
  keep_domain(input.city, report);
  BuiltCity built;
  built.city = std::move(input.city);
  built.terrain = std::move(input.terrain);
  built.facts = std::move(input.facts);
  return built;
}

CityMesh make_mesh(const Config& config, const CityModel& city, Raster terrain,
                   const Raster& canopy_heights, const StepHooks& hooks, Report& report) {
  MeshCityOptions options = mesh_options(config);
  options.grading.regions = read_size_regions(config, city, report.warnings);
  options.surfaces = read_surfaces(config, city, report.warnings);
  options.canopies = read_canopies(config, city, canopy_heights, report.warnings);
  CityMesh mesh = mesh_city(city, std::move(terrain), options, hooks);
  add_steps(mesh.steps, report);
  add_warnings(mesh.warnings, report);
  report.ground_mesh = mesh.ground_facts;
  report.volume_mesh = mesh.volume_facts;
  for (WorstCell& cell : report.volume_mesh->worst)
    cell.centre = {cell.centre[0] + city.origin.x, cell.centre[1] + city.origin.y, cell.centre[2]};
  for (Point3& toe : report.volume_mesh->feet_cut_back)
    toe = {toe[0] + city.origin.x, toe[1] + city.origin.y, toe[2]};
  report.surface_mesh = mesh.surface_facts;
  report.canopies = mesh.zones.zones;
  report.solver = mesh.solver;
  return mesh;
}

CityInMemory make_city(Config config, InputInMemory input, const StepHooks& hooks) {
  if (input.footprints) config.footprints = {input.footprints->source};
  if (input.points) config.points = {input.points->source};
  require_in_range(config, kCity);
  require_given(needed_for_city(config));
  refuse_mistaken_files(config);
  const ThreadLimit limit(config.threads);
  CityInMemory city{{}, begin_report("city", config)};
  // Canopies are told when the city is meshed.
  city.built = make_city(config, Next::kNothing, input, {hooks, {}, {}}, city.report, true);
  city.report.peak_rss_bytes = peak_rss_bytes();
  return city;
}

CityInMemory load_city(const Config& given, const StepHooks& hooks) {
  Config config = given;
  require_in_range(config, kMesh);
  require_given({{!config.city.empty(), "city", "a city model (.city.json)"}});
  refuse_mistaken_files(config);
  if (const auto building = as_footprints(config)) return make_city(*building, {}, hooks);
  const ThreadLimit limit(config.threads);
  CityInMemory city{{}, begin_report("mesh", config)};
  city.built = load_city(config, hooks, city.report);
  city.report.peak_rss_bytes = peak_rss_bytes();
  return city;
}

MeshInMemory make_mesh(const Config& config, const BuiltCity& city, const StepHooks& hooks) {
  require_in_range(config, kMesh);
  require_heights(city);
  const ThreadLimit limit(config.threads);
  MeshInMemory mesh{city.city, {}, begin_report("mesh", config)};
  keep_domain(city.city, mesh.report);
  mesh.report.city = city.facts;
  mesh.mesh = make_mesh(config, city.city, city.terrain, city.canopy_heights, hooks, mesh.report);
  mesh.report.peak_rss_bytes = peak_rss_bytes();
  return mesh;
}

std::string make_page(const CityInMemory& city) {
  require_heights(city.built);
  const PageMesh shown = page_preview(city.built.city, city.built.terrain);
  return page_of(city.built.city, &shown, page_footprints(city.built), city.report, "");
}

std::string make_page(const CityInMemory& city, const MeshInMemory& mesh) {
  Report report = city.report;
  report.config = mesh.report.config;
  report.peak_rss_bytes = mesh.report.peak_rss_bytes;
  report.ground_mesh = mesh.report.ground_mesh;
  report.volume_mesh = mesh.report.volume_mesh;
  report.surface_mesh = mesh.report.surface_mesh;
  report.canopies = mesh.report.canopies;
  report.solver = mesh.report.solver;
  add_steps(mesh.report.steps, report);
  add_warnings(mesh.report.warnings, report);
  const PageMesh shown = page_mesh(mesh.mesh.volume);
  return page_of(mesh.city, &shown, page_footprints(city.built), std::move(report), "");
}

}  // namespace tetropolis
