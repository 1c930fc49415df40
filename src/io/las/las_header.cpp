#include "las_header.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "core/foreign_code.h"
#include "core/parallel.h"
#include "io/file/input_file.h"
#include "io/file/positioned_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "LAS is read as it lies in memory");

namespace {

constexpr std::array<int, 11> kRecordLengths = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
/// Beyond these a header is broken: nothing on Earth is so far from the origin of its coordinates.
constexpr double kLargestScale = 1e3;
/// With a smaller scale all numbers of 32 bits lie within half a unit.
constexpr double kLeastScale = 1e-10;
constexpr double kLargestOffset = 1e9;
constexpr double kLargestElevation = 1e6;
constexpr std::size_t kVlrHeader = 54;
constexpr std::int64_t kEvlrHeader = 60;

/// The number stored at byte `at`. Precondition: it lies inside.
template <typename Number>
Number number_at(std::string_view bytes, std::size_t at) {
  Number value;
  std::memcpy(&value, bytes.data() + at, sizeof(Number));
  return value;
}

/// Text of a fixed field, up to its first zero, without bytes that would upset a terminal.
std::string text_at(std::string_view bytes, std::size_t at, std::size_t size) {
  std::string text(bytes.substr(at, size));
  text.resize(std::min(text.size(), text.find('\0')));
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

std::string read_front(const fs::path& path, const PositionedFile& file) {
  std::string bytes = file.head(375);
  if (bytes.empty()) fail_input(path, "the file is empty; get it again");
  if (bytes.starts_with("PK\3\4"))
    fail_input(path, "is a ZIP archive; unpack it and name its .las or .laz files");
  if (bytes.substr(0, 4) != "LASF")
    fail_input(path, "is not a LAS or LAZ file (it does not start with LASF); name a point cloud");
  if (bytes.size() < 227)
    fail_input(path, fmt::format("ends at byte {} within its header; the file is cut, get it again",
                                 bytes.size()));
  return bytes;
}

void parse_fixed(const fs::path& path, std::string_view h, LasLayout& layout) {
  LasInfo& info = layout.info;
  info.version_major = number_at<std::uint8_t>(h, 24);
  info.version_minor = number_at<std::uint8_t>(h, 25);
  if (info.version_major != 1 || info.version_minor > 5)
    fail_input(path, fmt::format("byte 24 says LAS {}.{}; only 1.0 to 1.5 exist",
                                 info.version_major, info.version_minor));
  const int header_size = number_at<std::uint16_t>(h, 94);
  const int smallest = info.version_minor >= 4 ? 375 : info.version_minor == 3 ? 235 : 227;
  if (header_size < smallest)
    fail_input(path,
               fmt::format("byte 94 gives a header of {} bytes, but LAS 1.{} needs {}; the file is "
                           "broken, get it again",
                           header_size, info.version_minor, smallest));
  if (h.size() < static_cast<std::size_t>(smallest))
    fail_input(path, fmt::format("ends at byte {} within its header; the file is cut, get it again",
                                 h.size()));
  layout.first_point = number_at<std::uint32_t>(h, 96);
  if (layout.first_point < header_size)
    fail_input(path,
               fmt::format("byte 96 says that points start at byte {}, inside the header of {} "
                           "bytes; the file is broken, get it again",
                           layout.first_point, header_size));
  if (layout.first_point > layout.file_size)
    fail_input(path, fmt::format("ends at byte {}, before its points start at byte {}; the file is "
                                 "cut, get it again",
                                 layout.file_size, layout.first_point));
  const int format = number_at<std::uint8_t>(h, 104);
  info.compressed = (format & 0x80) != 0;
  info.point_format = format & 0x3F;
  if (info.point_format > 10 || (format & 0x40) != 0)
    fail_input(path, fmt::format("byte 104 gives point format {}; only 0 to 10 are known", format));
  info.record_length = number_at<std::uint16_t>(h, 105);
  const int needed = kRecordLengths[static_cast<std::size_t>(info.point_format)];
  if (info.record_length < needed)
    fail_input(path,
               fmt::format("byte 105 gives records of {} bytes, but point format {} needs {}; "
                           "the file is broken, get it again",
                           info.record_length, info.point_format, needed));
}

void parse_numbers(const fs::path& path, std::string_view h, LasInfo& info) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    info.scale[axis] = number_at<double>(h, 131 + 8 * axis);
    info.offset[axis] = number_at<double>(h, 155 + 8 * axis);
    info.max[axis] = number_at<double>(h, 179 + 16 * axis);
    info.min[axis] = number_at<double>(h, 187 + 16 * axis);
    // Written so that NaN fails as well.
    if (!(info.scale[axis] >= kLeastScale && info.scale[axis] <= kLargestScale &&
          std::abs(info.offset[axis]) <= (axis < 2 ? kLargestOffset : kLargestElevation)))
      fail_input(
          path, fmt::format(
                    "byte {} gives scale {} and offset {} for {}; the file is broken, get it again",
                    131 + 8 * axis, info.scale[axis], info.offset[axis], "xyz"[axis]));
  }
  const auto legacy = number_at<std::uint32_t>(h, 107);
  const std::uint64_t extended = info.version_minor >= 4 ? number_at<std::uint64_t>(h, 247) : 0;
  const std::uint64_t count = extended != 0 ? extended : legacy;
  if (count > (std::uint64_t{1} << 62))
    fail_input(path,
               fmt::format("byte 247 gives {} points; the file is broken, get it again", count));
  info.point_count = static_cast<std::int64_t>(count);
}

