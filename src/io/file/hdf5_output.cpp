#include "hdf5_output.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <fstream>
#include <system_error>

#include "hdf5_file.h"
#include "hdf5_handle.h"
#include "io/deferred/hdf5_functions.h"

namespace tetropolis {

namespace {

namespace fs = std::filesystem;

/// Makes a dataset without data and returns where in the file they belong; HADDR_UNDEF for one
/// without rows.
haddr_t make_dataset(const Hdf5File& file, const Hdf5Dataset& dataset) {
  const std::array<hsize_t, 2> shape{dataset.rows, dataset.columns};
  const Hdf5Handle space(H5Screate_simple(dataset.columns == 0 ? 1 : 2, shape.data(), nullptr),
                         H5Sclose);
  const Hdf5Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links.id(), 1);
  H5Pset_obj_track_times(creation.id(), false);
  H5Pset_layout(creation.id(), H5D_CONTIGUOUS);
  H5Pset_alloc_time(creation.id(), H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_time(creation.id(), H5D_FILL_TIME_NEVER);
  Hdf5Handle set(H5Dcreate2(file.id(), dataset.path.c_str(), file_type(dataset.type), space.id(),
                            links.id(), creation.id(), H5P_DEFAULT),
                 H5Dclose);
  file.require(set.good());
  const haddr_t offset = H5Dget_offset(set.id());
  file.require(set.close() && (offset != HADDR_UNDEF || dataset.rows == 0));
  return offset;
}

/// Lets HDF5 make the file and returns where the data of each dataset begin; those without rows get
/// the end of the one before.
std::vector<std::uint64_t> lay_out(const fs::path& path, const fs::path& target,
                                   std::span<const Hdf5Dataset> datasets,
                                   const std::function<void(const Hdf5File&)>& prepare) {
  const QuietHdf5 quiet;
  Hdf5File file(path, target);
  if (prepare) prepare(file);
  std::vector<std::uint64_t> offsets;
  std::uint64_t end = 0;
  for (const Hdf5Dataset& dataset : datasets) {
    const haddr_t offset = make_dataset(file, dataset);
    offsets.push_back(offset == HADDR_UNDEF ? end : offset);
    end = offsets.back() + byte_count(dataset);
  }
  file.close();
  return offsets;
}

}  // namespace

std::int64_t file_type(Hdf5Type type) {
  if (type == Hdf5Type::kFloat64) return H5T_IEEE_F64LE;
  if (type == Hdf5Type::kUint8) return H5T_STD_U8LE;
  return type == Hdf5Type::kInt64 ? H5T_STD_I64LE : H5T_STD_I32LE;
}

std::uint64_t width_of(Hdf5Type type) {
  if (type == Hdf5Type::kUint8) return 1;
  return type == Hdf5Type::kInt32 ? 4 : 8;
}

std::uint64_t byte_count(const Hdf5Dataset& dataset) {
  return dataset.rows * std::max<std::uint64_t>(dataset.columns, 1) * width_of(dataset.type);
}

Hdf5Output::Hdf5Output(const fs::path& target, std::span<const Hdf5Dataset> datasets,
                       const std::function<void(const Hdf5File&)>& prepare)
    : file_(target) {
  read_layout(lay_out(file_.path(), target, datasets, prepare), datasets);
}

void Hdf5Output::read_layout(std::span<const std::uint64_t> offsets,
                             std::span<const Hdf5Dataset> datasets) {
  std::ifstream file(file_.path(), std::ios::binary);
  std::uint64_t at = 0;
  const auto add_own = [&](std::uint64_t end) {
    if (end < at) throw_cannot_write(file_.path(), "this HDF5 orders datasets in another way");
    Stretch own{at, end, std::string(end - at, '\0')};
    file.seekg(static_cast<std::streamoff>(at));
    file.read(own.bytes.data(), static_cast<std::streamsize>(end - at));
    if (!file) throw_cannot_write(file_.path(), "it cannot be read back");
    stretches_.push_back(std::move(own));
  };
  for (std::size_t i = 0; i < datasets.size(); ++i) {
    add_own(offsets[i]);
    at = offsets[i] + byte_count(datasets[i]);
    stretches_.push_back({offsets[i], at, {}});
  }
  add_own(std::max<std::uint64_t>(fs::file_size(file_.path()), at));
}

void Hdf5Output::begin_next() {
  assert(next_ + 1 < stretches_.size());
  assert(static_cast<std::uint64_t>(file_.stream().tellp()) == stretches_[next_].begin);
  file_.write(stretches_[next_].bytes);
  next_ += 2;
}

void Hdf5Output::commit() {
  assert(next_ + 1 == stretches_.size());
  assert(static_cast<std::uint64_t>(file_.stream().tellp()) == stretches_[next_].begin);
  file_.write(stretches_[next_].bytes);
  file_.commit();
}

}  // namespace tetropolis
