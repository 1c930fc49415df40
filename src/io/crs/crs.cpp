#include "tetropolis/io/crs/crs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <mutex>
#include <numbers>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/metric_crs.h"

#include "core/infinity.h"
#include "core/is_among.h"
#include "core/text.h"
#include "gdal_support.h"

namespace tetropolis {

namespace gdal {

namespace {

bool is_code(std::string_view text) {
  return !text.empty() && text.size() < 10 &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// A bare code is one of EPSG's.
std::string expand_shorthand(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return "";
  const std::size_t last = text.find_last_not_of(" \t\r\n");
  const std::string trimmed = text.substr(first, last - first + 1);
  return is_code(trimmed) ? "EPSG:" + trimmed : trimmed;
}

/// GDAL would also take file names and addresses, and read them; a definition has a mark of its
/// own.
bool is_definition(std::string_view text) {
  constexpr std::array<std::string_view, 4> kNames = {"WGS84", "WGS72", "NAD83", "NAD27"};
  if (text.empty() || text[0] == '/' || text[0] == '.') return false;
  // Of addresses PROJ reads OGC's itself, without a network.
  const std::size_t address = text.find("://");
  if (address < text.find_first_of("[{") &&
      text.find("opengis.net/def/crs") > address + std::string_view("://www.").size())
    return false;
  return text.find_first_of(":[{=") != std::string_view::npos || is_among(text, kNames);
}

/// A local system (of a site, a drawing) says nothing but its unit, which matters unless it is the
/// metre, or unknown (0 in GeoPackages of GDAL 3.9 and later).
bool is_local_in_other_units(OGRSpatialReferenceH srs) {
  const double unit = OSRGetLinearUnits(srs, nullptr);
  return OSRIsLocal(srs) != 0 && unit > 0 && !is_metre(unit);
}

/// Removes what has no bearing on x and y: a vertical system, a third axis. False if nothing is
/// left that has.
bool reduce_to_horizontal(OGRSpatialReferenceH srs) {
  OSRStripVertical(srs);
  if (OSRGetAxesCount(srs) == 3) OSRDemoteTo2D(srs, nullptr);
  OSRSetAxisMappingStrategy(srs, OAMS_TRADITIONAL_GIS_ORDER);
  return OSRIsProjected(srs) != 0 || OSRIsGeographic(srs) != 0 || is_local_in_other_units(srs);
}

/// The code that the definition carries, "" if none.
std::string stated_epsg(OGRSpatialReferenceH srs) {
  const char* authority = OSRGetAuthorityName(srs, nullptr);
  const char* code = OSRGetAuthorityCode(srs, nullptr);
  if (authority == nullptr || code == nullptr || std::strcmp(authority, "EPSG") != 0) return "";
  return std::string("EPSG:") + code;
}

/// Whether the database has the code, and not in metres where the definition is in feet: such ones
/// carry the codes of those in metres.
bool is_known(const std::string& code, OGRSpatialReferenceH srs) {
  const QuietErrors errors;
  const Srs known = parse_srs(code);
  // GDAL 3.10 takes a code that EPSG does not have for one of ESRI's, and has another for it.
  if (known == nullptr || stated_epsg(known.get()) != code) return false;
  return OSRIsProjected(srs) == 0 || is_metre(OSRGetLinearUnits(srs, nullptr)) ||
         !is_metre(OSRGetLinearUnits(known.get(), nullptr));
}

/// The same without the code that it carries, by which alone PROJ would look for it; null if that
/// fails.
Srs without_code(OGRSpatialReferenceH srs) {
  char* text = nullptr;
  if (OSRExportToPROJJSON(srs, &text, nullptr) != OGRERR_NONE || text == nullptr) return nullptr;
  nlohmann::json definition = nlohmann::json::parse(text, nullptr, false);
  CPLFree(text);
  if (!definition.is_object()) return nullptr;
  definition.erase("id");
  // Of a system with a transformation to WGS 84 the system is a member.
  if (definition.contains("source_crs")) definition["source_crs"].erase("id");
  const QuietErrors errors;
  return parse_srs(definition.dump());
}

using AxisDirections = std::array<OGRAxisOrientation, 2>;

AxisDirections axes_of(OGRSpatialReferenceH srs) {
  AxisDirections towards{OAO_Other, OAO_Other};
  for (std::size_t i = 0; i < towards.size(); ++i)
    OSRGetAxis(srs, nullptr, static_cast<int>(i), &towards[i]);
  return towards;
}

/// The same with axes east, north: systems that differ in the order of their axes only (EPSG:3042
/// and EPSG:25830) have the same coordinates here, where x is always the easting. Not where they
/// point south and west (EPSG:5513): there the coordinates are others.
Srs with_usual_axes(OGRSpatialReferenceH srs) {
  Srs result(OSRClone(srs));
  const AxisDirections towards = axes_of(srs);
  const auto is_usual = [](OGRAxisOrientation to) { return to == OAO_East || to == OAO_North; };
  // Those that have them already would only be looked up anew.
  if (OSRIsProjected(srs) != 0 && std::all_of(towards.begin(), towards.end(), is_usual) &&
      towards != AxisDirections{OAO_East, OAO_North})
    OSRSetAxes(result.get(), "PROJCS", "Easting", OAO_East, "Northing", OAO_North);
  return result;
}

bool equivalent(OGRSpatialReferenceH first, OGRSpatialReferenceH second) {
  const Srs a = with_usual_axes(first);
  const Srs b = with_usual_axes(second);
  constexpr std::array<const char*, 3> kOptions = {"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES",
                                                   "CRITERION=EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS",
                                                   nullptr};
  return OSRIsSameEx(a.get(), b.get(), kOptions.data()) != 0;
}

/// The code of the database entry that says the same, if there is one.
std::string find_epsg(OGRSpatialReferenceH srs) {
  int count = 0;
  int* confidence = nullptr;
  OGRSpatialReferenceH* matches = OSRFindMatches(srs, nullptr, &count, &confidence);
  std::string found;
  for (int i = 0; i < count && found.empty(); ++i) {
    // 90 and more: same definition, at most another spelling of the name. Below, only numbers that
    // agree in full convince; the name of a hand-made definition says nothing.
    if (confidence[i] >= 90 || equivalent(srs, matches[i])) found = stated_epsg(matches[i]);
  }
  OSRFreeSRSArray(matches);
  CPLFree(confidence);
  return found;
}

}  // namespace

Srs parse_whole_srs(const std::string& text) {
  initialise();
  Srs srs(OSRNewSpatialReference(nullptr));
  const std::string expanded = expand_shorthand(text);
  if (!is_definition(expanded) || OSRSetFromUserInput(srs.get(), expanded.c_str()) != OGRERR_NONE)
    return nullptr;
  return srs;
}

Srs parse_srs(const std::string& text) {
  Srs srs = parse_whole_srs(text);
  if (srs == nullptr || !reduce_to_horizontal(srs.get())) return nullptr;
  return srs;
}

double vertical_unit_metres(OGRSpatialReferenceH srs) {
  if (srs == nullptr) return 1;
  OGRAxisOrientation towards = OAO_Up;
  OSRGetAxis(srs, "VERT_CS", 0, &towards);
  const double unit = OSRGetTargetLinearUnits(srs, "VERT_CS", nullptr);
  return towards == OAO_Down ? -unit : unit;
}

std::string vertical_name(OGRSpatialReferenceH srs) {
  if (srs == nullptr) return "";
  const char* name = OSRGetAttrValue(srs, "VERT_CS", 0);
  if (name != nullptr) return name;
  const bool whole = OSRIsProjected(srs) != 0 || OSRIsGeographic(srs) != 0;
  return whole && OSRGetAxesCount(srs) == 3 ? kEllipsoidal : "";
}

std::string canonical_name(OGRSpatialReferenceH given, const std::string& expected) {
  if (given == nullptr) return "";
  Srs srs(OSRClone(given));
  if (!reduce_to_horizontal(srs.get())) return "";
  if (std::string code = stated_epsg(srs.get()); !code.empty()) {
    if (is_known(code, srs.get())) return code;
    // Some definitions carry codes of other authorities as EPSG's (102100).
    if (Srs bare = without_code(srs.get()); bare != nullptr) srs = std::move(bare);
  }
  if (!expected.empty()) {
    const QuietErrors errors;
    const Srs other = parse_srs(expected);
    if (other != nullptr && equivalent(srs.get(), other.get())) return expected;
  }
  if (std::string code = find_epsg(srs.get()); !code.empty()) return code;
  constexpr std::array<const char*, 3> kOptions = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
  char* wkt = nullptr;
  std::string result;
  if (OSRExportToWktEx(srs.get(), &wkt, kOptions.data()) == OGRERR_NONE && wkt != nullptr)
    result = wkt;
  CPLFree(wkt);
  return result;
}

}  // namespace gdal

namespace {

gdal::Srs require_srs(const std::string& text) {
  const gdal::QuietErrors errors;
  gdal::Srs srs = gdal::parse_srs(text);
  if (srs == nullptr)
    throw Error(ErrorKind::kUsage, "'" + first_bytes(text, 200) +
                                       "' is not a horizontal coordinate reference system" +
                                       errors.reason() + "; give an EPSG code or WKT");
  return srs;
}

}  // namespace

std::string normalise_crs(const std::string& text) {
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) return "";
  // Every reader and writer asks, and for the same few.
  static std::mutex mutex;
  static std::map<std::string, std::string> known;
  constexpr std::size_t kMostKnown = 100;
  {
    const std::lock_guard lock(mutex);
    if (const auto found = known.find(text); found != known.end()) return found->second;
  }
  const gdal::Srs srs = require_srs(text);
  const gdal::QuietErrors errors;
  std::string name = gdal::canonical_name(srs.get());
  const std::lock_guard lock(mutex);
  if (known.size() < kMostKnown) known.emplace(text, name);
  return name;
}

std::string crs_name(const std::string& crs) {
  if (crs.empty()) return "unknown";
  constexpr std::size_t kLongest = 60;
  if (crs.starts_with("EPSG:")) return crs.substr(0, kLongest);
  const gdal::QuietErrors errors;
  const gdal::Srs srs = gdal::parse_srs(crs);
  const char* name = srs == nullptr ? nullptr : OSRGetName(srs.get());
  std::string text = name == nullptr ? "" : name;
  if (text.empty() || text == "unknown") return "unnamed";  // as PROJ strings are
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  return text.size() <= kLongest ? text : first_bytes(text, kLongest) + "...";
}

bool is_geographic(const std::string& crs) {
  return !crs.empty() && OSRIsGeographic(require_srs(crs).get()) != 0;
}

double linear_unit_metres(const std::string& crs) {
  if (crs.empty()) return 1;
  const gdal::Srs srs = require_srs(crs);
  return OSRIsGeographic(srs.get()) != 0 ? 0 : OSRGetLinearUnits(srs.get(), nullptr);
}

std::string in_metres(const std::string& crs) {
  const gdal::Srs srs = require_srs(crs);
  if (is_metre(OSRGetLinearUnits(srs.get(), nullptr))) return normalise_crs(crs);
  const gdal::QuietErrors errors;
  const std::string name = std::string(OSRGetName(srs.get())) + " in metres";
  OSRSetLinearUnitsAndUpdateParameters(srs.get(), "metre", 1);
  // The code is that of the system in its own unit.
  const gdal::Srs bare = gdal::without_code(srs.get());
  if (bare == nullptr) return {};
  OSRSetProjCS(bare.get(), name.c_str());
  return gdal::canonical_name(bare.get());
}

bool is_true_to_scale(const std::string& crs, const Bounds2& box) {
  constexpr double kMost = 0.01;
  const double scale = length_scale(crs, {(box.xmin + box.xmax) / 2, (box.ymin + box.ymax) / 2});
  return !(std::abs(scale - 1) > kMost);
}

std::string utm_zone(Point2 at) {
  constexpr int kZones = 60, kNorth = 32600, kSouth = 32700;
  constexpr double kWidth = 6;  // degrees
  const auto zone = static_cast<int>(std::floor((std::remainder(at.x, 360) + 180) / kWidth));
  return "EPSG:" +
         std::to_string((at.y < 0 ? kSouth : kNorth) + std::clamp(zone, 0, kZones - 1) + 1);
}

double vertical_unit_metres(const std::string& text) {
  if (text.empty()) return 1;
  const gdal::QuietErrors errors;
  return gdal::vertical_unit_metres(gdal::parse_whole_srs(text).get());
}

double length_scale(const std::string& crs, Point2 at) {
  if (crs.empty() || is_geographic(crs)) return kNaN;
  const gdal::Srs srs = require_srs(crs);
  const gdal::QuietErrors errors;
  const gdal::Srs globe(OSRCloneGeogCS(srs.get()));
  if (globe == nullptr) return kNaN;
  OSRSetAxisMappingStrategy(globe.get(), OAMS_TRADITIONAL_GIS_ORDER);
  const gdal::Transform transform(OCTNewCoordinateTransformation(srs.get(), globe.get()));
  if (transform == nullptr) return kNaN;
  constexpr double kHalf = 50;  // units of the system
  std::array<double, 4> x{at.x - kHalf, at.x + kHalf, at.x, at.x};
  std::array<double, 4> y{at.y, at.y, at.y - kHalf, at.y + kHalf};
  std::array<int, 4> good{};
  OCTTransformEx(transform.get(), 4, x.data(), y.data(), nullptr, good.data());
  if (is_among(0, good)) return kNaN;
  const double unit = OSRGetAngularUnits(globe.get(), nullptr);
  const double axis = OSRGetSemiMajor(globe.get(), nullptr);
  const double inverse = OSRGetInvFlattening(globe.get(), nullptr);
  const double flattening = inverse > 0 ? 1 / inverse : 0;
  const double eccentricity2 = flattening * (2 - flattening);
  const double latitude = unit * (y[0] + y[1]) / 2;
  const double w2 = 1 - eccentricity2 * std::sin(latitude) * std::sin(latitude);
  const double across = axis / std::sqrt(w2), along = across * (1 - eccentricity2) / w2;
  double scale = 1;
  for (const std::size_t i : {std::size_t{0}, std::size_t{2}}) {
    // The short way around, also across the meridian of 180 degrees.
    const double turn = std::remainder(unit * (x[i + 1] - x[i]), 2 * std::numbers::pi);
    const double length =
        std::hypot(across * std::cos(latitude) * turn, along * unit * (y[i + 1] - y[i]));
    const double here = 2 * kHalf / length * OSRGetLinearUnits(srs.get(), nullptr);
    if (!(std::abs(std::log(here)) <= std::abs(std::log(scale)))) scale = here;
  }
  return scale;
}

bool same_horizontal_crs(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return false;
  if (a == b) return true;
  const gdal::Srs first = require_srs(a);
  const gdal::Srs second = require_srs(b);
  const gdal::QuietErrors errors;
  if (gdal::equivalent(first.get(), second.get())) return true;
  return gdal::canonical_name(first.get()) == gdal::canonical_name(second.get());
}

std::vector<Point2> reproject(std::span<const Point2> points, const std::string& from,
                              const std::string& to) {
  const gdal::Srs source = require_srs(from);
  const gdal::Srs target = require_srs(to);
  const gdal::QuietErrors errors;
  const gdal::Transform transform(OCTNewCoordinateTransformation(source.get(), target.get()));
  if (transform == nullptr)
    throw Error(ErrorKind::kUsage,
                "there is no transformation from " + crs_name(from) + " to " + crs_name(to));
  std::vector<Point2> result(points.begin(), points.end());
  constexpr std::size_t kBlock = 4096;
  std::vector<double> x(kBlock);
  std::vector<double> y(kBlock);
  std::vector<int> good(kBlock);
  for (std::size_t begin = 0; begin < result.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, result.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      x[i] = result[begin + i].x;
      y[i] = result[begin + i].y;
    }
    OCTTransformEx(transform.get(), static_cast<int>(count), x.data(), y.data(), nullptr,
                   good.data());
    for (std::size_t i = 0; i < count; ++i) {
      const bool ok = good[i] != 0 && std::isfinite(x[i]) && std::isfinite(y[i]);
      result[begin + i] = ok ? Point2{x[i], y[i]} : Point2{kNaN, kNaN};
    }
  }
  return result;
}

Bounds2 reproject_box(const Bounds2& box, const std::string& from, const std::string& to) {
  if (from == to || from.empty() || to.empty() || same_horizontal_crs(from, to)) return box;
  constexpr int kParts = 8;
  std::vector<Point2> grid;
  for (int i = 0; i <= kParts; ++i)
    for (int j = 0; j <= kParts; ++j)
      grid.push_back({box.xmin + box.width() * i / kParts, box.ymin + box.height() * j / kParts});
  Bounds2 result = Bounds2::nothing();
  for (const Point2 p : reproject(grid, from, to))
    if (std::isfinite(p.x)) result.extend(p);
  return result;
}

}  // namespace tetropolis
