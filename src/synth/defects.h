// The defects of the adversarial city, by what they damage.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "adversarial_city.h"
#include "seeded_random.h"
#include "village.h"

namespace tetropolis {

/// Each function applies the defect if it is one of its own and returns in how many places (0 also
/// where there is nothing to damage).

/// What is built: replaces the buildings of a plot, or adds a plot. Valid polygons, for the laser.
std::int64_t build_defect(std::string_view name, double size, std::vector<VillagePlot>& plots,
                          SeededRandom& random);

/// What the surveyor's file says of it.
std::int64_t damage_outlines(std::string_view name, AdversarialCity& city, SeededRandom& random);

/// What the laser missed and the classification got wrong.
std::int64_t damage_cloud(std::string_view name, AdversarialCity& city, SeededRandom& random);

}  // namespace tetropolis
