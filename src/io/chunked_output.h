// Formatting in parallel, writing in order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "tetropolis/core/parallel.h"
#include "tetropolis/core/progress.h"

namespace tetropolis {

/// Cuts [0, size) into chunks of `grain`, lets format(begin, end, buffer) append each chunk's bytes
/// to its own buffer, a batch of chunks at a time in parallel, and writes the buffers in order to
/// `file`, an AtomicFile or something with the same write(). Memory is that of one batch.
template <typename File, typename Format>
void write_chunked(File& file, std::size_t size, std::size_t grain, const Format& format,
                   const Progress& progress = {}) {
  constexpr std::size_t kBatch = 16;
  std::vector<std::string> buffers(kBatch);
  for (std::size_t start = 0; start < size; start += grain * kBatch) {
    progress.update(static_cast<double>(start) / static_cast<double>(size));
    const std::size_t stop = std::min(start + grain * kBatch, size);
    for (std::string& buffer : buffers) buffer.clear();
    parallel_chunks(stop - start, grain, [&](std::size_t begin, std::size_t end) {
      format(start + begin, start + end, buffers[begin / grain]);
    });
    for (const std::string& buffer : buffers) file.write(buffer);
  }
}

/// Appends the bytes of a number as they lie in memory.
template <typename Number>
void append_raw(std::string& buffer, Number value) {
  const auto* bytes = reinterpret_cast<const char*>(&value);
  buffer.append(bytes, sizeof value);
}

}  // namespace tetropolis
