// Lines of GeoJSON of which each is a collection, as downloads of tiles are. Private to src/io.
#pragma once

#include <filesystem>
#include <string>

#include "io/crs/gdal_support.h"

namespace tetropolis {

/// Whether the file is of lines of JSON by its name and begins with a collection.
bool are_lines_of_collections(const std::filesystem::path& path);

/// Writes its features into `folder` as one collection; the name for GDAL. Throws Error(kInput)
/// with the line that is no JSON.
std::string copy_features_of_lines(const std::filesystem::path& path,
                                   const gdal::MemoryFolder& folder);

}  // namespace tetropolis
