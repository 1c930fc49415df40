// Decoding runs of point records, compressed or not. Private to src/io.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <span>

#include "las_header.h"

namespace tetropolis {

/// Numbers of records, first and last; none if first > last.
struct NumberRange {
  std::int32_t first = std::numeric_limits<std::int32_t>::max();
  std::int32_t last = std::numeric_limits<std::int32_t>::min();

  bool contains(std::int32_t number) const { return number >= first && number <= last; }
  bool covers(const NumberRange& other) const { return other.first >= first && other.last <= last; }
};

/// What the pipeline needs of consecutive records: arrays of one length, for loops that take
/// several numbers at a time.
struct LasBlock {
  std::span<const std::int32_t> x;
  std::span<const std::int32_t> y;
  std::span<const std::int32_t> z;
  std::span<const std::uint8_t> classification;
  std::span<const std::uint8_t> withheld;  ///< 0 or 1.
  NumberRange x_range;
  NumberRange y_range;
  NumberRange z_range;

  std::size_t size() const { return x.size(); }
};

/// Where records become a block.
struct LasBlockBuffer {
  static constexpr std::size_t kMost = 1024;

  std::array<std::int32_t, kMost> x;
  std::array<std::int32_t, kMost> y;
  std::array<std::int32_t, kMost> z;
  std::array<std::uint8_t, kMost> classification;
  std::array<std::uint8_t, kMost> withheld;

  /// The first n records. Precondition: they are set, n <= kMost.
  LasBlock first(std::size_t n) const;
};

using LasVisitor = std::function<void(const LasBlock& block)>;

/// Decodes `count` records from number `first` on and hands them over in blocks of
/// at most LasBlockBuffer::kMost.
/// Precondition: first + count <= point count; for LAZ, first is a multiple of layout.chunk_size,
/// or layout.variable_chunks, or 0. Throws Error(kInput) with the point number if the file ends
/// before or cannot be decoded.
void decode_points(const std::filesystem::path& path, const LasLayout& layout, std::int64_t first,
                   std::int64_t count, const LasVisitor& visit);

/// Throws if an uncompressed file has no room for its count before what follows the points.
void check_las_length(const std::filesystem::path& path, const LasLayout& layout);

}  // namespace tetropolis
