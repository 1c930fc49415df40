#include "vtk_input.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include <zlib.h>

#include "io/file/input_file.h"

namespace tetropolis {

namespace {

constexpr std::int64_t kLongestHead = 1 << 20;
/// Plain arrays are read in pieces of this size.
constexpr std::uint64_t kPiece = 1 << 20;
/// No stream of zlib unpacks to more than this many times its size.
constexpr std::uint64_t kMostExpansion = 1040;

/// Value of an attribute in a tag, or an empty string.
std::string attribute(std::string_view tag, const std::string& name) {
  const std::string key = " " + name + "=\"";
  const std::size_t begin = tag.find(key);
  if (begin == std::string_view::npos) return {};
  const std::size_t end = tag.find('"', begin + key.size());
  if (end == std::string_view::npos) return {};
  return std::string(tag.substr(begin + key.size(), end - begin - key.size()));
}

std::optional<std::pair<VtkType, std::uint64_t>> type_and_width(const std::string& name) {
  static const std::map<std::string, std::pair<VtkType, std::uint64_t>> known{
      {"Float64", {VtkType::kFloat64, 8}}, {"Float32", {VtkType::kFloat32, 4}},
      {"Int64", {VtkType::kInt64, 8}},     {"Int32", {VtkType::kInt32, 4}},
      {"UInt32", {VtkType::kUInt32, 4}},   {"UInt8", {VtkType::kUInt8, 1}}};
  const auto found = known.find(name);
  if (found == known.end()) return std::nullopt;
  return found->second;
}

}  // namespace

void VtkInput::fail(const std::string& what) const { fail_input(path_, what); }

void VtkInput::require_end() const {
  std::string tail(std::min<std::uint64_t>(size_, 256), '\0');
  read_bytes(size_ - tail.size(), tail);
  if (tail.find("</VTKFile>") == std::string::npos)
    fail("ends without its closing tag: the file is cut");
}

VtkInput::VtkInput(std::filesystem::path path, const std::string& type,
                   const std::string& cell_count)
    : path_(std::move(path)), file_(path_), size_(static_cast<std::uint64_t>(file_.size())) {
  read_head(type, cell_count);
}

std::uint64_t VtkInput::number(const std::string& text, const std::string& what) const {
  if (text.empty() || text.find_first_not_of("0123456789") != std::string::npos || text.size() > 18)
    fail("not a number in the header: " + what);
  return std::stoull(text);
}

void VtkInput::read_bytes(std::uint64_t offset, std::span<char> bytes) const {
  const auto position = static_cast<std::int64_t>(offset);
  if (file_.read(position, bytes.data(), bytes.size()) < bytes.size())
    fail("ends inside an array: the file is cut");
}

void VtkInput::read_head(const std::string& type, const std::string& cell_count) {
  std::string head = file_.head(kLongestHead);
  if (head.find("<VTKFile") == std::string::npos ||
      head.find("type=\"" + type + "\"") == std::string::npos)
    fail("is not a VTK XML file of type " + type);
  const std::size_t appended = head.find("<AppendedData");
  if (appended == std::string::npos || head.find("encoding=\"raw\"", appended) == std::string::npos)
    fail("has no raw appended data; write it again with that data mode");
  read_appended_tag(head, appended);
  head.resize(appended);
  read_tags(head, cell_count);
}

void VtkInput::read_appended_tag(const std::string& head, std::size_t appended) {
  const std::size_t underscore = head.find('_', head.find('>', appended));
  if (underscore == std::string::npos) fail("has no appended data");
  data_ = underscore + 1;
  const std::size_t start = head.find("<VTKFile");
  const std::string tag = head.substr(start, head.find('>', start) - start);
  const std::string compressor = attribute(tag, "compressor");
  compressed_ = !compressor.empty();
  if (compressed_ && compressor != "vtkZLibDataCompressor")
    fail("is compressed by " + compressor +
         "; write it again uncompressed or with vtkZLibDataCompressor");
  const std::string header = attribute(tag, "header_type");
  if (header != "UInt64" && header != "UInt32" && !header.empty())
    fail("has headers of the unknown type " + header);
  word_ = header == "UInt64" ? 8 : 4;
  if (attribute(tag, "byte_order") == "BigEndian")
    fail("has big-endian data; write it again on a little-endian machine");
}

void VtkInput::read_field_tags(const std::string& head, std::size_t piece) {
  for (const char* element : {"<DataArray", "<Array"})
    for (std::size_t at = head.find(element); at < piece; at = head.find(element, at + 1)) {
      const std::size_t text = head.find('>', at) + 1;
      const std::string tag = head.substr(at, text - at);
      const std::string name = attribute(tag, "Name"), format = attribute(tag, "format");
      if (name == "origin" && format == "ascii")
        origin_ = head.substr(text, head.find('<', text) - text);
      if (format == "appended")
        fields_[name] = {attribute(tag, "type"), number(attribute(tag, "offset"), "offset")};
    }
}

void VtkInput::read_tags(const std::string& head, const std::string& cell_count) {
  const std::size_t piece = head.find("<Piece");
  if (piece == std::string::npos) fail("has no <Piece>");
  read_field_tags(head, piece);
  // Each piece has arrays of its own by the same names.
  if (head.find("<Piece", piece + 1) != std::string::npos)
    fail("has several pieces; write it again as one piece");
  const std::string piece_tag = head.substr(piece, head.find('>', piece) - piece);
  points_ = number(attribute(piece_tag, "NumberOfPoints"), "NumberOfPoints");
  cells_ = number(attribute(piece_tag, cell_count), cell_count);
  // Far beyond any file, and far from where products would overflow.
  const std::uint64_t most = size_ / 12 * (compressed_ ? kMostExpansion : 1) + 1;
  if (points_ > most || cells_ > most)
    fail("announces more points or cells than its size can hold: the file is cut");
  for (std::size_t at = head.find("<DataArray", piece); at != std::string::npos;
       at = head.find("<DataArray", at + 1)) {
    const std::string tag = head.substr(at, head.find('>', at) - at);
    if (attribute(tag, "format") != "appended") continue;
    arrays_[attribute(tag, "Name")] = {attribute(tag, "type"),
                                       number(attribute(tag, "offset"), "offset")};
  }
}

std::vector<std::uint64_t> VtkInput::read_words(std::uint64_t offset, std::uint64_t count) const {
  if (offset > size_ || count > (size_ - offset) / word_)
    fail("ends before an array: the file is cut");
  std::vector<char> bytes(count * word_);
  read_bytes(offset, bytes);
  std::vector<std::uint64_t> words(count, 0);
  for (std::size_t i = 0; i < words.size(); ++i)
    std::memcpy(&words[i], bytes.data() + i * word_, word_);
  return words;
}

void VtkInput::add_plain_pieces(std::uint64_t at, std::uint64_t bytes, std::uint64_t width,
                                VtkArray& array) const {
  const std::uint64_t announced = read_words(at, 1)[0];
  if (announced != bytes)
    fail("array " + array.name + " has " + std::to_string(announced) + " bytes, " +
         std::to_string(bytes) + " expected");
  const std::uint64_t begin = at + word_;
  if (bytes > size_ - begin) fail("ends inside array " + array.name + ": the file is cut");
  for (std::uint64_t done = 0; done < bytes; done += kPiece) {
    const std::uint64_t count = std::min(kPiece, bytes - done);
    array.pieces.push_back({begin + done, count, done / width, count});
  }
}

/// Before the blocks: their number, their size, that of the last one if it is smaller (else 0),
/// and the compressed size of each.
void VtkInput::add_blocks(std::uint64_t at, std::uint64_t bytes, std::uint64_t width,
                          VtkArray& array) const {
  const auto head = read_words(at, 3);
  const std::uint64_t blocks = head[0], size = head[1], last = head[2] == 0 ? size : head[2];
  if (blocks == 0 && bytes == 0) return;
  const bool plausible = size > 0 && size % width == 0 && last <= size &&
                         blocks == bytes / size + (bytes % size == 0 ? 0 : 1) && blocks > 0 &&
                         bytes - (blocks - 1) * size == last;
  if (!plausible) fail("array " + array.name + " has blocks that do not make up its size");
  const auto stored = read_words(at + 3 * word_, blocks);
  std::uint64_t offset = at + (3 + blocks) * word_;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const std::uint64_t raw = b + 1 == blocks ? last : size;
    if (stored[b] > size_ - offset) fail("ends inside array " + array.name + ": the file is cut");
    if (raw / kMostExpansion > stored[b])
      fail("array " + array.name + " has a block that is too small: the file is damaged");
    array.pieces.push_back({offset, stored[b], b * size / width, raw});
    offset += stored[b];
  }
}

