// Step 3.1: the 2D mesh of the domain that respects every footprint.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/domain.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/ground/ground_mesh.h"
#include "tetropolis/ground/surfaces.h"

namespace tetropolis {

/// A part of a building, in plan.
struct PartOutline {
  const Polygon* outline = nullptr;  ///< Local frame, metres.
  BuildingIndex building = kNoBuilding;
  std::int32_t part = 0;  ///< Number within the building.
};

/// A piece of a line that ends at `end`.
struct LinePiece {
  Point2 end;
  double max_edge = 0;  ///< Longest edge along it and away from it, metres, > 0.
};

/// An area with a longest edge of its own.
struct SizeRegion {
  Polygon area;     ///< Of mesh_ground: local frame. Of mesh_city: CRS coordinates.
  double size = 0;  ///< Metres, > 0.
};

/// How edges grow away from buildings. Lengths in metres.
struct SizeGrading {
  double far_size = 0;     ///< Longest edge anywhere, at least the mesh size; 0: that.
  double ground_size = 0;  ///< With far_size or regions: longest edge in the convex hull of all
                           ///< buildings; 0: no own bound.
  double growth = 1.2;     ///< Of an edge over the one before it, > 1.
  std::vector<SizeRegion> regions = {};
};

struct GroundMeshOptions {
  double mesh_size = 10;      ///< Longest edge in buildings, at walls and, without a grading,
                              ///< everywhere; metres, > 0.
  double min_angle_deg = 25;  ///< Degrees, 0 to 33.
  /// Longest edge at the wall between the neighbouring vertices a and b of a ring of `part`, along
  /// it and away from it, metres, > 0. Empty: mesh_size.
  std::function<double(RegionIndex part, Point2 a, Point2 b)> wall_edge = {};
  /// The pieces, in order, of the line from a to b between two parts of a building: their ends
  /// become vertices, the last one ends at b. Empty: one piece, mesh_size.
  std::function<std::vector<LinePiece>(RegionIndex left, RegionIndex right, Point2 a, Point2 b)>
      party_line = {};
  /// Elevation of the terrain, for the sake of steep triangles: see RefineOptions.
  std::function<double(Point2)> elevation = {};
  SizeGrading grading = {};
  /// The ground outside buildings, divided; each of its areas is a region after the open ground,
  /// with a patch of its kind. nullptr: all is open ground.
  const Surfaces* surfaces = nullptr;
};

/// Meshes `domain`, inside and outside of the footprints. Region b is footprint b, the last one
/// the open ground around them and in their courtyards; after it come areas of options.surfaces,
/// which are of these footprints and this domain.
///
/// Precondition: rings are simple; footprints do not overlap, best with some clearance (the gap
/// sets the edge length in it), and lie strictly inside of the domain. Orientation is free.
/// Guarantees: footprint vertices and domain corners keep their coordinates bit for bit; vertices
/// on the domain's sides lie exactly on them; every footprint edge is a union of mesh edges, which
/// are tagged with it, as those on the domain's sides are; every vertex belongs to a triangle; the
/// edge lengths and angles of refine(); vertices and triangles are numbered along a Hilbert curve.
/// The same input gives the same bytes.
///
/// Throws Error(kInput) for an empty domain and for a footprint that leaves the domain or has
/// coordinates that are not finite (named by index), Error(kUsage) for options out of range,
/// Error(kGuarantee) as refine().
GroundMesh mesh_ground(std::span<const Polygon> footprints, const Domain& domain,
                       const GroundMeshOptions& options = {}, const Progress& progress = {});

/// The same for buildings of several parts: region r is part r. Preconditions besides: parts are in
/// the order of their buildings and of their numbers; those of a building do not overlap, and where
/// they touch they have the same vertices. Lines between two parts are unions of mesh edges that
/// are tagged with the first part.
GroundMesh mesh_ground_parts(std::span<const PartOutline> parts, const Domain& domain,
                             const GroundMeshOptions& options = {}, const Progress& progress = {});

}  // namespace tetropolis
