#include "feature_heights.h"

#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tetropolis/core/error.h"

#include "core/infinity.h"
#include "core/text.h"
#include "io/file/input_file.h"
#include "measure_text.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// The column in which GDAL keeps the tags of OpenStreetMap that have none of their own, as
/// `"key"=>"value","key"=>"value"`, with a backslash before quotes in either.
constexpr const char* kOtherTags = "other_tags";

}  // namespace

std::string value_of_tag(const std::string& tags, const std::string& key) {
  const std::string begin = '"' + key + "\"=>\"";
  std::size_t at = tags.find(begin);
  // Not within another value, where quotes have a backslash before them.
  while (at != std::string::npos && at > 0 && tags[at - 1] != ',') at = tags.find(begin, at + 1);
  if (at == std::string::npos) return {};
  std::string value;
  for (at += begin.size(); at < tags.size() && tags[at] != '"'; ++at) {
    if (tags[at] == '\\' && at + 1 < tags.size()) ++at;
    value += tags[at];
  }
  return value;
}

int find_attribute(const fs::path& path, OGRLayerH layer, const std::string& wanted) {
  if (wanted.empty()) return kNoField;
  OGRFeatureDefnH definition = OGR_L_GetLayerDefn(layer);
  // The very name before others that differ in case, which GDAL takes for the same. Names in tables
  // that do not state their encoding are not in UTF-8.
  std::vector<std::string> names;
  for (int i = 0; i < OGR_FD_GetFieldCount(definition); ++i) {
    names.push_back(gdal::utf8(OGR_Fld_GetNameRef(OGR_FD_GetFieldDefn(definition, i))));
    if (names.back() == wanted) return i;
  }
  if (const int field = OGR_FD_GetFieldIndex(definition, wanted.c_str()); field >= 0) return field;
  if (const char* fid = OGR_L_GetFIDColumn(layer); fid != nullptr && wanted == fid)
    return kFidField;
  fail_input(path, fmt::format("has no attribute '{}'; it has: {}", wanted,
                               names.empty() ? std::string("none")
                                             : fmt::format("{}", fmt::join(names, ", "))));
}

namespace {

/// What the values of a column are, if they are no numbers.
const char* what_else(OGRFieldDefnH field) {
  if (OGR_Fld_GetSubType(field) == OFSTBoolean) return "Boolean";
  const OGRFieldType type = OGR_Fld_GetType(field);
  const bool is_number =
      type == OFTInteger || type == OFTInteger64 || type == OFTReal || type == OFTString;
  return is_number ? nullptr : OGR_GetFieldTypeName(type);
}

}  // namespace

AttributeField::AttributeField(const fs::path& path, OGRLayerH layer, std::string attribute,
                               const char* what, const char* setting)
    : name_(std::move(attribute)) {
  OGRFeatureDefnH columns = OGR_L_GetLayerDefn(layer);
  is_tag_ = !name_.empty() && OGR_FD_GetFieldIndex(columns, name_.c_str()) < 0 &&
            OGR_FD_GetFieldIndex(columns, kOtherTags) >= 0;
  field_ = find_attribute(path, layer, is_tag_ ? kOtherTags : name_);
  if (field_ == kNoField) return;
  // The feature number is no height, and neither is a date, a list, or yes and no.
  OGRFieldDefnH field = field_ == kFidField ? nullptr : OGR_FD_GetFieldDefn(columns, field_);
  type_ = field == nullptr ? OFTBinary : OGR_Fld_GetType(field);
  const char* const other = field == nullptr ? "the feature number" : what_else(field);
  if (other != nullptr)
    fail_input(path, fmt::format("attribute '{}' is {}, not a {}; name a numeric one with {}",
                                 name_, other, what, setting));
}

std::string AttributeField::text(OGRFeatureH feature) const {
  if (field_ == kNoField || OGR_F_IsFieldSetAndNotNull(feature, field_) == 0) return {};
  if (type_ != OFTString) {
    const double value = OGR_F_GetFieldAsDouble(feature, field_);
    return std::isnan(value) ? std::string() : fmt::format("{}", value);
  }
  const std::string text = gdal::utf8(OGR_F_GetFieldAsString(feature, field_));
  return is_tag_ ? value_of_tag(text, name_) : text;
}

