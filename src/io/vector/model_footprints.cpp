#include "model_footprints.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/crs/crs.h"

#include "core/files.h"
#include "core/text.h"
#include "io/cityjson/citygml.h"
#include "vector_geometry.h"

namespace tetropolis {

namespace fs = std::filesystem;

bool is_city_model(const fs::path& path) {
  if (!is_file(path)) return false;
  const std::string name = lower_case(path.filename().string());
  if (name.ends_with(".gml") || name.ends_with(".xml") || name.ends_with(".citygml"))
    return is_citygml(path);
  if (!name.ends_with("json") && !name.ends_with(".jsonl")) return false;
  // The type may be anywhere among the members of a large document.
  constexpr std::string_view kMark = "\"CityJSON";  // and CityJSONFeature
  constexpr std::size_t kSize = std::size_t{1} << 20;
  std::ifstream file(path, std::ios::binary);
  std::string block;
  while (file) {
    const std::size_t kept = std::min(block.size(), kMark.size());
    block.erase(0, block.size() - kept);
    block.resize(kept + kSize);
    file.read(block.data() + kept, static_cast<std::streamsize>(kSize));
    block.resize(kept + static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
    if (block.find(kMark) != std::string::npos) return true;
  }
  return false;
}

FootprintsInput read_model_footprints(const fs::path& path, const ReadFootprintsOptions& options) {
  const std::pair<const std::string&, const char*> settings[] = {
      {options.id_attribute, "id_attribute"},
      {options.height_attribute, "height_attribute"},
      {options.floors_attribute, "floors_attribute"},
      {options.where, "where"},
      {options.layer, "layer"}};
  for (const auto& [value, name] : settings)
    if (!value.empty() && value != "gml_id" && value != "id")  // these are the keys
      throw Error(ErrorKind::kUsage,
                  fmt::format("{}: is a city model, which is read whole, with ids and heights of "
                              "its own; leave out `{}`",
                              path.string(), name));
  FootprintsInput input;
  input.source = path.string();
  CityDetails details;
  CityModel model = read_city(path, &input.warnings, BrokenObjects::kDrop, &details);
  input.crs = options.source_crs.empty() ? model.crs : normalise_crs(options.source_crs);
  input.layer = "city model";
  for (std::size_t b = 0; b < model.buildings.size(); ++b) {
    const Building& building = model.buildings[BuildingIndex(b)];
    Footprint feature;
    feature.source_id = building.source_ids.front();
    feature.polygon = building.footprint;
    feature.height = building.h_roof - building.h_ground;
    feature.base = building.h_ground;
    feature.roofs = std::move(details.roofs[b]);
    if (options.attributes && !details.attributes.empty())
      feature.feature = static_cast<std::int64_t>(b);
    for_each_position(feature, [&](Point2& p) {
      p = {p.x + model.origin.x, p.y + model.origin.y};
    });
    for (const Point2 p : feature.polygon.outer) input.bounds.extend(p);
    input.features.push_back(std::move(feature));
  }
  if (options.attributes) input.attributes = std::move(details.attributes);
  for (Dropped& dropped : model.dropped) input.dropped.push_back({{std::move(dropped)}, -1});
  input.features_read = std::ssize(input.features) + std::ssize(input.dropped);
  if (input.crs.empty())
    input.warnings.push_back({"footprints_crs_unknown", 1,
                              path.string() + ": states no CRS; name it in the file, or to "
                                              "'tetropolis build' with footprints_crs"});
  if (!options.target_crs.empty() && !input.crs.empty())
    reproject_footprints(input, options.target_crs);
  return input;
}

}  // namespace tetropolis
