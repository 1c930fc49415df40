// Terrain beyond the data.
#pragma once

#include "tetropolis/terrain/raster.h"

namespace tetropolis {

/// Where terrain keeps its height, and how far it fades from there.
struct TerrainFade {
  Point2 along{1, 0};  ///< Unit vector: the first axis of the frame of `core`.
  Bounds2 core;        ///< Keeps its heights: coordinates along `along` and on the left of it.
  double width = 0;    ///< Metres around it, over which a smoothstep leads to `height`; > 0.
  double height = 0;
};

/// Mean of the nodes on the rim of the grid.
double rim_height(const Raster& raster);

/// A raster of the same nodes and as many more as cover `box`. Beyond the nodes that were, heights
/// are those of `wider`, without it those of the nearest place on their rim; all fade but for what
/// `wider` covers. Nodes in the core and there keep their bits.
/// Throws Error(kUsage) if there would be more than 400 million nodes.
Raster extend_terrain(const Raster& raster, const Bounds2& box, const TerrainFade& fade,
                      const Raster* wider = nullptr);

}  // namespace tetropolis
