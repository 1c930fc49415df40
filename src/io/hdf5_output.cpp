#include "hdf5_output.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <system_error>
#include <type_traits>
#include <vector>

#include <hdf5.h>

#include "tetropolis/core/parallel.h"

namespace tetropolis {

namespace {

static_assert(std::is_same_v<hid_t, std::int64_t>, "HDF5 1.10 or newer is needed");

/// HDF5 prints failures to stderr unless told otherwise; what was set comes back.
class QuietHdf5 {
 public:
  QuietHdf5() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// Closes an identifier when it goes.
class Handle {
 public:
  Handle(hid_t id, herr_t (*closer)(hid_t)) : id_(id), close_(closer) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  hid_t id() const { return id_; }
  bool good() const { return id_ >= 0; }
  /// Whether closing it went well, too.
  bool close() {
    const hid_t id = id_;
    id_ = -1;
    return close_(id) >= 0;
  }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

hid_t file_type(Hdf5Type type) {
  if (type == Hdf5Type::kFloat64) return H5T_IEEE_F64LE;
  return type == Hdf5Type::kInt64 ? H5T_STD_I64LE : H5T_STD_I32LE;
}

std::size_t type_size(Hdf5Type type) { return type == Hdf5Type::kInt32 ? 4 : 8; }

hid_t make_dataset(hid_t file, const Hdf5Output::Dataset& dataset, hid_t space) {
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links.id(), 1);
  H5Pset_obj_track_times(creation.id(), false);
  // Every byte is written below.
  H5Pset_fill_time(creation.id(), H5D_FILL_TIME_NEVER);
  return H5Dcreate2(file, std::string(dataset.path).c_str(), file_type(dataset.type), space,
                    links.id(), creation.id(), H5P_DEFAULT);
}

/// Writes `bytes` as the rows from `row` on; whether it worked.
bool write_rows(hid_t target, hid_t space, const Hdf5Output::Dataset& dataset, std::uint64_t row,
                std::uint64_t rows, const std::string& bytes) {
  const int rank = dataset.columns == 0 ? 1 : 2;
  const std::array<hsize_t, 2> start{row, 0};
  const std::array<hsize_t, 2> count{rows, dataset.columns};
  const Handle memory(H5Screate_simple(rank, count.data(), nullptr), H5Sclose);
  const hid_t type = file_type(dataset.type);
  return memory.good() &&
         H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) >=
             0 &&
         H5Dwrite(target, type, memory.id(), space, H5P_DEFAULT, bytes.data()) >= 0;
}

}  // namespace

Hdf5Output::Hdf5Output(const std::filesystem::path& target) : target_(target), file_(target) {
  const QuietHdf5 quiet;
  errno = 0;
  handle_ = H5Fcreate(file_.path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  if (handle_ < 0) fail();
}

Hdf5Output::~Hdf5Output() {
  const QuietHdf5 quiet;
  if (handle_ >= 0) H5Fclose(handle_);
}

void Hdf5Output::fail() const {
  throw_cannot_write(target_,
                     errno == 0 ? "HDF5 gave no reason" : std::generic_category().message(errno));
}

void Hdf5Output::write(const Dataset& dataset, std::size_t items, std::size_t grain,
                       const std::function<void(std::size_t, std::size_t, std::string&)>& format,
                       const Progress& progress) {
  const QuietHdf5 quiet;
  errno = 0;
  const std::array<hsize_t, 2> shape{dataset.rows, dataset.columns};
  Handle space(H5Screate_simple(dataset.columns == 0 ? 1 : 2, shape.data(), nullptr), H5Sclose);
  Handle target(make_dataset(handle_, dataset, space.id()), H5Dclose);
  if (!space.good() || !target.good()) fail();

  constexpr std::size_t kBatch = 16;
  const std::size_t row_bytes = type_size(dataset.type) * std::max<std::size_t>(dataset.columns, 1);
  std::vector<std::string> buffers(kBatch);
  std::uint64_t row = 0;
  for (std::size_t start = 0; start < items; start += grain * kBatch) {
    progress.update(static_cast<double>(start) / static_cast<double>(items));
    const std::size_t stop = std::min(start + grain * kBatch, items);
    for (std::string& buffer : buffers) buffer.clear();
    parallel_chunks(stop - start, grain, [&](std::size_t begin, std::size_t end) {
      format(start + begin, start + end, buffers[begin / grain]);
    });
    errno = 0;
    for (const std::string& buffer : buffers) {
      if (buffer.empty()) continue;
      const std::uint64_t rows = buffer.size() / row_bytes;
      if (!write_rows(target.id(), space.id(), dataset, row, rows, buffer)) fail();
      row += rows;
    }
  }
  assert(row == dataset.rows);
  if (!target.close()) fail();
}

void Hdf5Output::commit() {
  const QuietHdf5 quiet;
  errno = 0;
  const hid_t handle = handle_;
  handle_ = -1;
  if (H5Fclose(handle) < 0) fail();
  file_.commit();
}

}  // namespace tetropolis
