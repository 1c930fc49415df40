#include "read_planned.h"

#include <cstddef>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/error.h"

#include "core/is_among.h"
#include "core/text.h"
#include "file_and_attribute.h"
#include "io/file/input_paths.h"
#include "io/vector/merge_footprints.h"
#include "io/vector/model_footprints.h"

namespace tetropolis {

namespace {

namespace fs = std::filesystem;

FootprintsInput read_plan(const fs::path& path, const std::string& height_attribute,
                          ReadFootprintsOptions options) {
  options.where.clear();
  options.within = Bounds2::nothing();  // it may be in a system that others are not in
  const std::string layer_of_others = std::exchange(options.layer, {});
  const std::string crs_of_others = std::exchange(options.source_crs, {});
  std::vector<std::string> names;
  if (!is_city_model(path))
    for (const VectorLayer& layer : list_layers(path)) {
      names.insert(names.end(), layer.attributes.begin(), layer.attributes.end());
      if (layer.name == layer_of_others) options.layer = layer_of_others;
    }
  for (std::string* const name :
       {&options.id_attribute, &options.height_attribute, &options.floors_attribute})
    if (!is_among(*name, names)) name->clear();
  // A column `height` is the plan's own.
  if (is_among("height", names)) options.height_attribute.clear();
  if (!height_attribute.empty()) options.height_attribute = height_attribute;
  FootprintsInput planned = read_footprints(path, options);
  if (!planned.crs.empty() || crs_of_others.empty()) return planned;
  options.source_crs = crs_of_others;
  return read_footprints(path, options);
}

/// What a feature states in a column of heights, though it is none; "" if nothing.
std::string stated_text(const FootprintsInput& planned, const Footprint& feature,
                        const std::string& name) {
  const auto row = static_cast<std::size_t>(feature.feature);
  for (const AttributeColumn& column : planned.attributes)
    if (lower_case(column.name) == lower_case(name) && feature.feature >= 0 &&
        (column.known.empty() || column.known[row]))
      return std::visit([&](const auto& values) { return fmt::format("{}", values[row]); },
                        column.values);
  return {};
}

[[noreturn]] void throw_no_height(const fs::path& path, const std::string& id,
                                  const std::string& text) {
  const std::string stated = text.empty() ? "no height above ground"
                                          : fmt::format("the height '{}'", first_bytes(text, 40));
  throw Error(ErrorKind::kInput,
              fmt::format("{}: feature {} states {}; give each planned building one in a column "
                          "`height` (0: what is to be torn down; at most 1100 m), or name the "
                          "column: {}:COLUMN",
                          path.string(), id, stated, path.filename().string()));
}

}  // namespace

void add_planned(const Config& config, const ReadFootprintsOptions& options,
                 FootprintsInput& footprints) {
  if (config.planned.empty()) return;
  std::vector<fs::path> paths;
  std::vector<FootprintsInput> all;
  for (const std::string& entry : config.planned) {
    const FileAndAttribute given = parse_file_and_attribute("planned", entry);
    for (const fs::path& path : expand_paths(std::span(&given.file, 1), kVectorFiles)) {
      paths.push_back(path);
      all.push_back(read_plan(path, given.attribute, options));
      FootprintsInput& planned = all.back();
      for (Footprint& feature : planned.features) {
        if (!(feature.height >= 0))
          throw_no_height(
              path, feature.source_id,
              stated_text(planned, feature, given.attribute.empty() ? "height" : given.attribute));
        feature.is_planned = true;
        feature.base = std::numeric_limits<double>::quiet_NaN();  // it stands on the ground
      }
      for (UnusableFootprint& feature : planned.dropped) feature.is_planned = true;
      // Of a plan nothing is assumed: it is meant to have heights.
      std::erase_if(planned.warnings, [](const Warning& w) { return w.code == "height_assumed"; });
    }
  }
  FootprintsInput planned =
      all.size() > 1 ? merge_footprints(std::move(all), paths) : std::move(all.front());
  prefix_ids(std::string(kPlannedPrefix), planned);
  tell_ids_apart(footprints, planned);
  if (config.footprints.empty())
    footprints = std::move(planned);
  else
    append_footprints(std::move(planned), footprints);
}

}  // namespace tetropolis
