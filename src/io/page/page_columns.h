// The numbers that a page rebuilds a mesh from. Private to src/io/page.
//
// Lengths are whole multiples of kPageStep. Numbers are what is left of them when those that the
// reader knows already have been taken off, mostly 0: viewer/src/mesh/columns.ts adds them again.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"

#include "page_upper.h"

namespace tetropolis {

/// Metres.
inline constexpr double kPageStep = 0.001;

/// The nearest number of steps; 1,000 km at most, so that differences are numbers of 32 bits, too.
inline std::int32_t page_steps(double metres) {
  const double steps = metres / kPageStep;
  return std::isnan(steps) ? 0
                           : static_cast<std::int32_t>(std::llround(std::clamp(steps, -1e9, 1e9)));
}

/// Each array in the order of the mesh. Columns have the nodes of layers of prisms, too, below
/// their own.
struct PageColumns {
  std::vector<std::int32_t> x, y;      ///< Per vertex: less that of the one before.
  std::vector<std::int32_t> corners;   ///< Three per triangle: the first less that of the triangle
                                       ///< before, the others less the first.
  std::vector<std::int32_t> region;    ///< Per triangle: less that of the one before.
  std::vector<std::int32_t> building;  ///< Per region; kNoBuilding: open ground; -2 - k: a surface
                                       ///< layer of kind k.
  std::vector<std::int32_t> roof;      ///< Per region of a building: elevation, less that of the
                                       ///< region before; 0 for others.
  std::vector<std::int32_t> count;     ///< Per vertex: nodes, less those of the one before.
  std::vector<std::int32_t> floor;     ///< Per region (ascending) of the vertices with several:
                                       ///< position in the column.
  std::vector<std::int32_t> z;         ///< Per node. At a floor less the roof there, or less the
                                       ///< ground last met; at a top less the top last met; on
                                       ///< layers their thickness less the one last met; between
                                       ///< these less the elevation that even spacing gives, or in
                                       ///< prisms that of as many prisms met last.
  std::vector<std::int32_t> odd;       ///< Triangles whose columns, rounded, climb in another order
                                       ///< than the mesh's: less the one before.
  std::vector<std::uint8_t> steps;     ///< For each of these, upwards, the corner that goes next.
  PageUpper upper;
};

/// All columns, or with `floors_only` those nodes alone that are floors of their regions.
PageColumns page_columns(const ColumnMesh& mesh, bool floors_only);

}  // namespace tetropolis
