// From cleared lines to parts. Private to src/city.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tetropolis/city/city_model.h"

#include "city/roofs/partition.h"
#include "city/roofs/region_points.h"

namespace tetropolis {

struct FinishOptions {
  double percentile = 70;  ///< Of the points of flat roofs.
  double lowest = 0;       ///< Elevation that no roof goes below.
};

/// A part, and what is known of it.
struct FinishedPart {
  RoofPart part;  ///< Without source_id.
  MemberNumber member = 0;
  bool raised = false;      ///< To the lowest elevation.
  double mean_of_roof = 0;  ///< Elevation.
  double mean_above = 0;    ///< Of its points above the roof, metres; see below.
};

struct FinishedRoof {
  Polygon footprint;  ///< With the vertices of parts on it.
  std::vector<FinishedPart> parts;
  /// Per member: of its points off their roofs, vertically, summed; and how many there are. Points
  /// within half a metre of the member's outline do not count: they may be of walls.
  std::vector<double> squared_errors;
  std::vector<std::int64_t> counts;
  std::vector<double> flat_squared_errors;  ///< The same of one flat roof per member.
  /// Ascending: members most of whose points are in parts of others, 2 m off or more.
  std::vector<MemberNumber> lost;

  /// Whether a member has enough points for its errors to say something.
  bool has_fit(std::size_t member) const { return counts[member] >= 20; }
  /// By how much a member's points fit worse than one flat roof: the difference of root mean
  /// squares, metres; 0 where that is no misfit (plane_fit.h), or says nothing.
  double misfit(std::size_t member) const;
  /// Of all members.
  double misfit() const;
};

/// Snaps vertices (those on the outline to the inside) and fits the roofs. A sloped roof is made
/// gentler until no corner of its part is more than 0.5 m beyond the range of its points, nor below
/// the lowest elevation, and replaced by a flat one where that fits better.
FinishedRoof finish_parts(const RoofInput& input, Partition& lines, RegionPoints& points,
                          const FinishOptions& options);

}  // namespace tetropolis
