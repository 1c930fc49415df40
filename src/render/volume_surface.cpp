#include "volume_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/sort_once.h"
#include "vec3.h"

namespace tetropolis {

namespace {

struct CellFace {
  std::array<std::int64_t, 3> corners;  ///< Counter-clockwise seen from outside the cell.
  std::int64_t cell;

  std::array<std::int64_t, 3> key() const {
    auto sorted = corners;
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  }
};

/// Faces of one cell only.
std::vector<CellFace> single_faces(const TetMesh& mesh) {
  constexpr std::array<std::array<std::size_t, 3>, 4> kFaces = {
      {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  // By their lowest corner: all that may be equal lie together.
  std::vector<std::size_t> next(mesh.points.size() + 1, 0);
  const auto lowest = [&](std::size_t c, const std::array<std::size_t, 3>& f) {
    const auto& cell = mesh.cells[c];
    return static_cast<std::size_t>(std::min({cell[f[0]], cell[f[1]], cell[f[2]]}));
  };
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const auto& f : kFaces) ++next[lowest(c, f) + 1];
  for (std::size_t v = 0; v + 1 < next.size(); ++v) next[v + 1] += next[v];
  const std::vector<std::size_t> first = next;
  std::vector<CellFace> faces(mesh.cells.size() * 4);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const auto& f : kFaces) {
      const auto& cell = mesh.cells[c];
      faces[next[lowest(c, f)]++] = {{cell[f[0]], cell[f[1]], cell[f[2]]},
                                     static_cast<std::int64_t>(c)};
    }
  std::vector<CellFace> single;
  std::vector<std::pair<std::array<std::int64_t, 3>, std::size_t>> around;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    around.clear();
    for (std::size_t i = first[v]; i < first[v + 1]; ++i) around.emplace_back(faces[i].key(), i);
    std::sort(around.begin(), around.end());
    for (std::size_t i = 0; i < around.size(); ++i) {
      const bool before = i > 0 && around[i - 1].first == around[i].first;
      const bool after = i + 1 < around.size() && around[i + 1].first == around[i].first;
      if (!before && !after) single.push_back(faces[around[i].second]);
    }
  }
  return single;
}

/// Vertical faces have a slope of less than that against the vertical.
constexpr double kVertical = 1e-4;

class Sides {
 public:
  Sides(const TetMesh& mesh, const std::vector<CellFace>& faces) : mesh_(mesh) {
    for (const CellFace& face : faces)
      if (normal(face).z > kVertical)
        for (const std::int64_t v : face.corners) top_.push_back(v);
    sort_once(top_);
    for (const CellFace& face : faces)
      if (std::abs(normal(face).z) <= kVertical && touches_top(face)) lines_.push_back(line(face));
    std::sort(lines_.begin(), lines_.end());
  }

  Vec3 normal(const CellFace& face) const {
    const Vec3 a = point(face.corners[0]);
    return normalised(cross(point(face.corners[1]) - a, point(face.corners[2]) - a));
  }

  bool is_side(const CellFace& face) const {
    return std::binary_search(lines_.begin(), lines_.end(), line(face));
  }

 private:
  using Line = std::array<double, 4>;

  Vec3 point(std::int64_t v) const { return Vec3(mesh_.points[static_cast<std::size_t>(v)]); }

  bool touches_top(const CellFace& face) const {
    int on_top = 0;
    for (const std::int64_t v : face.corners)
      on_top += std::binary_search(top_.begin(), top_.end(), v) ? 1 : 0;
    return on_top == 2;
  }

  /// The segment that a vertical face is in the plan.
  Line line(const CellFace& face) const {
    std::array<std::pair<double, double>, 3> p;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 q = point(face.corners[i]);
      p[i] = {q.x, q.y};
    }
    std::sort(p.begin(), p.end());
    return {p[0].first, p[0].second, p[2].first, p[2].second};
  }

  const TetMesh& mesh_;
  std::vector<std::int64_t> top_;  ///< Vertices of faces that look up.
  std::vector<Line> lines_;
};

/// Walls are of the building whose roof, or other wall, they touch.
void name_walls(SurfaceMesh& surface) {
  std::vector<BuildingIndex> at(surface.points.size(), kNoBuilding);
  const auto mark = [&](std::size_t f) {
    for (const std::int32_t v : surface.triangles[f])
      at[static_cast<std::size_t>(v)] = surface.building[f];
  };
  std::vector<std::size_t> walls;
  for (std::size_t f = 0; f < surface.triangles.size(); ++f)
    if (surface.patch[f] == Patch::kWall)
      walls.push_back(f);
    else if (surface.building[f].valid())
      mark(f);
  const auto is_named = [&](std::size_t f) {
    for (const std::int32_t v : surface.triangles[f])
      if (const BuildingIndex b = at[static_cast<std::size_t>(v)]; b.valid())
        surface.building[f] = b;
    if (surface.building[f].valid()) mark(f);
    return surface.building[f].valid();
  };
  while (std::erase_if(walls, is_named) > 0) {
  }
}

}  // namespace

SurfaceMesh surface_of(const TetMesh& mesh) {
  const std::vector<CellFace> faces = single_faces(mesh);
  const Sides sides(mesh, faces);
  SurfaceMesh surface;
  std::vector<std::int32_t> number(mesh.points.size(), -1);
  for (const CellFace& face : faces) {
    const double up = sides.normal(face).z;
    if (up > kVertical || (up >= -kVertical && sides.is_side(face))) continue;
    const std::int32_t region =
        mesh.region.empty() ? -1 : mesh.region[static_cast<std::size_t>(face.cell)];
    const bool is_wall = up >= -kVertical;
    surface.patch.push_back(is_wall ? Patch::kWall : region < 0 ? Patch::kGround : Patch::kRoof);
    surface.building.push_back(is_wall ? kNoBuilding : BuildingIndex(region));
    std::array<std::int32_t, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto v = static_cast<std::size_t>(face.corners[i]);
      if (number[v] < 0) {
        number[v] = static_cast<std::int32_t>(surface.points.size());
        surface.points.push_back(mesh.points[v]);
      }
      corners[i] = number[v];
    }
    surface.triangles.push_back(corners);
  }
  name_walls(surface);
  return surface;
}

}  // namespace tetropolis
