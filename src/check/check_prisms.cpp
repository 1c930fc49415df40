#include "check_prisms.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "vector3.h"
#include "violations.h"
#include "volume_parts.h"

namespace tetropolis {

namespace {

/// Corners of a wedge's faces, outward: two triangles, then quadrilaterals.
constexpr std::array<std::array<std::size_t, 3>, 2> kTriangles{{{0, 2, 1}, {3, 4, 5}}};
constexpr std::array<std::array<std::size_t, 4>, 3> kQuads{
    {{0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}};

Vector3 plus(const Vector3& a, double share, const Vector3& b) {
  return {a[0] + share * b[0], a[1] + share * b[1], a[2] + share * b[2]};
}

struct WedgeFace {
  Vector3 area{}, centre{};
  double flatness = 1;
};

WedgeFace shape_of(std::span<const Vector3> corners) {
  Vector3 mean{};
  for (const Vector3& p : corners) mean = plus(mean, 1.0 / static_cast<double>(corners.size()), p);
  WedgeFace shape;
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3 &p = corners[i], &q = corners[(i + 1) % corners.size()];
    const Vector3 twice = cross(difference(q, p), difference(mean, p));
    const double size = length(twice) / 2;
    shape.area = plus(shape.area, 0.5, twice);
    shape.centre = plus(shape.centre, size, centre_of(p, q, mean));
    sum += size;
  }
  for (double& c : shape.centre) c /= sum;
  shape.flatness = length(shape.area) / sum;
  return shape;
}

template <std::size_t N>
std::array<Vector3, N> corners_at(const TetMesh& mesh, const std::array<std::int64_t, 6>& wedge,
                                  const std::array<std::size_t, N>& which) {
  std::array<Vector3, N> corners;
  for (std::size_t i = 0; i < N; ++i)
    corners[i] = mesh.points[static_cast<std::size_t>(wedge[which[i]])];
  return corners;
}

/// Edges at each corner have to turn one way: then the cell is positive everywhere.
bool is_positive(const TetMesh& mesh, const std::array<std::int64_t, 6>& wedge) {
  const auto corners = corners_at<6>(mesh, wedge, {0, 1, 2, 3, 4, 5});
  for (std::size_t i = 0; i < 3; ++i)
    for (const std::size_t level : {0, 3}) {
      const Vector3& at = corners[level + i];
      const Vector3 next = difference(corners[level + (i + 1) % 3], at);
      const Vector3 last = difference(corners[level + (i + 2) % 3], at);
      const Vector3 up = difference(corners[3 + i], corners[i]);
      if (!(dot(cross(next, last), up) > 0)) return false;
    }
  return true;
}

/// What is looked at of one wedge.
struct WedgeShape {
  double volume = 0, aspect = 0, flatness = 1;
  Vector3 centre{};
};

WedgeShape wedge_shape(const TetMesh& mesh, const std::array<std::int64_t, 6>& wedge) {
  const auto corners = corners_at<6>(mesh, wedge, {0, 1, 2, 3, 4, 5});
  Vector3 middle{};
  for (const Vector3& p : corners) middle = plus(middle, 1.0 / 6, p);
  WedgeShape shape;
  Vector3 sums{};
  const auto add = [&](const WedgeFace& face) {
    const double volume = dot(face.area, difference(face.centre, middle)) / 3;
    shape.volume += volume;
    shape.centre = plus(plus(shape.centre, 0.75 * volume, face.centre), 0.25 * volume, middle);
    shape.flatness = std::min(shape.flatness, face.flatness);
    for (std::size_t d = 0; d < 3; ++d) sums[d] += std::abs(face.area[d]);
  };
  for (const auto& which : kTriangles) add(shape_of(corners_at(mesh, wedge, which)));
  for (const auto& which : kQuads) add(shape_of(corners_at(mesh, wedge, which)));
  for (double& c : shape.centre) c /= shape.volume;
  const auto [least, most] = std::minmax({sums[0], sums[1], sums[2]});
  const double surface = sums[0] + sums[1] + sums[2];
  shape.aspect = std::max(most / least, surface / (6 * std::pow(shape.volume, 2.0 / 3)));
  return shape;
}

/// A quadrilateral of a wedge.
struct QuadUse {
  std::array<std::int64_t, 4> sorted;
  std::array<std::int64_t, 4> corners;  ///< Outward, the lowest first.
  std::size_t wedge;
};

std::vector<QuadUse> quads_of(const TetMesh& mesh) {
  std::vector<QuadUse> quads;
  for (std::size_t w = 0; w < mesh.wedges.size(); ++w)
    for (const auto& which : kQuads) {
      QuadUse& use = quads.emplace_back();
      for (std::size_t i = 0; i < 4; ++i) use.corners[i] = mesh.wedges[w][which[i]];
      std::rotate(use.corners.begin(), std::min_element(use.corners.begin(), use.corners.end()),
                  use.corners.end());
      use.sorted = use.corners;
      std::sort(use.sorted.begin(), use.sorted.end());
      use.wedge = w;
    }
  std::sort(quads.begin(), quads.end(), [](const QuadUse& a, const QuadUse& b) {
    return std::tie(a.sorted, a.wedge) < std::tie(b.sorted, b.wedge);
  });
  return quads;
}

}  // namespace

std::string place_of_wedge(const TetMesh& mesh, std::size_t w) {
  const Vector3& p = mesh.points[static_cast<std::size_t>(mesh.wedges[w][0])];
  return fmt::format("prism {} at ({:.3f}, {:.3f}, {:.3f})", w, p[0], p[1], p[2]);
}

void measure_wedges(const TetMesh& mesh, std::vector<std::uint8_t>& used, VolumeCheck& check) {
  check.prisms.cells = static_cast<std::int64_t>(mesh.wedges.size());
  for (std::size_t w = 0; w < mesh.wedges.size(); ++w) {
    const auto& wedge = mesh.wedges[w];
    for (const std::int64_t v : wedge) used[static_cast<std::size_t>(v)] = 1;
    const WedgeShape shape = wedge_shape(mesh, wedge);
    check.volume += shape.volume;
    check.prisms.max_aspect_ratio = std::max(check.prisms.max_aspect_ratio, shape.aspect);
    check.prisms.least_flatness = std::min(check.prisms.least_flatness, shape.flatness);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3 up = difference(mesh.points[static_cast<std::size_t>(wedge[3 + i])],
                                    mesh.points[static_cast<std::size_t>(wedge[i])]);
      check.least_vertical_edge = std::min(check.least_vertical_edge, length(up));
      if (up[0] != 0 || up[1] != 0)
        note_violation(check.violations, "prisms that are not upright",
                       [&] { return place_of_wedge(mesh, w); });
    }
    if (shape.volume > 0 && is_positive(mesh, wedge)) continue;
    ++check.inverted;
    note_violation(check.violations, "inverted cells", [&] { return place_of_wedge(mesh, w); });
  }
}

