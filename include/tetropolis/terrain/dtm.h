// Step 1.3: the digital terrain model from the ground points of a cloud.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/terrain/raster.h"

namespace tetropolis {

struct DtmOptions {
  double step = 1.0;                        ///< Metres between nodes, > 0.
  std::vector<std::uint8_t> classes{2, 9};  ///< Classes that count as ground (ground and water).
  /// A place where a node of the grid would be, in the domain or not, local frame; without one
  /// (domain.xmin, domain.ymin). Grids of one anchor and step have their nodes in common.
  std::optional<Point2> anchor{};
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

/// The grid of a DTM without heights (`values` has nx * ny zeros): nodes whole steps from the
/// anchor (see DtmOptions), just enough to cover the domain, up to 1e-9 steps of rounding. Throws
/// Error(kUsage) if the domain is empty, the domain or the anchor not finite, the step not
/// positive, or the grid has 2^31 nodes or more.
Raster dtm_grid(const Bounds2& domain, double step, const std::optional<Point2>& anchor = {});

/// Heights on dtm_grid(domain, options.step, options.anchor). Each point of the given classes
/// counts towards its nearest node (points whose nearest node is not on the grid are ignored), and
/// a node gets the mean height of its points. Then fill_empty_nodes.
///
/// Locality: let d be the number of steps, along the eight directions of the grid, from a node to
/// the nearest one with a point (0 where it has one itself). Its height depends on the points of
/// the nodes within d steps of it only. So the DTMs of two domains with the same anchor and step
/// have the same bits at a common node that is at least d steps from the rims of both grids, if
/// both clouds have the same points, in the same order, at the nodes within d steps. Guarantees:
/// every value is finite and lies between the lowest and the highest ground point, up to rounding;
/// the same bytes for any number of threads. Time is linear in points and nodes; memory beyond the
/// raster is 4 bytes per node, then that of fill_empty_nodes. Throws Error(kInput) if no ground
/// point lies on the grid. Source: Naserentin & Logg 2022 (arXiv 2210.05250), step 1.3.
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
