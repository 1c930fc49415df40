#include "tetropolis/io/mesh/ply.h"

#include <bit>
#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"

namespace tetropolis {

namespace {

static_assert(std::endian::native == std::endian::little, "PLY output writes native byte order");

}  // namespace

void write_ply(const std::filesystem::path& path, const SurfaceMesh& surface,
               const Placement& placement) {
  AtomicFile file(path);
  file.write(fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment origin {} {} {}\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\nelement face {}\n"
      "property list uchar int vertex_indices\nproperty int patch\nproperty int building\n"
      "end_header\n",
      placement.origin[0], placement.origin[1], placement.origin[2], surface.points.size(),
      surface.triangles.size()));
  write_chunked(file, surface.points.size(), kRowsPerChunk,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  for (std::size_t i = begin; i < end; ++i)
                    for (std::size_t c = 0; c < 3; ++c)
                      append_raw(buffer, surface.points[i][c] + placement.shift[c]);
                });
  write_chunked(file, surface.triangles.size(), kRowsPerChunk,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  for (std::size_t f = begin; f < end; ++f) {
                    append_raw(buffer, std::uint8_t{3});
                    for (const std::int32_t v : surface.triangles[f]) append_raw(buffer, v);
                    append_raw(buffer, static_cast<std::int32_t>(surface.patch[f]));
                    append_raw(buffer, surface.building[f]);
                  }
                });
  file.commit();
}

}  // namespace tetropolis
