// Unions, differences and intersections on the grid of steps (grid_geometry.h), which GEOS
// computes.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// What unions of very many polygons call between their parts, from any of their threads: it stops
/// them by throwing. May be empty.
using Poll = std::function<void()>;

/// Union of valid polygons, on the grid: valid polygons with disjoint interiors that touch at most
/// in points. Noded in floating point and rounded where the result stays valid, otherwise noded on
/// the grid. Throws Error(kGuarantee) where GEOS gives up on both.
std::vector<Polygon> unite_on_grid(std::span<const Polygon> polygons, const Poll& poll = {});

/// The same; but where all are slivers that go flat on the grid, the largest of them stands for
/// all: never empty, unless `polygons` is.
std::vector<Polygon> unite_or_largest(std::span<const Polygon> polygons, const Poll& poll = {});

/// `a`, which is such a result, and `b`, on the grid, as above: faster than uniting all where `b`
/// are many small fills.
std::vector<Polygon> add_on_grid(std::span<const Polygon> a, std::span<const Polygon> b);

/// `a`, which is such a result, without `b`: noded on the grid, or in floating point and rounded
/// where GEOS gives up on that. Throws as above.
std::vector<Polygon> subtract_on_grid(std::span<const Polygon> a, std::span<const Polygon> b);

/// What `a` and `b` have in common, likewise.
std::vector<Polygon> intersect_on_grid(std::span<const Polygon> a, std::span<const Polygon> b);

}  // namespace tetropolis
