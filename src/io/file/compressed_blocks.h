// Compression by zlib, block by block and in parallel.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace tetropolis {

/// Cuts a stream of bytes into blocks, compresses them in parallel and hands them on in order. The
/// result depends on the bytes alone, not on how they are cut into calls of write or on the number
/// of threads. Memory is that of some thirty blocks.
class CompressedBlocks {
 public:
  struct Options {
    std::size_t block_size = 1 << 18;
    /// If not 0: numbers of so many bytes; of each block the first bytes of all numbers come first,
    /// then the second ones, and so on (HDF5's shuffle filter). Divides block_size.
    std::size_t shuffled_width = 0;
    bool fill_last = false;  ///< Fill the last block up with zeros, else it is shorter.
  };

  CompressedBlocks(const Options& options, std::function<void(std::string_view)> use);
  void write(std::string_view bytes);
  /// Call once, last.
  void finish();

 private:
  void compress_pending(std::size_t bytes);

  Options options_;
  std::function<void(std::string_view)> use_;
  std::string pending_;
  std::vector<std::string> blocks_;
};

}  // namespace tetropolis