/// The records between header and points. Stops with a warning where they make no sense.
std::vector<Vlr> read_vlrs(const fs::path& path, const PositionedFile& file, std::string_view h,
                           LasLayout& layout) {
  const auto claimed = number_at<std::uint32_t>(h, 100);
  const std::size_t header_size = number_at<std::uint16_t>(h, 94);
  const auto end = static_cast<std::size_t>(layout.first_point);
  std::vector<Vlr> vlrs;
  std::size_t at = header_size;
  std::string head(kVlrHeader, '\0');
  for (std::uint32_t i = 0; i < claimed; ++i) {
    if (end - at < kVlrHeader ||
        file.read(static_cast<std::int64_t>(at), head.data(), head.size()) < head.size())
      break;
    const std::size_t length = number_at<std::uint16_t>(head, 20);
    if (end - at - kVlrHeader < length) break;
    Vlr vlr{text_at(head, 2, 16), number_at<std::uint16_t>(head, 18), std::string(length, '\0')};
    at += kVlrHeader;
    if (file.read(static_cast<std::int64_t>(at), vlr.data.data(), length) < length) break;
    at += length;
    vlrs.push_back(std::move(vlr));
  }
  if (vlrs.size() < claimed) {
    const std::string what = fmt::format(
        "byte 100 gives {} variable length records, but only {} fit before the points at byte {}",
        claimed, vlrs.size(), end);
    if (layout.info.compressed) fail_input(path, what + "; the file is broken, get it again");
    layout.info.warnings.push_back({"las_vlrs_broken", 1, path.string() + ": " + what});
  }
  return vlrs;
}

/// The records behind the points, as the header has them.
struct EvlrPlace {
  std::uint64_t start = 0;
  std::uint32_t count = 0;
};

EvlrPlace evlr_place(std::string_view h, const LasLayout& layout) {
  if (layout.info.version_minor < 4) return {};
  return {number_at<std::uint64_t>(h, 235), number_at<std::uint32_t>(h, 243)};
}

