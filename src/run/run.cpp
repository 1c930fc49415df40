#include "tetropolis/run/run.h"

#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tetropolis/core/threads.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/raster/geotiff.h"
#include "tetropolis/io/vector/city_layers.h"

#include "core/step_clock.h"
#include "folders.h"
#include "mistaken_input.h"
#include "options_of.h"
#include "preflight_line.h"
#include "read_input.h"
#include "read_meshable.h"
#include "result_files.h"
#include "run_frame.h"
#include "write_mesh.h"
#include "write_page.h"

namespace tetropolis {

namespace {

void require_input(const Config& config, Command command) {
  require_in_range(config, command);
  refuse_mistaken_files(config);
  require_given({{!config.footprints.empty() || config.terrain_only, "footprints",
                  "a vector file with building footprints, or add terrain_only"},
                 {!config.points.empty(), "points", "LAS or LAZ files or a folder of them"},
                 {!config.out.empty(), "out", "a folder for the results"}});
}

/// Results never replace what the run reads.
void keep_inputs(const Config& config, OutputFolder& out) {
  for (const std::string& file : {config.footprints, config.city, config.dtm})
    if (!file.empty()) out.keep(file);
  for (const std::string& file : config.points) out.keep(file);
}

/// The results of a run that makes a city model, meshes.
std::vector<std::string> names_of(const Config& config, bool city, bool mesh) {
  std::vector<std::string> names = results::of_run(city, mesh, config.formats);
  if (config.no_html) std::erase(names, results::kPage);
  return names;
}

/// So that `check` finds a source from anywhere, also when both have moved together.
std::string relative_to_results(const Config& config, const std::string& source) {
  return real_path(source).lexically_relative(real_path(config.out)).string();
}

void add_warnings(const std::vector<Warning>& warnings, Report& report) {
  report.warnings.insert(report.warnings.end(), warnings.begin(), warnings.end());
}

void add_steps(const std::vector<StepTime>& steps, Report& report) {
  for (const StepTime& step : steps) add_time(step, report.steps);
}

/// Steps 1.1 to 2.4: reads the input, writes city models and terrain.
/// Fills `footprints` if there is to be a page.
BuiltCity make_city(const Config& config, Next next, const RunHooks& hooks, OutputFolder& out,
                    Report& report, std::vector<PageFootprint>& footprints) {
  StepClock clock(hooks, report.steps);
  RunInput input = read_input(config, next, clock, report.warnings);
  const BuildCityOptions options = city_options(config);
  report.preflight = preflight(input.points, input.footprints, options.bounds);
  if (hooks.tell) hooks.tell(preflight_line(*report.preflight, input));
  const bool has_page = next == Next::kMesh && !config.no_html;
  std::vector<Footprint> features;
  if (has_page) features = features_near(input.footprints, input.points);
  BuiltCity built =
      build_city(std::move(input.points), std::move(input.footprints), options, hooks);
  add_steps(built.steps, report);
  add_warnings(built.warnings, report);
  report.input = built.input;
  report.city = built.facts;
  keep_domain(built.city, report);
  const CityModel& raw = built.raw;
  clock.run("1.7", "write city model", [&](const Progress&) {
    write_raster(out.result(results::kTerrain), built.terrain, raw.origin, raw.crs,
                 raw.domain.bounds());
    write_city(out.result(results::kRawCity), raw, "City model before simplification");
  });
  if (has_page) footprints = page_footprints(raw, built.city, std::move(features));
  clock.run("2.4", "write merged city model", [&](const Progress&) {
    write_city(out.result(results::kCity), built.city, "City model after simplification");
    write_city_layers(out.result(results::kLayers), raw, built.city, built.footprints);
  });
  built.raw = {};
  built.footprints = {};
  return built;
}

/// Steps 3.1 to 3.6: writes volume, boundary and surface, and the page that shows them.
void make_mesh(const Config& config, const CityModel& city, Raster terrain,
               std::span<const PageFootprint> footprints, const RunHooks& hooks, OutputFolder& out,
               Report& report) {
  CityMesh mesh = mesh_city(city, std::move(terrain), mesh_options(config), hooks);
  add_steps(mesh.steps, report);
  add_warnings(mesh.warnings, report);
  report.ground_mesh = mesh.ground_facts;
  report.volume_mesh = std::move(mesh.volume_facts);
  for (WorstCell& cell : report.volume_mesh->worst)
    cell.centre = {cell.centre[0] + city.origin.x, cell.centre[1] + city.origin.y, cell.centre[2]};
  for (Point3& toe : report.volume_mesh->feet_cut_back)
    toe = {toe[0] + city.origin.x, toe[1] + city.origin.y, toe[2]};
  report.surface_mesh = mesh.surface_facts;
  report.solver = std::move(mesh.solver);
  if (config.coordinates == Coordinates::kAbsolute)
    mesh.placement = {{city.origin.x, city.origin.y, 0}, {0, 0, 0}};
  StepClock clock(hooks, report.steps);
  clock.run("3.6", "write meshes", [&](const Progress& progress) {
    write_mesh(config, mesh.volume, mesh.boundary, mesh.placement, out, progress);
  });
  if (config.no_html) return;
  tell_process(report, out);
  clock.run("3.6", "write page", [&](const Progress&) {
    write_page(config, city, mesh.volume, footprints, report, out);
  });
}

}  // namespace

Report run_build(const Config& config, const RunHooks& hooks) {
  require_input(config, kBuild);
  const ThreadLimit limit(config.threads);
  Report report = begin_report("build", config);
  OutputFolder out(config.out, hooks.output, Replaces::kModels, config.overwrite);
  keep_inputs(config, out);
  claim(out, names_of(config, true, true), config, hooks);
  std::vector<PageFootprint> footprints;
  BuiltCity built = make_city(config, Next::kMesh, hooks, out, report, footprints);
  make_mesh(config, built.city, std::move(built.terrain), footprints, hooks, out, report);
  finish(report, out);
  return report;
}

Report run_city(const Config& config, const RunHooks& hooks) {
  require_input(config, kCity);
  const ThreadLimit limit(config.threads);
  Report report = begin_report("city", config);
  OutputFolder out(config.out, hooks.output, Replaces::kModels, config.overwrite);
  keep_inputs(config, out);
  claim(out, names_of(config, true, false), config, hooks);
  std::vector<PageFootprint> none;
  make_city(config, Next::kNothing, hooks, out, report, none);
  finish(report, out);
  return report;
}

Report run_mesh(const Config& config, const RunHooks& hooks) {
  require_in_range(config, kMesh);
  refuse_mistaken_files(config);
  require_given({{!config.city.empty(), "city", "a city model (.city.json)"},
                 {!config.dtm.empty(), "dtm", "a terrain raster (.tif)"},
                 {!config.out.empty(), "out", "a folder for the results"}});
  const ThreadLimit limit(config.threads);
  Report report = begin_report("mesh", config);
  report.sources = {{"city", relative_to_results(config, config.city)},
                    {"dtm", relative_to_results(config, config.dtm)}};
  OutputFolder out(config.out, hooks.output, Replaces::kModels, config.overwrite);
  keep_inputs(config, out);
  // Beside the city model that is meshed, what was made with it is no leftover.
  for (const char* name : {results::kRawCity, results::kLayers})
    out.keep(std::filesystem::path(config.city).parent_path() / name);
  claim(out, names_of(config, false, true), config, hooks);
  StepClock clock(hooks, report.steps);
  MeshableInput input = clock.run("1.2", "read city and terrain", [&](const Progress&) {
    return read_meshable(config, report.warnings);
  });
  report.city = std::move(input.facts);
  keep_domain(input.city, report);
  make_mesh(config, input.city, std::move(input.terrain), {}, hooks, out, report);
  finish(report, out);
  return report;
}

}  // namespace tetropolis
