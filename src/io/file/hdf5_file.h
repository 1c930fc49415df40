// A new HDF5 file that may fail to be written.
#pragma once

#include <filesystem>

#include "hdf5_handle.h"
#include "io/deferred/hdf5_functions.h"

namespace tetropolis {

/// HDF5 does not get over a write that fails: it cannot let go of the file any more and crashes the
/// program at exit, or says there that it loops for ever. So it writes through a driver of ours (a
/// "virtual file driver" in its documentation), which keeps the first failure to itself.
///
/// Throws Error(kInput) naming `target`, the place that the file is meant for, where it cannot be
/// written.
class Hdf5File {
 public:
  /// Datasets lie in it in the order they are made, however small.
  Hdf5File(const std::filesystem::path& path, const std::filesystem::path& target);
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  hid_t id() const { return file_.id(); }
  /// To be asked after each call that may write: throws unless `good`, what HDF5 says of the call,
  /// and unless all was written so far.
  void require(bool good) const;
  void close() { require(file_.close()); }

 private:
  std::filesystem::path target_;
  int error_ = 0;  ///< errno of the first write that failed.
  Hdf5Handle driver_;
  Hdf5Handle file_;
};

}  // namespace tetropolis
