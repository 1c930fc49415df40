#include "tetropolis/run/run.h"

#include <filesystem>
#include <string>
#include <utility>

#include "tetropolis/core/threads.h"

#include "folders.h"
#include "pipeline/stages.h"
#include "read_meshable.h"
#include "result_files.h"
#include "run_frame.h"

namespace tetropolis {

namespace {

void require_input(const Config& config, Command command) {
  require_in_range(config, command);
  require_given(!config.points.empty(), "--points", "name LAS or LAZ files or a folder of them");
  require_given(!config.footprints.empty() || config.terrain_only, "--footprints",
                "name a vector file with building footprints, or add --terrain-only");
  require_given(!config.out.empty(), "--out", "name a folder for the results");
}

/// Results never replace what the run reads.
void keep_inputs(const Config& config, OutputFolder& out) {
  for (const std::string& file : {config.footprints, config.city, config.dtm})
    if (!file.empty()) out.keep(file);
  for (const std::string& file : config.points) out.keep(file);
}

/// So that `check` finds a source from anywhere, also when both have moved together.
std::string relative_to_results(const Config& config, const std::string& source) {
  return real_path(source).lexically_relative(real_path(config.out)).string();
}

}  // namespace

Report run_build(const Config& config, const RunHooks& hooks) {
  require_input(config, kBuild);
  const ThreadLimit limit(config.threads);
  Report report = begin_report("build", config);
  StepClock clock(hooks, report);
  OutputFolder out(config.out, hooks.output, Replaces::kModels);
  keep_inputs(config, out);
  CityAndTerrain stage = make_city(config, Next::kMesh, out, clock, report);
  keep_domain(stage.city, report);
  make_mesh(config, stage.city, std::move(stage.dtm), out, clock, report);
  finish(report, out);
  return report;
}

Report run_city(const Config& config, const RunHooks& hooks) {
  require_input(config, kCity);
  const ThreadLimit limit(config.threads);
  Report report = begin_report("city", config);
  StepClock clock(hooks, report);
  OutputFolder out(config.out, hooks.output, Replaces::kModels);
  keep_inputs(config, out);
  const CityAndTerrain stage = make_city(config, Next::kNothing, out, clock, report);
  keep_domain(stage.city, report);
  finish(report, out);
  return report;
}

Report run_mesh(const Config& config, const RunHooks& hooks) {
  require_in_range(config, kMesh);
  require_given(!config.city.empty(), "--city", "name a city model (.city.json)");
  require_given(!config.dtm.empty(), "--dtm", "name a terrain raster (.tif)");
  require_given(!config.out.empty(), "--out", "name a folder for the results");
  const ThreadLimit limit(config.threads);
  Report report = begin_report("mesh", config);
  report.sources = {{"city", relative_to_results(config, config.city)},
                    {"dtm", relative_to_results(config, config.dtm)}};
  StepClock clock(hooks, report);
  OutputFolder out(config.out, hooks.output, Replaces::kModels);
  keep_inputs(config, out);
  // Beside the city model that is meshed, the one it was made from is no leftover.
  out.keep(std::filesystem::path(config.city).parent_path() / results::kRawCity);
  CityAndTerrain stage = clock.run("1.2", "read city and terrain",
                                   [&](const Progress&) { return read_meshable(config, report); });
  keep_domain(stage.city, report);
  make_mesh(config, stage.city, std::move(stage.dtm), out, clock, report);
  finish(report, out);
  return report;
}

}  // namespace tetropolis