namespace {

bool has_column(OGRLayerH layer, const char* name) {
  return OGR_FD_GetFieldIndex(OGR_L_GetLayerDefn(layer), name) >= 0;
}

/// Or text, which may be one.
bool has_number(OGRLayerH layer, const char* name) {
  OGRFeatureDefnH columns = OGR_L_GetLayerDefn(layer);
  const int field = OGR_FD_GetFieldIndex(columns, name);
  return field >= 0 && what_else(OGR_FD_GetFieldDefn(columns, field)) == nullptr;
}

std::string usual_height(OGRLayerH layer) {
  return has_column(layer, kOtherTags) || has_number(layer, "height") ? "height" : "";
}

/// Of OpenStreetMap and Overture, whose heights are in metres above ground.
bool is_known(OGRLayerH layer) {
  return has_column(layer, kOtherTags) || has_column(layer, "building") ||
         has_column(layer, "num_floors") || has_column(layer, "is_underground");
}

std::string usual_floors(OGRLayerH layer) {
  for (const char* name : {"building:levels", "building_levels", "num_floors", "levels"})
    if (has_number(layer, name)) return name;
  return has_column(layer, kOtherTags) ? "building:levels" : "";
}

}  // namespace

HeightReader::HeightReader(const fs::path& path, OGRLayerH layer,
                           const ReadFootprintsOptions& options)
    : path_(path),
      height_(path, layer,
              options.height_attribute.empty() ? usual_height(layer) : options.height_attribute,
              "height", "height_attribute"),
      floors_(path, layer,
              options.floors_attribute.empty() ? usual_floors(layer) : options.floors_attribute,
              "number of floors", "floors_attribute"),
      is_asked_for_(!options.height_attribute.empty()),
      is_known_(is_known(layer)),
      floor_height_(options.floor_height),
      unit_(options.height_unit) {}

void HeightReader::Unusable::add(const std::string& id, const std::string& text) {
  if (count++ == 0) first = fmt::format("feature {}: '{}'", id, first_bytes(text, 40));
}

StatedHeight HeightReader::read(OGRFeatureH feature, const std::string& id) {
  constexpr double kMost = 1100;  // metres: no building is that high
  constexpr double kMark = 999;   // stands for a height that nobody knows
  constexpr double kMostFloors = 250;
  double stated = kNaN;
  const std::string text = height_.text(feature);
  if (text.find_first_not_of(' ') != std::string::npos) {  // blanks are as good as null
    const double value = metres_of(text, unit_);
    const bool is_mark = metres_of(text, 1) == kMark;
    if (value <= kMost && !is_mark) {
      ++usable_;
      if (value > 0) return {value};
      stated = value;
    } else {
      heights_.add(id, text);
    }
  }
  const std::string storeys = floors_.text(feature);
  const double floors = floors_of(storeys);
  if (floors > 0 && floors <= kMostFloors) return {floors * floor_height_, true};
  if (storeys.find_first_not_of(' ') != std::string::npos && !(floors <= 0))
    storeys_.add(id, storeys);
  return {stated};
}

std::vector<Warning> HeightReader::warnings() const {
  std::vector<Warning> warnings;
  if (usable_ > 0 && !is_asked_for_ && !is_known_)
    warnings.push_back({"height_assumed", usable_,
                        fmt::format("{}: the attribute '{}' is taken for heights above ground in "
                                    "{}; name another with height_attribute or height_unit",
                                    path_.string(), height_.name(),
                                    unit_ == 1 ? "metres" : fmt::format("{:.4g} m", unit_))});
  if (heights_.count > 0 && usable_ == 0 && is_asked_for_)
    fail_input(
        path_,
        fmt::format("attribute '{}' has no usable height ({}); name another with height_attribute",
                    height_.name(), heights_.first));
  const auto tell = [&](const char* code, const Unusable& values, const char* what,
                        const std::string& name) {
    if (values.count > 0)
      warnings.push_back(
          {code, values.count,
           one_line(fmt::format("{}: {} features have no usable {} in '{}' (first: {})",
                                path_.string(), values.count, what, name, values.first))});
  };
  tell("height_not_a_number", heights_, "height", height_.name());
  tell("floors_not_a_number", storeys_, "number of floors", floors_.name());
  return warnings;
}

}  // namespace tetropolis
