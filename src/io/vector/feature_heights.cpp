#include "feature_heights.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tetropolis/core/error.h"

#include "core/text.h"
#include "io/file/input_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// Text as a number of metres: "12.5", also with a unit as OpenStreetMap writes it ("12.5 m").
double metres_of(std::string_view text) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const auto trim = [&] {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  };
  trim();
  if (text.ends_with('m')) text.remove_suffix(1);
  trim();
  double value = kNaN;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc{} && end == text.data() + text.size();
  return whole && std::isfinite(value) ? value : kNaN;
}

/// The column in which GDAL keeps the tags of OpenStreetMap that have none of their own, as
/// `"key"=>"value","key"=>"value"`, with a backslash before quotes in either.
constexpr const char* kOtherTags = "other_tags";

/// The value of a tag there; empty if there is none.
std::string value_of_tag(const std::string& tags, const std::string& key) {
  const std::string begin = '"' + key + "\"=>\"";
  std::size_t at = tags.find(begin);
  if (at == std::string::npos) return {};
  at += begin.size();
  return tags.substr(at, tags.find('"', at) - at);
}

}  // namespace

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

HeightReader::HeightReader(const fs::path& path, OGRLayerH layer, std::string attribute)
    : path_(path), attribute_(std::move(attribute)) {
  OGRFeatureDefnH columns = OGR_L_GetLayerDefn(layer);
  is_tag_ = !attribute_.empty() && OGR_FD_GetFieldIndex(columns, attribute_.c_str()) < 0 &&
            OGR_FD_GetFieldIndex(columns, kOtherTags) >= 0;
  field_ = find_attribute(path, layer, is_tag_ ? kOtherTags : attribute_);
  if (field_ == kNoField) return;
  // The feature number is no height, and neither is a date, a list, or yes and no.
  OGRFieldDefnH field =
      field_ == kFidField ? nullptr : OGR_FD_GetFieldDefn(OGR_L_GetLayerDefn(layer), field_);
  type_ = field == nullptr ? OFTBinary : OGR_Fld_GetType(field);
  const char* other = nullptr;
  if (field == nullptr)
    other = "the feature number";
  else if (OGR_Fld_GetSubType(field) == OFSTBoolean)
    other = "Boolean";
  else if (type_ != OFTInteger && type_ != OFTInteger64 && type_ != OFTReal && type_ != OFTString)
    other = OGR_GetFieldTypeName(type_);
  if (other != nullptr)
    fail_input(
        path_,
        fmt::format("attribute '{}' is {}, not a height; name a numeric one with height_attribute",
                    attribute_, other));
}

double HeightReader::read(OGRFeatureH feature, const std::string& id) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  if (field_ == kNoField || OGR_F_IsFieldSetAndNotNull(feature, field_) == 0) return kNaN;
  constexpr double kMost = 1100;  // metres: no building is that high
  constexpr double kMark = 999;   // stands for a height that nobody knows
  std::string text;
  double value = kNaN;
  if (type_ == OFTString) {
    text = gdal::utf8(OGR_F_GetFieldAsString(feature, field_));
    if (is_tag_) text = value_of_tag(text, attribute_);
    if (text.find_first_not_of(' ') == std::string::npos) return kNaN;  // as good as null
    value = metres_of(text);
  } else {
    value = OGR_F_GetFieldAsDouble(feature, field_);
    if (std::isnan(value)) return kNaN;  // as good as null, too
    text = fmt::format("{:.6g}", value);
  }
  if (value <= kMost && value != kMark) {
    ++usable_;
    return value;
  }
  if (others_++ == 0) first_ = fmt::format("feature {}: '{}'", id, first_bytes(text, 40));
  return kNaN;
}

std::optional<Warning> HeightReader::warning() const {
  if (others_ == 0) return std::nullopt;
  if (usable_ == 0)
    fail_input(
        path_,
        fmt::format("attribute '{}' has no usable height ({}); name another with height_attribute",
                    attribute_, first_));
  return Warning{"height_not_a_number", others_,
                 one_line(fmt::format("{}: {} features have no usable height in '{}' (first: {})",
                                      path_.string(), others_, attribute_, first_))};
}

}  // namespace tetropolis
