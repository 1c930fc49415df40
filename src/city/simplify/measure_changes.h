// How much simplification has changed.
#pragma once

#include <span>
#include <vector>

#include "tetropolis/city/simplify/simplify.h"
#include "tetropolis/core/progress.h"

#include "group.h"

namespace tetropolis {

/// Per group, how its polygon differs from its input. Adds the areas before, after and changed of
/// all to `stats`, where those of groups that were dropped are already, and sets the largest
/// distance. In parallel; the same for any number of threads.
std::vector<FootprintChange> measure_changes(std::span<const Group> groups, SimplifyStats& stats,
                                             const Progress& progress);

}  // namespace tetropolis
