#include "tetropolis/check/check_heights.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include <fmt/format.h>

#include "vector3.h"
#include "violations.h"

namespace tetropolis {

namespace {

constexpr double kHeightTolerance = 1e-9;
constexpr const char* kNotFinite = "coordinates that are not finite";

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

}  // namespace

HeightsCheck check_heights(const SurfaceMesh& surface, std::array<double, 3> shift,
                           const Raster& dtm, const CityModel& city) {
  HeightsCheck check;
  std::vector<bool> on_wall(surface.points.size(), false);
  std::vector<bool> on_ground(surface.points.size(), false);
  std::map<std::int32_t, BuildingIndex> roof_building;
  for (std::size_t f = 0; f < surface.triangles.size(); ++f)
    for (const std::int32_t v : surface.triangles[f]) {
      if (surface.patch[f] == Patch::kWall) on_wall[static_cast<std::size_t>(v)] = true;
      if (surface.patch[f] == Patch::kGround) on_ground[static_cast<std::size_t>(v)] = true;
      if (surface.patch[f] == Patch::kRoof) roof_building[v] = surface.building[f];
    }
  const auto place = [&](std::size_t v, double wanted) {
    const auto& p = surface.points[v];
    return fmt::format("vertex {} at ({:.3f}, {:.3f}): z = {:.9f}, {:.9f} expected", v, p[0], p[1],
                       p[2] + shift[2], wanted);
  };
  for (std::size_t v = 0; v < surface.points.size(); ++v) {
    if (!on_ground[v]) continue;
    ++check.ground_vertices;
    const auto& p = surface.points[v];
    if (!is_finite(p)) {
      note_violation(check.violations, kNotFinite, [&] { return fmt::format("vertex {}", v); });
      continue;
    }
    const double wanted = height_of_terrain(dtm, city.origin, p[0] + shift[0], p[1] + shift[1]);
    const double error = p[2] + shift[2] - wanted;
    if (std::abs(error) <= kHeightTolerance) continue;
    if (error < 0 && on_wall[v])
      ++check.lowered;
    else
      note_violation(check.violations, "ground vertices off the terrain",
                     [&] { return place(v, wanted); });
  }
  for (const auto& [vertex, building] : roof_building) {
    ++check.roof_vertices;
    const auto v = static_cast<std::size_t>(vertex);
    if (building < 0 || building >= static_cast<BuildingIndex>(city.buildings.size())) {
      note_violation(check.violations, "roofs of buildings that the city model lacks",
                     [&, building = building] { return fmt::format("building {}", building); });
      continue;
    }
    const double wanted = city.buildings[static_cast<std::size_t>(building)].h_roof;
    if (!(std::abs(surface.points[v][2] + shift[2] - wanted) <= kHeightTolerance))
      note_violation(check.violations, "roof vertices off the roof height",
                     [&] { return place(v, wanted); });
  }
  return check;
}

}  // namespace tetropolis