/// Whether a record behind the points is there: its name is text, which some writers end with a
/// zero and whatever was in memory, and it fits into the file.
bool read_evlr_head(const PositionedFile& file, std::int64_t at, std::string& head) {
  head.resize(static_cast<std::size_t>(kEvlrHeader));
  if (file.read(at, head.data(), head.size()) < head.size()) return false;
  const std::string_view field = std::string_view(head).substr(2, 16);
  const std::string_view name = field.substr(0, field.find('\0'));
  const bool is_text =
      std::all_of(name.begin(), name.end(), [](char c) { return c >= ' ' && c <= '~'; });
  const bool is_blank = name.empty() && field.find_first_not_of('\0') == field.npos;
  return is_text && (is_blank || !name.empty()) &&
         number_at<std::uint64_t>(head, 20) <=
             static_cast<std::uint64_t>(file.size() - at - kEvlrHeader);
}

/// The records behind the points, as far as they may tell the reference system. Stops with a
/// warning where there is none.
void read_evlrs(const fs::path& path, const PositionedFile& file, std::string_view h,
                LasLayout& layout, std::vector<Vlr>& vlrs) {
  const EvlrPlace place = evlr_place(h, layout);
  constexpr std::uint32_t kMost = 1000;
  const std::uint32_t wanted = std::min(place.count, kMost);
  std::uint32_t found = 0;
  if (place.start <= static_cast<std::uint64_t>(layout.file_size)) {
    auto at = static_cast<std::int64_t>(place.start);
    for (std::string head; found < wanted && read_evlr_head(file, at, head); ++found) {
      const auto length = number_at<std::uint64_t>(head, 20);
      Vlr vlr{text_at(head, 2, 16), number_at<std::uint16_t>(head, 18), ""};
      constexpr std::uint64_t kLongestWkt = 1U << 20;
      if (vlr.user_id == "LASF_Projection" && length <= kLongestWkt) {
        vlr.data.resize(static_cast<std::size_t>(length));
        if (file.read(at + kEvlrHeader, vlr.data.data(), vlr.data.size()) < vlr.data.size()) break;
        vlrs.push_back(std::move(vlr));
      }
      at += kEvlrHeader + static_cast<std::int64_t>(length);
    }
  }
  if (found < wanted)
    layout.info.warnings.push_back(
        {"las_vlrs_broken", 1,
         fmt::format("{}: byte 243 gives {} extended variable length records from byte {} on, but "
                     "only {} are there, and the file ends at byte {}",
                     path.string(), place.count, place.start, found, layout.file_size)});
}

/// Uncompressed files: where the records may end, and the count if the header has none.
void settle_records(const fs::path& path, std::string_view h, LasLayout& layout) {
  LasInfo& info = layout.info;
  const EvlrPlace evlrs = evlr_place(h, layout);
  const bool ends_before = evlrs.count > 0 &&
                           evlrs.start >= static_cast<std::uint64_t>(layout.first_point) &&
                           evlrs.start < static_cast<std::uint64_t>(layout.file_size);
  layout.points_end = ends_before ? static_cast<std::int64_t>(evlrs.start) : layout.file_size;
  if (info.compressed) return;
  const std::int64_t fit = (layout.points_end - layout.first_point) / info.record_length;
  const bool has_waveforms = info.point_format == 4 || info.point_format == 5 ||
                             info.point_format == 9 || info.point_format == 10;
  if (info.point_count != 0 && fit > info.point_count && !has_waveforms)
    info.warnings.push_back(
        {"las_count_small", fit - info.point_count,
         fmt::format("{}: the header counts {} points, but {} more follow; they are not read",
                     path.string(), info.point_count, fit - info.point_count)});
  if (fit == 0 || info.point_count != 0) return;
  info.point_count = fit;
  info.warnings.push_back(
      {"las_count_missing", 1,
       fmt::format("{}: the header counts 0 points; the {} that fit into the file are read",
                   path.string(), fit)});
}

