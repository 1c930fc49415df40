// Polygons that are close to each other become one (the paper's Algorithms 2 and 3). Coordinates
// are steps throughout (grid_geometry.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/geometry/types.h"

#include "overlay.h"

namespace tetropolis {

/// What fills the gap between segments a-b and c-d: the convex hull of the parts of each that are
/// within `reach` of the other. Empty if that has no area. It generalises the hull of
/// VertexProjections (Algorithm 3), whose points are the ends of these parts, from the nearest
/// points of single vertices to the places where the gap becomes wider than `reach`; so the hull's
/// free sides are as long as `reach` and leave no short edges.
Ring gap_fill(Point2 a, Point2 b, Point2 c, Point2 d, double reach);

/// The smallest box in the direction from `from` to `to` that holds the points and is a little
/// wider than `distance`. Empty if the direction is none.
Polygon box_along(std::span<const Point2> points, Point2 from, Point2 to, double distance);

/// Whether two walls face each other: nearly parallel, apart, and opposite for a quarter of
/// `distance` or more.
bool edges_face(Point2 a, Point2 b, Point2 c, Point2 d, double distance);

/// How a cluster became one polygon.
enum class MergeMethod : std::uint8_t { kUnion, kGapFill, kBridge, kUnionOfHulls, kHull };

struct MergedPolygon {
  Polygon polygon;
  std::vector<Polygon> input;  ///< The plain union (unite_or_largest).
  MergeMethod method = MergeMethod::kUnion;
  int growths = 0;  ///< For kGapFill: the growth that joined them, from 1.
};

/// One polygon from a cluster (Algorithm 2): the union; if that has several parts, with gap fills
/// in the gaps narrower than `distance`, of `growths` reaches, the first as long as `distance` and
/// each twice the one before; then with a box across the narrowest place between every two parts,
/// which joins what touches in a point; then with the parts' hulls; then the hull of all. Whether
/// features inside the result are far enough apart is not checked here (repair.h does), which
/// keeps hulls rare where the paper's test of the whole polygon, applied to input that itself has
/// short edges, makes them common.
MergedPolygon merge_polygons(std::span<const Polygon> cluster, double distance, int growths,
                             const Poll& poll = {});

}  // namespace tetropolis
