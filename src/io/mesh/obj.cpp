#include "tetropolis/io/mesh/obj.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"

namespace tetropolis {

namespace {

std::string group_line(const SurfaceMesh& surface, std::size_t f) {
  const BuildingIndex building = surface.building[f];
  const std::string& patch = surface.patch_of(f).name;
  return building == kNoBuilding ? fmt::format("g {}\n", patch)
                                 : fmt::format("g {} building_{}\n", patch, building);
}

}  // namespace

void write_obj(const std::filesystem::path& path, const SurfaceMesh& surface,
               const Placement& placement) {
  const auto group = [&](std::size_t f) {
    return std::pair(surface.patch[f], surface.building[f]);
  };
  std::vector<std::size_t> order(surface.triangles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return group(a) < group(b); });

  AtomicFile file(path);
  file.write(fmt::format("# origin {} {} {}\n", placement.origin[0], placement.origin[1],
                         placement.origin[2]));
  const auto& shift = placement.shift;
  write_chunked(file, surface.points.size(), kRowsPerChunk,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  auto out = std::back_inserter(buffer);
                  for (std::size_t i = begin; i < end; ++i) {
                    const auto& p = surface.points[i];
                    fmt::format_to(out, "v {:.6f} {:.6f} {:.6f}\n", p[0] + shift[0],
                                   p[1] + shift[1], p[2] + shift[2]);
                  }
                });
  write_chunked(file, order.size(), kRowsPerChunk,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  auto out = std::back_inserter(buffer);
                  for (std::size_t i = begin; i < end; ++i) {
                    const std::size_t f = order[i];
                    if (i == 0 || group(f) != group(order[i - 1])) buffer += group_line(surface, f);
                    const auto& t = surface.triangles[f];
                    fmt::format_to(out, "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
                  }
                });
  file.commit();
}

}  // namespace tetropolis
