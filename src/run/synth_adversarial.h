// `tetropolis synth --kind adversarial`: the files of a city with defects.
#pragma once

#include "tetropolis/run/output_folder.h"
#include "tetropolis/run/report.h"

#include "core/step_clock.h"

namespace tetropolis {

/// Writes footprints.shp or footprints.geojson, points.laz (or points_1.laz, points_2.laz, ...) and
/// manifest.json, and fills the report. `size`: side of the square, metres.
void synth_adversarial(const Config& config, double size, OutputFolder& out, StepClock& clock,
                       Report& report);

}  // namespace tetropolis
