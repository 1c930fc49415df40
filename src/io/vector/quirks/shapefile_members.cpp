#include "shapefile_members.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

#include "io/file/input_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kShapeHeader = 100;  // bytes, of .shp and .shx
constexpr std::int64_t kIndexRecord = 8;

/// A member of the shapefile as far as it is looked at.
struct Member {
  fs::path path;
  std::int64_t size = 0;
  std::array<unsigned char, 32> head{};  ///< Zeros beyond the end.
};

/// The member with this extension in small or capital letters; none if there is no such file.
/// Throws Error(kInput) if it cannot be read: GDAL takes it for one that is not there.
std::optional<Member> find_member(const fs::path& shp, const char* small, const char* capital) {
  for (const char* extension : {small, capital}) {
    Member member{fs::path(shp).replace_extension(extension)};
    std::error_code error;
    const auto size = fs::file_size(member.path, error);
    if (error) continue;
    member.size = static_cast<std::int64_t>(size);
    std::ifstream file(member.path, std::ios::binary);
    if (!file && fs::is_regular_file(member.path, error))
      fail_input(member.path, fmt::format("cannot be read: {}", std::strerror(errno)));
    file.read(reinterpret_cast<char*>(member.head.data()),
              static_cast<std::streamsize>(member.head.size()));
    return member;
  }
  return std::nullopt;
}

std::int64_t big_endian(const unsigned char* bytes) {
  std::int64_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value * 256 + bytes[i];
  return value;
}

std::int64_t big_endian(const Member& member, std::size_t at) {
  return big_endian(member.head.data() + at);
}

/// By the header of an index, which GDAL believes, and not its size.
std::int64_t shapes_of(const Member& index) {
  return (2 * big_endian(index, 24) - kShapeHeader) / kIndexRecord;
}

std::int64_t little_endian(const Member& member, std::size_t at, std::size_t bytes) {
  std::int64_t value = 0;
  for (std::size_t i = bytes; i-- > 0;) value = value * 256 + member.head[at + i];
  return value;
}

bool is_shapefile(const fs::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".shp" || extension == ".SHP";
}

/// Of a table. The head is 32 bytes, 32 for each column, and an end mark.
bool lacks_columns(const Member& table) {
  const std::int64_t head = little_endian(table, 8, 2);
  return head >= 33 && head < 65;
}

void require_size(const Member& member, std::int64_t stated) {
  if (member.size >= stated) return;
  throw Error(ErrorKind::kInput,
              fmt::format("{}: the file is cut: {} bytes of the {} its header states; get it again",
                          member.path.string(), member.size, stated));
}

/// Every entry of the index has to name the place of a record of the length that the record itself
/// states, and no two the same: a stale index gives shapes to the wrong attributes.
void require_index_of(const Member& shapes, const Member& index) {
  std::ifstream entries(index.path, std::ios::binary), records;
  entries.seekg(kShapeHeader);
  records.rdbuf()->pubsetbuf(nullptr, 0);  // every head is elsewhere
  records.open(shapes.path, std::ios::binary);
  const std::int64_t count = shapes_of(index);
  std::vector<std::int64_t> places;
  std::array<unsigned char, kIndexRecord> entry{}, head{};
  const auto read = [](std::ifstream& file, std::array<unsigned char, kIndexRecord>& to) {
    return static_cast<bool>(
        file.read(reinterpret_cast<char*>(to.data()), static_cast<std::streamsize>(to.size())));
  };
  const auto fail = [&](std::int64_t i, const char* what) {
    throw Error(ErrorKind::kInput,
                fmt::format("{}: entry {} of its index (.shx) {}; the files do not belong "
                            "together or one is broken, export them again",
                            shapes.path.string(), i, what));
  };
  for (std::int64_t i = 0; i < count && read(entries, entry); ++i) {
    const std::int64_t place = 2 * big_endian(entry.data());
    const std::int64_t length = big_endian(entry.data() + 4);
    if (length == 0) continue;  // deleted
    places.push_back(place);
    records.clear();
    records.seekg(place);
    if (!read(records, head)) continue;  // GDAL says where the file ends
    if (big_endian(head.data() + 4) != length) fail(i, "states another length than the shape has");
  }
  std::sort(places.begin(), places.end());
  const auto twice = std::adjacent_find(places.begin(), places.end());
  if (twice != places.end())
    fail(twice - places.begin(), "(in the order of the shapes) names the same shape as the next");
}

}  // namespace

void require_whole_shapefile(const fs::path& path) {
  if (!is_shapefile(path)) return;
  const auto shapes = find_member(path, ".shp", ".SHP");
  const auto index = find_member(path, ".shx", ".SHX");
  auto table = find_member(path, ".dbf", ".DBF");
  // Of these GDAL says nothing where it may not read them.
  find_member(path, ".prj", ".PRJ");
  find_member(path, ".cpg", ".CPG");
  if (table && lacks_columns(*table)) table.reset();
  constexpr std::int64_t kMagic = 9994;
  if (!shapes || big_endian(*shapes, 0) != kMagic) return;  // GDAL says what it is not
  // Lengths count words of 16 bits.
  require_size(*shapes, 2 * big_endian(*shapes, 24));
  // Without an index nothing else tells of records behind the length that the header states.
  if (!index && shapes->size > 2 * big_endian(*shapes, 24))
    throw Error(ErrorKind::kInput,
                fmt::format("{}: {} bytes are more than the {} its header states, and no index "
                            "(.shx) tells which is right; get the file again",
                            shapes->path.string(), shapes->size, 2 * big_endian(*shapes, 24)));
  if (index) require_size(*index, std::max(kShapeHeader, 2 * big_endian(*index, 24)));
  if (table)
    require_size(*table, little_endian(*table, 8, 2) +
                             little_endian(*table, 4, 4) * little_endian(*table, 10, 2));
  if (!index) return;
  const std::int64_t shape_count = shapes_of(*index);
  const std::int64_t record_count = table ? little_endian(*table, 4, 4) : shape_count;
  if (shape_count != record_count)
    throw Error(
        ErrorKind::kInput,
        fmt::format("{}: {} shapes by its index, but {} attribute records in {}; the files "
                    "do not belong together, export them again",
                    path.string(), shape_count, record_count, table->path.filename().string()));
  require_index_of(*shapes, *index);
}

bool has_empty_table(const fs::path& path) {
  if (!is_shapefile(path)) return false;
  const auto table = find_member(path, ".dbf", ".DBF");
  return table && lacks_columns(*table);
}

}  // namespace tetropolis
