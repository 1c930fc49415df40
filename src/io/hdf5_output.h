// A new HDF5 file, written dataset by dataset in one go.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "tetropolis/core/progress.h"
#include "tetropolis/io/atomic_file.h"

namespace tetropolis {

enum class Hdf5Type { kFloat64, kInt64, kInt32 };

/// The same calls give the same bytes: no times are stored. Used from one thread at a time.
class Hdf5Output {
 public:
  /// Throws Error(kInput) naming the file, here and below, if it cannot be written.
  explicit Hdf5Output(const std::filesystem::path& target);
  ~Hdf5Output();
  Hdf5Output(const Hdf5Output&) = delete;
  Hdf5Output& operator=(const Hdf5Output&) = delete;

  struct Dataset {
    std::string_view path;  ///< "/group/.../name"; missing groups are made.
    Hdf5Type type;
    std::uint64_t rows;
    std::uint64_t columns;  ///< 0: the dataset has one dimension.
  };

  /// Writes a dataset whose rows, in order, are what format(begin, end, buffer) appends as raw
  /// bytes for consecutive pieces of [0, items); pieces of `grain` items are formatted in parallel.
  /// The pieces together have exactly the bytes of the dataset.
  void write(const Dataset& dataset, std::size_t items, std::size_t grain,
             const std::function<void(std::size_t, std::size_t, std::string&)>& format,
             const Progress& progress = {});

  /// Closes the file and makes it appear.
  void commit();

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path target_;
  AtomicFile file_;
  std::int64_t handle_ = -1;
};

}  // namespace tetropolis
