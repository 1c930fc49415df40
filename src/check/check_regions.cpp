#include "check_regions.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include <fmt/format.h>

#include "building_name.h"
#include "core/infinity.h"
#include "footprint_grid.h"
#include "violations.h"

namespace tetropolis {

std::vector<Violation> check_regions(const TetMesh& mesh, std::array<double, 3> shift,
                                     const CityModel& city) {
  if (mesh.region.size() != mesh.cell_count())
    return {{"no region for every cell", 1,
             fmt::format("{} regions, {} cells", mesh.region.size(), mesh.cell_count())}};
  const FootprintGrid footprints(city);
  std::vector<double> lowest_roof;  // per building
  for (const Building& building : city.buildings) {
    double roof = building.h_roof;
    for (const RoofPart& part : building.parts)
      for (const Point2 p : part.outline.outer) roof = std::min(roof, part.roof(p));
    lowest_roof.push_back(roof);
  }
  const auto look = [&](std::size_t begin, std::size_t end, std::vector<Violation>& violations) {
    for (std::size_t c = begin; c < end; ++c) {
      double x = shift[0], y = shift[1], lowest = kInfinity;
      const auto corners = c < mesh.cells.size()
                               ? std::span<const std::int64_t>(mesh.cells[c])
                               : std::span<const std::int64_t>(mesh.wedges[c - mesh.cells.size()]);
      for (const std::int64_t v : corners) {
        const Point3& p = mesh.points[static_cast<std::size_t>(v)];
        x += p[0] / static_cast<double>(corners.size());
        y += p[1] / static_cast<double>(corners.size());
        lowest = std::min(lowest, p[2] + shift[2]);
      }
      if (!std::isfinite(x) || !std::isfinite(y)) {
        note_violation(violations, "cells whose coordinates are not finite",
                       [&] { return fmt::format("cell {}", c); });
        continue;
      }
      const BuildingIndex expected = footprints.at(x, y);
      // Above the lid cells are wider than what they stand over.
      const bool is_high = expected != kNoBuilding && lowest > lowest_roof[expected];
      if (is_high && mesh.region[c] == kNoBuilding.value()) continue;
      if (mesh.region[c] != expected)
        note_violation(violations, "cells with the wrong region", [&] {
          return fmt::format("cell {} says {}, it stands over {}", c,
                             building_name(city, BuildingIndex(mesh.region[c])),
                             building_name(city, expected));
        });
    }
  };
  return sum_of_violations(mesh.region.size(), look);
}

}  // namespace tetropolis
