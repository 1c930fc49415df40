#include "las_decode.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <laszip/laszip_api.h>

#include "core/foreign_code.h"
#include "io/file/input_file.h"
#include "io/file/positioned_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kBlock = LasBlockBuffer::kMost;

/// The least and the greatest.
NumberRange range_of(std::span<const std::int32_t> numbers) {
  NumberRange range;
  for (const std::int32_t number : numbers) {
    range.first = std::min(range.first, number);
    range.last = std::max(range.last, number);
  }
  return range;
}

/// Record i as it lies in an uncompressed file.
void parse_record(const unsigned char* bytes, bool extended, std::size_t i,
                  LasBlockBuffer& numbers) {
  std::memcpy(&numbers.x[i], bytes, 4);
  std::memcpy(&numbers.y[i], bytes + 4, 4);
  std::memcpy(&numbers.z[i], bytes + 8, 4);
  numbers.withheld[i] = (bytes[15] & (extended ? 0x04 : 0x80)) != 0 ? 1 : 0;
  numbers.classification[i] = extended ? bytes[16] : bytes[15] & 0x1F;
}

void decode_plain(const fs::path& path, const LasLayout& layout, std::int64_t first,
                  std::int64_t count, const LasVisitor& visit) {
  const PositionedFile file(path);
  const auto length = static_cast<std::size_t>(layout.info.record_length);
  const bool extended = layout.info.point_format >= 6;
  std::vector<unsigned char> bytes(std::min(kBlock, static_cast<std::size_t>(count)) * length);
  const auto numbers = std::make_unique_for_overwrite<LasBlockBuffer>();
  for (std::int64_t done = 0; done < count;) {
    const auto n = static_cast<std::size_t>(
        std::min<std::int64_t>(static_cast<std::int64_t>(kBlock), count - done));
    const std::int64_t at = layout.first_point + (first + done) * static_cast<std::int64_t>(length);
    const std::size_t got = file.read(at, bytes.data(), n * length) / length;
    if (got < n)
      fail_input(path, fmt::format("ends at point {} of {}: the file is cut; get it again",
                                   first + done + static_cast<std::int64_t>(got),
                                   layout.info.point_count));
    for (std::size_t i = 0; i < n; ++i)
      parse_record(bytes.data() + i * length, extended, i, *numbers);
    visit(numbers->first(n));
    done += static_cast<std::int64_t>(n);
  }
}

/// Owns a LASzip reader.
class LazReader {
 public:
  LazReader(const fs::path& path, const LasLayout& layout) : path_(path), layout_(layout) {
    if (laszip_create(&reader_) != 0) fail_input(path, "the LASzip library cannot be used");
    // Of the layered formats only these layers are unpacked; the others have no layers.
    laszip_decompress_selective(reader_, laszip_DECOMPRESS_SELECTIVE_CHANNEL_RETURNS_XY |
                                             laszip_DECOMPRESS_SELECTIVE_Z |
                                             laszip_DECOMPRESS_SELECTIVE_CLASSIFICATION |
                                             laszip_DECOMPRESS_SELECTIVE_FLAGS);
    laszip_BOOL compressed = 0;
    if (laszip_open_reader(reader_, path.c_str(), &compressed) != 0 ||
        laszip_get_point_pointer(reader_, &point_) != 0) {
      const std::string reason = error();
      laszip_destroy(reader_);
      fail_input(path,
                 "cannot be opened by LASzip: " + reason + "; get it again or convert it to LAS");
    }
  }
  ~LazReader() {
    laszip_close_reader(reader_);
    laszip_destroy(reader_);
  }
  LazReader(const LazReader&) = delete;
  LazReader& operator=(const LazReader&) = delete;

  void seek(std::int64_t point) {
    if (point != 0 && laszip_seek_point(reader_, point) != 0) fail_at(point);
  }

  /// The next point, to place i.
  void read(std::int64_t number, bool extended, std::size_t i, LasBlockBuffer& numbers) {
    if (laszip_read_point(reader_) != 0) fail_at(number);
    numbers.x[i] = point_->X;
    numbers.y[i] = point_->Y;
    numbers.z[i] = point_->Z;
    numbers.classification[i] = extended ? point_->extended_classification : point_->classification;
    numbers.withheld[i] =
        extended ? point_->extended_classification_flags >> 2 & 1 : point_->withheld_flag;
  }

 private:
  std::string error() const {
    laszip_CHAR* text = nullptr;
    if (laszip_get_error(reader_, &text) != 0 || text == nullptr) return "unknown reason";
    std::string line = text;
    for (char& c : line)
      if (c < ' ' || c > '~') c = ' ';
    return line;
  }

  [[noreturn]] void fail_at(std::int64_t number) const {
    // LASzip says of every exception, also of one for want of memory, that it is an internal error.
    const std::string reason = error();
    const bool unclear = reason.find("internal error") != std::string::npos;
    fail_input(
        path_,
        fmt::format("cannot be decompressed at point {} of {} (LASzip: {}): {}; get it again",
                    number, layout_.info.point_count, reason,
                    unclear ? "the file is broken, or memory ran out" : "the file is broken"));
  }

  const fs::path& path_;
  const LasLayout& layout_;
  laszip_POINTER reader_ = nullptr;
  laszip_point_struct* point_ = nullptr;
};

void decode_laz(const fs::path& path, const LasLayout& layout, std::int64_t first,
                std::int64_t count, const LasVisitor& visit) {
  // LASzip recurses without an end on some broken files, and Debian's stops at failed assertions.
  const ForeignCode laszip(path.c_str());
  LazReader reader(path, layout);
  reader.seek(first);
  const bool extended = layout.info.point_format >= 6;
  const auto numbers = std::make_unique_for_overwrite<LasBlockBuffer>();
  for (std::int64_t done = 0; done < count;) {
    const auto n = static_cast<std::size_t>(
        std::min<std::int64_t>(static_cast<std::int64_t>(kBlock), count - done));
    for (std::size_t i = 0; i < n; ++i)
      reader.read(first + done + static_cast<std::int64_t>(i), extended, i, *numbers);
    visit(numbers->first(n));
    done += static_cast<std::int64_t>(n);
  }
}

}  // namespace

LasBlock LasBlockBuffer::first(std::size_t n) const {
  LasBlock block;
  block.x = std::span(x).first(n);
  block.y = std::span(y).first(n);
  block.z = std::span(z).first(n);
  block.classification = std::span(classification).first(n);
  block.withheld = std::span(withheld).first(n);
  block.x_range = range_of(block.x);
  block.y_range = range_of(block.y);
  block.z_range = range_of(block.z);
  return block;
}

void decode_points(const fs::path& path, const LasLayout& layout, std::int64_t first,
                   std::int64_t count, const LasVisitor& visit) {
  if (count <= 0) return;
  if (layout.info.compressed)
    decode_laz(path, layout, first, count, visit);
  else
    decode_plain(path, layout, first, count, visit);
}

void check_las_length(const fs::path& path, const LasLayout& layout) {
  if (layout.info.compressed) return;
  const std::int64_t fit = (layout.points_end - layout.first_point) / layout.info.record_length;
  if (layout.info.point_count > fit)
    fail_input(path, fmt::format("ends at point {} of {}: the file is cut; get it again", fit,
                                 layout.info.point_count));
}

}  // namespace tetropolis
