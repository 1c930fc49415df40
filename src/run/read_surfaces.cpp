#include "read_surfaces.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

#include "core/text.h"
#include "read_areas.h"

namespace tetropolis {

namespace {

std::optional<SurfaceKind> kind_named(const std::string& word) {
  const auto found =
      std::find(kSurfaceKindNames.begin(), kSurfaceKindNames.end(), lower_case(word));
  if (found == kSurfaceKindNames.end()) return std::nullopt;
  return static_cast<SurfaceKind>(found - kSurfaceKindNames.begin());
}

/// The words of an attribute, per feature. Throws Error(kInput) if there is no such text.
const std::vector<std::string>& words_of(const FootprintsInput& input, const std::string& name) {
  for (const AttributeColumn& column : input.attributes)
    if (column.name == name)
      if (const auto* words = std::get_if<std::vector<std::string>>(&column.values)) return *words;
  throw Error(ErrorKind::kInput,
              fmt::format("{}: has no attribute {} with text; surface_layers takes FILE:water, "
                          "FILE:road, FILE:vegetation or FILE:ATTRIBUTE",
                          input.source, name));
}

}  // namespace

SurfaceLayerEntry parse_surface_layer(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == text.size())
    throw Error(ErrorKind::kUsage,
                fmt::format("surface_layers: '{}': give FILE:water, FILE:road, FILE:vegetation, or "
                            "FILE:ATTRIBUTE with an attribute of these words",
                            text));
  SurfaceLayerEntry entry;
  entry.file = text.substr(0, colon);
  const std::string word = text.substr(colon + 1);
  entry.kind = kind_named(word);
  if (!entry.kind) entry.attribute = word;
  return entry;
}

std::vector<SurfaceArea> read_surfaces(const Config& config, const CityModel& city,
                                       std::vector<Warning>& warnings) {
  std::vector<SurfaceArea> surfaces;
  const Bounds2 domain = city.domain.bounds().moved(city.origin);
  for (const std::string& text : config.surface_layers) {
    const SurfaceLayerEntry entry = parse_surface_layer(text);
    FootprintsInput input = read_areas(entry.file, city.crs, domain, !entry.kind, warnings);
    const std::size_t before = surfaces.size();
    std::string unknown;
    std::int64_t unknown_count = 0;
    const std::vector<std::string> none;
    const std::vector<std::string>& words = entry.kind ? none : words_of(input, entry.attribute);
    for (Footprint& feature : input.features) {
      const std::string word = entry.kind ? "" : words[static_cast<std::size_t>(feature.feature)];
      const std::optional<SurfaceKind> kind = entry.kind ? entry.kind : kind_named(word);
      if (kind) {
        surfaces.push_back({*kind, std::move(feature.polygon)});
      } else if (++unknown_count == 1) {
        unknown = word;
      }
    }
    if (surfaces.size() == before)
      throw Error(
          ErrorKind::kInput,
          fmt::format("{}: has no polygon of water, road or vegetation{}; leave it out of "
                      "surface_layers",
                      entry.file,
                      entry.kind ? "" : fmt::format(" by its attribute {}", entry.attribute)));
    if (!input.dropped.empty())
      warnings.push_back(
          {"surface_unusable", static_cast<std::int64_t>(input.dropped.size()),
           fmt::format("{} features of {} are left out, the first, {}: {}", input.dropped.size(),
                       entry.file, input.dropped.front().source_id, input.dropped.front().reason)});
    if (unknown_count > 0)
      warnings.push_back({"surface_unknown", unknown_count,
                          fmt::format("{} polygons of {} are left out: {} is '{}' or the like, not "
                                      "water, road or vegetation",
                                      unknown_count, entry.file, entry.attribute, unknown)});
  }
  return surfaces;
}

}  // namespace tetropolis
