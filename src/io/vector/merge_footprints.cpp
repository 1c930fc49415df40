#include "merge_footprints.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "tetropolis/io/crs/crs.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

template <typename Values>
void resize(Values& values, std::size_t size) {
  std::visit([&](auto& list) { list.resize(size); }, values);
}

/// `rows`: how many there were before.
void append_attributes(std::vector<AttributeColumn>& to, std::vector<AttributeColumn> from,
                       std::size_t rows) {
  std::size_t added = 0;
  std::vector<bool> taken(to.size(), false);
  for (AttributeColumn& column : from) {
    added = std::max(added, column.known.size());
    std::size_t c = 0;
    while (c < taken.size() && (taken[c] || to[c].name != column.name || to[c].type != column.type))
      ++c;
    if (c == taken.size()) {
      AttributeColumn fresh{column.name, column.type};
      std::visit([&](auto& list) { fresh.values = std::decay_t<decltype(list)>(); }, column.values);
      to.push_back(std::move(fresh));
      taken.push_back(false);
    }
    taken[c] = true;
    AttributeColumn& target = to[c];
    target.known.resize(rows, false);
    resize(target.values, rows);
    target.known.insert(target.known.end(), column.known.begin(), column.known.end());
    std::visit(
        [&](auto& list) {
          auto& all = std::get<std::decay_t<decltype(list)>>(target.values);
          all.insert(all.end(), list.begin(), list.end());
        },
        column.values);
  }
  for (AttributeColumn& column : to) {
    column.known.resize(rows + added, false);
    resize(column.values, rows + added);
  }
}

std::size_t rows_of(const FootprintsInput& input) {
  return input.attributes.empty() ? std::size_t{0} : input.attributes.front().known.size();
}

}  // namespace

void prefix_ids(const std::string& prefix, FootprintsInput& input) {
  for (Footprint& feature : input.features) feature.source_id.insert(0, prefix);
  for (UnusableFootprint& feature : input.dropped) feature.source_id.insert(0, prefix);
}

void tell_ids_apart(const FootprintsInput& others, FootprintsInput& input) {
  std::set<std::string> taken;
  for (const Footprint& feature : others.features) taken.insert(feature.source_id);
  for (const UnusableFootprint& feature : others.dropped) taken.insert(feature.source_id);
  const auto make_unique = [&](std::string& id) {
    const std::string base = id;
    for (int k = 2; !taken.insert(id).second; ++k) id = fmt::format("{}~{}", base, k);
  };
  for (Footprint& feature : input.features) make_unique(feature.source_id);
  for (UnusableFootprint& feature : input.dropped) make_unique(feature.source_id);
}

void append_footprints(FootprintsInput input, FootprintsInput& all) {
  if (!all.crs.empty() && !input.crs.empty() && !same_horizontal_crs(all.crs, input.crs))
    reproject_footprints(input, all.crs);
  const std::size_t rows = rows_of(all);
  append_attributes(all.attributes, std::move(input.attributes), rows);
  for (Footprint& feature : input.features) {
    if (feature.feature >= 0) feature.feature += static_cast<std::int64_t>(rows);
    all.features.push_back(std::move(feature));
  }
  for (UnusableFootprint& feature : input.dropped) {
    if (feature.feature >= 0) feature.feature += static_cast<std::int64_t>(rows);
    all.dropped.push_back(std::move(feature));
  }
  all.features_read += input.features_read;
  all.unlisted += input.unlisted;
  if (!input.bounds.empty()) all.bounds.extend(input.bounds);
  all.warnings.insert(all.warnings.end(), input.warnings.begin(), input.warnings.end());
}

FootprintsInput merge_footprints(std::vector<FootprintsInput> inputs,
                                 const std::vector<fs::path>& paths) {
  std::map<std::string, int> names;
  for (std::size_t f = 0; f < inputs.size(); ++f) {
    std::string name = paths[f].stem().string();
    if (const int times = ++names[name]; times > 1) name += fmt::format("~{}", times);
    prefix_ids(name + ":", inputs[f]);
  }
  FootprintsInput all = std::move(inputs.front());
  if (inputs.size() > 1) all.source = fmt::format("{}, and {} more", all.source, inputs.size() - 1);
  for (std::size_t f = 1; f < inputs.size(); ++f) append_footprints(std::move(inputs[f]), all);
  return all;
}

}  // namespace tetropolis
