// Decoding runs of point records, compressed or not. Private to src/io.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>

#include "las_header.h"

namespace tetropolis {

/// What the pipeline needs of one record.
struct LasRecord {
  std::int32_t x;
  std::int32_t y;
  std::int32_t z;
  std::uint8_t classification;
  bool withheld;
  /// Without it a copy is two moves that overlap, on which processors stall.
  std::uint16_t padding;
};

/// Receives consecutive blocks of records.
using LasVisitor = std::function<void(const LasRecord* records, std::size_t count)>;

/// Decodes `count` records from number `first` on and hands them over in blocks of a thousand.
/// Precondition: first + count <= point count; for LAZ, first is a multiple of layout.chunk_size,
/// or layout.variable_chunks, or 0. Returns, after the last point of a LAZ file, how many bytes of
/// compressed points are left before its chunk table, if that is known; otherwise 0. Throws
/// Error(kInput) with the point number if the file ends before or cannot be decoded.
std::int64_t decode_points(const std::filesystem::path& path, const LasLayout& layout,
                           std::int64_t first, std::int64_t count, const LasVisitor& visit);

/// What the last chunk of a layered LAZ file with chunks of equal size states: its number of
/// points; -1 for other files. Throws Error(kInput) if the file cannot be opened.
std::int64_t points_in_last_chunk(const std::filesystem::path& path, const LasLayout& layout);

/// Throws if an uncompressed file is too short for its count.
void check_las_length(const std::filesystem::path& path, const LasLayout& layout);

}  // namespace tetropolis
