// Guarantee 1: every polygon of the input is in exactly one building, or dropped with a reason.
#pragma once

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/simplify/simplify.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/pipeline/build_city.h"

namespace tetropolis {

/// That every polygon of the input is in one building of the model or in its `dropped`, and that
/// nothing is there twice. Throws Error(kGuarantee) naming the feature.
void require_all_accounted(const FootprintsInput& input, const CityModel& model);

/// That simplification has put every building of `raw` into one footprint, or dropped it. Throws
/// Error(kGuarantee) naming the feature.
void require_each_once(const CityModel& raw, const Simplification& simple);

/// What became of the footprints of which `model` is made.
FootprintAccount account_of(const InputFacts& input, const CityModel& model);

}  // namespace tetropolis