VtkArray VtkInput::array(const std::string& name, std::uint64_t count) const {
  const auto found = arrays_.find(name);
  if (found == arrays_.end()) fail("has no appended array " + name);
  const auto type = type_and_width(found->second.type);
  if (!type) fail("array " + name + " has the unsupported type " + found->second.type);
  VtkArray array{name, type->first, {}};
  const std::uint64_t width = type->second, at = data_ + found->second.offset;
  if (compressed_)
    add_blocks(at, count * width, width, array);
  else
    add_plain_pieces(at, count * width, width, array);
  return array;
}

std::string VtkInput::field_bytes(const std::string& name, const std::string& type) const {
  const auto found = fields_.find(name);
  if (found == fields_.end() || found->second.type != type) return {};
  VtkArray array{name, VtkType::kUInt8, {}};
  const std::uint64_t at = data_ + found->second.offset;
  std::uint64_t bytes = 0;
  if (compressed_) {
    const auto head = read_words(at, 3);
    if (head[0] > size_ || head[1] > kMostExpansion * size_ || head[2] > head[1])
      fail("array " + name + " has blocks that do not make up its size");
    if (head[0] > 0) bytes = (head[0] - 1) * head[1] + (head[2] == 0 ? head[1] : head[2]);
    add_blocks(at, bytes, 1, array);
  } else {
    bytes = read_words(at, 1)[0];
    add_plain_pieces(at, bytes, 1, array);
  }
  std::string all;
  std::vector<char> part;
  for (const VtkPiece& piece : array.pieces) {
    read_piece(piece, part);
    all.append(part.data(), part.size());
  }
  return all;
}

