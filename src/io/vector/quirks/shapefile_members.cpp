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

#include <fmt/format.h>

#include "core/text.h"
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

std::int64_t big_endian(const Member& member, std::size_t at) {
  std::int64_t value = 0;
  for (std::size_t i = at; i < at + 4; ++i) value = value * 256 + member.head[i];
  return value;
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
  fail_input(member.path, fmt::format("the file is cut: {} bytes of the {} its header states; get "
                                      "it again",
                                      member.size, stated));
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
  if (index) require_size(*index, std::max(kShapeHeader, 2 * big_endian(*index, 24)));
  if (table)
    require_size(*table, little_endian(*table, 8, 2) +
                             little_endian(*table, 4, 4) * little_endian(*table, 10, 2));
  if (!index) return;
  const std::int64_t shape_count = shapes_of(*index);
  const std::int64_t record_count = table ? little_endian(*table, 4, 4) : shape_count;
  if (shape_count != record_count)
    fail_input(path, fmt::format("its index has {} shapes, but {} has {} records; the files do not "
                                 "belong together, export them again",
                                 shape_count, table->path.filename().string(), record_count));
}

bool needs_copy(const fs::path& path) {
  if (!is_shapefile(path)) return false;
  const auto table = find_member(path, ".dbf", ".DBF");
  return !find_member(path, ".shx", ".SHX") || (table && lacks_columns(*table));
}

std::string copy_shapefile(const fs::path& path, const gdal::MemoryFolder& folder) {
  const auto table = find_member(path, ".dbf", ".DBF");
  const auto copy = [&](const fs::path& member) {
    std::string name = path.stem().string() + lower_case(member.extension().string());
    if (CPLCopyFile(folder.path(name).c_str(), member.c_str()) != 0)
      fail_input(member, "cannot be read; check its permissions");
    return folder.path(name);
  };
  if (table && !lacks_columns(*table)) copy(table->path);
  if (const auto system = find_member(path, ".prj", ".PRJ")) copy(system->path);
  if (const auto encoding = find_member(path, ".cpg", ".CPG")) copy(encoding->path);
  return copy(path);
}

}  // namespace tetropolis
