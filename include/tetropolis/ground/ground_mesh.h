// The triangle mesh of the domain in which every footprint edge is a union of mesh edges.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tetropolis/core/indexed_vector.h"
#include "tetropolis/core/ragged_array.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/ground/region.h"

namespace tetropolis {

/// An edge of the mesh on a segment of the input: on a side of the domain or on the outline of a
/// region.
struct TaggedEdge {
  VertexIndex low, high;           ///< Its vertices, low < high.
  RegionIndex region = kNoRegion;  ///< Whose outline it lies on; kNoRegion: the domain's.
  std::int32_t segment = 0;        ///< Number of the outline's edge, ring by ring; of the side.
  friend bool operator==(const TaggedEdge&, const TaggedEdge&) = default;
};

/// Vertices and triangles are numbered so that neighbours in the plane are near in memory.
struct GroundMesh {
  IndexedVector<VertexIndex, Point2> vertices;                         ///< Local frame, metres.
  IndexedVector<TriangleIndex, std::array<VertexIndex, 3>> triangles;  ///< Counter-clockwise.
  IndexedVector<TriangleIndex, RegionIndex> region;  ///< Per triangle: index in `regions`.
  IndexedVector<RegionIndex, Region> regions;  ///< Building parts first, by building; then others.
  std::vector<TaggedEdge> tagged_edges;        ///< All there are, ascending by (low, high).
  std::vector<Patch> sides;                    ///< Patch of each side of the domain.
  PatchTable patches;                   ///< Those of floors and sides, and of what is to be built.
  std::int64_t small_input_angles = 0;  ///< Corners of the input sharper than the minimum angle.
  /// Triangles below it: at such corners, and across from them (see refine.h).
  std::int64_t triangles_below_min_angle = 0;

  const Region& region_of(TriangleIndex t) const { return regions[region[t]]; }
  /// Whether triangle t lies in a footprint.
  bool inside_building(TriangleIndex t) const { return region_of(t).is_building(); }
};

/// The regions around each vertex, ascending: those of the triangles it is a corner of.
using VertexRegions = RaggedArray<RegionIndex, std::int32_t>;

/// Time and memory linear in the mesh.
VertexRegions regions_at_vertices(const GroundMesh& mesh);

}  // namespace tetropolis
