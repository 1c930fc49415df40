#include "tetropolis/run/run.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tetropolis/core/threads.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/raster/geotiff.h"
#include "tetropolis/io/vector/city_layers.h"

#include "core/parallel.h"
#include "core/step_clock.h"
#include "file_and_attribute.h"
#include "folders.h"
#include "foreign_model.h"
#include "make_in_memory.h"
#include "mistaken_input.h"
#include "options_of.h"
#include "read_size_regions.h"
#include "read_surfaces.h"
#include "replace_results.h"
#include "result_files.h"
#include "run_frame.h"
#include "write_mesh.h"
#include "write_page.h"

namespace tetropolis {

namespace {

void require_input(const Config& config, Command command) {
  require_in_range(config, command);
  refuse_mistaken_files(config);
  std::vector<Needed> needed = needed_for_city(config);
  needed.push_back({!config.out.empty(), "out", "a folder for the results"});
  require_given(needed);
}

/// Results never replace what the run reads.
void keep_inputs(const Config& config, OutputFolder& out) {
  for (const std::string& file : input_files(config)) out.keep(file);
}

/// The results of a run that makes a city model, meshes.
std::vector<std::string> names_of(const Config& config, bool city, bool mesh) {
  std::vector<std::string> formats = config.formats;
  if (!config.no_html) formats.emplace_back("html");
  return results::of_run(city, mesh, formats);
}

/// So that `check` finds a source from anywhere, also when both have moved together.
std::string relative_to_results(const Config& config, const std::string& source) {
  return real_path(source).lexically_relative(real_path(config.out)).string();
}

/// Steps 1.1 to 2.3. Writes the terrain.
BuiltCity make_out_city(const Config& config, Next next, const RunHooks& hooks, OutputFolder& out,
                        Report& report) {
  const bool canopies = next == Next::kMesh && !config.canopies.empty();
  BuiltCity built = make_city(config, next, {}, hooks, report, canopies);
  StepClock(hooks, report.steps).run("1.7", "write terrain", [&](const Progress&) {
    write_raster(out.result(results::kTerrain), built.terrain, built.raw.origin, built.raw.crs,
                 built.city.domain.bounds());
  });
  return built;
}

void write_out_city(const BuiltCity& built, StepClock& clock, OutputFolder& out) {
  clock.run("2.4", "write city models", [&](const Progress&) {
    write_city(out.result(results::kRawCity), built.raw, "City model before simplification");
    write_city(out.result(results::kCity), built.city, "City model after simplification");
    write_city_layers(out.result(results::kLayers), built.raw, built.city, built.footprints);
  });
}

/// Steps 3.1 to 3.5.
CityMesh make_out_mesh(const Config& config, const CityModel& city, Raster terrain,
                       const Raster& canopy_heights, const RunHooks& hooks, Report& report) {
  CityMesh mesh = make_mesh(config, city, std::move(terrain), canopy_heights, hooks, report);
  if (config.coordinates == Coordinates::kAbsolute)
    mesh.placement = {{city.origin.x, city.origin.y, 0}, {0, 0, 0}};
  return mesh;
}

/// Both, as few steps of meshing keep all threads busy at its beginning. The city loses what its
/// mesh does not need.
CityMesh write_city_and_make_mesh(const Config& config, BuiltCity& built, const RunHooks& hooks,
                                  OutputFolder& out, Report& report) {
  CityMesh mesh;
  // Meshing calls the hooks; what both call, not at the same time.
  std::mutex polling;
  const auto cancelled = [&] {
    const std::lock_guard lock(polling);
    return hooks.cancelled && hooks.cancelled();
  };
  StepHooks beside;
  beside.cancelled = cancelled;
  std::vector<StepTime> times;
  // Nobody waits for the mesh of a city that cannot be written.
  std::atomic<bool> has_failed{false};
  RunHooks meshing = hooks;
  meshing.cancelled = [&] { return has_failed || cancelled(); };
  const auto before = std::ssize(report.steps);
  parallel_in_order(2, [&](std::size_t job) {
    if (job == 0) {
      StepClock clock(beside, times);
      try {
        write_out_city(built, clock, out);
      } catch (...) {
        has_failed = true;
        throw;
      }
      built.raw = {};
      built.footprints = {};
    } else {
      mesh = make_out_mesh(config, built.city, std::move(built.terrain), built.canopy_heights,
                           meshing, report);
      built.canopy_heights = {};
    }
  });
  report.steps.insert(report.steps.begin() + before, times.begin(), times.end());
  return mesh;
}

/// Step 3.6: writes volume, boundary and surface, and the page that shows them.
void write_out_mesh(const Config& config, const CityModel& city, const CityMesh& mesh,
                    std::span<const PageFootprint> footprints, const RunHooks& hooks,
                    OutputFolder& out, Report& report) {
  StepClock clock(hooks, report.steps);
  PageMesh shown;
  clock.run("3.6", "write meshes", [&](const Progress& progress) {
    // The disk, or the copying of what it is to have, keeps one thread busy at most.
    parallel_in_order(config.no_html ? 1 : 2, [&](std::size_t job) {
      if (job == 0)
        write_mesh(config, mesh, city.buildings, out, progress);
      else
        shown = page_mesh(mesh.volume);
    });
  });
  if (config.no_html) return;
  tell_process(report, out);
  clock.run("3.6", "write page",
            [&](const Progress&) { write_page(config, city, shown, footprints, report, out); });
}

/// Before anything is read: a model that has to be simplified gets a city model and a terrain of
/// its own. What the run reads is in nobody's way.
void require_room_for_mesh(const Config& config) {
  if (config.overwrite) return;
  const std::filesystem::path folder = real_path(config.out);
  std::vector<std::string> names = names_of(config, true, true);
  // Beside the city model that is meshed, what was made with it is no leftover.
  const bool is_beside = real_path(config.city).parent_path() == folder;
  std::erase_if(names, [&](const std::string& name) {
    if (is_beside && (name == results::kRawCity || name == results::kLayers)) return true;
    const auto is_it = [&](const std::string& file) { return real_path(file) == folder / name; };
    return is_it(config.city) || std::any_of(config.dtm.begin(), config.dtm.end(), is_it);
  });
  require_ours(folder, {names.begin(), names.end()});
}

}  // namespace

std::vector<std::string> input_files(const Config& config) {
  std::vector<std::string> files;
  if (!config.city.empty()) files.push_back(config.city);
  for (const auto* given : {&config.footprints, &config.points, &config.dtm, &config.dsm})
    files.insert(files.end(), given->begin(), given->end());
  if (domain_shape(config) == DomainShape::kGiven) files.push_back(config.domain);
  for (const std::string& entry : config.refine)
    if (std::string file = parse_refine(entry).file; !file.empty()) files.push_back(file);
  for (const std::string& entry : config.surface_layers)
    files.push_back(parse_surface_layer(entry).file);
  for (const auto& [setting, entries] :
       {std::pair("planned", &config.planned), std::pair("canopies", &config.canopies)})
    for (const std::string& entry : *entries)
      files.push_back(parse_file_and_attribute(setting, entry).file);
  return files;
}

Report run_build(const Config& config, const RunHooks& hooks) {
  require_input(config, kBuild);
  const ThreadLimit limit(config.threads);
  Report report = begin_report("build", config);
  OutputFolder out(config.out, hooks.output, Replaces::kModels, config.overwrite);
  keep_inputs(config, out);
  claim(out, names_of(config, true, true), config, hooks);
  BuiltCity built = make_out_city(config, Next::kMesh, hooks, out, report);
  std::vector<PageFootprint> footprints;
  if (!config.no_html) footprints = page_footprints(built);
  const CityMesh mesh = write_city_and_make_mesh(config, built, hooks, out, report);
  write_out_mesh(config, built.city, mesh, footprints, hooks, out, report);
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
  const BuiltCity built = make_out_city(config, Next::kNothing, hooks, out, report);
  StepClock clock(hooks, report.steps);
  write_out_city(built, clock, out);
  if (!config.no_html) {
    tell_process(report, out);
    clock.run("3.6", "write page", [&](const Progress&) {
      StepHooks preview;
      preview.cancelled = hooks.cancelled;
      write_page(config, built.city, page_preview(built.city, built.terrain, preview),
                 page_footprints(built), report, out);
    });
  }
  finish(report, out);
  return report;
}

Report run_mesh(const Config& given, const RunHooks& hooks) {
  Config config = given;
  require_in_range(config, kMesh);
  refuse_mistaken_files(config);
  require_given({{!config.city.empty(), "city", "a city model (.city.json)"},
                 {!config.out.empty(), "out", "a folder for the results"}});
  require_room_for_mesh(config);
  if (const auto building = as_footprints(config)) {
    if (hooks.tell)
      hooks.tell(config.city +
                 ": its outlines are simplified and its roofs made again, as by "
                 "'tetropolis build'");
    return run_build(*building, hooks);
  }
  const ThreadLimit limit(config.threads);
  Report report = begin_report("mesh", config);
  report.sources = {{"city", relative_to_results(config, config.city)},
                    {"dtm", relative_to_results(config, config.dtm.front())}};
  OutputFolder out(config.out, hooks.output, Replaces::kModels, config.overwrite);
  keep_inputs(config, out);
  // Beside the city model that is meshed, what was made with it is no leftover.
  for (const char* name : {results::kRawCity, results::kLayers})
    out.keep(std::filesystem::path(config.city).parent_path() / name);
  claim(out, names_of(config, false, true), config, hooks);
  BuiltCity built = load_city(config, hooks, report);
  const CityMesh mesh = make_out_mesh(config, built.city, std::move(built.terrain),
                                      built.canopy_heights, hooks, report);
  write_out_mesh(config, built.city, mesh, {}, hooks, out, report);
  finish(report, out);
  return report;
}

}  // namespace tetropolis
