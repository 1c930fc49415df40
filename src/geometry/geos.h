// The few GEOS operations the library uses, on plain polygons. Each call has a context of its own,
// so calls may run at the same time. Private to the library: no public header includes it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis::geos {

/// All results are lists of polygons with disjoint interiors, each with its outer ring
/// counter-clockwise and its holes clockwise, ordered by the lowest then leftmost vertex of the
/// outer ring; points and lines are left out. `grid` > 0: the result is noded on multiples of
/// `grid`, which closes cracks along edges that both lists share (rounding afterwards would not);
/// 0: in floating point. nullopt where GEOS gave up.
using Result = std::optional<std::vector<Polygon>>;

/// The order of results, by their outer rings, and of the holes of each: by the first vertex, which
/// is the lowest, then leftmost one of its ring.
bool comes_before(const Ring& a, const Ring& b);

/// Union of valid polygons (which may overlap).
Result unite(std::span<const Polygon> polygons, double grid);

/// a and b together; both are lists of valid polygons with disjoint interiors.
Result join(std::span<const Polygon> a, std::span<const Polygon> b, double grid);

/// a without b; both are lists of valid polygons, `a` with disjoint interiors.
Result subtract(std::span<const Polygon> a, std::span<const Polygon> b, double grid);

/// a and b; both are lists of valid polygons with disjoint interiors.
Result intersect(std::span<const Polygon> a, std::span<const Polygon> b, double grid);

/// All points within `distance` of the polygons, which are valid; `distance` < 0: all that are
/// farther than that inside. With square corners, bevelled where they are sharper than about 23
/// degrees.
Result offset(std::span<const Polygon> polygons, double distance);

/// The faces that the rings of all polygons divide the plane into, the one around all left out.
/// Rings are noded on multiples of `grid` first, so faces have the same vertices along what they
/// share; ends of lines that bound nothing are left out.
Result faces(std::span<const Polygon> polygons, double grid);

/// Valid in the OGC sense: rings may touch in points.
bool is_valid(std::span<const Polygon> polygons);

/// A valid version of any polygon with finite coordinates: what its outer ring encloses less what
/// its holes enclose.
Result make_valid(const Polygon& polygon);

}  // namespace tetropolis::geos
