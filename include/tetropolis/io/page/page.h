// One page that shows a city and its mesh: HTML that needs no network and no other file.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// An input feature on the map, and what became of it.
struct PageFootprint {
  std::string source_id;
  Polygon polygon;                       ///< Local frame, metres.
  BuildingIndex building = kNoBuilding;  ///< It is part of this one of the city's; kNoBuilding:
  std::string reason = {};               ///< it was dropped, and why.
};

/// Cells up to which a page has the volume mesh, unless told otherwise: some 12 MB and three
/// seconds in the browser. Beyond, it shows the surface (ground, roofs and walls), and says so.
inline constexpr std::int64_t kMostPageCells = 20'000'000;

/// Triangles of the ground mesh up to which a page has it, some 20 MB. Beyond, it shows the
/// buildings as prisms.
inline constexpr std::int64_t kMostPageTriangles = 3'000'000;

/// Plan coordinates and elevations in a page are within this of the mesh's, metres.
inline constexpr double kPageTolerance = 0.002;

/// A mesh as a page has it: most of its bytes, and most of the time that it takes.
struct PageMesh {
  std::int64_t cells = 0;   ///< That there are.
  bool is_shown = false;    ///< Within kMostPageTriangles.
  bool has_volume = false;  ///< Within `most_cells`, too.
  std::int32_t layers = 0;  ///< Of prisms, if it has the volume.
  bool is_whole = false;    ///< All cells are prisms.
  std::string blocks = {};  ///< Members of the page's object of data.
};

/// `mesh`: local frame. The volume is stored as its columns, from which the page climbs
/// (column_mesh.h) to the same cells, and the steps of the front above them.
PageMesh page_mesh(const ColumnMesh& mesh, std::int64_t most_cells = kMostPageCells);

/// What a page shows. All but the city may be missing; nothing is copied.
struct PageContents {
  const CityModel& city;
  const PageMesh* mesh = nullptr;                    ///< Of `city`.
  std::span<const PageFootprint> footprints = {};    ///< Before merging, in any order.
  std::map<std::string, std::int64_t> dropped = {};  ///< Number of features dropped, by reason.
  std::string report = {};  ///< Text of report.json (run/report.h): numbers, times, warnings.
  std::string repeat = {};  ///< The command line that makes the same again.
};

/// The page as HTML, UTF-8. Works from file:// and as an iframe's srcdoc, in browsers with WebGL 2
/// and DecompressionStream (Chrome 94, Firefox 113, Safari 16.4). The numbers that the page tells
/// are those of `report`: without it there are none.
std::string page_html(const PageContents& contents);

}  // namespace tetropolis
