// Ground points of unclassified clouds.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

struct GroundFilterOptions {
  std::vector<std::uint8_t> classes{0, 1, 12};  ///< Classes that may be ground: never classified,
                                                ///< unclassified, overlap.
  double cell = 1.0;       ///< Metres, > 0. Coarser (up to 4 m) where there are fewer points than
                           ///< cells, and where there would be more than 2^27 cells.
  double window = 20.0;    ///< Metres, > 0: what is narrower than twice that, and rises from its
                           ///< surroundings, is an object, if it is in no footprint.
  double slope = 0.15;     ///< Rise over run that is still terrain, > 0.
  double tolerance = 0.5;  ///< Metres between a ground point and the surface, where that is level.
  double tolerance_per_slope = 1.25;  ///< And more by this where it slopes, metres.
  /// What is measured over all points where it is not given; see Locality below.
  std::optional<Point2> anchor{};   ///< A corner of the cells, local frame.
  std::optional<double> spacing{};  ///< Mean distance of neighbouring points, metres, > 0.
  std::optional<Point2> tilt{};     ///< Rise per metre of the whole terrain, to east and north.
};

/// Finds the ground points of a cloud: result[p] is 1 where point p lies on the ground, otherwise
/// 0. Points of other classes are ignored.
///
/// The simple morphological filter of Pingel, Clarke & McBride, "An improved simple morphological
/// filter for the terrain classification of airborne LIDAR data" (ISPRS J. 77, 2013), after Zhang
/// et al., "A progressive morphological filter for removing nonground measurements from airborne
/// LIDAR data" (IEEE TGRS 41, 2003): a grid of lowest points is opened with ever larger windows; a
/// cell is an object where one opening lowers it by more than slope * window; the surface through
/// the other cells is the terrain, and points within a tolerance of it are ground. Differences:
/// terrain that slopes as a whole is also looked at with a plane taken out of it, and objects are
/// what both ways find (else rims of slopes or tops of cliffs would be); windows are octagons; the
/// drop is measured from the grid itself; one of a storey (3 m) is never terrain, so that wide flat
/// halls are seen; a lowest point with fewer than three others at most 1 m higher within 10 m is a
/// low outlier and left out (the paper opens the surface upside down, which takes alleys for low
/// outliers); cells inside footprints say nothing about the terrain, so no known building is too
/// wide, but points in them that lie on the terrain around are ground; cells without points are,
/// for the opening only, filled from the lowest surroundings of their void at the given slope, also
/// around the cloud, so that buildings at the water or cut by the rim of the cloud do not lean on a
/// void.
///
/// Light wells, basement stairs, areaways and ditches are filled for the opening, too: what is at
/// most 6 m wide (an even number of cells: up to 8 m, where these are larger than 1 m) between
/// higher cells, or between these and voids, and no more than 3.6 m deep. Else the ground between
/// two of them that are closer than twice the window would be an object. But not where more than
/// two thirds of what is either low so or wide (4 m and more from any such place) within the window
/// is low: that is the ground between rows of garages, sheds, hedges or greenhouses.
///
/// Low outliers that are many are near others, so a lowest point is a low outlier, too, if of the
/// 25 cells around most hold points more than 1 m higher, at most 4 (less than 5 square metres)
/// hold one at its level, 1 m up and down, and either the higher ones lie in a plane or, within 10
/// m, the level has fewer than 6 % of the cells that the commonest one above has. Where points are
/// as dense as cells that is done again with what is left, three times at most. At 2 points per
/// square metre and more this finds 5 low outliers per 100 square metres, 2 to 20 m deep and
/// deeper, some by two and three.
///
/// And of the objects that are found, what rises gradually instead of in walls is taken back:
/// banks, dykes, ridges and hilltops, of 50 square metres and more. A drop as large as that of a
/// wall is none where the surface behind rises likewise, on slopes of 45 degrees. Smaller pieces of
/// terrain that objects, footprints and walls cut off from the rest, a metre above most of the
/// ground nearby, are what openings left of objects between footprints (podiums), and go.
///
/// Known weakness: on slopes much steeper than `slope` that are not those of the whole terrain,
/// parts of wide buildings that are in no footprint may pass for terrain, and so may podiums of
/// more than 50 square metres between footprints; hilltops where trees leave few smooth cells may
/// pass for objects. Rows of objects in no footprint that are wider than 8 m and lower than 3.6 m
/// may pass for terrain with ditches, and terrain in strips of less than about 12 m between ditches
/// for objects. Shafts and light wells below 5 square metres are low outliers. More low outliers
/// than said above, as many of one depth, or one per 100 square metres where there are only 50
/// points, pull the terrain down.
///
/// Locality: without the last three options, far points have a say in where cells begin, how wide
/// they are, how many points are to be expected in them and how the terrain slopes as a whole. With
/// them (fewer than 2^27 cells, and some candidate outside of footprints), what is far away matters
/// only where it hangs together with what is here: a void, or one object or piece of terrain, each
/// judged as a whole; and within 2 cells of the sides of the box around the candidates. Everything
/// else is decided within three times the window.
///
/// Guarantees: the same for any number of threads. Linear in points, footprints (their edges, and
/// the rows of cells these span) and cells, logarithmic in the window; but filling voids takes one
/// pass over the cells for each turn of the most winding void. About 30 bytes per cell.
/// Precondition: options as stated there.
std::vector<std::uint8_t> filter_ground(const PointCloud& cloud,
                                        std::span<const Polygon> footprints,
                                        const GroundFilterOptions& options = {},
                                        const Progress& progress = {});

}  // namespace tetropolis
