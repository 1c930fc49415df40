// Opening vector files through GDAL, as they come from the net. Private to src/io.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tetropolis/city/city_model.h"

#include "io/crs/gdal_support.h"

namespace tetropolis {

/// An open vector file and what must outlive it.
struct VectorFile {
  std::shared_ptr<const gdal::MemoryFolder> copy;  ///< In memory; null if the file itself is open.
  std::shared_ptr<const void> scratch = {};        ///< Keeps a copy on disk while it is open.
  gdal::Dataset dataset;
  std::int64_t opening_errors = 0;  ///< Of single features: all can be read.
  std::string first_error;
  bool is_osm = false;                           ///< Buildings of OpenStreetMap, and its account:
  std::vector<Dropped> osm_lost = {};            ///< Those without an area.
  std::vector<std::string> osm_incomplete = {};  ///< Those read without some of their corners.
};

/// Whether the short name of the data set's format begins like this ("GeoJSON": GeoJSONSeq, too).
bool is_of_format(GDALDatasetH dataset, std::string_view begin);

/// Whether GDAL reads all features of the format but for the geometry of those where that is broken
/// (with GML_SKIP_CORRUPTED_FEATURES: but for such features).
bool drops_geometries(GDALDatasetH dataset);

bool first_layer_holds_polygons(GDALDatasetH dataset);

/// Opens a vector file or folder for reading; a shapefile also without its index, of a ZIP archive
/// the one vector file that it holds, and what gzip has packed. Leaves the file's folder as it is.
/// `any_crs`: its reference system will not be used, and may be any. Throws Error(kInput).
VectorFile open_vector(const std::filesystem::path& path, const gdal::QuietErrors& errors,
                       bool any_crs = false);

}  // namespace tetropolis
