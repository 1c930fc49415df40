#include "hdf5_input.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "core/foreign_code.h"
#include "input_file.h"
#include "io/deferred/hdf5_functions.h"

namespace tetropolis {

namespace {

/// Bytes that one byte of a deflated chunk can become at most (RFC 1951: 258 for two bits), and
/// some room.
constexpr std::uint64_t kMostInflated = 1100;

hid_t open_file(const std::filesystem::path& path) {
  require_ordinary_file(path);
  const QuietHdf5 quiet;
  const ForeignCode guard(path.c_str());
  return H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
}

}  // namespace

Hdf5Input::Hdf5Input(std::filesystem::path path)
    : path_(std::move(path)), file_(open_file(path_), H5Fclose) {
  if (!file_.good()) fail("cannot be read, is not an HDF5 file, or is cut; write it again");
}

Hdf5Handle Hdf5Input::open(const Hdf5Dataset& wanted) const {
  const hid_t set = H5Dopen2(file_.id(), wanted.path.c_str(), H5P_DEFAULT);
  if (set < 0) fail("has no dataset " + wanted.path);
  return {set, H5Dclose};
}

std::uint64_t Hdf5Input::rows_of(const Hdf5Dataset& wanted) const {
  const QuietHdf5 quiet;
  const ForeignCode guard(path_.c_str());
  const Hdf5Handle set = open(wanted);
  const Hdf5Handle type(H5Dget_type(set.id()), H5Tclose);
  if (H5Tequal(type.id(), file_type(wanted.type)) <= 0)
    fail("dataset " + wanted.path + " has another type than tetropolis writes");
  const Hdf5Handle space(H5Dget_space(set.id()), H5Sclose);
  const int dimensions = wanted.columns == 0 ? 1 : 2;
  std::array<hsize_t, 2> shape{0, 0};
  if (H5Sget_simple_extent_ndims(space.id()) != dimensions ||
      H5Sget_simple_extent_dims(space.id(), shape.data(), nullptr) < 0 ||
      shape[1] != wanted.columns)
    fail("dataset " + wanted.path + " has another shape than tetropolis writes");
  const std::uint64_t row = std::max<std::uint64_t>(wanted.columns, 1) * width_of(wanted.type);
  std::error_code error;
  const std::uint64_t file_size = std::filesystem::file_size(path_, error);
  const std::uint64_t stored = std::min<std::uint64_t>(H5Dget_storage_size(set.id()), file_size);
  if (shape[0] / kMostInflated > stored / row)
    fail("dataset " + wanted.path + " has fewer bytes in the file than its " +
         std::to_string(shape[0]) + " rows need");
  return shape[0];
}

void Hdf5Input::read_all(const Hdf5Dataset& wanted, void* rows) const {
  const QuietHdf5 quiet;
  const ForeignCode guard(path_.c_str());
  const Hdf5Handle set = open(wanted);
  if (H5Dread(set.id(), file_type(wanted.type), H5S_ALL, H5S_ALL, H5P_DEFAULT, rows) < 0)
    fail("dataset " + wanted.path + " cannot be read: the file is cut or broken; write it again");
}

void Hdf5Input::fail(const std::string& what) const { fail_input(path_, what); }

}  // namespace tetropolis
