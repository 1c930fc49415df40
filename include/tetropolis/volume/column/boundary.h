// The boundary of the volume as a triangle mesh, every face tagged.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tetropolis/geometry/patch.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// A surface of triangles, some of them in pairs, with its own, gapless vertex numbering.
struct SurfaceMesh {
  std::vector<std::array<double, 3>> points;           ///< Local frame, metres.
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< Of a boundary: counter-clockwise seen
                                                       ///< from outside the meshed volume, normals
                                                       ///< leave the air.
  std::vector<Patch> patch;             ///< Per triangle; ascending, so patches are consecutive
                                        ///< (sort_by_patch).
  PatchTable patches;                   ///< All that `patch` may have.
  std::vector<BuildingIndex> building;  ///< Per triangle: for roofs and walls the building, else
                                        ///< kNoBuilding.
  std::vector<NodeIndex> node;          ///< Per point: its number in the volume mesh; empty if the
                                        ///< surface was read from a file.
  std::vector<CellIndex> cell;          ///< Per triangle: the cell behind it; likewise.

  /// Positions of triangles that are, with the next one, the halves (a, b, c) and (a, c, d) of one
  /// quadrilateral face; ascending. It is one face: those of prisms, on walls and sides.
  std::vector<std::int32_t> quads = {};

  const PatchInfo& patch_of(std::size_t f) const { return patches.of(patch[f]); }
};

/// The boundary of `mesh`. Every face that belongs to one cell only is there once. Throws
/// Error(kGuarantee) naming the edge if one on the rim of the ground mesh is not tagged with a side
/// of the domain.
SurfaceMesh extract_boundary(const ColumnMesh& mesh);

/// Brings faces into the order that files of volume meshes need, after patches of some have been
/// changed: by patch, and in it triangles before quadrilaterals; else they keep their order, and
/// points stay. Preconditions: `surface.patches` has all patches; the halves of a quadrilateral
/// have the same.
void sort_by_patch(SurfaceMesh& surface);

/// The 3 or 4 points of a face, in order.
struct FaceCorners {
  std::array<std::int32_t, 4> points{};
  std::size_t count = 3;

  const std::int32_t* begin() const { return points.data(); }
  const std::int32_t* end() const { return points.data() + count; }
};

/// The faces of a surface, whose quadrilaterals are one each. Refers to it.
class SurfaceFaces {
 public:
  explicit SurfaceFaces(const SurfaceMesh& surface) : surface_(surface) {}
  std::size_t size() const { return surface_.triangles.size() - surface_.quads.size(); }
  /// The first triangle of face i.
  std::size_t triangle(std::size_t i) const { return i + quads_before(i); }
  bool is_quad(std::size_t i) const {
    const std::size_t q = quads_before(i);
    return q < surface_.quads.size() && face_of(q) == i;
  }
  FaceCorners corners(std::size_t i) const;
  /// How many of the faces before face i are quadrilaterals.
  std::size_t quads_before(std::size_t i) const;

 private:
  std::size_t face_of(std::size_t q) const {
    return static_cast<std::size_t>(surface_.quads[q]) - q;
  }

  const SurfaceMesh& surface_;
};

/// The faces of some patches only, renumbered.
SurfaceMesh select_patches(const SurfaceMesh& surface, std::span<const Patch> patches);

/// Ground, roofs and walls of a boundary as people look at them: its solid patches, renumbered, and
/// turned round, so normals point into the air. Its quadrilaterals are triangles.
SurfaceMesh city_surface(const SurfaceMesh& boundary);

struct PatchCount {
  std::string name;
  std::int64_t faces = 0;
  friend bool operator==(const PatchCount&, const PatchCount&) = default;
};

/// Number of faces of each patch of `surface.patches`, also of those without faces; quadrilaterals
/// are one.
std::vector<PatchCount> count_by_patch(const SurfaceMesh& surface);

/// Whether every edge has exactly two faces that run along it in opposite directions (closed,
/// oriented, edge-manifold); otherwise the number of edges that break it.
struct SurfaceTopology {
  std::int64_t open_edges = 0;          ///< Edges with one face.
  std::int64_t non_manifold_edges = 0;  ///< Edges with more than two faces.
  std::int64_t misoriented_edges = 0;   ///< Edges with two faces in the same direction.
  bool closed() const { return open_edges == 0; }
  bool manifold() const { return non_manifold_edges == 0 && misoriented_edges == 0; }
};
SurfaceTopology check_topology(const SurfaceMesh& surface);

}  // namespace tetropolis
