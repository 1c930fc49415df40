// Elevations of roofs at the vertices of the ground mesh.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/ragged_array.h"
#include "tetropolis/ground/mesh_ground.h"
#include "tetropolis/volume/column/edge_graph.h"

namespace tetropolis {

/// The floor of a building part at a vertex.
struct RoofFloor {
  RegionIndex part = kNoRegion;
  double z = 0;      ///< Elevation, metres.
  double level = 0;  ///< See column_mesh.h.
  double rise = 0;   ///< How far it rises at most to the next vertices of the part, metres.
  friend bool operator==(const RoofFloor&, const RoofFloor&) = default;
};

/// Per building part an elevation; where roofs are not horizontal, elevations of their own.
struct RoofHeights {
  /// Per building part (region): elevation of a horizontal roof; of others the lowest there is.
  std::vector<double> flat;
  /// Per vertex, the floors of all parts around it where one of these is somewhere not at `flat`;
  /// no rows if all roofs are horizontal.
  RaggedArray<RoofFloor, std::int32_t> sloped = {};

  RoofHeights() = default;
  RoofHeights(std::vector<double> elevations)  // NOLINT: horizontal roofs are elevations
      : flat(std::move(elevations)) {}

  std::size_t parts() const { return flat.size(); }
  bool all_flat() const { return sloped.values.empty(); }
  std::span<const RoofFloor> sloped_at(VertexIndex v) const {
    return all_flat() ? std::span<const RoofFloor>{} : sloped[v];
  }
  /// Elevation of a part's roof at vertex v. Precondition: the part is around v.
  double at(RegionIndex part, VertexIndex v) const {
    for (const RoofFloor& floor : sloped_at(v))
      if (floor.part == part) return floor.z;
    return flat[part];
  }
};

/// Roofs nearer to each other than this at a vertex meet there, metres: walls of such steps would
/// have flat cells, or more of them than the mesh size means. Found by trial: 0.5 for 0.3 at a mesh
/// size of 10 m saves 41 % of the cells of Amsterdam south and has 7 % more vertices where roofs
/// meet. Beside roofs steeper than 45 degrees it is more, by half the squared secant.
inline double least_roof_step(double mesh_size) { return std::clamp(mesh_size / 20, 0.3, 1.0); }

/// How the line from p to q between two roofs is divided: where they cross, unless that is nearer
/// than half a metre to an end; and into pieces no longer than `longest`, and than four times the
/// least step on them (less than `least_step`, as from least_roof_step, does not count), fewer at
/// steep roofs, so that walls of low steps have no flat cells.
std::vector<LinePiece> divide_party_line(const RoofPlane& a, const RoofPlane& b, Point2 p, Point2 q,
                                         double longest, double least_step);

/// What reconcile_roofs() changed.
struct ReconciledRoofs {
  RoofHeights roofs;
  std::int64_t closed = 0;  ///< Vertices at which roofs were moved together by more than a
                            ///< centimetre,
  double most_closed = 0;   ///< by so much at most, metres.
  std::int64_t lifted = 0;  ///< Vertices at which a roof was lifted (see below),
  double most_lifted = 0;   ///< by so much at most, metres.
};

/// The elevations that `planes` (per building part) have at the vertices, so that columns can be
/// built on them:
/// - two roofs at a vertex are the same or `least_step` apart (as from least_roof_step); nearer
///   ones meet halfway, as do those up to 0.75 m apart, or a metre, where triangles are too long
///   for such a step, as at a third roof;
/// - roofs do not cross along an edge between them: where they would, they meet at the end at which
///   they are nearer to each other;
/// - around a vertex, floors rise to one place and fall from there, so that walls are a manifold:
///   a lower roof between two higher ones is lifted to the lower of these at that vertex.
/// What happens at a vertex depends on the vertices of connected edges of parts only.
ReconciledRoofs reconcile_roofs(const GroundMesh& mesh, const EdgeGraph& edges,
                                std::span<const RoofPlane> planes, double least_step);

}  // namespace tetropolis
