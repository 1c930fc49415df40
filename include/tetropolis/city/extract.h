// Step 1.5: the points that a building's roof and ground heights are computed from.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/progress.h"
#include "tetropolis/core/ragged_array.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Index into a PointCloud. 32 bits: the arrays of 2^32 points would fill 56 GB.
using PointIndex = std::uint32_t;

/// One list of points per building: ascending, each point once.
using PointLists = RaggedArray<PointIndex>;

struct BuildingPoints {
  PointLists roof;
  PointLists ground;
  std::vector<std::uint8_t> by_exclusion;  ///< Per building, 0: its roof points have class 6; 1:
                                           ///< they are what no class excludes; 2: the same, as a
                                           ///< clean roof without class 6.
  friend bool operator==(const BuildingPoints&, const BuildingPoints&) = default;
};

/// Which points are of roofs. kAuto looks at the whole cloud; with one of the others, what a
/// building gets depends on the points at it alone, as tiles of one city need it.
enum class RoofPoints {
  kAuto,        ///< By class 6, or by exclusion if the cloud has none.
  kClassified,  ///< By class 6; clean roofs without it by exclusion.
  kExclusion,
};

struct ExtractOptions {
  double margin = 1.0;  ///< Metres around a footprint in which ground points are taken, >= 0.
  double sigma = 2.0;   ///< Points further from the mean height than this many standard deviations
                        ///< of their list are dropped; infinity keeps all.
  bool drop_tree_crowns =
      true;  ///< Remove crowns of trees (tree_crowns.h) from roof points by exclusion.
  /// Points among which those of buildings have no class of their own.
  std::vector<PointRange> no_buildings{};
  RoofPoints roof_points = RoofPoints::kAuto;
};

/// Roof points lie inside the footprint (contains()) and have class 6; ground points lie outside
/// it, at most `margin` from its boundary (squared_distance_to_segment), and have class 2 or 9.
/// Points in a hole are outside. Roof points are by exclusion, instead,
/// - of all buildings, if options.roof_points says so: kAuto, if the whole cloud has no point of
///   class 6 (or a few strays: fewer than one in 1000 points, and fewer than eight or, if that is
///   more, than buildings);
/// - of a building with more points of options.no_buildings inside, whatever their class, than it
///   has roof points of class 6, unless none are left;
/// - of a building with fewer than four roof points of class 6, if what it has by exclusion is a
///   clean roof: ten points or more, half at least of all points inside; in the median two metres
///   or more above the 10th percentile of its ground points, of which there are some; and three
///   quarters of them within 0.25 m (standard deviation) of a plane through those around. Crowns,
///   hedges and cars are none.
/// By exclusion, roof points are the points inside of classes that may_be_roof; these lose what is
/// at most half a metre above the 10th percentile of the building's ground points (unless that is
/// more than half of the list), and the crowns of trees unless told otherwise. Each list then loses
/// its outliers (drop_outliers). One point may belong to several buildings: footprints may overlap,
/// margins do.
///
/// Guarantees: lists in the order of the footprints; the same for any number of threads.
///
/// Memory: the result has 4 bytes for each point of each of its lists; beside it, a grid over the
/// footprints and their edges, at most 24 bytes for each pair of a building and a point found at it
/// (by exclusion: found within 3 m of it, too), and what drop_tree_crowns needs of one building per
/// thread. The number of pairs grows with the square of the margin, and nothing bounds it.
///
/// Throws Error(kInput) for clouds of 2^32 points or more.
///
/// Source: Naserentin & Logg 2022 (arXiv 2210.05250), step 1.5; a uniform grid replaces the trees.
BuildingPoints extract_building_points(std::span<const Polygon> footprints, const PointCloud& cloud,
                                       const ExtractOptions& options = {},
                                       const Progress& progress = {});

/// The same for the footprints of buildings. `others`: footprints that are no buildings of the
/// model (they cross its boundary): what is in them is no tree beside a building.
BuildingPoints extract_building_points(std::span<const Building> buildings,
                                       std::span<const Polygon> others, const PointCloud& cloud,
                                       const ExtractOptions& options = {},
                                       const Progress& progress = {});

/// From every list, removes the points whose height is further than `sigma` population standard
/// deviations from the list's mean height. One pass: the mean is not taken again.
void drop_outliers(PointLists& lists, const PointCloud& cloud, double sigma);

/// The points of merged buildings (step 2.3): building m of the result has the union of the lists
/// of the buildings members[m] of `points`, each point once, ascending. Outliers are not dropped
/// again. Precondition: members are indices of buildings of `points`.
BuildingPoints merge_building_points(const BuildingPoints& points,
                                     std::span<const std::vector<BuildingIndex>> members);

}  // namespace tetropolis
