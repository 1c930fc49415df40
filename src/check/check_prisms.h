// The layers of a written volume, from the ground up.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/tet_mesh.h"

namespace tetropolis {

struct LayersCheck {
  std::vector<double> height;  ///< Of all layers, per vertex of the surface: 0 where none begin.
  std::int64_t columns = 0;    ///< Places with layers.
  double share_as_asked = 0;   ///< Of the ground's area, a third of a face for each corner: where
                               ///< the lowest is as high as asked, to a millimetre.
  double greatest_growth = 0;  ///< Ratio of the heights of a layer and the one below.
};

/// Of the ground's vertices. `first`: height asked for of the lowest layer, metres; `count`:
/// layers, which may have prisms on them.
LayersCheck check_prism_layers(const TetMesh& mesh, const SurfaceMesh& surface, double first,
                               int count);

}  // namespace tetropolis
