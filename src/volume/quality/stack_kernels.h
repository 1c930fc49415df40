// Loops up the cells of a stack and the faces beside it, compiled for vectors.
//
// A cell is what is between two fronts of its stack: they are its lower and upper face, and the two
// others stand on sides of the triangle. So a cell costs one normal, one root and a few products.
// Figures differ from those of tet_cosines(), face_shape() and boundary_skewness() by rounding, and
// are the same on every machine.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/geometry/types.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// The fronts that climb over a triangle, from its floor to the top.
struct Fronts {
  std::array<Point2, 3> corner{};    ///< In ascending order of vertices, as all that follows.
  double turn = 1;                   ///< -1: that is not the triangle's order.
  std::array<const double*, 3> z{};  ///< Per column: its elevation in each of cells + 1 fronts.
  std::size_t cells = 0;             ///< From each front to the next, one column rises.
};

/// The fronts over some triangles.
class FrontStore {
 public:
  void clear() { places_.clear(), used_ = 0; }
  void add(const ColumnMesh& mesh, TriangleIndex t);
  /// Over the i-th triangle added; until the next is.
  Fronts operator[](std::size_t i) const;

 private:
  struct Place {
    Fronts fronts;  // without z
    std::size_t first = 0;
  };
  std::vector<Place> places_;
  std::vector<double> z_;  // per triangle 3 rows of cells + 1
  std::size_t used_ = 0;
};

/// The faces over a side of a triangle, upwards: each has a node of either end and, above one of
/// them, a third.
struct Strip {
  std::vector<double> a, b;      ///< Elevation at the lower and the upper vertex of the side; one
                                 ///< more than faces, for the top.
  std::vector<double> opposite;  ///< Of the front's third node: with the face's, the cell behind.
  std::size_t faces = 0;
};

/// Over the side opposite to corner `i`.
void gather_strip(const Fronts& fronts, std::size_t i, Strip& strip);

/// Extremes over some cells: cosines of the least and greatest dihedral angle, squared aspect
/// ratio.
struct CellFigures {
  double greatest = -1, least = 1, aspect2 = 0;
  std::int64_t inverted = 0;  ///< How many have a volume <= 0.
};

/// Over some faces: the least squared cosine of non-orthogonality, the greatest squared skewness.
struct FaceFigures {
  double straight2 = 1, skewness2 = 0;
};

class StackKernels {
 public:
  /// Measures the cells over a triangle and the faces between them.
  void measure(const Fronts& fronts);
  const CellFigures& cells() const { return cells_; }
  const FaceFigures& faces() const { return faces_; }
  /// Per cell: cosine of its least dihedral angle, and squared aspect ratio.
  std::span<const double> greatest() const { return row(kGreatest); }
  std::span<const double> aspect2() const { return row(kAspect2); }

  /// Of faces between two stacks: the last `count` of the strips at a-b, seen from the two corners
  /// opposite to it.
  FaceFigures measure_between(Point2 a, Point2 b, const std::array<Point2, 2>& opposite,
                              const std::array<Strip, 2>& strips, std::size_t count);

 private:
  // clang-format off
  enum Row : std::size_t {
    kNormalX, kNormalY, kNormalZ, kArea, kEdge2, kSide0, kSide1, kSide2,  // per front
    kGreatest, kLeast, kAspect2, kVolumes, kX, kY, kFrom, kTo,            // per cell
    kStraight2, kSkewness2,                                               // per face
    kRows
  };
  // clang-format on
  double* at(Row r) { return rows_.data() + r * stride_; }
  std::span<const double> row(Row r) const { return {rows_.data() + r * stride_, size_}; }
  void make_room(std::size_t cells);

  std::vector<double> rows_;
  std::size_t stride_ = 0, size_ = 0;
  CellFigures cells_;
  FaceFigures faces_;
};

}  // namespace tetropolis
