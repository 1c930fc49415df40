#include "tetropolis/io/mesh/stl.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "core/parallel.h"
#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"
#include "io/file/input_file.h"
#include "io/file/positioned_file.h"
#include "mesh_input.h"

namespace tetropolis {

namespace {

static_assert(std::endian::native == std::endian::little, "STL output writes native byte order");

constexpr std::size_t kHeader = 80;
constexpr std::size_t kBegin = kHeader + sizeof(std::uint32_t);
constexpr std::size_t kTriangleBytes = 12 * sizeof(float) + sizeof(std::uint16_t);
constexpr std::string_view kOriginMark = "tetropolis origin ";

using Corner = std::array<float, 3>;

/// Of what is written, so that it fits the corners as a reader has them. Apart from the rounding of
/// the corners: GCC 12 takes two doubles that become single and double again, side by side, for
/// unchanged.
[[gnu::noinline]] Corner unit_normal(const std::array<Corner, 3>& p) {
  const auto side = [&](std::size_t corner, std::size_t axis) {
    return static_cast<double>(p[corner][axis]) - static_cast<double>(p[0][axis]);
  };
  std::array<double, 3> n{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    n[i] = side(1, j) * side(2, k) - side(1, k) * side(2, j);
  }
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (!(length > 0)) return {0, 0, 0};
  return {static_cast<float>(n[0] / length), static_cast<float>(n[1] / length),
          static_cast<float>(n[2] / length)};
}

void append_triangle(const SurfaceMesh& surface, std::size_t f, std::string& buffer) {
  std::array<Corner, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& p = surface.points[static_cast<std::size_t>(surface.triangles[f][i])];
    for (std::size_t c = 0; c < 3; ++c) corners[i][c] = static_cast<float>(p[c]);
  }
  append_raw(buffer, unit_normal(corners));
  append_raw(buffer, corners);
  append_raw(buffer, static_cast<std::uint16_t>(surface.patch[f]));
}

/// Of the header, if it is as write_stl makes it.
std::optional<Point3> origin_of(std::string header) {
  header.resize(std::min(header.find('\0'), header.size()));
  if (!header.starts_with(kOriginMark)) return std::nullopt;
  return point_from_text(header.substr(kOriginMark.size()));
}

}  // namespace

void write_stl(const std::filesystem::path& path, const SurfaceMesh& surface,
               const Placement& placement) {
  const auto& [shift, origin] = placement;
  std::string head = fmt::format("{}{} {} {}", kOriginMark, shift[0] + origin[0],
                                 shift[1] + origin[1], shift[2] + origin[2]);
  head.resize(kHeader, '\0');
  append_raw(head, static_cast<std::uint32_t>(surface.triangles.size()));
  AtomicFile file(path);
  file.write(head);
  write_chunked(file, surface.triangles.size(), kRowsPerChunk,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  for (std::size_t f = begin; f < end; ++f) append_triangle(surface, f, buffer);
                });
  file.commit();
}

StlMesh read_stl(const std::filesystem::path& path) {
  const PositionedFile file(path);
  const auto size = static_cast<std::uint64_t>(file.size());
  const std::string head = file.head(kBegin);
  std::uint32_t count = 0;
  if (head.size() == kBegin) std::memcpy(&count, head.data() + kHeader, sizeof count);
  const std::uint64_t expected = kBegin + std::uint64_t{count} * kTriangleBytes;
  if (head.size() < kBegin || size < expected) {
    if (head.starts_with("solid")) fail_input(path, "is ASCII STL; only binary STL can be read");
    fail_input(path, head.size() < kBegin
                         ? "is too short for binary STL"
                         : fmt::format("has {} bytes; with its {} triangles binary STL has {}: the "
                                       "file is cut or of another format",
                                       size, count, expected));
  }
  require_room_for_surface(path, 3 * std::uint64_t{count}, count);
  StlMesh mesh;
  mesh.origin = origin_of(head.substr(0, kHeader));
  mesh.triangles.resize(count);
  mesh.attribute.resize(count);
  parallel_chunks(count, kRowsPerChunk, [&](std::size_t begin, std::size_t end) {
    std::string bytes((end - begin) * kTriangleBytes, '\0');
    if (file.read(static_cast<std::int64_t>(kBegin + begin * kTriangleBytes), bytes.data(),
                  bytes.size()) < bytes.size())
      fail_input(path, "ends inside a triangle: the file is cut");
    for (std::size_t f = begin; f < end; ++f) {
      const char* at =
          bytes.data() + (f - begin) * kTriangleBytes + sizeof(Corner);  // after the normal
      std::memcpy(&mesh.triangles[f], at, sizeof mesh.triangles[f]);
      std::memcpy(&mesh.attribute[f], at + sizeof mesh.triangles[f], sizeof mesh.attribute[f]);
    }
  });
  return mesh;
}

}  // namespace tetropolis
