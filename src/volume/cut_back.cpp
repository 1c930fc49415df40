#include "tetropolis/volume/cut_back.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "tetropolis/core/units.h"
#include "tetropolis/volume/fill_columns.h"

#include "shapes_over.h"
#include "tet_cosines.h"

namespace tetropolis {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Highest that p may be above the line from a to b, at elevations za and zb at its ends, if
/// nothing rises from it more steeply than `slope`: the least of elevation + slope * distance along
/// it. An end at infinity is not there. This is the update of a triangle in fast marching (Kimmel
/// and Sethian, "Computing geodesic paths on manifolds", PNAS 95, 1998).
double highest_at(Point2 p, Point2 a, double za, Point2 b, double zb, double slope) {
  const double at_ends = std::min(za + slope * std::hypot(p.x - a.x, p.y - a.y),
                                  zb + slope * std::hypot(p.x - b.x, p.y - b.y));
  if (za == kInfinity || zb == kInfinity) return at_ends;
  const double ex = b.x - a.x, ey = b.y - a.y, length = std::hypot(ex, ey);
  const double rise = (zb - za) / length;
  if (!(std::abs(rise) < slope)) return at_ends;
  const double foot = ((p.x - a.x) * ex + (p.y - a.y) * ey) / length;
  const double away = std::abs((p.x - a.x) * ey - (p.y - a.y) * ex) / length;
  const double least = foot - away * rise / std::sqrt(slope * slope - rise * rise);
  if (!(least > 0 && least < length)) return at_ends;
  return std::min(at_ends, za + rise * least + slope * std::hypot(least - foot, away));
}

/// How many cells over triangle t are outside the bounds.
std::int64_t count_bad_cells_over(const ColumnMesh& mesh, std::size_t t,
                                  const AngleBounds& bounds) {
  const double greatest_cosine = std::cos(to_radians(bounds.least));
  const double least_cosine = std::cos(to_radians(bounds.greatest));
  std::int64_t bad = 0;
  for_each_shape_over(mesh, t, [&](const auto&, const auto&, const TetCosines& shape) {
    if (shape.greatest > greatest_cosine || shape.least < least_cosine) ++bad;
  });
  return bad;
}

}  // namespace

std::vector<BuildingIndex> cut_back(const GroundMesh& mesh, std::span<const BuildingIndex> building,
                                    std::span<const double> roofs,
                                    std::span<const std::uint8_t> cut, const CutSlopes& slopes,
                                    std::vector<double>& ground) {
  constexpr double kWorthwhile = 1e-6;                   // metres
  std::vector<double> start(ground.size(), kInfinity);   // of slopes: roofs, and ground cut already
  std::vector<std::int32_t> changed(ground.size(), -1);  // in which sweep, last
  std::vector<std::uint8_t> at_roof(ground.size(), 0);
  std::vector<std::uint8_t> has_lowered(cut.size(), 0);
  for (std::size_t v = 0; v < start.size(); ++v) {
    const BuildingIndex b = building[v];
    if (b == kNoBuilding || cut[static_cast<std::size_t>(b)] == 0) continue;
    start[v] = roofs[static_cast<std::size_t>(b)];
    at_roof[v] = 1;
    changed[v] = 0;
  }
  const double beyond = std::max(slopes.at_roof, slopes.beyond);
  const auto lower = [&](std::size_t v, std::size_t a, std::size_t b) {
    const double slope = at_roof[a] != 0 || at_roof[b] != 0 ? slopes.at_roof : beyond;
    const double most =
        highest_at(mesh.vertices[v], mesh.vertices[a], start[a], mesh.vertices[b], start[b], slope);
    if (!(most < ground[v] - kWorthwhile)) return false;
    ground[v] = most;
    start[v] = std::min(start[v], most);
    for (const std::size_t u : {a, b})
      if (at_roof[u] != 0) has_lowered[static_cast<std::size_t>(building[u])] = 1;
    return true;
  };
  bool again = true;
  for (std::int32_t sweep = 1; again; ++sweep) {
    again = false;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto corner = [&](std::size_t k) {
        return static_cast<std::size_t>(mesh.triangles[t][k % 3]);
      };
      const auto is_recent = [&](std::size_t k) { return changed[corner(k)] >= sweep - 1; };
      if (mesh.region[t] != kNoBuilding || !(is_recent(0) || is_recent(1) || is_recent(2)))
        continue;
      for (std::size_t i = 0; i < 3; ++i) {
        if (!lower(corner(i), corner(i + 1), corner(i + 2))) continue;
        changed[corner(i)] = sweep;
        again = true;
      }
    }
  }
  std::vector<BuildingIndex> lowered;
  for (std::size_t b = 0; b < has_lowered.size(); ++b)
    if (has_lowered[b] != 0) lowered.push_back(static_cast<BuildingIndex>(b));
  return lowered;
}

std::int64_t mark_buried_roofs(const ColumnMesh& mesh, const ColumnPlan& plan,
                               const AngleBounds& bounds, std::vector<std::uint8_t>& cut) {
  std::int64_t marked = 0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    if (mesh.inside_building(t)) continue;
    double highest = -kInfinity;
    for (const VertexIndex v : mesh.ground.triangles[t])
      highest = std::max(highest, plan.ground[static_cast<std::size_t>(v)]);
    const auto is_buried = [&](VertexIndex v) {
      const BuildingIndex b = plan.building[static_cast<std::size_t>(v)];
      return b != kNoBuilding && cut[static_cast<std::size_t>(b)] == 0 &&
             highest > plan.roofs[static_cast<std::size_t>(b)];
    };
    const auto& corners = mesh.ground.triangles[t];
    if (std::none_of(corners.begin(), corners.end(), is_buried) ||
        count_bad_cells_over(mesh, t, bounds) == 0)
      continue;
    for (const VertexIndex v : corners) {
      if (!is_buried(v)) continue;
      cut[static_cast<std::size_t>(plan.building[static_cast<std::size_t>(v)])] = 1;
      ++marked;
    }
  }
  return marked;
}

std::int64_t count_bad_cells(const ColumnMesh& mesh, std::span<const BuildingIndex> building,
                             const AngleBounds& bounds, std::span<const std::uint8_t> cut) {
  std::int64_t bad = 0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto& corners = mesh.ground.triangles[t];
    const auto touches = [&](VertexIndex v) {
      const BuildingIndex b = building[static_cast<std::size_t>(v)];
      return b != kNoBuilding && cut[static_cast<std::size_t>(b)] != 0;
    };
    if (!mesh.inside_building(t) && std::any_of(corners.begin(), corners.end(), touches))
      bad += count_bad_cells_over(mesh, t, bounds);
  }
  return bad;
}

}  // namespace tetropolis
