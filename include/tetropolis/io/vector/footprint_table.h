// Footprints that a caller has in memory, such as a GeoDataFrame.
#pragma once

#include <string>
#include <vector>

#include "tetropolis/io/vector/vector.h"

namespace tetropolis {

/// An attribute of the features: their values as text, "" where there is none.
struct TableColumn {
  std::string name;
  AttributeType type = AttributeType::kText;
  std::vector<std::string> values;
};

/// Columns of one length, one row per feature; `ids` may be empty instead.
struct FootprintTable {
  std::vector<std::string> wkb;  ///< Geometries as well-known binary; "": none.
  std::vector<std::string> ids;  ///< Values of options.id_attribute, or of an index; "": none.
  std::vector<TableColumn> columns;
  std::string source = "footprints";  ///< What messages call it.
  std::string crs = {};               ///< As normalise_crs takes it; "" if unknown.
};

/// What read_footprints makes of a file with these features, by the same options (of which `layer`
/// means nothing); feature numbers start at 0. Errors: those of read_footprints; kInput with the
/// feature for bytes that are no well-known binary; kUsage for columns of different lengths.
FootprintsInput take_footprints(const FootprintTable& table,
                                const ReadFootprintsOptions& options = {});

}  // namespace tetropolis
