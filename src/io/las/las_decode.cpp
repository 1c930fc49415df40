#include "las_decode.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <istream>
#include <limits>
#include <memory>
#include <optional>
#include <streambuf>
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

/// A LAZ file as a stream for LASzip, which knows how far was read. If its table of chunks is
/// missing, the place of the table is that which LASzip's writer puts there until it has written
/// one: LASzip then does not look for it.
class FileBuffer : public std::streambuf {
 public:
  FileBuffer(const fs::path& path, const LasLayout& layout)
      : file_(path), layout_(layout), bytes_(std::size_t{1} << 16) {}

  /// Of the next byte, in the file.
  std::int64_t position() const { return begin_ + (gptr() - eback()); }

 protected:
  int_type underflow() override {
    const std::int64_t at = position();
    const std::size_t got = file_.read(at, bytes_.data(), bytes_.size());
    if (got == 0) return traits_type::eof();
    begin_ = at;
    if (layout_.chunk_table_missing) hide_table_place(got);
    setg(bytes_.data(), bytes_.data(), bytes_.data() + got);
    return traits_type::to_int_type(*gptr());
  }
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const std::int64_t base = from == std::ios_base::beg   ? 0
                              : from == std::ios_base::cur ? position()
                                                           : file_.size();
    return move_to(base + offset);
  }
  pos_type seekpos(pos_type to, std::ios_base::openmode) override { return move_to(to); }

 private:
  /// In the first `size` bytes of the buffer.
  void hide_table_place(std::size_t size) {
    const std::int64_t place = layout_.first_point;
    std::array<char, sizeof place> mark;
    std::memcpy(mark.data(), &place, sizeof place);
    for (std::size_t i = 0; i < mark.size(); ++i) {
      const std::int64_t at = place + static_cast<std::int64_t>(i) - begin_;
      if (at >= 0 && at < static_cast<std::int64_t>(size))
        bytes_[static_cast<std::size_t>(at)] = mark[i];
    }
  }
  pos_type move_to(std::int64_t to) {
    if (to < 0) return pos_type(off_type(-1));
    if (to >= begin_ && to <= begin_ + (egptr() - eback())) {
      setg(eback(), eback() + (to - begin_), egptr());
    } else {
      begin_ = to;
      setg(nullptr, nullptr, nullptr);
    }
    return pos_type(to);
  }

  PositionedFile file_;
  const LasLayout& layout_;
  std::vector<char> bytes_;
  std::int64_t begin_ = 0;  ///< Where in the file the buffer's first byte lies.
};

