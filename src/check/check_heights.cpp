#include "check_heights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "building_name.h"
#include "core/disjoint_sets.h"
#include "core/infinity.h"
#include "core/sort_once.h"
#include "core/units.h"
#include "roof_planes.h"
#include "vector3.h"
#include "violations.h"

namespace tetropolis {

namespace {

constexpr double kHeightTolerance = 1e-9;
constexpr double kSnapped = 0.01;              // metres; planes that meet do so to millimetres
constexpr double kExcavationTolerance = 1e-5;  // metres; good to a nanometre a triangle
constexpr double kNeedTolerance = 1e-6;        // metres; whether ground had to be lowered

/// Bilinear interpolation, written out anew, in the coordinates of the reference system: those are
/// what the files share.
double height_of_terrain(const Raster& dtm, Point2 origin, double local_x, double local_y) {
  const double x = local_x + origin.x - (dtm.x0 + origin.x);
  const double y = local_y + origin.y - (dtm.y0 + origin.y);
  const double gx = std::min(std::max(x / dtm.step, 0.0), dtm.nx - 1.0);
  const double gy = std::min(std::max(y / dtm.step, 0.0), dtm.ny - 1.0);
  const double i = std::min(std::floor(gx), std::max(dtm.nx - 2.0, 0.0));
  const double j = std::min(std::floor(gy), std::max(dtm.ny - 2.0, 0.0));
  const double s = gx - i, t = gy - j;
  const auto node = [&](double column, double row) {
    const auto c = static_cast<std::int32_t>(std::min(column, dtm.nx - 1.0));
    const auto r = static_cast<std::int32_t>(std::min(row, dtm.ny - 1.0));
    return dtm.at(c, r);
  };
  return (1 - s) * (1 - t) * node(i, j) + s * (1 - t) * node(i + 1, j) +
         (1 - s) * t * node(i, j + 1) + s * t * node(i + 1, j + 1);
}

/// The terrain at the vertices of ground faces, and the highest at their neighbours there.
struct Terrain {
  std::vector<double> at;       ///< Not a number elsewhere, and where a vertex is not finite.
  std::vector<double> highest;  ///< At the vertex and those it has an edge to.
};

/// At all vertices of a piece of water, the median of the terrain along its shore; where two pieces
/// meet in a corner, the lower.
void level_water(const SurfaceMesh& surface, std::vector<double>& terrain) {
  const auto water =
      std::find_if(surface.patches.begin(), surface.patches.end(), [](const PatchInfo& patch) {
        return patch.kind == PatchKind::kGround && patch.name == "water";
      });
  if (water == surface.patches.end()) return;
  std::vector<std::uint8_t> on_shore(surface.points.size(), 0);
  DisjointSets<std::size_t> pieces(surface.triangles.size());
  std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> face_at;  // an edge
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    const PatchKind kind = surface.patch_of(f).kind;
    if (kind != PatchKind::kGround && kind != PatchKind::kWall) continue;
    const std::array<std::int32_t, 3>& corners = surface.triangles[f];
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t v = corners[i], next = corners[(i + 1) % 3];
      if (surface.patch[f] != water->patch)
        on_shore[static_cast<std::size_t>(v)] = 1;
      else
        pieces.join(f, face_at.try_emplace(std::minmax(v, next), f).first->second);
    }
  }
  std::map<std::size_t, std::vector<std::size_t>> vertices;
  for (std::size_t f = 0; f < surface.triangles.size(); ++f)
    if (surface.patch[f] == water->patch)
      for (const std::int32_t v : surface.triangles[f])
        vertices[pieces.root(f)].push_back(static_cast<std::size_t>(v));
  std::vector<double> levels(terrain.size(), kInfinity);
  for (auto& [root, own] : vertices) {
    sort_once(own);
    std::array<std::vector<double>, 2> heights;  // off the shore, and on it
    for (const std::size_t v : own)
      if (!std::isnan(terrain[v])) heights[on_shore[v]].push_back(terrain[v]);
    std::vector<double>& values = heights[heights[1].empty() ? 0 : 1];
    if (values.empty()) continue;
    std::sort(values.begin(), values.end());
    for (const std::size_t v : own) levels[v] = std::min(levels[v], values[values.size() / 2]);
  }
  for (std::size_t v = 0; v < terrain.size(); ++v)
    if (levels[v] < kInfinity && !std::isnan(terrain[v])) terrain[v] = levels[v];
}

