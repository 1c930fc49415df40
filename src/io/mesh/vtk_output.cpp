#include "vtk_output.h"

#include <cassert>

#include <fmt/format.h>

namespace tetropolis {

namespace {

/// The attribute, as wide as the largest offset would make it.
std::string offset_attribute(std::uint64_t offset) {
  return fmt::format("{:<30}", fmt::format("offset=\"{}\"", offset));
}

std::string_view bytes_of(const std::vector<std::uint64_t>& words) {
  return {reinterpret_cast<const char*>(words.data()), words.size() * sizeof(std::uint64_t)};
}

}  // namespace

VtkOutput::VtkOutput(const std::filesystem::path& target, Compression compression)
    : file_(target), compression_(compression) {}

std::string_view VtkOutput::file_attributes() const {
  return compression_ == Compression::kNone
             ? "version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\""
             : "version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" "
               "compressor=\"vtkZLibDataCompressor\"";
}

std::string VtkOutput::tag(const VtkArraySpec& array) {
  std::string shape =
      array.components > 0 ? fmt::format(" NumberOfComponents=\"{}\"", array.components) : "";
  if (array.tuples > 0) shape += fmt::format(" NumberOfTuples=\"{}\"", array.tuples);
  // Until the offset is known, the array's number stands for it.
  const std::string offset = offset_attribute(arrays_.size());
  arrays_.emplace_back().bytes = array.bytes;
  return fmt::format("<{} type=\"{}\" Name=\"{}\"{} format=\"appended\" {}/>\n",
                     array.type == "String" ? "Array" : "DataArray", array.type, array.name, shape,
                     offset);
}

void VtkOutput::write(std::string_view bytes) {
  file_.write(bytes);
  position_ += bytes.size();
}

void VtkOutput::write_head(const std::string& head) {
  assert(position_ == 0);
  for (std::size_t i = 0; i < arrays_.size(); ++i) {
    const std::size_t tag = head.find(offset_attribute(i));
    assert(tag != std::string::npos);
    arrays_[i].tag = tag;
  }
  write(head);
  data_ = position_;
}

void VtkOutput::begin_next() {
  assert(next_ < arrays_.size());
  Array& array = arrays_[next_];
  array.begin = position_;
  if (compression_ == Compression::kNone) {
    array.header = {array.bytes};
  } else {
    const std::uint64_t blocks = (array.bytes + kBlock - 1) / kBlock;
    array.header = {blocks, kBlock, array.bytes % kBlock};
  }
  const std::size_t known = array.header.size();
  if (compression_ != Compression::kNone) array.header.resize(known + array.header[0], 0);
  write(bytes_of(array.header));
  array.header.resize(known);
}

void VtkOutput::write_block(std::string_view block) {
  arrays_[next_].header.push_back(block.size());
  write(block);
}

void VtkOutput::commit(std::string_view tail) {
  assert(next_ == arrays_.size());
  write(tail);
  for (const Array& array : arrays_) {
    file_.overwrite(array.tag, offset_attribute(array.begin - data_));
    if (compression_ != Compression::kNone) file_.overwrite(array.begin, bytes_of(array.header));
  }
  file_.commit();
}

}  // namespace tetropolis
