// Seeded synthetic cities: footprints, a point cloud of them, and the truth behind both.
//
// The same options give the same bytes on every platform and for any number of threads: random
// numbers come from a generator of our own, geometry from additions, multiplications, divisions and
// square roots only (which IEEE 754 defines to the last bit), and all coordinates are whole
// millimetres, as in a LAS file.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Hills, and possibly a river in its valley. Made by the functions below; see synthetic_ground.
struct SyntheticTerrain {
  double base = 20;                ///< Lowest elevation off the river, metres.
  double relief = 0;               ///< Highest elevation above `base`, metres; 0 is flat.
  std::array<double, 4> phases{};  ///< Of the waves the hills are made of, in [0, 1).
  bool river = false;              ///< From west to east around y = river_y.
  double river_y = 0;
  double river_amplitude = 0;   ///< Metres it winds to either side.
  double river_wavelength = 1;  ///< Metres.
  double river_phase = 0;       ///< In [0, 1).
  double river_half_width = 0;  ///< Metres.
  double water_level = 0;       ///< Elevation, below `base`.
  double valley = 1;            ///< Metres from the banks over which the hills rise.
  Point2 slope;                 ///< Rise per metre to the east and to the north.
  double step_height = 0;       ///< A wall of rock: so many metres higher where the position times
                                ///< step_normal exceeds step_offset.
  Point2 step_normal{1, 0};
  double step_offset = 0;
  double canal_spacing = 0;     ///< Canals along the lines x and y = spacing * (k + 1/2), metres;
                                ///< 0: none. What lies between them are islands.
  double canal_half_width = 0;  ///< Metres.
  double canal_depth = 0;       ///< Of the water's surface below the banks, metres.
};

/// Elevation of the terrain without buildings and trees as a laser sees it, so the water level in
/// the river and the canals. Metres. Continuous, and steep only at the banks of the river, unless
/// there are walls of rock or canals.
double synthetic_ground(const SyntheticTerrain& terrain, double x, double y);

/// Whether the position is in the river or in a canal.
bool synthetic_water(const SyntheticTerrain& terrain, double x, double y);

/// Distance from the river's centre line, approximately (exactly where the river runs straight); at
/// most river_half_width means water. Infinity without a river. Metres.
double synthetic_river_distance(const SyntheticTerrain& terrain, double x, double y);

/// What a city consists of.
struct SyntheticCounts {
  std::int64_t buildings = 0;   ///< All footprints; the sum of the next six.
  std::int64_t scattered = 0;   ///< Rectangles of the random city.
  std::int64_t row_houses = 0;  ///< In perimeter blocks, with party walls.
  std::int64_t courtyards = 0;  ///< With a hole.
  std::int64_t towers = 0;      ///< Free-standing towers and slabs.
  std::int64_t houses = 0;      ///< Free-standing small houses.
  std::int64_t sheds = 0;
  std::int64_t trees = 0;
  std::int64_t shifted = 0;         ///< Footprints moved by centimetres (untidy).
  std::int64_t extra_vertices = 0;  ///< Footprints with a duplicate or superfluous vertex (untidy).
};

struct SyntheticCity {
  std::vector<Polygon>
      footprints;                  ///< Local frame; outer rings counter-clockwise, holes clockwise.
  std::vector<std::string> ids;    ///< One per footprint, unique.
  std::vector<double> ground;      ///< Per footprint: terrain at its interior point, elevation.
  std::vector<double> heights;     ///< Per footprint: roof above `ground`, metres.
  PointCloud points;               ///< Local frame, in rows from south to north.
  Bounds2 domain;                  ///< {0, 0, size, size}.
  Point2 origin{319000, 6396000};  ///< Suggested origin of the local frame in `crs`.
  std::string crs = "EPSG:3006";
  SyntheticTerrain terrain;
  SyntheticCounts counts;
  /// Of cities with sloped roofs: the buildings as the laser sees them, in the order of footprints,
  /// whose ids are their sources; those without parts have level roofs. Footprints are tidy, and
  /// have the corners of their parts. Otherwise empty.
  CityModel truth;
};

/// The city of the paper's benchmark (b): N axis-aligned rectangles at random places, so that many
/// overlap. Sides are uniform in [1, 20] m and heights in [12.5, 50] m. Every rectangle keeps
/// `margin` from the border of the square and every centre `min_distance` from the others.
struct RandomCityOptions {
  std::int64_t buildings = 1000;
  double size = 2500;  ///< Side of the square domain, metres.
  std::uint64_t seed = 1;
  double points_per_m2 = 1;  ///< 0 gives no points.
  double relief = 15;        ///< Of the rolling terrain, metres; 0 is flat.
  double margin = 40;        ///< Metres, >= 0.
  double min_distance = 2;   ///< Metres, >= 0.
};

/// Points have class 6 on the highest roof and class 2 elsewhere; none lie under roofs.
/// Throws Error(kUsage) if that many buildings do not fit, or an option is out of range.
/// Source: Naserentin & Logg 2022 (arXiv 2210.05250), benchmark study (b).
SyntheticCity synthetic_random_city(const RandomCityOptions& options,
                                    const Progress& progress = {});

/// A city of streets and blocks: quarters with street grids turned this way and that, perimeter
/// blocks whose adjoining buildings differ in height and share their party walls vertex by vertex,
/// courtyards, some buildings around a yard (with a hole), towers, houses with sheds, a park
/// without buildings, trees, and hills on both sides of a river with bridges.
struct BlockCityOptions {
  double size = 500;  ///< Side of the square domain, metres, >= 300.
  std::uint64_t seed = 1;
  double points_per_m2 = 3;    ///< 0 gives no points.
  double relief = 15;          ///< Metres; 0 is flat, but the river keeps its banks.
  double margin = 25;          ///< Metres from the border that stay free of buildings, >= 0.
  std::int64_t buildings = 0;  ///< About so many, by wider or narrower plots; 0: as it comes.
  bool sloped_roofs = false;   ///< Roofs in parts with planes of their own: see roofs.h.
  bool untidy = true;          ///< A few footprints moved by up to 5 cm, or with a duplicate or
                               ///< superfluous vertex, as in real cadastral data.
};

/// Points: roofs 6 (with chimneys and parapets), ground 2, trees and bushes 3, 4, 5, water 9,
/// unclassified 1 (cars, facades, bridges), noise 7 (low) and 18 (high); none lie under roofs.
/// Throws Error(kUsage) if an option is out of range.
SyntheticCity synthetic_block_city(const BlockCityOptions& options, const Progress& progress = {});

}  // namespace tetropolis