Terrain terrain_of(const SurfaceMesh& surface, std::array<double, 3> shift, const Raster& dtm,
                   const CityModel& city, const std::vector<double>& layers) {
  Terrain terrain{std::vector<double>(surface.points.size(), std::nan("")),
                  std::vector<double>(surface.points.size(), -kInfinity)};
  const auto for_each_ground_face = [&](const auto& visit) {
    for (std::size_t f = 0; f < surface.triangles.size(); ++f)
      if (surface.patch_of(f).kind == PatchKind::kGround) visit(surface.triangles[f]);
  };
  for_each_ground_face([&](const std::array<std::int32_t, 3>& face) {
    for (const std::int32_t v : face) {
      double& height = terrain.at[static_cast<std::size_t>(v)];
      const auto& p = surface.points[static_cast<std::size_t>(v)];
      if (std::isnan(height) && is_finite(p))
        height = height_of_terrain(dtm, city.origin, p[0] + shift[0], p[1] + shift[1]);
    }
  });
  level_water(surface, terrain.at);
  for (std::size_t v = 0; v < terrain.at.size(); ++v) terrain.at[v] += layers[v];
  for_each_ground_face([&](const std::array<std::int32_t, 3>& face) {
    double highest = -kInfinity;
    for (const std::int32_t v : face)
      highest = std::fmax(highest, terrain.at[static_cast<std::size_t>(v)]);
    for (const std::int32_t v : face) {
      double& around = terrain.highest[static_cast<std::size_t>(v)];
      around = std::max(around, highest);
    }
  });
  return terrain;
}

/// Per vertex of a wall, what of_building(b, v) says for its building; infinity elsewhere.
template <typename OfBuilding>
std::vector<double> at_walls(const SurfaceMesh& surface, const CityModel& city,
                             const OfBuilding& of_building) {
  std::vector<double> values(surface.points.size(), kInfinity);
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    const BuildingIndex b = surface.building[f];
    if (surface.patch_of(f).kind != PatchKind::kWall || b < 0 ||
        static_cast<std::size_t>(b) >= city.buildings.size())
      continue;
    for (const std::int32_t corner : surface.triangles[f]) {
      const auto v = static_cast<std::size_t>(corner);
      values[v] = of_building(static_cast<std::size_t>(b), v);
    }
  }
  return values;
}

/// The lowest vertex of a roof at each place of the plan.
class LowestRoofs {
 public:
  explicit LowestRoofs(const SurfaceMesh& surface) {
    for (std::size_t f = 0; f < surface.triangles.size(); ++f)
      if (surface.patch_of(f).kind == PatchKind::kRoof)
        for (const std::int32_t v : surface.triangles[f]) {
          const auto& p = surface.points[static_cast<std::size_t>(v)];
          if (is_finite(p)) roofs_.push_back(p);
        }
    std::sort(roofs_.begin(), roofs_.end());
  }
  /// Vertices of one column have the same x and y. Infinity where there is no roof.
  double at(const Point3& p) const {
    const auto it = std::lower_bound(roofs_.begin(), roofs_.end(), Point3{p[0], p[1], -kInfinity});
    return it != roofs_.end() && (*it)[0] == p[0] && (*it)[1] == p[1] ? (*it)[2] : kInfinity;
  }

 private:
  std::vector<Point3> roofs_;
};

/// Per vertex of a wall, the elevation of the roof over it; infinity elsewhere. Of buildings of
/// several roofs that is the lowest, as the mesh has it: whether it is right is looked at by
/// itself.
std::vector<double> roofs_over_walls(const SurfaceMesh& surface, double z_shift,
                                     const CityModel& city) {
  const LowestRoofs lowest(surface);
  return at_walls(surface, city, [&](std::size_t b, std::size_t v) {
    const Building& building = city.buildings[b];
    return building.parts.empty() ? building.h_roof : lowest.at(surface.points[v]) + z_shift;
  });
}

/// The least of height + slope * distance from p along the line from a to b, whose ends have these
/// heights: by golden section, since it is convex. The ends count even where the other is not there
/// (infinity).
double least_along(Point2 p, Point2 a, double at_a, Point2 b, double at_b, double slope) {
  const auto value = [&](double t) {
    const double x = a.x + t * (b.x - a.x), y = a.y + t * (b.y - a.y);
    return at_a + t * (at_b - at_a) + slope * std::hypot(p.x - x, p.y - y);
  };
  const double ends = std::min(at_a + slope * std::hypot(p.x - a.x, p.y - a.y),
                               at_b + slope * std::hypot(p.x - b.x, p.y - b.y));
  if (at_a == kInfinity || at_b == kInfinity) return ends;
  const double golden = (std::sqrt(5.0) - 1) / 2;
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double left = high - golden * (high - low), right = low + golden * (high - low);
    if (value(left) < value(right))
      high = right;
    else
      low = left;
  }
  return std::min(ends, value((low + high) / 2));
}

