// The commands: steps strung together, from files to a folder of results.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tetropolis/core/steps.h"
#include "tetropolis/run/config.h"
#include "tetropolis/run/output_folder.h"
#include "tetropolis/run/report.h"

namespace tetropolis {

/// How a run tells its caller what it does. All may be empty.
struct RunHooks : StepHooks {
  OutputWatcher output;  ///< For callers that may have to end the process.
  /// One line each, before the work: which results the run replaces, what the input is.
  std::function<void(const std::string& line)> tell;
};

/// Each writes the files of docs/files.md into config.out and returns what report.json says, and a
/// warning "hidden_folder_left" if a hidden folder could not be removed when the results were in
/// place. The folder appears complete or, after an exception, is as it was before.
/// Throw Error (see error.h for the kinds; kUsage as require_in_range for settings out of their
/// range) and Cancelled.

/// Steps 1.1 to 3.6.
Report run_build(const Config& config, const RunHooks& hooks = {});
/// Steps 1.1 to 2.4.
Report run_city(const Config& config, const RunHooks& hooks = {});
/// Steps 3.1 to 3.6 on a written city model and terrain: the same mesh as run_build's.
Report run_mesh(const Config& config, const RunHooks& hooks = {});
/// Writes footprints.shp and points.laz of a synthetic city; of the kind "adversarial"
/// footprints.shp or footprints.geojson, points.laz or points_1.laz, points_2.laz..., and
/// manifest.json, which lists them. The same bytes for the same settings. Files that a synthetic
/// city of any kind has left in the folder go, so that two do not mix.
Report run_synth(const Config& config, const RunHooks& hooks = {});

/// Files and folders that a run with these settings reads, but the configuration file; of `refine`
/// and `domain`, those with polygons. Throws Error(kUsage): entries of refine that mean nothing.
std::vector<std::string> input_files(const Config& config);

}  // namespace tetropolis
