// Reading VTK XML files with raw appended data: the head and the arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "io/file/positioned_file.h"

namespace tetropolis {

enum class VtkType { kFloat64, kFloat32, kInt64, kInt32, kUInt32, kUInt8 };

/// A stretch of an array as it lies in the file.
struct VtkPiece {
  std::uint64_t offset;  ///< Of its first byte in the file.
  std::uint64_t stored;  ///< Bytes in the file; less than `bytes` if it is compressed.
  std::uint64_t first;   ///< Number of its first value.
  std::uint64_t bytes;
};

struct VtkArray {
  std::string name;
  VtkType type{};
  std::vector<VtkPiece> pieces;
};

/// An open file. Its arrays are plain or in blocks compressed by vtkZLibDataCompressor, after
/// headers of 32 or 64 bits. Errors are Error(kInput) and name the file.
class VtkInput {
 public:
  /// Reads the head. `type`: of the data set, as "PolyData"; `cell_count`: the attribute that
  /// counts its cells.
  VtkInput(std::filesystem::path path, const std::string& type, const std::string& cell_count);

  std::uint64_t points() const { return points_; }
  std::uint64_t cells() const { return cells_; }
  bool has(const std::string& name) const { return arrays_.contains(name); }
  /// The texts of an array of the type String in the field data; none if there is no such array.
  std::vector<std::string> texts(const std::string& name) const;
  /// The values of an array of the type Int32 in the field data.
  std::vector<std::int32_t> field_numbers(const std::string& name) const;
  /// The text of the field data `origin`; empty if there is none as text.
  const std::string& origin() const { return origin_; }

  /// The array `name`. Checked: it has `count` values of a known type, and the file has its bytes
  /// (so it is safe to make room for them).
  VtkArray array(const std::string& name, std::uint64_t count) const;

  /// Calls use(first, values) for all pieces of the array, in parallel and in any order: `first` is
  /// the number of the first value, `values` a span of the stored type. Memory is that of one piece
  /// a thread.
  template <typename Use>
  void read(const VtkArray& array, const Use& use) const {
    parallel_chunks(array.pieces.size(), 1, [&](std::size_t begin, std::size_t end) {
      std::vector<char> bytes;
      for (std::size_t p = begin; p < end; ++p) {
        read_piece(array.pieces[p], bytes);
        const std::uint64_t first = array.pieces[p].first;
        switch (array.type) {
          case VtkType::kFloat64:
            use(first, values_of<double>(bytes));
            break;
          case VtkType::kFloat32:
            use(first, values_of<float>(bytes));
            break;
          case VtkType::kInt64:
            use(first, values_of<std::int64_t>(bytes));
            break;
          case VtkType::kInt32:
            use(first, values_of<std::int32_t>(bytes));
            break;
          case VtkType::kUInt32:
            use(first, values_of<std::uint32_t>(bytes));
            break;
          case VtkType::kUInt8:
            use(first, values_of<std::uint8_t>(bytes));
            break;
        }
      }
    });
  }

  /// Throws unless the closing tag is there: what is cut may have all arrays that are read.
  void require_end() const;
  [[noreturn]] void fail(const std::string& what) const;

 private:
  struct Tag {
    std::string type;
    std::uint64_t offset;
  };

  template <typename Value>
  static std::span<const Value> values_of(const std::vector<char>& bytes) {
    return {reinterpret_cast<const Value*>(bytes.data()), bytes.size() / sizeof(Value)};
  }

  void read_head(const std::string& type, const std::string& cell_count);
  void read_appended_tag(const std::string& head, std::size_t appended);
  void read_tags(const std::string& head, const std::string& cell_count);
  void read_field_tags(const std::string& head, std::size_t piece);
  std::string field_bytes(const std::string& name, const std::string& type) const;
  std::uint64_t number(const std::string& text, const std::string& what) const;
  void read_bytes(std::uint64_t offset, std::span<char> bytes) const;
  std::vector<std::uint64_t> read_words(std::uint64_t offset, std::uint64_t count) const;
  void add_plain_pieces(std::uint64_t at, std::uint64_t bytes, std::uint64_t width,
                        VtkArray& array) const;
  void add_blocks(std::uint64_t at, std::uint64_t bytes, std::uint64_t width,
                  VtkArray& array) const;
  void read_piece(const VtkPiece& piece, std::vector<char>& bytes) const;

  std::filesystem::path path_;
  PositionedFile file_;
  std::uint64_t size_ = 0;
  std::uint64_t data_ = 0;  // byte after the underscore
  std::uint64_t word_ = 8;  // bytes of a number in the arrays' headers
  bool compressed_ = false;
  std::uint64_t points_ = 0;
  std::uint64_t cells_ = 0;
  std::map<std::string, Tag> arrays_;
  std::map<std::string, Tag> fields_;
  std::string origin_;
};

}  // namespace tetropolis
