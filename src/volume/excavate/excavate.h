// Terrain excavated around roofs that lie below it, and from the toes of slopes and of low walls.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/ground/ground_mesh.h"

#include "volume/column/roof_heights.h"

namespace tetropolis {

/// How steeply excavated ground may rise; tangents, > 0.
struct ExcavationSlopes {
  double at_source = 1.4825609685127403;  ///< In the triangles at the roof's edge or the toe; 56
                                          ///< degrees.
  double beyond = 2.475;                  ///< Further away, if that is more; 68 degrees.
};

/// From where terrain is to be excavated, and which walls may be dug out.
struct ExcavationMarks {
  std::vector<std::uint8_t> roofs;  ///< Per building part, 1: from the edge of its roof.
  std::vector<double> toes;         ///< Per vertex, elevation of the toe of a slope or of a low
                                    ///< wall; infinity: none.
  std::vector<std::uint8_t> walls = {};  ///< Per building part, 1: the ground at its walls may be
                                         ///< lowered below the lowest that is there (plan_columns).

  bool operator==(const ExcavationMarks&) const = default;
};

/// From each of these something was lowered.
struct ExcavationSources {
  std::vector<BuildingIndex> roofs;  ///< Ascending; those of buildings with one roof.
  std::vector<Point3> toes;          ///< By vertex; z as marked, or of the roof there, if that is
                                     ///< marked, of a building with several: not all may be.
  std::vector<double> roof_slopes_deg;  ///< How steeply the ground rises from each of them,
  std::vector<double> toe_slopes_deg;   ///< degrees (ExcavationSlopes::at_source).
};

/// Lowers `ground` at vertices outside buildings and on walls, until it rises no more steeply than
/// `slopes` say from the roof's edge of a marked building, from a marked toe (which itself is at
/// most at its elevation), or from ground that was lowered so (to a nanometre). Distances are
/// those in the triangles outside buildings. Where the terrain dips below that, nothing beyond is
/// touched; a hillside steeper than the steeper of `slopes` is excavated to its crest. `ground`:
/// elevation per vertex; `building` as from lowest_roofs; `marks`: each list of its size, or empty;
/// `walls` are ignored.
ExcavationSources excavate(const GroundMesh& mesh, std::span<const RegionIndex> building,
                           const RoofHeights& roofs, const ExcavationMarks& marks,
                           const ExcavationSlopes& slopes, std::vector<double>& ground);

}  // namespace tetropolis
