// Building footprints in vector files (paper step 1.2).
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "tetropolis/city/attribute_column.h"
#include "tetropolis/city/city_model.h"
#include "tetropolis/city/stated_roof.h"
#include "tetropolis/core/warning.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Of features beyond ReadFootprintsOptions::within, how many are listed: a country has more of
/// them than anybody wants to be told.
inline constexpr std::int64_t kMostListedBeyond = 100'000;

struct ReadFootprintsOptions {
  std::string layer = {};         ///< Name; empty: the only layer with polygons.
  std::string id_attribute = {};  ///< Attribute that becomes source_id; empty: the feature number.
  std::string height_attribute = {};  ///< Attribute with heights above ground; empty: `height` of
                                      ///< the features that OpenStreetMap and Overture describe.
  std::string floors_attribute = {};  ///< Attribute with numbers of floors; empty:
                                      ///< `building:levels`, `building_levels`, `num_floors` or
                                      ///< `levels`, if there is one.
  double floor_height = 3;            ///< Metres per floor, > 0.
  double height_unit = 1;       ///< Metres per unit of heights that name none themselves, > 0.
  std::string where = {};       ///< OGR SQL condition on attributes: only such features are read.
  std::string source_crs = {};  ///< What the coordinates are in, whatever the file says; empty:
                                ///< what the file says.
  std::string target_crs = {};  ///< Reproject to this; empty: leave as they are.
  Bounds2 within = Bounds2::nothing();  ///< Features beyond it (by more than a margin) are dropped
                                        ///< as outside the domain; of them ids are read, and what
                                        ///< they state of heights. Empty: all are read.
  std::string within_crs = {};  ///< Of `within`; empty: that of the file, if it is in metres.
  bool own_crs_first = false;   ///< `within_crs` is for files that are not in metres, nor in feet.
  bool attributes = false;      ///< Keep all attributes of the features.
};

/// One polygon of the input.
struct Footprint {
  std::string source_id;  ///< Unique in the input; see read_footprints.
  Polygon polygon;        ///< CRS coordinates. Rings as they were read: neither repaired nor
                          ///< oriented; the repeated last vertex is gone, outer has >= 3 vertices.
  double height = std::numeric_limits<double>::quiet_NaN();  ///< Above ground, metres; NaN if the
                                                             ///< feature states none.
  std::int64_t feature = -1;           ///< Row of FootprintsInput::attributes; -1 if there is none.
  bool from_floors = false;            ///< The height is a number of floors times floor_height.
  std::vector<StatedRoof> roofs = {};  ///< Of a city model; none: flat at `height`.
  double base = std::numeric_limits<double>::quiet_NaN();  ///< Elevation that `height` and `roofs`
                                                           ///< are above, in a city model; NaN:
                                                           ///< that of the ground.
  bool is_planned = false;  ///< Has the height that it states, and others make way: those that it
                            ///< covers by half, and what it covers of all. Of height 0: nothing is
                            ///< to stand there.
  bool is_open_below = false;  ///< A roof on posts or a building that begins above the ground, by
                               ///< attributes of OpenStreetMap or Overture.

  /// Whether it is an area to be cleared.
  bool is_cleared() const { return is_planned && !(height > 0); }
};

/// A feature, or a polygon of one, that is no footprint.
struct UnusableFootprint : Dropped {
  std::int64_t feature = -1;  ///< As for Footprint.
  bool is_planned = false;    ///< Of a plan.
};

struct FootprintsInput {
  std::string source = "footprints";        ///< What messages call them: the path that was read.
  std::vector<Footprint> features;          ///< In the order of the file, parts of outlines last.
  std::vector<UnusableFootprint> dropped;   ///< Features and parts that are no footprint, and why.
  std::int64_t unlisted = 0;                ///< Features beyond ReadFootprintsOptions::within that
                                            ///< are not in `dropped` (kMostListedBeyond).
  std::vector<AttributeColumn> attributes;  ///< In the order of the file, if asked for. Binary ones
                                            ///< are left out, lists are text.
  std::int64_t features_read = 0;       ///< Features of the file, before multipolygons are split.
  std::string crs;                      ///< Of the coordinates (canonical, crs.h); "" if unknown.
  Bounds2 bounds = Bounds2::nothing();  ///< Of all vertices kept; empty if there are none.
  bool is_extent = false;               ///< `bounds` is of those alone that make a building.
  std::string layer;                    ///< The layer that was read.
  std::vector<Warning> warnings;
};

