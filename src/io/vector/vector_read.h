// The part of read_footprints behind opening a file. Private to src/io.
#pragma once

#include <filesystem>

#include "tetropolis/io/vector/vector.h"

#include "vector_open.h"

namespace tetropolis {

/// The footprints of an open data set. `path`: what messages call it.
FootprintsInput read_open_vector(const std::filesystem::path& path, const VectorFile& file,
                                 gdal::QuietErrors& errors, const ReadFootprintsOptions& options);

}  // namespace tetropolis
