#include "hdf5_compressed.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "hdf5_file.h"
#include "hdf5_handle.h"
#include "io/deferred/hdf5_functions.h"

namespace tetropolis {

namespace {

namespace fs = std::filesystem;

/// Rows of a chunk: some hundred kilobytes.
constexpr std::uint64_t kChunkRows = 32768;

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

}  // namespace

/// Errors of HDF5 are kept quiet while it lives; members go in reverse order.
struct Hdf5CompressedOutput::State {
  State(const fs::path& path, const fs::path& target) : file(path, target) {}
  QuietHdf5 quiet;
  Hdf5File file;
  std::unique_ptr<Hdf5Handle> dataset;
};

Hdf5CompressedOutput::Hdf5CompressedOutput(const fs::path& target,
                                           std::span<const Hdf5Dataset> datasets)
    : file_(target),
      datasets_(datasets.begin(), datasets.end()),
      state_(std::make_unique<State>(file_.path(), target)) {}

Hdf5CompressedOutput::~Hdf5CompressedOutput() = default;

CompressedBlocks::Options Hdf5CompressedOutput::begin_next() {
  assert(next_ < datasets_.size());
  const Hdf5Dataset& dataset = datasets_[next_];
  state_->dataset =
      std::make_unique<Hdf5Handle>(create_dataset(state_->file.id(), dataset), H5Dclose);
  state_->file.require(state_->dataset->good());
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
  const std::array<hsize_t, 2> offset{row_, 0};
  state_->file.require(H5Dwrite_chunk(state_->dataset->id(), H5P_DEFAULT, 0, offset.data(),
                                      chunk.size(), chunk.data()) >= 0);
  row_ += kChunkRows;
}

void Hdf5CompressedOutput::end_next() {
  state_->file.require(state_->dataset->close());
  state_->dataset.reset();
  ++next_;
}

void Hdf5CompressedOutput::commit() {
  assert(next_ == datasets_.size());
  state_->file.close();
  state_.reset();
  file_.commit();
}

}  // namespace tetropolis
