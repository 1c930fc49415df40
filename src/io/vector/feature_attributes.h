// All attributes of features, column by column. Private to src/io.
#pragma once

#include <vector>

#include "tetropolis/io/vector/vector.h"

#include "io/crs/gdal_support.h"

namespace tetropolis {

/// Of GDAL's types, the one that holds an attribute.
OGRFieldType field_type(AttributeType type);

class AttributeReader {
 public:
  /// Makes the columns of the layer; without `wanted`, none.
  AttributeReader(OGRLayerH layer, bool wanted, std::vector<AttributeColumn>& columns);

  /// Adds a value to each column.
  void read(OGRFeatureH feature);

 private:
  std::vector<AttributeColumn>& columns_;
  std::vector<int> fields_;  ///< Of each column.
};

}  // namespace tetropolis
