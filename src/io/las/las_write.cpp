#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <ostream>
#include <streambuf>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <laszip/laszip_api.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/las/las.h"

#include "core/text.h"
#include "io/crs/gdal_support.h"
#include "io/file/atomic_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// Coordinates as they are stored, and what the header says of them.
struct Quantised {
  std::array<std::vector<std::int32_t>, 3> values;
  std::array<double, 3> offset{};
  std::array<double, 3> min{};
  std::array<double, 3> max{};
};

void quantise_axis(const fs::path& path, std::span<const PointCoordinate> local, double shift,
                   double scale, std::size_t axis, Quantised& result) {
  if (local.empty()) return;
  const auto [low, high] = std::minmax_element(local.begin(), local.end());
  // A round number near the middle leaves most room for fine scales.
  const double middle = shift + *low / 2 + *high / 2;
  const double offset = std::round(middle / 1000) * 1000;
  const double largest =
      std::max(std::abs(shift + *low - offset), std::abs(shift + *high - offset));
  if (!(largest / scale < 2147483647.0))
    throw Error(ErrorKind::kUsage,
                fmt::format("{}: a scale of {} is too fine for {} = {} .. {}; choose a coarser one",
                            path.string(), scale, "xyz"[axis], shift + *low, shift + *high));
  std::vector<std::int32_t>& values = result.values[axis];
  values.resize(local.size());
  for (std::size_t i = 0; i < local.size(); ++i)
    values[i] = static_cast<std::int32_t>(std::llround((shift + local[i] - offset) / scale));
  const auto [first, last] = std::minmax_element(values.begin(), values.end());
  result.offset[axis] = offset;
  result.min[axis] = *first * scale + offset;
  result.max[axis] = *last * scale + offset;
}

int epsg_number(const std::string& crs) {
  constexpr std::string_view kPrefix = "EPSG:";
  int code = 0;
  if (crs.compare(0, kPrefix.size(), kPrefix) != 0) return 0;
  std::from_chars(crs.data() + kPrefix.size(), crs.data() + crs.size(), code);
  return code;
}

/// LASzip does not free its encoders when a stream has failed, so this one never does: what does
/// not arrive is gone, and the file knows.
class LenientBuffer final : public std::streambuf {
 public:
  explicit LenientBuffer(std::streambuf& file) : file_(file) {}

 protected:
  int_type overflow(int_type c) override {
    if (!traits_type::eq_int_type(c, traits_type::eof())) file_.sputc(traits_type::to_char_type(c));
    return traits_type::not_eof(c);
  }
  std::streamsize xsputn(const char* bytes, std::streamsize size) override {
    file_.sputn(bytes, size);
    return size;
  }
  int sync() override {
    file_.pubsync();
    return 0;
  }
  pos_type seekoff(off_type offset, std::ios::seekdir from, std::ios::openmode which) override {
    return somewhere(file_.pubseekoff(offset, from, which));
  }
  pos_type seekpos(pos_type position, std::ios::openmode which) override {
    return somewhere(file_.pubseekpos(position, which));
  }

 private:
  static pos_type somewhere(pos_type position) {
    return position == pos_type(off_type(-1)) ? pos_type(0) : position;
  }

  std::streambuf& file_;
};

/// Owns a LASzip writer.
class LazWriter {
 public:
  LazWriter(const fs::path& target, AtomicFile& file)
      : target_(target), file_(file), buffer_(*file.stream().rdbuf()), stream_(&buffer_) {
    if (laszip_create(&writer_) != 0)
      throw_cannot_write(target, "the LASzip library cannot be used");
  }
  ~LazWriter() {
    if (is_open_) laszip_close_writer(writer_);
    laszip_destroy(writer_);
  }
  LazWriter(const LazWriter&) = delete;
  LazWriter& operator=(const LazWriter&) = delete;

  laszip_POINTER get() const { return writer_; }

  void open(bool compressed) {
    check(laszip_open_writer_stream(writer_, stream_, compressed, 0));
    is_open_ = true;
  }
  void close() {
    is_open_ = false;
    check(laszip_close_writer(writer_));
  }

  void require_written() const { file_.require_written(); }

  void check(laszip_I32 status) const {
    if (status == 0) return;
    laszip_CHAR* text = nullptr;
    laszip_get_error(writer_, &text);
    throw_cannot_write(target_, text == nullptr ? "unknown reason" : text);
  }

 private:
  const fs::path& target_;
  const AtomicFile& file_;
  LenientBuffer buffer_;
  std::ostream stream_;
  laszip_POINTER writer_ = nullptr;
  bool is_open_ = false;
};

void fill_header(laszip_header_struct& header, const Quantised& points, std::size_t count,
                 const WritePointsOptions& options) {
  const bool extended = options.point_format == 6;
  header.version_major = 1;
  header.version_minor = extended ? 4 : 2;
  header.header_size = extended ? 375 : 227;
  header.offset_to_point_data = header.header_size;
  header.point_data_format = static_cast<laszip_U8>(options.point_format);
  header.point_data_record_length = extended ? 30 : 28;
  // The same bytes every time: no date, no version of ours in the file.
  std::strncpy(header.system_identifier, "OTHER", sizeof header.system_identifier);
  std::strncpy(header.generating_software, "Tetropolis", sizeof header.generating_software);
  header.file_creation_day = 1;
  header.file_creation_year = 2000;
  if (extended) {
    header.extended_number_of_point_records = count;
    header.extended_number_of_points_by_return[0] = count;
  } else {
    header.number_of_point_records = static_cast<laszip_U32>(count);
    header.number_of_points_by_return[0] = static_cast<laszip_U32>(count);
  }
  header.x_scale_factor = header.y_scale_factor = header.z_scale_factor = options.scale;
  std::tie(header.x_offset, header.y_offset, header.z_offset) = std::tuple_cat(points.offset);
  std::tie(header.min_x, header.min_y, header.min_z) = std::tuple_cat(points.min);
  std::tie(header.max_x, header.max_y, header.max_z) = std::tuple_cat(points.max);
}

