// Step 3.1: the 2D mesh of the domain that respects every footprint.
#pragma once

#include <functional>
#include <span>

#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/domain.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/ground/ground_mesh.h"

namespace tetropolis {

struct GroundMeshOptions {
  double mesh_size = 10;      ///< Longest edge, metres, > 0.
  double min_angle_deg = 25;  ///< Degrees, 0 to 33.
  /// Longest edge at the wall between the neighbouring vertices a and b of a ring of `building`,
  /// along it and away from it, metres, > 0. Empty: mesh_size for all.
  std::function<double(BuildingIndex building, Point2 a, Point2 b)> wall_edge = {};
  /// Elevation of the terrain, for the sake of steep triangles: see RefineOptions.
  std::function<double(Point2)> elevation = {};
};

/// Meshes `domain`, inside and outside of the footprints. Region b is footprint b,
/// the last one the open ground around them and in their courtyards (regions_of_buildings).
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

}  // namespace tetropolis