std::vector<WedgeTriangle> wedge_triangles(const TetMesh& mesh) {
  std::vector<WedgeTriangle> triangles;
  for (std::size_t w = 0; w < mesh.wedges.size(); ++w) {
    const Vector3 centre = wedge_shape(mesh, mesh.wedges[w]).centre;
    for (const auto& which : kTriangles) {
      std::array<std::int64_t, 3> corners;
      for (std::size_t i = 0; i < 3; ++i) corners[i] = mesh.wedges[w][which[i]];
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      triangles.push_back({corners, w, centre});
    }
  }
  return triangles;
}

void match_quads(const TetMesh& mesh, FaceSums& sums, VolumeCheck& check) {
  const std::vector<QuadUse> quads = quads_of(mesh);
  const auto corners_of = [&](const QuadUse& quad) {
    std::array<Vector3, 4> corners;
    for (std::size_t i = 0; i < 4; ++i)
      corners[i] = mesh.points[static_cast<std::size_t>(quad.corners[i])];
    return corners;
  };
  const auto centre_at = [&](std::size_t w) { return wedge_shape(mesh, mesh.wedges[w]).centre; };
  const auto skew_of = [](const std::array<Vector3, 4>& corners, const WedgeFace& face,
                          const Vector3& skew, double least) {
    const double off = length(skew);
    double extent = least;
    for (const Vector3& p : corners)
      extent = std::max(extent, std::abs(dot(skew, difference(p, face.centre))) / off);
    return off > 0 ? off / extent : 0;
  };
  for (std::size_t i = 0, j = 0; i < quads.size(); i = j) {
    while (j < quads.size() && quads[j].sorted == quads[i].sorted) ++j;
    const auto place = [&] { return place_of_wedge(mesh, quads[i].wedge); };
    const std::array<Vector3, 4> corners = corners_of(quads[i]);
    const WedgeFace face = shape_of(corners);
    const Vector3 from = centre_at(quads[i].wedge), to_face = difference(face.centre, from);
    if (j - i == 1) {
      check.boundary_quads.push_back(quads[i].corners);
      const double share = dot(face.area, to_face) / dot(face.area, face.area);
      sums.skewness =
          std::max(sums.skewness, skew_of(corners, face, plus(to_face, -share, face.area),
                                          0.4 * std::abs(share) * length(face.area)));
      continue;
    }
    const auto& a = quads[i].corners;
    const auto& b = quads[i + 1].corners;
    if (j - i > 2) {
      note_violation(check.violations, "faces of more than two cells", place);
    } else if (b != std::array{a[0], a[3], a[2], a[1]}) {
      note_violation(check.violations, "neighbouring cells that overlap", place);
    } else {
      const Vector3 line = difference(centre_at(quads[i + 1].wedge), from);
      const double along = dot(face.area, line);
      sums.add_cosine(along / (length(face.area) * length(line)));
      sums.skewness =
          std::max(sums.skewness,
                   skew_of(corners, face, plus(to_face, -dot(face.area, to_face) / along, line),
                           0.2 * length(line)));
    }
  }
}

