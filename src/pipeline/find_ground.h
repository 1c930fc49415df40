// What makes the ground points of a cloud fit for use, before step 1.3.
#pragma once

#include "city_input.h"
#include "core/step_clock.h"

namespace tetropolis {

/// Where no point is ground (or always, as options.ground_filter says) a filter finds the ground
/// points, which then have class 2. Where only some of the files have no ground, that is done for
/// those. Where the terrain is given, what nobody has classified and lies at most 0.5 m above it is
/// ground, instead. Sets input.no_buildings. Ground points far off all others around become noise.
/// Adds to `facts` and `warnings`. Throws Error(kInput) naming the cloud if no ground is left.
void find_ground(const BuildCityOptions& options, CityInput& input, StepClock& clock,
                 InputFacts& facts, std::vector<Warning>& warnings);

}  // namespace tetropolis