/// LAS 1.4 R15, section 2.6; key numbers from OGC GeoTIFF 1.1, table 7.
void add_crs(const LazWriter& writer, laszip_header_struct& header, const std::string& crs) {
  const int code = epsg_number(crs);
  if (code > 0 && code <= std::numeric_limits<std::uint16_t>::max()) {
    const bool degrees = is_geographic(crs);
    const laszip_geokey_struct keys[] = {
        {1024, 0, 1, static_cast<laszip_U16>(degrees ? 2 : 1)},
        {static_cast<laszip_U16>(degrees ? 2048 : 3072), 0, 1, static_cast<laszip_U16>(code)}};
    writer.check(laszip_set_geokeys(writer.get(), 2, keys));
  }
  if (crs.empty() || header.version_minor < 4) return;
  const gdal::QuietErrors errors;
  char* text = nullptr;
  // The specification means the WKT of OGC 2001.
  const bool is_written = OSRExportToWkt(gdal::parse_srs(crs).get(), &text) == OGRERR_NONE;
  const std::unique_ptr<char, void (*)(void*)> wkt(text, VSIFree);
  if (!is_written || !wkt || std::strlen(text) >= std::numeric_limits<std::uint16_t>::max()) return;
  const auto length = static_cast<laszip_U16>(std::strlen(text) + 1);
  writer.check(laszip_add_vlr(writer.get(), "LASF_Projection", 2112, length, "OGC WKT",
                              reinterpret_cast<const laszip_U8*>(text)));
  header.global_encoding |= 0x10;
}

void write_records(const LazWriter& writer, const Quantised& points,
                   std::span<const std::uint8_t> classes, std::span<const std::uint8_t> flags,
                   bool extended) {
  laszip_point_struct* point = nullptr;
  writer.check(laszip_get_point_pointer(writer.get(), &point));
  point->return_number = 1;
  point->number_of_returns = 1;
  point->extended_point_type = extended ? 1 : 0;
  point->extended_return_number = 1;
  point->extended_number_of_returns = 1;
  constexpr std::size_t kFew = 4096;  // points after which a disk that is full is noticed
  for (std::size_t i = 0; i < classes.size(); ++i) {
    if (i % kFew == 0) writer.require_written();
    point->X = points.values[0][i];
    point->Y = points.values[1][i];
    point->Z = points.values[2][i];
    point->classification = classes[i] < 32 ? classes[i] & 0x1F : 0;
    point->extended_classification = classes[i];
    if (!flags.empty()) {
      point->synthetic_flag = (flags[i] & kSyntheticPoint) != 0 ? 1 : 0;
      point->keypoint_flag = (flags[i] & kKeyPoint) != 0 ? 1 : 0;
      point->withheld_flag = (flags[i] & kWithheldPoint) != 0 ? 1 : 0;
      point->extended_classification_flags = flags[i] & 0x0F;
    }
    writer.check(laszip_write_point(writer.get()));
  }
}

void check_request(const fs::path& path, const PointCloud& cloud,
                   const WritePointsOptions& options) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorKind::kUsage, path.string() + ": " + what);
  };
  if (options.point_format != 1 && options.point_format != 6)
    refuse(fmt::format("cannot write point format {}; choose 1 or 6", options.point_format));
  if (!(options.scale > 0) || !std::isfinite(options.scale))
    refuse(fmt::format("cannot use scale {}; choose a positive one", options.scale));
  if (options.point_format == 1) {
    for (const std::uint8_t code : cloud.classification)
      if (code > 31) refuse(fmt::format("class {} does not fit point format 1; choose 6", code));
    if (cloud.size() > std::numeric_limits<std::uint32_t>::max())
      refuse("too many points for LAS 1.2; choose point format 6");
  }
}

bool wants_compression(const fs::path& path) {
  return lower_case(path.extension().string()) == ".laz";
}

}  // namespace

void write_points(const fs::path& path, const PointCloud& cloud, Point2 origin,
                  const WritePointsOptions& options) {
  for (const std::size_t size : {cloud.y.size(), cloud.z.size(), cloud.classification.size(),
                                 options.flags.empty() ? cloud.size() : options.flags.size()})
    if (size != cloud.size())
      throw Error(ErrorKind::kUsage,
                  fmt::format("{}: arrays of {} and {} values for points; give one of each",
                              path.string(), cloud.size(), size));
  check_request(path, cloud, options);
  const std::string crs = normalise_crs(options.crs);
  Quantised points;
  quantise_axis(path, cloud.x, origin.x, options.scale, 0, points);
  quantise_axis(path, cloud.y, origin.y, options.scale, 1, points);
  quantise_axis(path, cloud.z, 0, options.scale, 2, points);
  AtomicFile file(path);
  {
    LazWriter writer(path, file);
    laszip_header_struct* header = nullptr;
    writer.check(laszip_get_header_pointer(writer.get(), &header));
    fill_header(*header, points, cloud.size(), options);
    add_crs(writer, *header, crs);
    writer.check(laszip_preserve_generating_software(writer.get(), 1));
    writer.check(laszip_request_native_extension(writer.get(), 1));
    writer.open(wants_compression(path));
    write_records(writer, points, cloud.classification, options.flags, options.point_format == 6);
    writer.close();
  }
  file.commit();
}

}  // namespace tetropolis
