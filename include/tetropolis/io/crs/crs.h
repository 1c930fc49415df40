// Coordinate reference systems as strings. Only the horizontal part counts: of a compound system
// (EPSG:7415) its horizontal one (EPSG:28992) is meant everywhere.
//
// The empty string stands for "unknown". All coordinates are x = east or longitude, y = north or
// latitude, whatever axis order the authority prescribes.
#pragma once

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// The canonical name of a reference system: "EPSG:n" where the definition carries that code or is
/// equivalent to exactly what the code stands for, else one line of WKT 2 (ISO 19162). A code that
/// the database does not have (102100), or has in metres for a definition in other units, counts as
/// none. A local system (LOCAL_CS, ENGCRS) has a name only if its unit is known and not the metre,
/// so that nobody takes its coordinates for metres.
///
/// `text`: "EPSG:28992", "28992", "urn:ogc:def:crs:EPSG::7415",
/// "https://www.opengis.net/def/crs/EPSG/0/7415" (0 or a version of the database),
/// ".../def/crs-compound?1=...&2=..." of two of these, WKT of any kind, a PROJ string or PROJJSON.
/// Empty in, empty out. normalise_crs(normalise_crs(t)) == normalise_crs(t). The first answers are
/// remembered for the process; any thread may ask. Files and the network are never consulted.
/// Errors: kUsage with the text, if it is neither a reference system of the Earth's surface nor
/// such a local one.
std::string normalise_crs(const std::string& text);

/// What to call the system in a message: its code, or the name that its definition carries, or
/// "unnamed"; "unknown" for the unknown one. One short line whatever the text, never an error.
std::string crs_name(const std::string& crs);

/// True for longitude and latitude in degrees. False for the unknown system.
bool is_geographic(const std::string& crs);

/// Metres per unit of x and y: 1, 0.3048 (international foot), 0.30480060960121924 (US survey
/// foot)... 1 for the unknown system, 0 for geographic ones, which have no linear unit.
double linear_unit_metres(const std::string& crs);

/// Whether a unit of so many metres is the metre, but for rounding.
inline bool is_metre(double unit) { return std::abs(unit - 1) <= 1e-9; }

/// Metres per unit of height in a compound or vertical system, negative where it counts downwards,
/// 1 where `text` (as for normalise_crs) says nothing of heights or is not understood.
double vertical_unit_metres(const std::string& text);

/// How many times as long as on the Earth's ellipsoid a short way at `at` is in a projected system:
/// of the ways along x and along y the one that is further from 1. 1.89 for web Mercator
/// (EPSG:3857) at 58 degrees north, 0.9996 to 1.001 in UTM zones. NaN for other systems, and where
/// `at` cannot be transformed. The radii of curvature are those of Snyder, "Map projections: a
/// working manual" (USGS Professional Paper 1395, 1987), equations 4-18 and 4-20.
double length_scale(const std::string& crs, Point2 at);

/// Whether coordinates of `a` can be used as coordinates of `b` unchanged, heights aside. False if
/// either is unknown.
bool same_horizontal_crs(const std::string& a, const std::string& b);

/// The points in `to`, in their order; points that cannot be transformed become NaN, NaN.
/// Precondition: both systems are known. Errors: kUsage if there is no way from one to the other.
std::vector<Point2> reproject(std::span<const Point2> points, const std::string& from,
                              const std::string& to);

/// The box around a box in another system, by a grid of points in it: sides that bend may lie
/// outside by a little. The box itself where the systems are the same or one is unknown; empty if
/// none of its points can be transformed. Errors: as for points.
Bounds2 reproject_box(const Bounds2& box, const std::string& from, const std::string& to);

}  // namespace tetropolis
