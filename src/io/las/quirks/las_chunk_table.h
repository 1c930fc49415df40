// Broken tables of chunks in LAZ files, as downloads that were cut or disks that rotted leave them
// (potree/PotreeConverter#692, LASzip/LASzip#81, PDAL/PDAL#4431): LASzip takes what it makes of one
// for positions, and recurses until its stack ends. Private to src/io.
#pragma once

#include <cstdint>
#include <filesystem>

#include "io/file/positioned_file.h"

namespace tetropolis {

/// What is known of a table before it is read.
struct LazTablePlace {
  std::int64_t at = 0;           ///< Byte of its version, which the number of chunks follows.
  std::int64_t end = 0;          ///< Byte up to which it may reach.
  std::int64_t first_chunk = 0;  ///< Byte of the first chunk.
  std::uint32_t chunks = 0;
  std::uint32_t chunk_size = 0;  ///< Points per chunk; UINT32_MAX if the table states them.
  std::int64_t points = 0;       ///< Of the file, by its header.
};

/// Throws Error(kInput) if the file ends within the table, chunks reach beyond the table's place,
/// or the points that it states are fewer than place.points.
///
/// Source: the layout is that of LASzip (Isenburg, LASzip: lossless compression of LiDAR data,
/// PE&RS 79(2), 2013), the coder that of A. Said (Introduction to Arithmetic Coding - Theory and
/// Practice, HP Labs report HPL-2004-76, 2004).
void check_chunk_table(const std::filesystem::path& path, const PositionedFile& file,
                       const LazTablePlace& place);

}  // namespace tetropolis