/// From where terrain was excavated, per vertex.
struct Starts {
  std::vector<double> z;      ///< Elevation; infinity: not from there.
  std::vector<double> slope;  ///< Tangent; infinity: not from there.
};

/// Lowers `depth` (elevation per vertex, infinity: none) of vertices below the terrain to where
/// they would be if it were excavated from `starts`, and from what was excavated before, to the
/// slope that belongs to it. Goes from vertex to vertex until nothing changes.
void excavate_depths(const SurfaceMesh& surface, double z_shift, const Terrain& terrain,
                     Starts starts, std::vector<double>& depth) {
  const auto is_below = [&](std::size_t v) {
    return surface.points[v][2] + z_shift < terrain.at[v] - kHeightTolerance;
  };
  std::vector<std::size_t> faces;
  std::map<std::size_t, std::vector<std::size_t>> faces_at;  // of the vertices of these
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    const auto& corners = surface.triangles[f];
    const auto below = [&](std::int32_t v) { return is_below(static_cast<std::size_t>(v)); };
    if (surface.patch_of(f).kind != PatchKind::kGround ||
        std::none_of(corners.begin(), corners.end(), below))
      continue;
    faces.push_back(f);
    for (const std::int32_t v : corners) faces_at[static_cast<std::size_t>(v)].push_back(f);
  }
  const auto start = [&](std::size_t u) { return std::min(depth[u], starts.z[u]); };
  const auto place = [&](std::size_t v) {
    return Point2{surface.points[v][0], surface.points[v][1]};
  };
  while (!faces.empty()) {
    std::set<std::size_t> next;
    for (const std::size_t f : faces)
      for (std::size_t i = 0; i < 3; ++i) {
        const auto corner = [&](std::size_t k) {
          return static_cast<std::size_t>(surface.triangles[f][k % 3]);
        };
        const std::size_t v = corner(i), a = corner(i + 1), b = corner(i + 2);
        if (!is_below(v)) continue;
        const double now = std::min(depth[v], terrain.at[v]);
        if (!(std::min(start(a), start(b)) < now)) continue;
        const double own = std::min(starts.slope[a], starts.slope[b]);
        const bool at_source = starts.z[a] < kInfinity || starts.z[b] < kInfinity;
        const double slope = at_source ? own : std::max(own, ExcavationSlopes{}.beyond);
        const double most = least_along(place(v), place(a), start(a), place(b), start(b), slope);
        if (!(most < now - kHeightTolerance)) continue;
        depth[v] = most;
        starts.slope[v] = std::min(starts.slope[v], own);
        next.insert(faces_at[v].begin(), faces_at[v].end());
      }
    faces.assign(next.begin(), next.end());
  }
}

