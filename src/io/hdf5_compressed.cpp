#include "hdf5_compressed.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <hdf5.h>
#include <unistd.h>

#include "hdf5_handle.h"

namespace tetropolis {

namespace {

namespace fs = std::filesystem;

/// Rows of a chunk: some hundred kilobytes.
constexpr std::uint64_t kChunkRows = 32768;
/// More than HDF5 needs for groups and datasets as few as ours, and for a chunk's place in the
/// index.
constexpr std::uint64_t kRoomForHdf5 = 1 << 20, kRoomForChunk = 1024;
/// Room is reserved in steps of this size where there is so much.
constexpr std::uint64_t kStep = 16 << 20;

[[noreturn]] void fail(const fs::path& target, int error) {
  throw_cannot_write(target,
                     error == 0 ? "HDF5 gave no reason" : std::generic_category().message(error));
}

std::uint64_t chunk_rows(const Hdf5Dataset& dataset) { return std::min(kChunkRows, dataset.rows); }

/// Whole numbers gain by shuffling; coordinates, which are often repeated, lose.
bool is_shuffled(const Hdf5Dataset& dataset) { return dataset.type != Hdf5Type::kFloat64; }

hid_t create_dataset(hid_t file, const Hdf5Dataset& dataset) {
  const int dimensions = dataset.columns == 0 ? 1 : 2;
  const std::array<hsize_t, 2> shape{dataset.rows, dataset.columns};
  const std::array<hsize_t, 2> chunk{chunk_rows(dataset), dataset.columns};
  const Hdf5Handle space(H5Screate_simple(dimensions, shape.data(), nullptr), H5Sclose);
  const Hdf5Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links.id(), 1);
  H5Pset_obj_track_times(creation.id(), false);
  if (dataset.rows > 0) {
    H5Pset_chunk(creation.id(), dimensions, chunk.data());
    if (is_shuffled(dataset)) H5Pset_shuffle(creation.id());
    H5Pset_deflate(creation.id(), 1);
    H5Pset_fill_time(creation.id(), H5D_FILL_TIME_NEVER);
  }
  return H5Dcreate2(file, dataset.path.c_str(), file_type(dataset.type), space.id(), links.id(),
                    creation.id(), H5P_DEFAULT);
}

/// The end of what HDF5 says is in the file.
std::uint64_t end_of(const fs::path& path) {
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  haddr_t end = HADDR_UNDEF;
  if (!file.good() || H5Fget_eoa(file.id(), &end) < 0) return 0;
  return end;
}

}  // namespace

/// Errors of HDF5 are kept quiet while it lives; members go in reverse order.
struct Hdf5CompressedOutput::State {
  QuietHdf5 quiet;
  std::unique_ptr<Hdf5Handle> file;
  std::unique_ptr<Hdf5Handle> dataset;
};

Hdf5CompressedOutput::Hdf5CompressedOutput(const fs::path& target,
                                           std::span<const Hdf5Dataset> datasets)
    : file_(target), target_(target), datasets_(datasets.begin(), datasets.end()) {
  needed_ = kRoomForHdf5;
  reserve(needed_);
  state_ = std::make_unique<State>();
  errno = 0;
  state_->file = std::make_unique<Hdf5Handle>(
      H5Fcreate(file_.path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  if (!state_->file->good()) fail(target_, errno);
  reserved_ = 0;  // gone with the truncation
  reserve(needed_);
}

Hdf5CompressedOutput::~Hdf5CompressedOutput() = default;

void Hdf5CompressedOutput::reserve(std::uint64_t bytes) {
  if (bytes <= reserved_) return;
  const int file = ::open(file_.path().c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) fail(target_, errno);
  int error = 0;
  for (const std::uint64_t more : {kStep, std::uint64_t{0}}) {
    do {
      // What is reserved is left alone: where the file system cannot reserve, all of it is read.
      error = ::posix_fallocate(file, static_cast<off_t>(reserved_),
                                static_cast<off_t>(bytes + more - reserved_));
    } while (error == EINTR);
    if (error == 0) {
      reserved_ = bytes + more;
      break;
    }
  }
  ::close(file);
  if (error != 0) fail(target_, error);
}

CompressedBlocks::Options Hdf5CompressedOutput::begin_next() {
  assert(next_ < datasets_.size());
  const Hdf5Dataset& dataset = datasets_[next_];
  errno = 0;
  state_->dataset =
      std::make_unique<Hdf5Handle>(create_dataset(state_->file->id(), dataset), H5Dclose);
  if (!state_->dataset->good()) fail(target_, errno);
  row_ = 0;
  CompressedBlocks::Options options;
  options.block_size =
      chunk_rows(dataset) * byte_count(dataset) / std::max<std::uint64_t>(dataset.rows, 1);
  options.shuffled_width = is_shuffled(dataset) ? width_of(dataset.type) : 0;
  options.fill_last = true;
  return options;
}

void Hdf5CompressedOutput::write_chunk(std::string_view chunk) {
  const QuietHdf5 quiet;  // on this thread, which may be any
  needed_ += chunk.size() + kRoomForChunk;
  reserve(needed_);
  const std::array<hsize_t, 2> offset{row_, 0};
  errno = 0;
  if (H5Dwrite_chunk(state_->dataset->id(), H5P_DEFAULT, 0, offset.data(), chunk.size(),
                     chunk.data()) < 0)
    fail(target_, errno);
  row_ += kChunkRows;
}

void Hdf5CompressedOutput::end_next() {
  errno = 0;
  if (!state_->dataset->close()) fail(target_, errno);
  state_->dataset.reset();
  ++next_;
}

void Hdf5CompressedOutput::commit() {
  assert(next_ == datasets_.size());
  errno = 0;
  if (!state_->file->close()) fail(target_, errno);
  const std::uint64_t end = end_of(file_.path());
  if (end == 0) fail(target_, 0);
  std::error_code error;
  fs::resize_file(file_.path(), end, error);
  if (error) fail(target_, error.value());
  state_.reset();
  file_.commit();
}

}  // namespace tetropolis
