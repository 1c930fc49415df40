// From a planar graph to a triangle store: the stages shared by triangulation and refinement.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/ground/triangulation.h"

#include "tri_mesh.h"

namespace tetropolis {

/// Region of what lies outside of the domain or in a hole.
inline constexpr std::int32_t kOutsideRegion = std::numeric_limits<std::int32_t>::min() + 1;

/// A triangulated graph. Subsegments' `piece` is the index of their input segment, or kHullSegment.
struct Construction {
  TriMesh mesh;
  std::vector<VertexIndex> input_vertex;
  std::int64_t crossings = 0;
};

/// Throws Error(kInput) as constrained_delaunay() says.
void check_graph(const PlanarGraph& graph);

/// Points only: removes duplicates and triangulates, with ghosts. The mesh has no triangles if the
/// points are collinear.
void insert_points(const PlanarGraph& graph, Construction& result);

/// Makes every input segment a chain of subsegments.
void insert_segments(const PlanarGraph& graph, Construction& result);

/// Sets the triangles' regions, kOutsideRegion for those to be left out and for ghosts. With
/// `convex_hull` (or no segments) hull edges become subsegments. The region is written as the
/// marker.
void classify(const PlanarGraph& graph, bool convex_hull, Construction& result);

/// All of the above, ghosts included.
Construction construct(const PlanarGraph& graph, bool convex_hull);

/// Removes ghosts and what lies outside.
void carve_outside(TriMesh& mesh);

/// The same, and numbers triangles along a Hilbert curve: what is near has numbers that are, and no
/// far place changes their order.
void carve_along_curve(TriMesh& mesh);

/// Copies the mesh into the public arrays. Subsegments' pieces are looked up in `piece_input` if
/// that is not empty.
Triangulation export_triangulation(const PlanarGraph& graph, const Construction& construction,
                                   const std::vector<std::int32_t>& piece_input);

}  // namespace tetropolis
