// A prism between two heights of a triangle, and its faces, as OpenFOAM's checkMesh sees them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "tetropolis/geometry/types.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// Made of the triangles between its edges and the mean of its corners.
struct PrismFace {
  std::array<Point3, 4> corners{};
  std::size_t count = 0;  ///< Of corners: 3 or 4.
  Point3 area{};          ///< Vector, outwards.
  Point3 centre{};
  double flatness = 1;  ///< Its area over that of these triangles.
};

struct Prism {
  std::array<PrismFace, 5> faces;  ///< Its lower face, its upper one, and those over the sides from
                                   ///< corner i to the next.
  Point3 centre{};
  double volume = 0;
};

/// Corners of the lower and of the upper face, each above the other, counter-clockwise from above.
Prism prism_between(const std::array<Point3, 3>& low, const std::array<Point3, 3>& high);

/// Prism `layer` of the stack over triangle t.
Prism prism_at(const ColumnMesh& mesh, TriangleIndex t, std::int32_t layer);

/// The triangle beyond the side from corner i to the next; kNoTriangle on the rim.
TriangleIndex triangle_beyond(const ColumnMesh& mesh, TriangleIndex t, std::size_t i);

/// Cosine of the angle between a face's area and the line between the centres of the cells at it;
/// the area leaves the first.
double cosine_across(const PrismFace& face, const Point3& from, const Point3& to);

/// How far that line passes by the face's centre, in terms of the face's extent that way.
double skewness_across(const PrismFace& face, const Point3& from, const Point3& to);

/// The same of a face on the boundary, for the perpendicular from the centre of its cell.
double skewness_at_boundary(const PrismFace& face, const Point3& from);

}  // namespace tetropolis
