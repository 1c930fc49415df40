#include "tetropolis/geometry/domain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"
#include "geometry/predicates.h"

namespace tetropolis {

bool Domain::is_meshable() const {
  return std::isfinite(box_.xmin) && std::isfinite(box_.ymin) && std::isfinite(box_.xmax) &&
         std::isfinite(box_.ymax) && box_.xmin < box_.xmax && box_.ymin < box_.ymax;
}

Domain::Domain(Ring ring, std::vector<Patch> patches, std::vector<PatchInfo> own)
    : box_(tetropolis::bounds(ring)),
      ring_(std::move(ring)),
      side_patches_(std::move(patches)),
      own_patches_(std::move(own)) {
  if (ring_.size() < 3 || side_patches_.size() != ring_.size())
    throw Error(
        ErrorKind::kUsage,
        fmt::format("domain: {} patches for {} sides; give a patch for each of three or more",
                    side_patches_.size(), ring_.size()));
}

double Domain::area() const { return is_box() ? box_.width() * box_.height() : signed_area(ring_); }

Domain Domain::moved(Point2 by) const {
  Domain result = *this;
  result.box_ = box_.moved(by);
  for (Point2& p : result.ring_) p = {p.x + by.x, p.y + by.y};
  return result;
}

Polygon Domain::outline() const { return is_box() ? rectangle(box_) : Polygon{ring_, {}}; }

/// From the ring, negative outside of it.
double Domain::depth(Point2 p) const {
  double nearest = kInfinity;
  for (std::size_t i = 0, j = ring_.size() - 1; i < ring_.size(); j = i++)
    nearest = std::min(nearest, distance_to_segment(p, ring_[j], ring_[i]));
  return nearest == 0 || tetropolis::contains({ring_, {}}, p) ? nearest : -nearest;
}

std::vector<Domain::Side> Domain::sides() const {
  constexpr std::array kPatches{Patch::kYMin, Patch::kXMax, Patch::kYMax, Patch::kXMin};
  const Ring ring = outline().outer;
  std::vector<Side> sides;
  for (std::size_t i = 0; i < ring.size(); ++i)
    sides.push_back(
        {ring[i], ring[(i + 1) % ring.size()], is_box() ? kPatches[i] : side_patches_[i]});
  return sides;
}

bool Domain::encloses(Point2 p) const {
  if (!is_box()) return depth(p) > 0;
  return p.x > box_.xmin && p.x < box_.xmax && p.y > box_.ymin && p.y < box_.ymax;
}

bool Domain::covers(const Polygon& polygon) const {
  return position_of(polygon) == DomainPosition::kInside;
}

DomainPosition Domain::position_of(const Polygon& polygon) const {
  const Bounds2 box = tetropolis::bounds(polygon);
  if (box.empty()) return DomainPosition::kInside;
  if (!box.intersects(box_)) return DomainPosition::kOutside;
  if (!is_box()) {
    const auto is_inside = [&](Point2 p) { return depth(p) > 0; };
    const std::vector<Side> own = sides();
    bool crosses = false;
    for_each_edge({polygon.outer, {}}, [&](Point2 a, Point2 b) {
      for (const Side& side : own) crosses = crosses || segments_cross(a, b, side.from, side.to);
    });
    const auto& outer = polygon.outer;
    if (!crosses && std::all_of(outer.begin(), outer.end(), is_inside))
      return DomainPosition::kInside;
    const bool is_apart = !crosses && std::none_of(outer.begin(), outer.end(), is_inside) &&
                          !tetropolis::contains({outer, {}}, own.front().from);
    return is_apart ? DomainPosition::kOutside : DomainPosition::kCrossing;
  }
  return box_.covers(box) ? DomainPosition::kInside : DomainPosition::kCrossing;
}

double Domain::distance_to_side(std::size_t side, Point2 p) const {
  if (!is_box()) {
    const Point2 a = ring_[side], b = ring_[(side + 1) % ring_.size()];
    const double dx = b.x - a.x, dy = b.y - a.y;
    return (dx * (p.y - a.y) - dy * (p.x - a.x)) / std::hypot(dx, dy);
  }
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
  if (!is_box()) return depth(p);
  return std::min({p.x - box_.xmin, box_.xmax - p.x, p.y - box_.ymin, box_.ymax - p.y});
}

}  // namespace tetropolis
