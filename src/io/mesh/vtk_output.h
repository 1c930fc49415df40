// Writing VTK XML files: a head with tags, and the arrays behind it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tetropolis/core/progress.h"
#include "tetropolis/io/file/compression.h"

#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"
#include "io/file/compressed_blocks.h"

namespace tetropolis {

/// One array of the appended section. `components` 0 and `tuples` 0: left out of the tag. The type
/// "String" has texts of any length, with a zero byte behind each.
struct VtkArraySpec {
  std::string_view type;
  std::string_view name;
  int components;
  std::uint64_t bytes;
  std::uint64_t tuples = 0;  ///< Field data alone need their number.
};

/// A file with raw appended data, plain or compressed by vtkZLibDataCompressor. Streams: compressed
/// sizes are not known before they are written, so the places for them (offsets in tags, headers of
/// arrays) are filled in at the end. Throws Error(kInput) if the file cannot be written.
class VtkOutput {
 public:
  VtkOutput(const std::filesystem::path& target, Compression compression);

  /// Attributes of the element VTKFile.
  std::string_view file_attributes() const;
  /// The tag of the next array. Arrays are written in the order of their tags.
  std::string tag(const VtkArraySpec& array);
  /// Writes everything before the arrays' data; it holds all tags.
  void write_head(const std::string& head);
  /// Writes the next array: what write_chunked makes of the arguments. Its bytes must be as many as
  /// its tag said.
  template <typename Format>
  void write_next(std::size_t items, const Format& format, const Progress& progress = {}) {
    begin_next();
    const std::size_t grain = grain_for(items, arrays_[next_].bytes);
    if (compression_ == Compression::kNone) {
      write_chunked(file_, items, grain, format, progress);
      position_ += arrays_[next_].bytes;
    } else {
      CompressedBlocks blocks({.block_size = kBlock},
                              [&](std::string_view block) { write_block(block); });
      write_chunked(blocks, items, grain, format, progress);
      blocks.finish();
    }
    ++next_;
  }
  /// Call after all arrays with what comes behind them: the file appears.
  void commit(std::string_view tail);

 private:
  /// Divisible by the width of all types.
  static constexpr std::uint64_t kBlock = std::uint64_t{1} << 18;

  struct Array {
    std::uint64_t bytes = 0;
    std::uint64_t tag = 0;              ///< Where in the file the offset in its tag is.
    std::uint64_t begin = 0;            ///< Where in the file it begins.
    std::vector<std::uint64_t> header;  ///< If compressed.
  };

  void begin_next();
  void write_block(std::string_view block);
  void write(std::string_view bytes);

  AtomicFile file_;
  Compression compression_;
  std::vector<Array> arrays_;
  std::uint64_t position_ = 0;
  std::uint64_t data_ = 0;  ///< Where offsets count from.
  std::size_t next_ = 0;
};

}  // namespace tetropolis
