// A prism between two heights of a triangle, and its faces, as OpenFOAM's checkMesh sees them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

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

/// The prisms over a triangle of a mesh, from the ground up, as its nodes are when they are asked
/// for. The mesh stays where it is.
class PrismStack {
 public:
  PrismStack(const ColumnMesh& mesh, TriangleIndex t);
  std::int32_t count() const { return count_; }
  /// Precondition: 0 <= layer < count().
  Prism prism(std::int32_t layer) const {
    return prism_between(corners(layer), corners(layer + 1));
  }
  Point3 centre(std::int32_t layer) const;

 private:
  std::array<Point3, 3> corners(std::int32_t level) const;

  const ColumnMesh* mesh_;
  std::int32_t count_;
  std::int32_t layers_;  ///< Of them, below the columns.
  std::array<Point2, 3> at_{};
  std::array<NodeIndex, 3> layer_node_{}, floor_{};
};

/// The same with the stacks beyond its sides.
class PrismSurroundings {
 public:
  PrismSurroundings(const ColumnMesh& mesh, TriangleIndex t);
  const PrismStack& stack() const { return stack_; }
  /// Whether a prism is beyond the side from corner i to the next of prism `layer`.
  bool has_beyond(std::size_t i, std::int32_t layer) const {
    const std::int32_t beside = layer + beyond_[i].above;
    return beyond_[i].stack && beside >= 0 && beside < beyond_[i].stack->count();
  }
  /// Precondition of these two: has_beyond(i, layer).
  TriangleIndex triangle_beyond(std::size_t i) const { return beyond_[i].triangle; }
  Point3 centre_beyond(std::size_t i, std::int32_t layer) const {
    return beyond_[i].stack->centre(layer + beyond_[i].above);
  }

 private:
  struct Beyond {
    TriangleIndex triangle = kNoTriangle;
    std::int32_t above = 0;  ///< Its prism k + above is beside prism k.
    std::optional<PrismStack> stack;
  };
  PrismStack stack_;
  std::array<Beyond, 3> beyond_;
};

/// Cosine of the angle between a face's area and the line between the centres of the cells at it;
/// the area leaves the first.
double cosine_across(const PrismFace& face, const Point3& from, const Point3& to);

/// How far that line passes by the face's centre, in terms of the face's extent that way.
double skewness_across(const PrismFace& face, const Point3& from, const Point3& to);

/// The same of a face on the boundary, for the perpendicular from the centre of its cell.
double skewness_at_boundary(const PrismFace& face, const Point3& from);

}  // namespace tetropolis
