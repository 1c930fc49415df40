// The city model: buildings of one or several parts with flat or sloped roofs, and an account of
// every input feature.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "tetropolis/core/indexed_vector.h"
#include "tetropolis/geometry/domain.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// What a building's numbers rest on when the data had gaps; bits of Building::flags.
enum BuildingFlag : std::uint32_t {
  kGroundFromDtm = 1U << 0,         ///< No ground points near it: h_ground is the DTM's.
  kRoofFromUnclassified = 1U << 1,  ///< No class 6 in the cloud: roof points by exclusion.
  kRoofFromAttribute = 1U << 2,     ///< No roof points: height taken from the named attribute.
  kNoRoofPoints = 1U << 3,          ///< No roof points and no attribute: the minimum height.
  kMinimumHeight = 1U << 4,         ///< Raised to the minimum building height.
  kMerged = 1U << 5,                ///< More than one input feature.
  kConvexHull = 1U << 6,            ///< Simplification had to fall back to a hull.
  kRepaired = 1U << 7,              ///< Rings were invalid and have been repaired, or
                                    ///< simplification moved the outline (simplify.h).
  kClipped = 1U << 8,               ///< Cut: by the domain or a planned building.
  kRoofFromFloors = 1U << 9,        ///< Height from a number of floors.
  kDefaultHeight = 1U << 10,        ///< Nothing stated: the default height.
  kPlanned = 1U << 11,              ///< A planned building, or one that is merged with others.
};

/// The flags' names in files and reports, in bit order ("ground_from_dtm", ...).
std::vector<std::string> flag_names(std::uint32_t flags);
/// Inverse of flag_names; unknown names are ignored.
std::uint32_t flags_from_names(const std::vector<std::string>& names);

/// Ids of features of a plan begin with this.
inline constexpr std::string_view kPlannedPrefix = "planned:";

/// Level of detail of roofs, after Biljecki, Ledoux and Stoter, "An improved LOD specification for
/// 3D building models" (2016).
enum class Lod : std::uint8_t {
  kBlock,  ///< One flat roof per building, however many footprints it is merged from.
  k1_2,    ///< One flat roof per footprint: merged buildings are divided at party walls.
  k1_3,    ///< Flat roofs; heights within a footprint that differ by a metre or more are parts.
  k2_2,    ///< Roof planes.
};

/// The name in files and options: "block", "1.2", "1.3", "2.2".
const char* name_of(Lod lod);

/// The plane z = elevation + slope_x (x - at.x) + slope_y (y - at.y). `at` is in whole metres,
/// `elevation` in whole millimetres, slopes (dimensionless) in whole millionths, so that files keep
/// planes as they are (snap_plane).
struct RoofPlane {
  Point2 at;             ///< Local frame, metres.
  double elevation = 0;  ///< Metres, at `at`.
  double slope_x = 0;
  double slope_y = 0;

  bool is_flat() const { return slope_x == 0 && slope_y == 0; }
  /// Exactly `elevation` everywhere if the plane is flat.
  double operator()(Point2 p) const {
    return elevation + (slope_x * (p.x - at.x) + slope_y * (p.y - at.y));
  }
  friend bool operator==(const RoofPlane&, const RoofPlane&) = default;
};

/// The plane nearest to `plane` of those that files keep as they are.
RoofPlane snap_plane(const RoofPlane& plane);

/// A part of a building below one roof plane.
struct RoofPart {
  /// Local frame, metres; counter-clockwise, holes clockwise. Parts of a building tile its
  /// footprint: neighbours have the same vertices along their common line, and the footprint's
  /// rings have every vertex of a part that lies on them. Coordinates are snapped
  /// (snap_coordinate).
  Polygon outline;
  RoofPlane roof;
  std::string source_id;  ///< The input feature it stands on, or stands on most.
  Lod lod = Lod::k1_2;  ///< What the points carried: kBlock where the building's height had to do.
  std::int64_t n_points = 0;  ///< Roof points in the outline.
  double rmse = 0;            ///< Vertical, of these points, metres; NaN without points.
};

