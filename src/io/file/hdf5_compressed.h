// A new HDF5 file with given datasets in compressed chunks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tetropolis/core/progress.h"

#include "atomic_file.h"
#include "chunked_output.h"
#include "compressed_blocks.h"
#include "hdf5_output.h"

namespace tetropolis {

/// Like Hdf5Output, with the filters "shuffle" (whole numbers only) and "deflate". The chunks are
/// compressed here, in parallel, and HDF5 puts them into the file.
class Hdf5CompressedOutput {
 public:
  Hdf5CompressedOutput(const std::filesystem::path& target, std::span<const Hdf5Dataset> datasets);
  ~Hdf5CompressedOutput();
  Hdf5CompressedOutput(const Hdf5CompressedOutput&) = delete;
  Hdf5CompressedOutput& operator=(const Hdf5CompressedOutput&) = delete;

  /// As Hdf5Output::write_next.
  template <typename Format>
  void write_next(std::size_t items, const Format& format, const Progress& progress = {}) {
    if (const CompressedBlocks::Options options = begin_next(); options.block_size > 0) {
      CompressedBlocks blocks(options, [&](std::string_view chunk) { write_chunk(chunk); });
      write_chunked(blocks, items, grain_for(items, byte_count(datasets_[next_])), format,
                    progress);
      blocks.finish();
    }
    end_next();
  }

  /// Call after all datasets: the file appears.
  void commit();

 private:
  struct State;  // identifiers of HDF5

  CompressedBlocks::Options begin_next();
  void write_chunk(std::string_view chunk);
  void end_next();

  AtomicFile file_;
  std::vector<Hdf5Dataset> datasets_;
  std::unique_ptr<State> state_;
  std::size_t next_ = 0;
  std::uint64_t row_ = 0;  ///< First row of the next chunk.
};

}  // namespace tetropolis
