// Ground points that cannot be ground: birds, pits, multiple echoes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Indices of single ground points (classes 2 and 9) far above or below their neighbourhood,
/// ascending. `anchor`: a corner of the cells, local frame; without one, that of the box around the
/// ground points.
///
/// The neighbourhood of a point are the ground points in its cell of 4 m and the 8 around it; if
/// these hold fewer than 9, cells of 16, 64, 256, 1024 m. A point is an outlier if all hold:
/// - it is further than 3 m and than 6 median absolute deviations from the median height there
/// (Hampel, "The influence curve and its role in robust estimation", 1974);
/// - it is alone: points at most 1 m higher or lower, itself included, occupy at most 3 of the
///   144 squares, a quarter of the cell wide, that the neighbourhood consists of; only one, if
///   there are fewer points than squares;
/// - no point that is not alone lies even further from the median on the same side.
/// So quays, cliffs and quarry walls stay, however high: what is below them, and above, is not
/// alone, and what is alone lies between. Copies of a point are as alone as the point itself; where
/// points are counted, they count. A point without 8 others within 3 km of it is never an outlier.
///
/// Locality: with an anchor, whether a point is an outlier depends on the points in its
/// neighbourhood only: within 8 m, and where these are fewer than 9 further, up to 2 km. Without
/// one, also on how far the ground points reach, since cells begin there. Where they reach so far
/// that cells have to grow (more than 32 km across), on that, too.
///
/// The same for any number of threads. Linear in points where the ground is dense, but for sorting
/// the few neighbourhoods in which something is far from the median; each coarser size of cells
/// that is needed is a few passes more. Memory: 5 bytes per point and 18 per cell (as many as the
/// extent holds, at most 2^26: cells grow where there would be more); 4 per ground point where the
/// ground around rises or falls by more than 3 m; and, per thread, up to 50 for each point of
/// a neighbourhood, which around points that lie far apart from all others may be most of the
/// cloud. Throws Error(kInput) for 2^32 points or more, and Cancelled.
std::vector<std::uint32_t> find_ground_outliers(const PointCloud& cloud,
                                                std::optional<Point2> anchor = {},
                                                const Progress& progress = {});

}  // namespace tetropolis
