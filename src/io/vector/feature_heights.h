// Attributes of features: which column has them, and heights. Private to src/io.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "tetropolis/core/warning.h"

#include "io/crs/gdal_support.h"

namespace tetropolis {

inline constexpr int kNoField = -1;
inline constexpr int kFidField = -2;  ///< The feature number.

/// The column of an attribute; kNoField for "". Throws Error(kInput) that lists the attributes if
/// there is no such one.
int find_attribute(const std::filesystem::path& path, OGRLayerH layer, const std::string& wanted);

/// The heights of a layer's features, and what kept others from being one.
class HeightReader {
 public:
  /// `attribute`: empty for none. Of OpenStreetMap it may be any tag. Throws Error(kInput) if it is
  /// of a type that is no height.
  HeightReader(const std::filesystem::path& path, OGRLayerH layer, std::string attribute);

  /// NaN where there is none.
  double read(OGRFeatureH feature, const std::string& id);

  /// After all features: a warning where some have no usable height. Throws where all have none.
  std::optional<Warning> warning() const;

 private:
  const std::filesystem::path& path_;
  std::string attribute_;
  int field_ = kNoField;
  bool is_tag_ = false;  ///< The attribute is one of OpenStreetMap's other tags.
  OGRFieldType type_ = OFTReal;
  std::int64_t usable_ = 0;
  std::int64_t others_ = 0;
  std::string first_;
};

}  // namespace tetropolis