/// Owns a LASzip reader.
class LazReader {
 public:
  /// With `tells_position` LASzip reads through a stream. It takes single bytes, for which its own
  /// stdio needs no more time, and a tenth less in a program of one thread, where nothing is
  /// locked.
  LazReader(const fs::path& path, const LasLayout& layout, bool tells_position)
      : path_(path), layout_(layout) {
    if (laszip_create(&reader_) != 0) fail_input(path, "the LASzip library cannot be used");
    // Of the layered formats only these layers are unpacked; the others have no layers.
    laszip_decompress_selective(reader_, laszip_DECOMPRESS_SELECTIVE_CHANNEL_RETURNS_XY |
                                             laszip_DECOMPRESS_SELECTIVE_Z |
                                             laszip_DECOMPRESS_SELECTIVE_CLASSIFICATION |
                                             laszip_DECOMPRESS_SELECTIVE_FLAGS);
    if (tells_position || layout.chunk_table_missing) stream_.emplace(path, layout);
    laszip_BOOL compressed = 0;
    const bool opened = (stream_ ? laszip_open_reader_stream(reader_, stream_->stream, &compressed)
                                 : laszip_open_reader(reader_, path.c_str(), &compressed)) == 0;
    if (!opened || laszip_get_point_pointer(reader_, &point_) != 0) {
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

  /// Byte of the file up to which was read. Precondition: made to tell it.
  std::int64_t position() const { return stream_->buffer.position(); }

 private:
  struct Stream {
    Stream(const fs::path& path, const LasLayout& layout) : buffer(path, layout), stream(&buffer) {
      // A stream that has failed gives LASzip garbage for bytes, unless it throws.
      stream.exceptions(std::ios::failbit | std::ios::badbit);
    }
    FileBuffer buffer;
    std::istream stream;
  };

  std::string error() const {
    laszip_CHAR* text = nullptr;
    if (laszip_get_error(reader_, &text) != 0 || text == nullptr) return "unknown reason";
    std::string line = text;
    for (char& c : line)
      if (c < ' ' || c > '~') c = ' ';
    return line;
  }

  [[noreturn]] void fail_at(std::int64_t number) const {
    const std::int64_t total = layout_.info.point_count;
    if (layout_.chunk_table_missing)
      fail_input(path_, fmt::format("ends at point {} of {}: the file is cut; get it again", number,
                                    total));
    // LASzip says of every exception, also of one for want of memory, that it is an internal error.
    const std::string reason = error();
    const bool unclear = reason.find("internal error") != std::string::npos;
    fail_input(
        path_,
        fmt::format("cannot be decompressed at point {} of {} (LASzip: {}): {}; get it again",
                    number, total, reason,
                    unclear ? "the file is broken, or memory ran out" : "the file is broken"));
  }

  const fs::path& path_;
  const LasLayout& layout_;
  std::optional<Stream> stream_;
  laszip_POINTER reader_ = nullptr;
  laszip_point_struct* point_ = nullptr;
};

std::int64_t decode_laz(const fs::path& path, const LasLayout& layout, std::int64_t first,
                        std::int64_t count, const LasVisitor& visit) {
  // LASzip recurses without an end on some broken files, and Debian's stops at failed assertions.
  const ForeignCode laszip(path.c_str());
  const bool ends = first + count == layout.info.point_count && layout.chunk_table != 0;
  LazReader reader(path, layout, ends);
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
  if (first + count == layout.info.point_count && !layout.table_cut.empty())
    fail_input(path, layout.table_cut);
  if (!ends) return 0;
  // All writers known end the last chunk where its last point does, to the byte.
  const std::int64_t left = layout.chunk_table - reader.position();
  if (left < 0)
    fail_input(path, fmt::format("the header counts {} points, but fewer are there: the last bytes "
                                 "read are not theirs; get it again",
                                 layout.info.point_count));
  return left;
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

std::int64_t decode_points(const fs::path& path, const LasLayout& layout, std::int64_t first,
                           std::int64_t count, const LasVisitor& visit) {
  if (count <= 0) return 0;
  if (layout.info.compressed) return decode_laz(path, layout, first, count, visit);
  decode_plain(path, layout, first, count, visit);
  return 0;
}

std::int64_t check_layers(const fs::path& path, const LasLayout& layout) {
  const std::int64_t points = layout.info.point_count;
  if (layout.layers == 0 || points == 0) return -1;
  const auto require = [&](bool holds, const LazChunk& chunk, const char* what) {
    if (!holds)
      fail_input(path, fmt::format("the chunk of points from {} on, at byte {}, {}: the file is "
                                   "broken; get it again",
                                   chunk.first_point, chunk.at, what));
  };
  const bool has_table = layout.chunk_table != 0;
  const PositionedFile file(path);
  // A chunk is its first point as it is, the number of its points, the size of each layer, and the
  // layers.
  std::vector<std::uint32_t> numbers(1 + static_cast<std::size_t>(layout.layers));
  const std::size_t length = numbers.size() * sizeof numbers[0];
  std::vector<LazChunk> chunks;
  for (LazChunk next{0, layout.first_point + 8}; next.first_point < points;) {
    if (has_table && next.at >= layout.chunk_table)
      fail_input(path,
                 fmt::format("the header counts {} points, but only {} are there; get it again",
                             points, next.first_point));
    if (file.read(next.at + layout.info.record_length, numbers.data(), length) < length &&
        !has_table)
      return -1;
    std::int64_t bytes = 0;
    for (std::size_t layer = 1; layer < numbers.size(); ++layer) bytes += numbers[layer];
    const std::int64_t end =
        next.at + layout.info.record_length + static_cast<std::int64_t>(length) + bytes;
    // Where the table is missing so may be the end of the last chunk.
    require(has_table ? end <= layout.chunk_table
                      : bytes <= std::int64_t{std::numeric_limits<std::uint32_t>::max()},
            next, "states layers that do not fit into the file");
    const std::int64_t count = layout.chunk_size > 0 ? layout.chunk_size : numbers[0];
    require(count > 0, next, "states that it has no points");
    chunks.push_back(next);
    next = {next.first_point + count, end};
  }
  if (!has_table || (layout.chunk_size == 0 && !layout.variable_chunks)) return -1;
  for (std::size_t k = 1; k < chunks.size(); ++k)  // LASzip finds the first without the table
    require(k < layout.chunks.size() && layout.chunks[k].at == chunks[k].at &&
                layout.chunks[k].first_point == chunks[k].first_point,
            chunks[k], "is elsewhere by the table of chunks");
  const std::int64_t in_last = numbers[0];
  return in_last >= 1 && in_last <= layout.chunk_size ? in_last : -1;
}

void check_las_length(const fs::path& path, const LasLayout& layout) {
  if (layout.info.compressed) return;
  const std::int64_t fit = (layout.points_end - layout.first_point) / layout.info.record_length;
  if (layout.info.point_count > fit)
    fail_input(path, fmt::format("ends at point {} of {}: the file is cut; get it again", fit,
                                 layout.info.point_count));
}

}  // namespace tetropolis