/// Per vertex, how far down ground below the terrain may be because it was excavated; infinity
/// where it was not.
std::vector<double> depths_of(const SurfaceMesh& surface, std::array<double, 3> shift,
                              const Terrain& terrain, const CityModel& city,
                              const std::vector<double>& roofs,
                              const std::optional<ExcavationSources>& excavated) {
  constexpr double kSamePlace = 1e-6;  // metres
  const double gentlest = std::tan(to_radians(30));
  std::vector<double> depth(surface.points.size(), kInfinity);
  if (!excavated) {  // from anywhere
    Starts starts{roofs, std::vector(depth.size(), gentlest)};
    for (std::size_t v = 0; v < depth.size(); ++v)
      if (!std::isnan(terrain.at[v]))
        starts.z[v] = std::min(starts.z[v], surface.points[v][2] + shift[2]);
    excavate_depths(surface, shift[2], terrain, std::move(starts), depth);
    return depth;
  }
  const std::size_t buildings = city.buildings.size();
  std::vector<double> slopes(buildings, kInfinity);
  for (std::size_t i = 0; i < excavated->roofs.size(); ++i) {
    const auto b = static_cast<std::size_t>(excavated->roofs[i]);  // one beyond all, if negative
    if (b >= buildings) continue;
    slopes[b] = std::tan(to_radians(excavated->roof_slopes_deg[i]));
  }
  Starts starts{roofs,
                at_walls(surface, city, [&](std::size_t b, std::size_t) { return slopes[b]; })};
  for (std::size_t v = 0; v < starts.z.size(); ++v)
    if (starts.slope[v] == kInfinity) starts.z[v] = kInfinity;
  std::vector<std::pair<double, std::size_t>> by_x;
  for (std::size_t v = 0; v < surface.points.size(); ++v)
    if (!std::isnan(terrain.at[v])) by_x.emplace_back(surface.points[v][0] + shift[0], v);
  std::sort(by_x.begin(), by_x.end());
  for (std::size_t i = 0; i < excavated->toes.size(); ++i) {
    const Point3& toe = excavated->toes[i];
    for (auto it = std::lower_bound(by_x.begin(), by_x.end(),
                                    std::pair(toe[0] - kSamePlace, std::size_t{0}));
         it != by_x.end() && it->first <= toe[0] + kSamePlace; ++it) {
      const std::size_t v = it->second;
      if (std::abs(surface.points[v][1] + shift[1] - toe[1]) > kSamePlace) continue;
      starts.z[v] = std::min(starts.z[v], toe[2]);
      starts.slope[v] =
          std::min(starts.slope[v], std::tan(to_radians(excavated->toe_slopes_deg[i])));
      depth[v] = std::min(depth[v], toe[2]);
    }
  }
  excavate_depths(surface, shift[2], terrain, std::move(starts), depth);
  return depth;
}

/// A surface whose heights are looked at, and what they are compared with.
class HeightChecker {
 public:
  HeightChecker(const SurfaceMesh& surface, std::array<double, 3> shift, const Raster& dtm,
                const CityModel& city, double minimum_wall,
                const std::optional<ExcavationSources>& excavated,
                const std::vector<double>& layers)
      : surface_(surface),
        shift_(shift),
        city_(city),
        minimum_wall_(minimum_wall),
        layers_(layers),
        sources_known_(excavated.has_value()),
        terrain_(terrain_of(surface, shift, dtm, city, layers)),
        roofs_(roofs_over_walls(surface, shift[2], city)),
        depth_(depths_of(surface, shift, terrain_, city, roofs_, excavated)) {}

  HeightsCheck check();

 private:
  double elevation(std::size_t v) const { return surface_.points[v][2] + shift_[2]; }
  /// Of a wall above the layers: three fifths of these at least.
  double minimum_wall(std::size_t v) const {
    return std::max(minimum_wall_ - layers_[v], 0.6 * layers_[v]);
  }
  std::string place(std::size_t v, double wanted) const;
  void check_ground(std::size_t v);
  void check_roof(std::size_t f, const RoofPlanes& planes);

  const SurfaceMesh& surface_;
  std::array<double, 3> shift_;
  const CityModel& city_;
  double minimum_wall_;
  const std::vector<double>& layers_;
  bool sources_known_;  ///< From where the terrain was excavated.
  Terrain terrain_;
  std::vector<double> roofs_, depth_;
  std::set<std::pair<std::size_t, std::size_t>> looked_at_;  ///< Vertices and parts.
  HeightsCheck result_;
};

std::string HeightChecker::place(std::size_t v, double wanted) const {
  const auto& p = surface_.points[v];
  return fmt::format("vertex {} at ({:.3f}, {:.3f}): z = {:.9f}, {:.9f} expected", v, p[0], p[1],
                     elevation(v), wanted);
}

void HeightChecker::check_ground(std::size_t v) {
  ++result_.ground_vertices;
  if (!is_finite(surface_.points[v])) {
    note_violation(result_.violations, kCoordinatesNotFinite,
                   [&] { return fmt::format("vertex {}", v); });
    return;
  }
  const double wanted = terrain_.at[v];
  const double error = elevation(v) - wanted;
  if (std::abs(error) <= kHeightTolerance) {
    const double wall = roofs_[v] - elevation(v);
    result_.perhaps_lowered += std::abs(wall - minimum_wall(v)) <= kNeedTolerance ? 1 : 0;
    return;
  }
  const double above_depth = elevation(v) - depth_[v];
  const bool is_excavated = above_depth >= -kExcavationTolerance &&
                            (!sources_known_ || above_depth <= kExcavationTolerance);
  if (error > 0 || (roofs_[v] == kInfinity && !is_excavated)) {
    note_violation(result_.violations, "ground vertices off the terrain",
                   [&] { return place(v, wanted); });
    return;
  }
  ++result_.lowered;
  // Low walls are toes, too, and without a report nobody knows which.
  if (sources_known_ && !is_excavated &&
      terrain_.highest[v] <= roofs_[v] - minimum_wall(v) - kNeedTolerance)
    note_violation(result_.violations, "ground vertices lowered at walls that are high enough",
                   [&] { return place(v, wanted); });
}