std::vector<std::string> VtkInput::texts(const std::string& name) const {
  const std::string bytes = field_bytes(name, "String");
  std::vector<std::string> texts;
  for (std::size_t begin = 0, end = 0; (end = bytes.find('\0', begin)) != std::string::npos;
       begin = end + 1)
    texts.push_back(bytes.substr(begin, end - begin));
  return texts;
}

std::vector<std::int32_t> VtkInput::field_numbers(const std::string& name) const {
  const std::string bytes = field_bytes(name, "Int32");
  std::vector<std::int32_t> numbers(bytes.size() / sizeof(std::int32_t));
  if (!numbers.empty())
    std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(std::int32_t));
  return numbers;
}

void VtkInput::read_piece(const VtkPiece& piece, std::vector<char>& bytes) const {
  bytes.resize(piece.bytes);
  if (!compressed_) {
    read_bytes(piece.offset, bytes);
    return;
  }
  std::vector<char> stored(piece.stored);
  read_bytes(piece.offset, stored);
  uLongf size = piece.bytes;
  const int code = uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                              reinterpret_cast<const Bytef*>(stored.data()), stored.size());
  if (code != Z_OK || size != piece.bytes)
    fail("the block at byte " + std::to_string(piece.offset) +
         " cannot be decompressed: the file is damaged");
}

}  // namespace tetropolis
