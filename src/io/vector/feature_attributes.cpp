#include "feature_attributes.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>

#include <fmt/format.h>

namespace tetropolis {

namespace {

std::optional<AttributeType> type_of(OGRFieldDefnH field) {
  switch (OGR_Fld_GetType(field)) {
    case OFTInteger:
      return OGR_Fld_GetSubType(field) == OFSTBoolean ? AttributeType::kBoolean
                                                      : AttributeType::kInteger;
    case OFTInteger64:
      return AttributeType::kInteger;
    case OFTReal:
      return AttributeType::kReal;
    case OFTDate:
      return AttributeType::kDate;
    case OFTDateTime:
      return AttributeType::kDateTime;
    case OFTBinary:
      return std::nullopt;
    default:  // text, times, lists
      return AttributeType::kText;
  }
}

/// "" where it is no date.
std::string date_of(OGRFeatureH feature, int field, bool with_time) {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, zone = 0;
  float second = 0;
  if (OGR_F_GetFieldAsDateTimeEx(feature, field, &year, &month, &day, &hour, &minute, &second,
                                 &zone) == 0 ||
      month < 1 || month > 12 || day < 1 || day > 31)
    return {};
  std::string text = fmt::format("{:04}-{:02}-{:02}", year, month, day);
  if (!with_time) return text;
  text += fmt::format("T{:02}:{:02}:{:06.3f}", hour, minute, second);
  constexpr int kLocal = 1, kUtc = 100, kQuarter = 15;  // GDAL's marks; minutes
  if (zone == kUtc) return text + "Z";
  if (zone <= kLocal) return text;
  const int offset = (zone - kUtc) * kQuarter;
  return text + fmt::format("{}{:02}:{:02}", offset < 0 ? '-' : '+', std::abs(offset) / 60,
                            std::abs(offset) % 60);
}

std::string text_of(OGRFeatureH feature, int field, AttributeType type) {
  if (type == AttributeType::kText) return gdal::utf8(OGR_F_GetFieldAsString(feature, field));
  return date_of(feature, field, type == AttributeType::kDateTime);
}

}  // namespace

OGRFieldType field_type(AttributeType type) {
  switch (type) {
    case AttributeType::kInteger:
      return OFTInteger64;
    case AttributeType::kBoolean:
      return OFTInteger;
    case AttributeType::kReal:
      return OFTReal;
    case AttributeType::kText:
      return OFTString;
    case AttributeType::kDate:
      return OFTDate;
    case AttributeType::kDateTime:
      return OFTDateTime;
  }
  return OFTString;
}

AttributeReader::AttributeReader(OGRLayerH layer, bool wanted,
                                 std::vector<AttributeColumn>& columns)
    : columns_(columns) {
  if (!wanted) return;
  OGRFeatureDefnH definition = OGR_L_GetLayerDefn(layer);
  for (int f = 0; f < OGR_FD_GetFieldCount(definition); ++f) {
    OGRFieldDefnH field = OGR_FD_GetFieldDefn(definition, f);
    const std::optional<AttributeType> type = type_of(field);
    if (!type) continue;
    AttributeColumn column{gdal::utf8(OGR_Fld_GetNameRef(field)), *type};
    if (*type == AttributeType::kInteger || *type == AttributeType::kBoolean)
      column.values = std::vector<std::int64_t>();
    else if (*type == AttributeType::kReal)
      column.values = std::vector<double>();
    else
      column.values = std::vector<std::string>();
    columns_.push_back(std::move(column));
    fields_.push_back(f);
  }
}

void AttributeReader::read(OGRFeatureH feature) {
  for (std::size_t c = 0; c < fields_.size(); ++c) {
    AttributeColumn& column = columns_[c];
    const int field = fields_[c];
    bool known = OGR_F_IsFieldSetAndNotNull(feature, field) != 0;
    if (auto* integers = std::get_if<std::vector<std::int64_t>>(&column.values)) {
      integers->push_back(known ? OGR_F_GetFieldAsInteger64(feature, field) : 0);
    } else if (auto* reals = std::get_if<std::vector<double>>(&column.values)) {
      reals->push_back(known ? OGR_F_GetFieldAsDouble(feature, field) : 0);
    } else {
      auto& texts = std::get<std::vector<std::string>>(column.values);
      texts.push_back(known ? text_of(feature, field, column.type) : std::string());
      known = known && (column.type == AttributeType::kText || !texts.back().empty());
    }
    column.known.push_back(known);
  }
}

}  // namespace tetropolis
