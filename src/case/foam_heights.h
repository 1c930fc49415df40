// Heights of a case's cells and faces above what is below them. Private to src/case.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "foam_mesh.h"

namespace tetropolis {

/// Per point [m], the elevation of the lowest one over the same place: its ground, or the roof it
/// stands on.
std::vector<double> floors_below(const std::vector<Point3>& points);

/// Height [m] of a point in a vertical face `f` above the line between the floors (per point of the
/// mesh) of the face's ends.
double height_above_floor(const FoamMesh& mesh, const std::vector<double>& floors, std::size_t f,
                          const Point3& at);

/// Per cell [m], the mean height of its corners above their floors (per point of the mesh).
std::vector<double> heights_of_cells(const FoamMesh& mesh, const std::vector<double>& floors);

/// A cell over a face of its own, by distances from the face's plane [m].
struct WallCell {
  double height = 0;  ///< Of its farthest corner.
  double centre = 0;  ///< Of the mean of its corners (each as often as faces have it).
};

/// Per point [m], how high above its floor (per point of the mesh) layers of prisms over the same
/// place end; 0 without prisms.
std::vector<double> tops_of_prisms(const FoamMesh& mesh, const std::vector<double>& floors);

/// The open land, or all ground where none is open.
struct OpenLand {
  double width = 0;       ///< Of its faces [m]: the root of twice their mean area, weighed by area.
  double layers_top = 0;  ///< The median of tops_of_prisms at their corners [m].
};

OpenLand open_land(const FoamMesh& mesh, const std::vector<double>& tops);

/// Those over boundary faces, in their order.
std::vector<WallCell> cells_on(const FoamMesh& mesh, std::span<const std::size_t> faces);

}  // namespace tetropolis
