#include "tetropolis/geometry/domain.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tetropolis/geometry/polygon.h"

namespace tetropolis {

bool Domain::is_meshable() const {
  return std::isfinite(box_.xmin) && std::isfinite(box_.ymin) && std::isfinite(box_.xmax) &&
         std::isfinite(box_.ymax) && box_.xmin < box_.xmax && box_.ymin < box_.ymax;
}

Polygon Domain::outline() const { return rectangle(box_); }

std::vector<Domain::Side> Domain::sides() const {
  constexpr std::array kPatches{Patch::kYMin, Patch::kXMax, Patch::kYMax, Patch::kXMin};
  const Ring ring = outline().outer;
  std::vector<Side> sides;
  for (std::size_t i = 0; i < ring.size(); ++i)
    sides.push_back({ring[i], ring[(i + 1) % ring.size()], kPatches[i]});
  return sides;
}

bool Domain::encloses(Point2 p) const {
  return p.x > box_.xmin && p.x < box_.xmax && p.y > box_.ymin && p.y < box_.ymax;
}

bool Domain::covers(const Polygon& polygon) const {
  return position_of(polygon) == DomainPosition::kInside;
}

DomainPosition Domain::position_of(const Polygon& polygon) const {
  const Bounds2 box = tetropolis::bounds(polygon);
  if (box.empty()) return DomainPosition::kInside;
  if (!box.intersects(box_)) return DomainPosition::kOutside;
  return box_.covers(box) ? DomainPosition::kInside : DomainPosition::kCrossing;
}

double Domain::distance_to_side(std::size_t side, Point2 p) const {
  switch (side) {
    case 0:
      return p.y - box_.ymin;
    case 1:
      return box_.xmax - p.x;
    case 2:
      return box_.ymax - p.y;
    default:
      return p.x - box_.xmin;
  }
}

double Domain::distance_to_boundary(Point2 p) const {
  return std::min({p.x - box_.xmin, box_.xmax - p.x, p.y - box_.ymin, box_.ymax - p.y});
}

}  // namespace tetropolis
