#include "cut.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "core/parallel.h"
#include "core/units.h"

namespace tetropolis {

namespace {

constexpr std::size_t kGrain = 65536;

std::vector<double> distances(const std::vector<Point3>& points, const CutPlane& plane) {
  std::vector<double> d(points.size());
  parallel_chunks(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) d[i] = plane.distance(Vec3(points[i]));
  });
  return d;
}

/// Where the edge from a to b meets the plane: the same for b to a.
Point2 meeting(const CutPlane& plane, const std::vector<Point3>& points,
               const std::vector<double>& d, std::size_t a, std::size_t b) {
  if (a > b) std::swap(a, b);
  const Vec3 p(points[a]), q(points[b]);
  const Vec3 m = p + (d[a] / (d[a] - d[b])) * (q - p);
  return {plane.position(m), m.z};
}

/// Columns are upright, and so is the plane: a prism is cut where its triangle is.
std::optional<CutCell> cut_wedge(const TetMesh& mesh, const CutPlane& plane,
                                 const std::vector<double>& d, std::size_t w) {
  std::array<std::size_t, 6> v{};
  for (std::size_t i = 0; i < 6; ++i) v[i] = static_cast<std::size_t>(mesh.wedges[w][i]);
  const auto is_behind = [&](std::size_t i) { return d[v[i % 3]] >= 0; };
  for (std::size_t i = 0; i < 3; ++i) {
    if (is_behind(i) == is_behind(i + 1) || is_behind(i) == is_behind(i + 2)) continue;
    const auto corner = [&](std::size_t layer, std::size_t to) {
      return meeting(plane, mesh.points, d, v[3 * layer + i], v[3 * layer + (i + to) % 3]);
    };
    return CutCell{{corner(0, 1), corner(0, 2), corner(1, 2), corner(1, 1)},
                   4,
                   static_cast<std::int64_t>(mesh.cells.size() + w)};
  }
  return std::nullopt;
}

std::vector<CutCell> cut_some(const TetMesh& mesh, const CutPlane& plane,
                              const std::vector<double>& d, std::size_t begin, std::size_t end) {
  std::vector<CutCell> cut;
  for (std::size_t c = begin; c < end; ++c) {
    if (c >= mesh.cells.size()) {
      if (const auto cell = cut_wedge(mesh, plane, d, c - mesh.cells.size())) cut.push_back(*cell);
      continue;
    }
    std::array<std::size_t, 4> front, behind;
    std::size_t n_front = 0, n_behind = 0;
    for (const std::int64_t v : mesh.cells[c]) {
      const auto vertex = static_cast<std::size_t>(v);
      if (d[vertex] >= 0)
        behind[n_behind++] = vertex;
      else
        front[n_front++] = vertex;
    }
    if (n_front == 0 || n_behind == 0) continue;
    CutCell cell;
    cell.cell = static_cast<std::int64_t>(c);
    const auto corner = [&](std::size_t f, std::size_t b) {
      return meeting(plane, mesh.points, d, front[f], behind[b]);
    };
    if (n_front == 1)
      cell.corners = {corner(0, 0), corner(0, 1), corner(0, 2), {}};
    else if (n_behind == 1)
      cell.corners = {corner(0, 0), corner(1, 0), corner(2, 0), {}};
    else {
      cell.corners = {corner(0, 0), corner(0, 1), corner(1, 1), corner(1, 0)};
      cell.size = 4;
    }
    cut.push_back(cell);
  }
  return cut;
}

}  // namespace

CutPlane plane_along(double azimuth, Vec3 through) {
  const double a = to_radians(azimuth);
  // Exact along the axes.
  const auto direction = [](double s) { return std::abs(s) < 1e-12 ? 0.0 : s; };
  const double x = direction(std::sin(a)), y = direction(std::cos(a));
  return {through, {x, y, 0}, {-y, x, 0}};
}

std::vector<CutCell> cut_cells(const TetMesh& mesh, const CutPlane& plane) {
  const std::vector<double> d = distances(mesh.points, plane);
  return parallel_reduce_ordered(
      mesh.cell_count(), kGrain, std::vector<CutCell>(),
      [&](std::size_t begin, std::size_t end) { return cut_some(mesh, plane, d, begin, end); },
      [](std::vector<CutCell> all, const std::vector<CutCell>& some) {
        all.insert(all.end(), some.begin(), some.end());
        return all;
      });
}

std::vector<CutFace> cut_faces(const SurfaceMesh& surface, const CutPlane& plane) {
  const std::vector<double> d = distances(surface.points, plane);
  std::vector<CutFace> cut;
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    const PatchInfo& patch = surface.patch_of(f);
    if (!patch.is_solid() && patch.kind != PatchKind::kOther) continue;
    std::array<Point2, 2> ends;
    std::size_t n = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = static_cast<std::size_t>(surface.triangles[f][i]);
      const auto b = static_cast<std::size_t>(surface.triangles[f][(i + 1) % 3]);
      if ((d[a] >= 0) != (d[b] >= 0)) ends[n++] = meeting(plane, surface.points, d, a, b);
    }
    if (n == 2) cut.push_back({ends, patch.kind, surface.building[f]});
  }
  return cut;
}

}  // namespace tetropolis
