#include "tetropolis/io/mesh/stl.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"

namespace tetropolis {

namespace {

std::array<double, 3> unit_normal(const SurfaceMesh& surface,
                                  const std::array<std::int32_t, 3>& triangle) {
  const auto& a = surface.points[static_cast<std::size_t>(triangle[0])];
  const auto& b = surface.points[static_cast<std::size_t>(triangle[1])];
  const auto& c = surface.points[static_cast<std::size_t>(triangle[2])];
  const std::array<double, 3> u{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const std::array<double, 3> v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  std::array<double, 3> n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                          u[0] * v[1] - u[1] * v[0]};
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (length > 0)
    for (double& x : n) x /= length;
  return n;
}

/// As "%.6f" or "%.6g" has it.
void append(std::string& text, double value, std::chars_format format) {
  std::array<char, 400> digits;
  const auto [end, error] =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, format, 6);
  text.append(digits.data(), end);
}

void append_facet(const SurfaceMesh& surface, std::size_t f, const Placement& placement,
                  std::string& buffer) {
  buffer += "facet normal";
  for (const double x : unit_normal(surface, surface.triangles[f])) {
    buffer += ' ';
    append(buffer, x, std::chars_format::general);
  }
  buffer += "\nouter loop\n";
  for (const std::int32_t v : surface.triangles[f]) {
    buffer += "vertex";
    for (std::size_t c = 0; c < 3; ++c) {
      buffer += ' ';
      append(buffer, surface.points[static_cast<std::size_t>(v)][c] + placement.shift[c],
             std::chars_format::fixed);
    }
    buffer += '\n';
  }
  buffer += "endloop\nendfacet\n";
}

}  // namespace

void write_stl(const std::filesystem::path& path, const SurfaceMesh& surface,
               const Placement& placement) {
  AtomicFile file(path);
  for (std::size_t begin = 0; begin < surface.patch.size();) {
    std::size_t end = begin;
    while (end < surface.patch.size() && surface.patch[end] == surface.patch[begin]) ++end;
    const std::string& name = surface.patch_of(begin).name;
    file.write(fmt::format("solid {}\n", name));
    write_chunked(file, end - begin, 8192,
                  [&](std::size_t first, std::size_t last, std::string& buffer) {
                    for (std::size_t f = begin + first; f < begin + last; ++f)
                      append_facet(surface, f, placement, buffer);
                  });
    file.write(fmt::format("endsolid {}\n", name));
    begin = end;
  }
  file.commit();
}

}  // namespace tetropolis