/// A polygonal prism footprint x [h_ground, h_roof]; with `parts`, prisms below their roofs.
struct Building {
  std::string id;                       ///< "b" and a number, unique in the model (tetropolis_id).
  std::vector<std::string> source_ids;  ///< The input features it is made of; never empty.
  Polygon footprint;                    ///< Local frame, metres.
  double h_ground = 0;                  ///< Elevation, metres; see snap_height.
  double h_roof = 0;                    ///< Elevation, metres; see snap_height.
  std::int64_t n_ground_points = 0;     ///< Points h_ground was computed from (after outliers).
  std::int64_t n_roof_points = 0;       ///< Points h_roof was computed from (after outliers).
  std::uint32_t flags = 0;              ///< BuildingFlag bits.
  double attribute_height = 0;          ///< Height above ground from the input attribute; NaN or
                                        ///< <= 0 where there is none.
  /// Elevation of the roof, where the input states that: attribute_height follows from it
  /// (compute_heights). NaN: it does not. Not in files.
  double attribute_roof = std::numeric_limits<double>::quiet_NaN();
  std::vector<RoofPart> parts = {};  ///< None: the whole footprint is flat at h_roof. Otherwise
                                     ///< h_roof is the height of the block in LoD1.2.
};

/// Why an input feature ended in no building, for counts and maps.
enum class DropCause : std::uint8_t {
  kUnusable,      ///< No polygon, or one that cannot be repaired.
  kOutside,       ///< Outside the domain.
  kBoundary,      ///< Across the domain's boundary, or mostly beyond the points.
  kTooSmall,      ///< Smaller than the minimum area.
  kTooNarrow,     ///< Nowhere as wide as the distance that walls have to keep.
  kNotABuilding,  ///< Below ground or not built: by attributes, or as ground was measured in it.
  kOutlined,      ///< An outline for which its parts stand.
  kReplaced,      ///< A planned building stands there, or nothing is to.
};

inline constexpr std::size_t kDropCauses = 8;

/// The name in files: "unusable", "outside", "boundary", "too_small", "too_narrow", "no_building",
/// "outlined", "replaced".
const char* name_of(DropCause cause);

/// The reason of those that are `DropCause::kOutside`.
inline constexpr const char* kOutsideReason = "outside the domain";

/// An input feature that ended in no building, and why (one short clause, lower case).
struct Dropped {
  std::string source_id;
  std::string reason;
  DropCause cause = DropCause::kUnusable;  ///< Files of city models do not keep it.
};

/// Guarantee 1: every input feature is in the source_ids of exactly one building or in `dropped`.
struct CityModel {
  IndexedVector<BuildingIndex, Building> buildings;
  std::vector<Dropped> dropped;
  Point2 origin;  ///< Local frame's origin in the CRS; whole metres.
  Domain domain;  ///< Local frame.
  double domain_top = std::numeric_limits<double>::quiet_NaN();  ///< Elevation that its top should
                                                                 ///< have, metres; NaN: any.
  std::string crs;  ///< "EPSG:28992", or WKT where there is no code, or empty if unknown.
};

/// Horizontal coordinates of footprints and of the domain are whole multiples of this step
/// (metres), so that writing a city model to CityJSON and reading it back changes nothing.
inline constexpr double kCoordinateStep = 1e-4;
inline constexpr double kStepsPerMetre = 10000;

/// The multiple of kCoordinateStep nearest to `value`: always the same double for the same
/// multiple.
double snap_coordinate(double value);
inline Point2 snap_coordinate(Point2 p) { return {snap_coordinate(p.x), snap_coordinate(p.y)}; }

/// The elevation in whole millimetres nearest to `value`, in metres: heights that build_city
/// computes are such, so that files hold what they mean and a mesh stands on what files say. NaN
/// stays NaN.
double snap_height(double value);

}  // namespace tetropolis
