// Guarantees 1 and 2 on a written city model.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tetropolis/check/violation.h"
#include "tetropolis/city/city_model.h"

namespace tetropolis {

struct CityCheck {
  std::int64_t buildings = 0;
  std::int64_t dropped = 0;
  double min_clearance = 0;  ///< Between vertices, and vertices and edges, of all rings; metres.
  std::string closest;       ///< Two buildings (or one twice) that have it, and where.
  /// Of vertices from the domain's boundary, metres, negative outside; infinity if not checked.
  double domain_distance = std::numeric_limits<double>::infinity();
  double area = 0;         ///< Of all footprints, square metres.
  std::int64_t parts = 0;  ///< Of the buildings that have some.
  /// Between lines of the parts of one building, the footprint's among them, metres; infinity if
  /// not checked.
  double part_clearance = std::numeric_limits<double>::infinity();
  std::vector<Violation> violations;
};

/// Each source id once; footprints finite, simple and oriented, their holes inside them and outside
/// of each other; parts tile their footprint, to a millionth of its area and edge by edge; roofs
/// above ground. With `min_distance` (metres, finite, not negative) also: footprints disjoint (one
/// may stand in another's courtyard), and clearance at least this between all rings, lines of parts
/// and to the domain's boundary. Without it (a raw model) footprints may touch and overlap, and
/// clearance is that within each of them. The same result for any number of threads.
CityCheck check_city(const CityModel& city, std::optional<double> min_distance);

}  // namespace tetropolis
