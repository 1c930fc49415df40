#include "city_account.h"

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

namespace tetropolis {

void require_all_accounted(const FootprintsInput& input, const CityModel& model) {
  std::set<std::string_view> accounted;
  const auto account = [&](const std::string& id) {
    if (!accounted.insert(id).second)
      throw Error(ErrorKind::kGuarantee, fmt::format("feature {} is accounted for twice", id));
  };
  for (const Dropped& dropped : model.dropped) account(dropped.source_id);
  for (const Building& building : model.buildings)
    for (const std::string& id : building.source_ids) account(id);
  const auto require = [&](const auto& features) {
    for (const auto& feature : features)
      if (!accounted.contains(feature.source_id))
        throw Error(ErrorKind::kGuarantee,
                    fmt::format("feature {} is not accounted for", feature.source_id));
  };
  require(input.features);
  require(input.dropped);
}

void require_each_once(const CityModel& raw, const Simplification& simple) {
  std::vector<int> times(raw.buildings.size(), 0);
  for (const std::vector<BuildingIndex>& members : simple.members)
    for (const BuildingIndex m : members) ++times[static_cast<std::size_t>(m)];
  for (const DroppedFootprint& dropped : simple.dropped)
    ++times[static_cast<std::size_t>(dropped.index)];
  for (std::size_t i = 0; i < times.size(); ++i)
    if (times[i] != 1)
      throw Error(ErrorKind::kGuarantee,
                  fmt::format("feature {} is accounted for {} times after merging; report it",
                              raw.buildings[i].source_ids.front(), times[i]));
}

}  // namespace tetropolis