/// LAZ: finds the table of chunks. LASzip recurses until its stack ends where the table is zeroed,
/// cut off or not one (potree/PotreeConverter#692, LASzip/LASzip#81, PDAL/PDAL#4431).
void settle_chunks(const fs::path& path, const PositionedFile& file, std::uint32_t chunk_size,
                   LasLayout& layout) {
  const std::int64_t points = layout.info.point_count, first_chunk = layout.first_point + 8;
  std::int64_t table = 0, end = layout.file_size;
  std::array<std::uint32_t, 2> head{};  // Version and number of chunks.
  const bool has_place = file.read(layout.first_point, &table, sizeof table) == sizeof table;
  // Writers into pipes put the place at the file's end.
  if (table == -1) {
    end -= 8;
    file.read(end, &table, sizeof table);
  }
  if (!has_place || table < first_chunk || table > end - 8 ||
      file.read(table, head.data(), sizeof head) < sizeof head) {
    if (points == 0) return;  // laz-perf places the table of no points wrongly
    fail_input(path, fmt::format("ends at byte {} without its table of chunks; the file is cut, "
                                 "get it again",
                                 layout.file_size));
  }
  const std::int64_t chunks = head[1];
  // Writers into pipes cannot go back to the header; some writers end with an empty chunk.
  if (points == 0 && chunks > 0 && table - first_chunk >= layout.info.record_length)
    fail_input(path, fmt::format("the header counts 0 points, but {} bytes of points follow; get "
                                 "the file again or repair it",
                                 table - first_chunk));
  layout.variable_chunks = chunk_size == UINT32_MAX;
  // A chunk takes bytes; LASzip reserves memory for as many as are claimed.
  const std::int64_t least =
      layout.variable_chunks ? std::min<std::int64_t>(points, 1) : (points - 1) / chunk_size + 1;
  if (head[0] != 0 || chunks > layout.file_size - layout.first_point ||
      (points > 0 && chunks < least))
    fail_input(path, fmt::format("the table at byte {} has {} chunks for {} points; the file is "
                                 "broken, get it again",
                                 table, chunks, points));
  if (!layout.variable_chunks && points > 0) layout.chunk_size = chunk_size;
}

/// LAZ: checks what the decoder takes for granted.
void settle_compression(const fs::path& path, const PositionedFile& file,
                        const std::vector<Vlr>& vlrs, LasLayout& layout) {
  LaszipRecord record;
  int found = 0;
  for (const Vlr& vlr : vlrs) {
    if (vlr.user_id != "laszip encoded" || vlr.record_id != 22204) continue;
    ++found;
    const std::string problem = check_laszip_record(vlr.data, layout.info.record_length, record);
    if (!problem.empty()) fail_input(path, problem + "; get the file again or convert it to LAS");
  }
  if (found != 1)
    fail_input(
        path,
        fmt::format("is compressed, but has {} LASzip records; the file is broken, get it again",
                    found));
  if (layout.info.point_count > std::numeric_limits<std::uint32_t>::max())
    fail_input(path,
               fmt::format("has {} points, but LASzip reads only {}; split it",
                           layout.info.point_count, std::numeric_limits<std::uint32_t>::max()));
  if (record.compressor == 1) return;
  settle_chunks(path, file, record.chunk_size, layout);
}

}  // namespace

