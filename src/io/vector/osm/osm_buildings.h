// The buildings of OpenStreetMap files as a layer of areas. Private to src/io.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"

#include "io/crs/gdal_support.h"

namespace tetropolis {

struct OsmBuildings {
  gdal::Dataset dataset;      ///< In memory: the layer "multipolygons", WGS 84.
  std::vector<Dropped> lost;  ///< Buildings without an area, and why; "way/7", "relation/3".
  std::vector<std::string> incomplete;  ///< Read without some of their corners: the same names.
};

/// Areas tagged building (but not building=no), building:part, and the outlines of relations of
/// type building. Columns: osm_id (of relations), osm_way_id, name, type, building, building:part,
/// height, building:levels, building:levels:underground, min_height, layer, location; other_tags
/// holds the rest as `"key"=>"value","key"=>"value"`.
///
/// Multipolygons are put together from their ways by these ends; rings within others are their
/// holes, whatever their roles. A relation that has no tag of its own has those of its outer way.
/// An outer way of a relation that is an area is no area of its own. A relation of type building
/// without an outline is `lost` with the cause DropCause::kOutlined if it has parts. The same
/// account whatever the format. Errors: those of read_osm.
OsmBuildings read_osm_buildings(const std::filesystem::path& path);

}  // namespace tetropolis
