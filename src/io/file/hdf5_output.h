// A new HDF5 file with given datasets, written as a stream.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tetropolis/core/progress.h"

#include "atomic_file.h"
#include "chunked_output.h"

namespace tetropolis {

class Hdf5File;

enum class Hdf5Type { kFloat64, kInt64, kInt32, kUint8 };

struct Hdf5Dataset {
  std::string path;  ///< "/group/.../name"; missing groups are made.
  Hdf5Type type;     ///< Little endian.
  std::uint64_t rows;
  std::uint64_t columns;  ///< 0: the dataset has one dimension.
};

/// Bytes of a number.
std::uint64_t width_of(Hdf5Type type);
/// Bytes of the numbers of a dataset.
std::uint64_t byte_count(const Hdf5Dataset& dataset);
/// The type's number in HDF5.
std::int64_t file_type(Hdf5Type type);

/// HDF5 only lays the file out, empty; what it wrote of its own is kept and the data are streamed
/// in between.
///
/// The same calls give the same bytes: no times are stored. Used from one thread at a time. Throws
/// Error(kInput) naming the file if it cannot be written.
class Hdf5Output {
 public:
  /// `prepare` may make groups, attributes and small datasets of its own before.
  Hdf5Output(const std::filesystem::path& target, std::span<const Hdf5Dataset> datasets,
             const std::function<void(const Hdf5File&)>& prepare = {});

  /// Writes the next dataset, in the order given. Its rows are what format(begin, end, buffer)
  /// appends as raw bytes for consecutive pieces of [0, items), formatted in parallel; together
  /// they have exactly the bytes of the dataset.
  template <typename Format>
  void write_next(std::size_t items, const Format& format, const Progress& progress = {}) {
    begin_next();
    const Stretch& stretch = stretches_[next_ - 1];
    write_chunked(file_, items, grain_for(items, stretch.end - stretch.begin), format, progress);
  }

  /// Call after all datasets: the file appears.
  void commit();

 private:
  /// A stretch of bytes that HDF5 wrote, or that of a dataset.
  struct Stretch {
    std::uint64_t begin;
    std::uint64_t end;
    std::string bytes;  ///< Empty for a dataset.
  };
  void begin_next();
  void read_layout(std::span<const std::uint64_t> offsets, std::span<const Hdf5Dataset> datasets);

  AtomicFile file_;
  std::vector<Stretch> stretches_;  ///< The whole file in order: HDF5's own and datasets in turn.
  std::size_t next_ = 0;
};

}  // namespace tetropolis
