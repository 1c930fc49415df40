// Step 1.4: existing buildings make way for planned ones.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tetropolis/pipeline/build_city.h"

#include "clean_features.h"

namespace tetropolis {

inline bool is_planned(const Building& building) { return (building.flags & kPlanned) != 0; }

/// Where planned buildings stand, others make way: those that they cover by half or more
/// are dropped; of others all parts of `min_area` square metres that are left stay, or the largest
/// where there is none. Where planned ones overlap, the highest stands, such as a tower on a
/// podium. Those of height 0 are dropped: nothing is to stand there. The order stays. `part_id`: an
/// id for another part of a feature. Warns of how many make way or are cut ("planned").
void make_way_for_planned(double min_area,
                          const std::function<std::string(const std::string&)>& part_id,
                          CleanFeatures& clean, std::vector<Warning>& warnings);

}  // namespace tetropolis
