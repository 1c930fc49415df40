// `tetropolis synth --kind adversarial`: the files of a city with defects.
#pragma once

#include <filesystem>
#include <vector>

#include "tetropolis/pipeline/output_folder.h"

#include "step_clock.h"

namespace tetropolis {

/// Writes footprints.shp or footprints.geojson, points.laz (or points_1.laz, points_2.laz, ...) and
/// manifest.json, and fills the report. Returns what an earlier city left in config.out and this
/// one does not replace, to be removed once the results are there: two cities must not mix.
std::vector<std::filesystem::path> synth_adversarial(const Config& config, const OutputFolder& out,
                                                     StepClock& clock, Report& report);

}  // namespace tetropolis
