// Step 2.3: parts of buildings below roof planes.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/extract.h"
#include "tetropolis/city/stated_roof.h"
#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/point_cloud.h"

namespace tetropolis {

struct RoofOptions {
  Lod lod = Lod::k2_2;      ///< kBlock: nothing is done.
  double clearance = 1;     ///< Epsilon, metres; the footprints keep it.
  double percentile = 70;   ///< Of the points of a flat roof, in [0, 100].
  double min_height = 2.5;  ///< Least height of a roof above its building's ground, metres.
  double min_area = 2;      ///< Of a part, square metres.
};

/// What became of the roofs.
struct RoofFacts {
  std::int64_t parts = 0;
  std::map<std::string, std::int64_t> parts_by_lod;  ///< By name_of(Lod).
  /// Parts with points that stay below the LoD asked for: too few points, or flat fits better.
  std::int64_t fallbacks = 0;
  std::int64_t parts_without_points = 0;
  std::int64_t raised = 0;  ///< Parts raised to the minimum height.
  /// Source ids of footprints most of whose points are in parts of others, 2 m off or more.
  std::vector<std::string> lost;
  std::int64_t undivided = 0;  ///< Buildings that stay one block: their parts keep no clearance.
  /// Vertices at which four walls share a vertical line: solids have an edge of more than two faces
  /// there, and the mesher lifts a roof.
  std::int64_t shared_wall_corners = 0;
  double max_slope_deg = 0;
  /// Per footprint with 20 points at least half a metre inside: vertical, of these, metres.
  double rmse_median = std::numeric_limits<double>::quiet_NaN();
  double rmse_p90 = std::numeric_limits<double>::quiet_NaN();
  double volume_of_points = 0;  ///< Between ground and such points, by part, cubic metres.
  double volume = 0;            ///< Between ground and roofs.
  double volume_of_blocks = 0;  ///< Between ground and Building::h_roof.
};

/// Gives the buildings of `city` their parts. `raw`: the buildings before merging, whose source ids
/// are those of `city`; `points`: of the buildings of `raw`, outliers not dropped, with indices of
/// `cloud`; `members`: per building of `city`, those of `raw` that it is made of; `stated`: in the
/// local frame, for footprints without points, where samples of them do (RoofPart::n_points counts
/// these).
///
/// A building is divided where its points say so (label_cells.h), the lines are simplified to the
/// clearance together (clear_lines.h), and each part gets a plane fitted to its points, or, where a
/// flat roof fits better or points are too few, a flat one (RoofPart::lod).
///
/// Guarantees: part_defects finds nothing. Footprints get the vertices of parts that lie on them:
/// these are snapped to the inside, so that an outline may give way by 0.1 mm. The same bytes for
/// any number of threads; a building's parts depend on its own points and footprints alone.
RoofFacts make_roofs(CityModel& city, const CityModel& raw, const BuildingPoints& points,
                     std::span<const std::vector<BuildingIndex>> members, const PointCloud& cloud,
                     const RoofOptions& options, const StatedRoofs& stated = {},
                     const Progress& progress = {});

/// What is wrong with the parts of buildings, one line each: parts that do not tile their
/// footprint, rings that are not simple or turn the wrong way, parts below `min_area`, vertices and
/// edges closer than `clearance` within a building (the clearance between buildings is that of
/// their footprints, see joint_clearance), lines of parts that meet at less than 15 degrees, roofs
/// steeper than 70 degrees. Buildings without parts have none. At most `limit`.
std::vector<std::string> part_defects(std::span<const Building> buildings, double clearance,
                                      double min_area = 2, std::size_t limit = 100);

}  // namespace tetropolis
