// The validator of simplified footprints (guarantee 2): how close features come, and whether
// every ring is as it should be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tetropolis/geometry/domain.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// A vertex, or the edge that starts at it.
struct RingFeature {
  std::int32_t polygon = -1;  ///< -1: the domain's boundary.
  std::int32_t ring = 0;      ///< 0 is the outer ring, k is hole k - 1.
  std::int32_t index = 0;     ///< Vertex of the ring, or of its edge's start.
  friend bool operator==(const RingFeature&, const RingFeature&) = default;
};

/// The closest pair of a vertex and another vertex or an edge that it is not an end of.
struct Clearance {
  double distance = std::numeric_limits<double>::infinity();  ///< Metres.
  RingFeature vertex;
  RingFeature other;  ///< An edge; of a vertex, one that starts or ends there.
  Point2 at;          ///< Where `vertex` is.
};

/// The exact joint minimum clearance of all rings together: the least distance between two vertices
/// or between a vertex and an edge that does not belong to it, over all rings of all polygons and,
/// if given, the domain's boundary. Two polygons that are apart are therefore no closer than this,
/// and no edge is shorter. 0 where vertices coincide or lie outside the domain; edges that cross
/// without a vertex near are not seen here but by footprint_defects. Infinity if there is no
/// vertex. Ties go to the domain's boundary, then to the lowest vertex. Any rings of finite
/// coordinates. Near-linear time. Minimum clearance is defined in Thompson and van Oosterom (2006),
/// "Interchange of spatial data: inhibiting factors", for one geometry.
Clearance joint_clearance(std::span<const Polygon> polygons,
                          const std::optional<Domain>& domain = std::nullopt);

/// Whether a distance between features is at least `threshold` metres, up to a nanometre: alleys as
/// wide as the threshold, between coordinates that binary numbers only come close to, are clear.
inline bool is_clear(double distance, double threshold) { return distance >= threshold - 1e-9; }

enum class FootprintDefectKind : std::uint8_t {
  kTooFewVertices,   ///< A ring of fewer than three vertices.
  kNotFinite,        ///< A coordinate that is not finite or beyond 1e9 m.
  kOffGrid,          ///< A coordinate that is not a multiple of kCoordinateStep.
  kOrientation,      ///< An outer ring not counter-clockwise or a hole not clockwise.
  kRingsTouch,       ///< Two edges cross or touch (or the rings of one, or a ring itself).
  kHoleOutside,      ///< A hole outside its outer ring or inside another hole.
  kPolygonsOverlap,  ///< A polygon inside another one.
};

struct FootprintDefect {
  FootprintDefectKind kind;
  RingFeature first;
  RingFeature second;  ///< The other edge of kRingsTouch; the polygon around of kPolygonsOverlap.
  Point2 at;
  std::string message;  ///< One line naming polygon, ring and vertex.
};

/// Everything that is wrong with polygons that should be simple, correctly oriented, with their
/// holes inside and disjoint, without touching anywhere. Decided exactly for coordinates on the
/// grid of kCoordinateStep. Nesting is looked at only if nothing else is wrong. At most `limit`
/// defects.
std::vector<FootprintDefect> footprint_defects(std::span<const Polygon> polygons,
                                               std::size_t limit = 100);

}  // namespace tetropolis
