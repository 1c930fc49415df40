// Terrain cut back around roofs that lie below it, and from the feet of cliffs and low walls.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/ground/ground_mesh.h"

namespace tetropolis {

/// How steeply ground may rise where it is cut back; tangents, > 0.
struct CutSlopes {
  double at_start = 1.4825609685127403;  ///< In the triangles at the roof's edge or the cliff's
                                         ///< foot; 56 degrees.
  double beyond = 2.475;                 ///< Further away, if that is more; 68 degrees.
};

/// From where the terrain is to be cut back, and which walls may be dug out.
struct CutMarks {
  std::vector<std::uint8_t> roofs;  ///< Per building part, 1: from the edge of its roof.
  std::vector<double> feet;         ///< Per vertex, elevation of the foot of a cliff or of a wall;
                                    ///< infinity: none.
  std::vector<std::uint8_t> walls = {};  ///< Per building part, 1: the ground at its walls may be
                                         ///< lowered below the lowest that is there (plan_columns).

  bool any() const { return !roofs.empty() || !feet.empty(); }
  bool operator==(const CutMarks&) const = default;
};

/// From where it was: from each of these something was lowered.
struct CutSources {
  std::vector<BuildingIndex> roofs;  ///< Ascending.
  std::vector<Point3> feet;          ///< By vertex; z as marked.
};

/// Lowers `ground` at vertices outside buildings and on walls, until it rises no more steeply than
/// `slopes` say from the roof's edge of a marked building, from a marked foot (which itself is at
/// most at its elevation), or from ground that was lowered so (to a nanometre). Distances are
/// those in the triangles outside buildings. Where the terrain dips below that, nothing beyond is
/// touched; a hillside steeper than the steeper of `slopes` is cut back to its crest. `ground`:
/// elevation per vertex; `building` as from lowest_roofs; `roofs`: elevation per building part;
/// `marks`: each list of its size, or empty; `walls` are not looked at.
CutSources cut_back(const GroundMesh& mesh, std::span<const BuildingIndex> building,
                    std::span<const double> roofs, const CutMarks& marks, const CutSlopes& slopes,
                    std::vector<double>& ground);

}  // namespace tetropolis
