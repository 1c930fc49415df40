#include "assign_members.h"

#include <utility>

#include "tetropolis/geometry/polygon.h"

#include "city/grid_geometry.h"
#include "geometry/geos.h"

namespace tetropolis {

namespace {

/// Square steps; 0 where GEOS gives up.
double overlap(const Polygon& a, const Polygon& b) {
  const auto common = geos::intersect({&a, 1}, {&b, 1}, 1.0);
  double sum = 0;
  if (common)
    for (const Polygon& polygon : *common) sum += area(polygon);
  return sum;
}

}  // namespace

std::vector<SplitPart> assign_members(const std::vector<Polygon>& parts, std::size_t kept,
                                      double least, std::span<const Polygon> cleaned,
                                      std::vector<BuildingIndex>& members) {
  std::vector<SplitPart> result;
  std::vector<std::vector<BuildingIndex>> of_part(parts.size());
  std::vector<Bounds2> boxes;
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    boxes.push_back(bounds(parts[i]));
    if (i != kept && area(parts[i]) >= least) candidates.push_back(i);
  }
  if (candidates.empty()) return result;
  for (const BuildingIndex m : members) {
    const Polygon member = grid::to_steps(cleaned[m]);
    const Bounds2 box = bounds(member);
    std::size_t best = kept;
    double most = 0;
    for (const std::size_t i : candidates) {
      if (!box.intersects(boxes[i])) continue;
      const double common = overlap(member, parts[i]);
      if (common > most) {
        most = common;
        best = i;
      }
    }
    if (best != kept && overlap(member, parts[kept]) >= most) best = kept;
    of_part[best].push_back(m);
  }
  if (of_part[kept].empty()) return result;
  for (const std::size_t i : candidates)
    if (!of_part[i].empty()) result.push_back({parts[i], std::move(of_part[i])});
  members = std::move(of_part[kept]);
  return result;
}

}  // namespace tetropolis
