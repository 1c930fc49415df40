// Formatting in parallel, writing in order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "tetropolis/core/progress.h"

#include "core/parallel.h"

namespace tetropolis {

/// Of a table, for write_chunked: some hundred kilobytes.
inline constexpr std::size_t kRowsPerChunk = 16384;

/// How many of `items` items, which have `bytes` bytes in all, make a chunk for write_chunked: so
/// few that it stays in a core's cache until it is written, and so many that the system takes large
/// pages for it.
inline std::size_t grain_for(std::size_t items, std::uint64_t bytes) {
  constexpr double kChunkBytes = 768 * 1024;
  const double grain = static_cast<double>(items) * kChunkBytes /
                       static_cast<double>(std::max<std::uint64_t>(bytes, 1));
  return std::clamp<std::size_t>(static_cast<std::size_t>(grain), 1,
                                 std::max<std::size_t>(items, 1));
}

/// Cuts [0, size) into chunks of `grain`, lets format(begin, end, buffer) append each chunk's bytes
/// to a buffer of its own, several at the same time, and writes the buffers in order to `file`, an
/// AtomicFile or something with the same write(), while the next are being filled. Memory is that
/// of eight chunks.
template <typename File, typename Format>
void write_chunked(File& file, std::size_t size, std::size_t grain, const Format& format,
                   const Progress& progress = {}) {
  constexpr std::size_t kBuffers = 8;
  std::vector<std::string> buffers(kBuffers);
  parallel_pipeline(
      (size + grain - 1) / grain, buffers,
      [&](std::size_t chunk, std::string& buffer) {
        buffer.clear();
        format(chunk * grain, std::min((chunk + 1) * grain, size), buffer);
      },
      [&](std::size_t chunk, const std::string& buffer) {
        progress.update(static_cast<double>(chunk * grain) / static_cast<double>(size));
        file.write(buffer);
      });
}

/// Appends the bytes of a number as they lie in memory.
template <typename Number>
void append_raw(std::string& buffer, Number value) {
  const auto* bytes = reinterpret_cast<const char*>(&value);
  buffer.append(bytes, sizeof value);
}

/// Puts numbers one after the other into room that is made for them all at once.
class RawNumbers {
 public:
  /// Room for `bytes` more at the end of the buffer.
  RawNumbers(std::string& buffer, std::size_t bytes) {
    const std::size_t size = buffer.size();
    buffer.resize(size + bytes);
    at_ = buffer.data() + size;
  }
  template <typename Number>
  void put(Number value) {
    std::memcpy(at_, &value, sizeof value);
    at_ += sizeof value;
  }

 private:
  char* at_;
};

}  // namespace tetropolis