/// A roof face: its building is in the city model.
void HeightChecker::check_roof(std::size_t f, const RoofPlanes& planes) {
  const std::array<std::int32_t, 3>& corners = surface_.triangles[f];
  const auto finite = [&](std::int32_t v) {
    return is_finite(surface_.points[static_cast<std::size_t>(v)]);
  };
  if (!std::all_of(corners.begin(), corners.end(), finite)) {
    note_violation(result_.violations, "roof vertices off the roof height",
                   [&] { return fmt::format("face {}", f); });
    return;
  }
  const auto place_of = [&](std::int32_t v) {
    const auto& p = surface_.points[static_cast<std::size_t>(v)];
    return Point2{p[0] + shift_[0], p[1] + shift_[1]};
  };
  const Point2 a = place_of(corners[0]), b = place_of(corners[1]), c = place_of(corners[2]);
  const BuildingIndex building = surface_.building[f];
  const std::optional<std::size_t> part =
      planes.part_at(building, {(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3});
  if (!part) {
    note_violation(result_.violations, "roof faces beside the parts of their building",
                   [&] { return fmt::format("face {} at ({:.3f}, {:.3f})", f, a.x, a.y); });
    return;
  }
  for (const std::int32_t corner : corners) {
    const auto v = static_cast<std::size_t>(corner);
    // Faces of one part at a vertex have the same floor there.
    if (!looked_at_.emplace(v, *part).second) continue;
    const Point2 p = place_of(corner);
    const double wanted = planes.height(building, *part, p);
    const double tolerance = planes.tolerance(building, *part);
    const double off = std::abs(elevation(v) - wanted);
    if (off <= tolerance) continue;
    const auto [low, high] = planes.range_at(building, p);
    if (elevation(v) < low - tolerance || elevation(v) > high + tolerance) {
      note_violation(result_.violations, "roof vertices off the roof height",
                     [&] { return place(v, wanted); });
      continue;
    }
    if (off > kSnapped) ++result_.roof_snapped;
    result_.most_snapped = std::max(result_.most_snapped, off);
  }
}

HeightsCheck HeightChecker::check() {
  const RoofPlanes planes(city_);
  std::vector<bool> on_ground(surface_.points.size(), false);
  std::map<std::int32_t, BuildingIndex> roof_building;
  for (std::size_t f = 0; f < surface_.triangles.size(); ++f)
    for (const std::int32_t v : surface_.triangles[f]) {
      if (surface_.patch_of(f).kind == PatchKind::kGround)
        on_ground[static_cast<std::size_t>(v)] = true;
      if (surface_.patch_of(f).kind == PatchKind::kRoof) roof_building[v] = surface_.building[f];
    }
  for (std::size_t v = 0; v < on_ground.size(); ++v)
    if (on_ground[v]) check_ground(v);
  const auto is_known = [&](BuildingIndex b) {
    return b >= 0 && b < BuildingIndex(city_.buildings.size());
  };
  for (const auto& [vertex, building] : roof_building) {
    ++result_.roof_vertices;
    if (!is_known(building))
      note_violation(result_.violations, "roofs of buildings that the city model lacks",
                     [&, b = building] { return building_name(city_, b); });
  }
  for (std::size_t f = 0; f < surface_.triangles.size(); ++f)
    if (surface_.patch_of(f).kind == PatchKind::kRoof && is_known(surface_.building[f]))
      check_roof(f, planes);
  return std::move(result_);
}

}  // namespace

HeightsCheck check_heights(const SurfaceMesh& surface, std::array<double, 3> shift,
                           const Raster& dtm, const CityModel& city, double minimum_wall,
                           const std::optional<ExcavationSources>& excavated,
                           const std::vector<double>& layers) {
  const std::vector<double> heights =
      layers.empty() ? std::vector(surface.points.size(), 0.0) : layers;
  SurfaceMesh lifted = surface;
  for (std::size_t v = 0; v < heights.size(); ++v) lifted.points[v][2] += heights[v];
  return HeightChecker(lifted, shift, dtm, city, minimum_wall, excavated, heights).check();
}

}  // namespace tetropolis