LayersCheck check_prism_layers(const TetMesh& mesh, const SurfaceMesh& surface, double first,
                               int count) {
  LayersCheck check;
  check.height.assign(surface.points.size(), 0);
  std::vector<std::uint8_t> is_as_asked(surface.points.size(), 0);
  constexpr std::int64_t kNone = -1;
  std::vector<std::int64_t> above(mesh.points.size(), kNone);
  for (const auto& wedge : mesh.wedges)
    for (std::size_t i = 0; i < 3; ++i) above[static_cast<std::size_t>(wedge[i])] = wedge[3 + i];
  std::vector<std::pair<Vector3, std::size_t>> bottoms;
  for (std::size_t v = 0; v < above.size(); ++v)
    if (above[v] != kNone) bottoms.emplace_back(mesh.points[v], v);
  std::sort(bottoms.begin(), bottoms.end());
  const auto measure = [&](std::size_t on_surface) {
    const Vector3& p = surface.points[on_surface];
    const auto at = std::lower_bound(bottoms.begin(), bottoms.end(), std::pair(p, std::size_t{0}));
    if (at == bottoms.end() || at->first != p) return;
    ++check.columns;
    double below = 0, z = p[2];
    std::int64_t u = above[at->second];
    for (int k = 0; k < count && u != kNone; ++k, u = above[static_cast<std::size_t>(u)]) {
      const double height = mesh.points[static_cast<std::size_t>(u)][2] - z;
      if (!(height > 0)) return;  // told as inverted
      if (k == 0 && std::abs(height - first) <= 1e-3) is_as_asked[on_surface] = 1;
      if (k > 0) check.greatest_growth = std::max(check.greatest_growth, height / below);
      z += height;
      below = height;
    }
    check.height[on_surface] = z - p[2];
  };
  std::vector<std::uint8_t> is_seen(surface.points.size(), 0);
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    if (surface.patch_of(f).kind != PatchKind::kGround) continue;
    for (const std::int32_t corner : surface.triangles[f]) {
      const auto v = static_cast<std::size_t>(corner);
      if (std::exchange(is_seen[v], std::uint8_t{1}) == 0) measure(v);
    }
  }
  double all = 0;
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    if (surface.patch_of(f).kind != PatchKind::kGround) continue;
    const auto p = [&](std::size_t i) {
      return surface.points[static_cast<std::size_t>(surface.triangles[f][i])];
    };
    const Vector3 u = difference(p(1), p(0)), w = difference(p(2), p(0));
    const double area = std::abs(u[0] * w[1] - u[1] * w[0]) / 2;
    all += area;
    for (const std::int32_t v : surface.triangles[f])
      check.share_as_asked += is_as_asked[static_cast<std::size_t>(v)] != 0 ? area / 3 : 0;
  }
  if (all > 0) check.share_as_asked /= all;
  return check;
}

}  // namespace tetropolis
