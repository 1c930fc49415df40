// The longest edge wanted at each place: small near buildings, growing with the distance.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "tetropolis/geometry/types.h"
#include "tetropolis/ground/mesh_ground.h"

namespace tetropolis {

/// An area in which edges are at most `size` long, metres, > 0.
struct SizeSource {
  const Polygon* area = nullptr;
  double size = 0;
  bool inside = true;  ///< False: only its outline counts.
};

/// The least over all sources of their size plus `slope` times the distance from them, and at most
/// `far_size`. So it is Lipschitz with the constant `slope`, and what it is at a place depends on
/// sources up to far_size / slope away alone.
///
/// A quadtree whose leaves know the edges that can be nearest to a point of theirs (most have fewer
/// than nine); in a leaf the field differs by less than half from its middle. Reading it takes a
/// walk down the tree, any number of threads at a time.
class SizeField {
 public:
  /// Over `box`, which is not empty.
  SizeField(std::span<const SizeSource> sources, const Bounds2& box, double far_size, double slope);

  /// Precondition: p lies in the box.
  double operator()(Point2 p) const;

  /// Pairs of size and area, square metres, that cover the box.
  std::vector<std::pair<double, double>> sizes() const;

 private:
  struct Area {
    Polygon polygon;
    double size;
  };
  struct Edge {
    Point2 a, b;
    double size;
  };
  struct Node {
    std::int32_t children = -1;  ///< The first of four, or -1.
    std::int32_t edges_begin = 0, edges_end = 0;
    std::int32_t areas_begin = 0, areas_end = 0;
    double most = 0;  ///< The field is at most this in the node.
  };

  double at(Point2 p, const Node& leaf) const;
  void build(std::size_t node, Point2 middle, double half, std::span<const std::int32_t> edges,
             std::span<const std::int32_t> areas, int depth);
  void collect(const Node& node, Point2 middle, double half,
               std::vector<std::pair<double, double>>& sizes) const;

  Bounds2 box_;
  double slope_;
  double least_ = 0;  ///< The least size of any source.
  Point2 middle_;     ///< Of the root, a square.
  double half_ = 0;
  std::vector<Area> areas_;
  std::vector<Edge> edges_;
  std::vector<Node> nodes_;
  std::vector<std::int32_t> leaf_edges_, leaf_areas_;
};

/// Throws Error(kUsage) unless sizes and growth are in the ranges that mesh_ground.h states.
void require_sizes(double mesh_size, const SizeGrading& grading);

/// The field of a mesh around `buildings` (whose insides it does not know). Precondition: those of
/// require_sizes.
SizeField graded_sizes(std::span<const Polygon* const> buildings, const Bounds2& box,
                       double mesh_size, const SizeGrading& grading);

/// Whether the mesh has sizes that differ by place.
inline bool is_graded(double mesh_size, const SizeGrading& grading) {
  return grading.far_size > mesh_size || !grading.regions.empty();
}

}  // namespace tetropolis
