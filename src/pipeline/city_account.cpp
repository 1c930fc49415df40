#include "city_account.h"

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/error.h"

namespace tetropolis {

namespace {

/// "1 block", "2 blocks".
std::string counted(std::int64_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

}  // namespace

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
    for (const BuildingIndex m : members) ++times[m];
  for (const DroppedFootprint& dropped : simple.dropped) ++times[dropped.index];
  for (std::size_t i = 0; i < times.size(); ++i)
    if (times[i] != 1)
      throw Error(ErrorKind::kGuarantee,
                  fmt::format("feature {} is accounted for {} times after merging; report it",
                              raw.buildings[i].source_ids.front(), times[i]));
}

FootprintAccount account_of(const InputFacts& input, const CityModel& model) {
  FootprintAccount account;
  account.features = input.footprints_read;
  account.further_parts = input.footprint_parts - input.footprints_read;
  account.of(DropCause::kOutside) = account.unlisted = input.footprints_unlisted;
  for (const Building& building : model.buildings) {
    const std::int64_t members = std::ssize(building.source_ids);
    (members == 1 ? account.kept : account.merged) += members;
  }
  for (const Dropped& dropped : model.dropped) ++account.of(dropped.cause);
  return account;
}

std::string account_in_words(const CityFacts& facts, const BuildCityOptions& options) {
  const FootprintAccount& account = facts.account;
  if (account.features == 0) return {};
  const double distance = options.simplify.min_distance;
  const bool clips = options.boundary_buildings == BoundaryBuildings::kClip ||
                     options.domain.shape == DomainShape::kGiven;
  std::vector<std::string> kept, dropped;
  const auto tell = [](std::vector<std::string>& list, std::int64_t count,
                       const std::string& what) {
    if (count > 0) list.push_back(fmt::format("{} {}", count, what));
  };
  tell(kept, account.merged,
       fmt::format("in {}, closer than {:g} m", counted(facts.merged_groups, "block"), distance));
  tell(kept, account.kept, "alone");
  tell(dropped, account.of(DropCause::kBoundary),
       clips ? "at the boundary" : "at the boundary (`boundary_buildings` clip keeps them)");
  tell(dropped, account.of(DropCause::kOutside), kOutsideReason);
  tell(dropped, account.of(DropCause::kTooSmall),
       fmt::format("smaller than {:g} m2", options.simplify.min_area));
  tell(dropped, account.of(DropCause::kTooNarrow), fmt::format("narrower than {:g} m", distance));
  tell(dropped, account.of(DropCause::kNotABuilding), "below ground or not built");
  tell(dropped, account.of(DropCause::kOutlined), "outlines of parts");
  tell(dropped, account.of(DropCause::kReplaced), "for what is planned");
  tell(dropped, account.of(DropCause::kUnusable), "without a usable outline");
  std::string line = counted(account.features, "footprint");
  if (account.further_parts > 0)
    line += fmt::format(" with {} polygons", account.features + account.further_parts);
  line += fmt::format(" make{} {}", account.features == 1 ? "s" : "",
                      counted(facts.buildings, "building"));
  if (!kept.empty()) line += fmt::format(": {}", fmt::join(kept, ", "));
  if (!dropped.empty()) line += fmt::format("; dropped: {}", fmt::join(dropped, ", "));
  return line;
}

}  // namespace tetropolis
