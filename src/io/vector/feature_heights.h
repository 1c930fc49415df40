// Attributes of features: which column has them, and heights. Private to src/io.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tetropolis/core/warning.h"
#include "tetropolis/io/vector/vector.h"

#include "io/crs/gdal_support.h"

namespace tetropolis {

inline constexpr int kNoField = -1;
inline constexpr int kFidField = -2;  ///< The feature number.

/// The column of an attribute; kNoField for "". Throws Error(kInput) that lists the attributes if
/// there is no such one.
int find_attribute(const std::filesystem::path& path, OGRLayerH layer, const std::string& wanted);

/// The value of a tag in a column of such, as in `"key"=>"value","key"=>"value"`; "" if there is
/// none.
std::string value_of_tag(const std::string& tags, const std::string& key);

/// A column, or a tag of OpenStreetMap that has none of its own.
class AttributeField {
 public:
  AttributeField() = default;
  /// `attribute`: empty for none. Throws Error(kInput) if there is no such one, or it is of a type
  /// that is no number or text, for `what` ("height") that `setting` names.
  AttributeField(const std::filesystem::path& path, OGRLayerH layer, std::string attribute,
                 const char* what, const char* setting);

  bool exists() const { return field_ != kNoField; }
  bool is_number() const { return type_ != OFTString; }
  /// As text; "" for none. Numbers as "%.17g".
  std::string text(OGRFeatureH feature) const;
  const std::string& name() const { return name_; }

 private:
  std::string name_;
  int field_ = kNoField;
  bool is_tag_ = false;
  OGRFieldType type_ = OFTReal;
};

struct StatedHeight {
  double metres;  ///< NaN where there is none.
  bool from_floors = false;
};

/// The heights of a layer's features, and what kept others from being one.
class HeightReader {
 public:
  /// Of the options: height_attribute, floors_attribute, floor_height, height_unit. Throws
  /// Error(kInput) if an attribute is of a type that is no height.
  HeightReader(const std::filesystem::path& path, OGRLayerH layer,
               const ReadFootprintsOptions& options);

  StatedHeight read(OGRFeatureH feature, const std::string& id);

  /// After all features: what was taken for heights without being asked for, and that some have no
  /// usable one. Throws where all have none of an attribute that was asked for.
  std::vector<Warning> warnings() const;

 private:
  const std::filesystem::path& path_;
  AttributeField height_, floors_;
  bool is_asked_for_ = false;
  bool is_known_ = false;
  double floor_height_;
  double unit_;
  std::int64_t usable_ = 0;
  /// Values that are none, and the first of them.
  struct Unusable {
    std::int64_t count = 0;
    std::string first{};
    void add(const std::string& id, const std::string& text);
  };
  Unusable heights_, storeys_;
};

}  // namespace tetropolis
