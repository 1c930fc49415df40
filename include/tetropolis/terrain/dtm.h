// Step 1.3: the digital terrain model from the ground points of a cloud.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/terrain/raster.h"

namespace tetropolis {

struct DtmOptions {
  double step = 1.0;                        ///< Metres between nodes, > 0.
  std::vector<std::uint8_t> classes{2, 9};  ///< Classes that count as ground (ground and water).
};

/// What the heights of a DTM rest on.
struct DtmReport {
  std::int64_t ground_points = 0;  ///< Points averaged into nodes.
  std::int64_t nodes = 0;          ///< nx * ny.
  double empty_share = 0;          ///< Share of nodes without a point before filling, in [0, 1).
  std::int64_t voids = 0;          ///< Squares without a point: of as many whole steps as fit into
                                   ///< 20 m, of one where none does.
  double void_share = 0;           ///< Their share.
};

/// The grid of a DTM without heights (`values` has nx * ny zeros): node (0, 0) at (domain.xmin,
/// domain.ymin) and just enough nodes to cover the domain, up to 1e-9 steps of rounding.
/// Throws Error(kUsage) if the domain is empty or not finite, the step not positive, or the grid
/// has 2^31 nodes or more.
Raster dtm_grid(const Bounds2& domain, double step);

/// Heights on dtm_grid(domain, options.step). Each point of the given classes counts towards its
/// nearest node (points whose nearest node is not on the grid are ignored), and a node gets the
/// mean height of its points. Then fill_empty_nodes. Guarantees: every value is finite and lies
/// between the lowest and the highest ground point, up to rounding; the same bytes for any number
/// of threads. Time is linear in points and nodes; memory beyond the raster is 4 bytes per node,
/// then that of fill_empty_nodes. Throws Error(kInput) if no ground point lies on the grid. Source:
/// Naserentin & Logg 2022 (arXiv 2210.05250), step 1.3.
Raster build_dtm(const PointCloud& cloud, const Bounds2& domain, const DtmOptions& options = {},
                 const Progress& progress = {}, DtmReport* report = nullptr);

/// Gives every node whose value is NaN a height, front by front from the rims of the voids: the
/// nodes that have a filled one among their 8 neighbours get the mean of those, all at once; then
/// the next front. The result does not depend on the order in which nodes are visited: mirroring or
/// transposing the raster mirrors or transposes the result, bit for bit.
/// Precondition: at least one value is not NaN. Linear time; memory beyond the raster is 12 bytes
/// per empty node and an eighth per node.
void fill_empty_nodes(Raster& raster, const Progress& progress = {});

}  // namespace tetropolis