std::string check_laszip_record(std::string_view data, int record_length, LaszipRecord& record) {
  // LASzip record: compressor, coder, version, options, chunk size, two 64-bit numbers, number of
  // items, then type, size and version of each (Isenburg, LASzip: lossless compression of LiDAR
  // data, PE&RS 79(2), 2013, and the record's description in its distribution).
  if (data.size() < 34) return "the LASzip record is too short";
  record.compressor = number_at<std::uint16_t>(data, 0);
  const int coder = number_at<std::uint16_t>(data, 2);
  record.chunk_size = number_at<std::uint32_t>(data, 12);
  const std::size_t items = number_at<std::uint16_t>(data, 32);
  if (record.compressor < 1 || record.compressor > 3)
    return fmt::format("LASzip compressor {} is not supported", record.compressor);
  if (coder != 0) return fmt::format("LASzip coder {} is not supported", coder);
  if (record.compressor != 1 && record.chunk_size == 0)
    return "the LASzip record gives chunks of 0 points";
  if (items == 0 || data.size() < 34 + 6 * items) return "the LASzip record's items are cut";
  // The decoder would look for the next record in this one.
  if (data.size() > 34 + 6 * items)
    return fmt::format("the LASzip record has {} bytes, {} more than its items", data.size(),
                       data.size() - 34 - 6 * items);
  // Sizes by item type: BYTE (any), POINT10, GPSTIME11, RGB12, WAVEPACKET13, POINT14, RGB14,
  // RGBNIR14, WAVEPACKET14, BYTE14 (any); the numbers between are not in use.
  constexpr std::array<int, 15> kSizes = {0, -1, -1, -1, -1, -1, 20, 8, 6, 29, 30, 6, 8, 29, 0};
  // From POINT14 on they are packed in layers; the decoder mixes up the two kinds if the compressor
  // is not of theirs.
  constexpr std::size_t kFirstLayered = 10;
  int total = 0;
  for (std::size_t i = 0; i < items; ++i) {
    const std::size_t type = number_at<std::uint16_t>(data, 34 + 6 * i);
    const int size = number_at<std::uint16_t>(data, 36 + 6 * i);
    const int version = number_at<std::uint16_t>(data, 38 + 6 * i);
    if (type >= kSizes.size() || kSizes[type] < 0 || (kSizes[type] > 0 && size != kSizes[type]))
      return fmt::format("LASzip item type {} of {} bytes is not supported", type, size);
    if (version > 4) return fmt::format("LASzip item version {} is not supported", version);
    if ((type >= kFirstLayered) != (record.compressor == 3))
      return fmt::format("LASzip compressor {} does not go with items of type {}",
                         record.compressor, type);
    total += size;
  }
  if (total != record_length)
    return fmt::format("LASzip items of {} bytes do not make records of {}", total, record_length);
  return "";
}

LasLayout read_las_layout(const fs::path& path, LasSystems& systems, bool crs_matters) {
  const PositionedFile file(path);
  LasLayout layout;
  layout.file_size = file.size();
  const std::string front = read_front(path, file);
  parse_fixed(path, front, layout);
  parse_numbers(path, front, layout.info);
  std::vector<Vlr> vlrs = read_vlrs(path, file, front, layout);
  settle_records(path, front, layout);
  if (layout.info.compressed) settle_compression(path, file, vlrs, layout);
  read_evlrs(path, file, front, layout, vlrs);
  bool stated = false;
  for (const Vlr& vlr : vlrs) {
    layout.info.copc = layout.info.copc || (vlr.user_id == "copc" && vlr.record_id == 1);
    stated = stated || (vlr.user_id == "LASF_Projection" &&
                        (vlr.record_id == 34735 || vlr.record_id == 2112));
  }
  const bool wkt =
      layout.info.point_format >= 6 || (number_at<std::uint16_t>(front, 6) & 0x10) != 0;
  const LasSystems::System system = [&] {
    const ForeignCode gdal_and_proj(path.c_str());
    return systems.of(vlrs, wkt);
  }();
  layout.info.crs = system.crs;
  layout.info.vertical_unit = system.vertical_unit;
  layout.info.vertical_crs = system.vertical_crs;
  if (!crs_matters || !layout.info.crs.empty()) return layout;
  for (Warning& warning : layout.info.warnings)
    if (warning.code == "las_vlrs_broken")
      warning.message +=
          "; its CRS may be lost: get the file again, or name the CRS with points_crs";
  if (stated)
    layout.info.warnings.push_back({"las_crs_unknown", 1,
                                    path.string() + ": states a CRS that is not understood; "
                                                    "name it with points_crs"});
  return layout;
}

std::vector<LasInfo> inspect_las(std::span<const fs::path> paths) {
  std::vector<LasInfo> infos(paths.size());
  LasSystems systems;
  parallel_in_order(paths.size(),
                    [&](std::size_t f) { infos[f] = read_las_layout(paths[f], systems).info; });
  return infos;
}

LasInfo inspect_las(const fs::path& path) { return inspect_las(std::span(&path, 1)).front(); }

}  // namespace tetropolis