/// Reads the polygons of any vector format GDAL knows (SHP, GPKG, GeoJSON, FlatGeobuf, ...).
///
/// source_id is the value of the id attribute as text, or the feature number: GDAL's FID, which
/// starts at 0 in shapefiles and usually at 1 in GeoPackages. Features without a value in the id
/// attribute fall back on their number. The polygons of a multipolygon or collection are numbered
/// from 1 in their order; part k > 1 has "#k" added (part 1 keeps the plain id). An id that was
/// used before gets "~2", "~3", ... added, with the warning "duplicate_ids". Guarantee: every
/// feature is in `features` or in `dropped`, each of its polygons in exactly one of them, and no
/// two entries of both lists together have the same id.
///
/// Heights may be numbers or text that says one ("12.5", "12.5 m"); other text, what is above
/// 1,100 m, and 999 (which marks unknown heights) is NaN and counted by the warning
/// "height_not_a_number".
///
/// In shapefiles the ring around all others is the outer one; in all formats a part within a part
/// (not in one of its holes) and turned against it is a hole of it (what becomes of a shapefile
/// turned the wrong way), unless it leaves a rim of less than 1 m or lies more than a metre above
/// or below it. Features that are bodies in space (surfaces in space, or polygons of which three or
/// more are vertical) have the footprint that read_city would find, with the warning
/// "footprints_from_bodies".
///
/// Of OpenStreetMap's own formats only areas tagged as buildings are features; the attribute of
/// heights may be any of their tags.
///
/// `within` has no effect on files of unknown system, or of another than they say, and on city
/// models. A feature beyond it has one entry in `dropped` (DropCause::kOutside, no row), whatever
/// polygons it is made of; after kMostListedBeyond they are counted only.
///
/// Z and M are ignored, curves become chords of 4 degrees. Null, empty and other geometries are
/// dropped. Reprojection happens if the file's system and target_crs are both known and differ.
/// An unknown system is left alone: crs is then "" whatever the target, with the warning
/// "footprints_crs_unknown". A file in degrees whose features mostly cannot be is of unknown
/// system, too ("footprints_crs_implausible"; GeoJSON without a crs member means WGS 84 by RFC
/// 7946, but many files hold metres). Nothing is written anywhere, not even beside a .shp without
/// its .shx.
///
/// Errors, kInput with the path: missing, not a vector file, no polygon layer, several and none
/// named, unknown layer or attribute (the message lists what there is), a height attribute without
/// any number but with something else, a shapefile whose members are cut or do not belong together,
/// a file cut or broken so that features are lost without an account. kUsage: source_crs,
/// target_crs or within_crs is invalid.
FootprintsInput read_footprints(const std::filesystem::path& path,
                                const ReadFootprintsOptions& options = {});

/// The same in another system: what read_footprints makes of them with `target` as target_crs.
/// Precondition: footprints.crs is known. Errors: kUsage for a bad system; kInput with the source
/// if there is no way from one to the other.
void reproject_footprints(FootprintsInput& footprints, const std::string& target);

/// What a vector file says of one of its layers.
struct VectorLayer {
  std::string name;
  std::string geometry;  ///< As GDAL names it: "Multi Polygon", "Unknown (any)", "None".
  bool holds_polygons = false;
  std::int64_t features = -1;  ///< -1 where counting them means reading all of them.
  std::vector<std::string> attributes;
};

/// The layers in the order of the file. Errors as read_footprints has them for files that cannot be
/// opened.
std::vector<VectorLayer> list_layers(const std::filesystem::path& path);

/// Writes polygons with the attributes "id" (text) and, if heights are given, "height" (real).
/// The format follows the extension: .shp (with .shx, .dbf, .prj, .cpg), .gpkg, .geojson or .json.
/// GeoJSON gets a crs member unless the system is WGS 84 or unknown.
///
/// polygons: local frame; `origin` is added. ids and heights: one per polygon; heights may be empty
/// and NaN where unknown. Guarantee: the same input gives the same bytes with the same GDAL (dates
/// inside are fixed); every file appears complete or not at all, and of a shapefile the .shp last.
/// What is cut short while it replaces a shapefile may leave new members beside the old .shp.
/// Errors: kInput if it cannot be written, kUsage for another extension, a bad crs, or another
/// number of ids or heights than of polygons.
void write_footprints(const std::filesystem::path& path, std::span<const Polygon> polygons,
                      std::span<const std::string> ids, std::span<const double> heights,
                      Point2 origin, const std::string& crs);

}  // namespace tetropolis
