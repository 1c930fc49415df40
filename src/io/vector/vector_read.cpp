#include "vector_read.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/crs/datum.h"
#include "tetropolis/io/crs/metric_crs.h"
#include "tetropolis/io/vector/vector.h"

#include "core/foreign_code.h"
#include "feature_attributes.h"
#include "feature_heights.h"
#include "feature_marks.h"
#include "io/crs/gdal_support.h"
#include "io/deferred/gdal_functions.h"
#include "io/file/input_file.h"
#include "io/vector/quirks/incomplete_file.h"
#include "model_footprints.h"
#include "vector_geometry.h"
#include "vector_layers.h"
#include "vector_open.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

constexpr const char* kGetAgain = "; the file is cut or broken, get it again";

OGRFieldDefnH definition(OGRLayerH layer, int field) {
  return OGR_FD_GetFieldDefn(OGR_L_GetLayerDefn(layer), field);
}

bool is_real(OGRLayerH layer, int field) {
  return field >= 0 && OGR_Fld_GetType(definition(layer, field)) == OFTReal;
}

/// A number as an id: whole ones without decimals (numbers in tables have some), and with all their
/// digits, which GDAL cuts to 15.
std::string number_id(double value, bool is_single) {
  if (std::trunc(value) == value) return fmt::format("{:.0f}", value + 0.0);  // no -0
  return is_single ? fmt::format("{}", static_cast<float>(value)) : fmt::format("{}", value);
}

/// Hands out ids that were not handed out before.
class UniqueIds {
 public:
  std::string unique(const std::string& wanted) {
    if (used_.insert(wanted).second) return wanted;
    ++duplicates_;
    int& number = next_[wanted];
    if (number == 0) number = 2;
    for (;; ++number) {
      std::string id = fmt::format("{}~{}", wanted, number);
      if (used_.insert(id).second) return id;
    }
  }
  std::int64_t duplicates() const { return duplicates_; }

 private:
  std::unordered_set<std::string> used_;
  std::unordered_map<std::string, int> next_;
  std::int64_t duplicates_ = 0;
};

/// Whether the layer's first coordinate is the northing or latitude.
bool is_north_first(OGRSpatialReferenceH srs) {
  if (srs == nullptr) return false;
  int count = 0;
  const int* mapping = OSRGetDataAxisToSRSAxisMapping(srs, &count);
  if (mapping == nullptr || count < 2) return false;
  const int first = mapping[0];
  const gdal::Srs usual(OSRClone(srs));
  OSRSetAxisMappingStrategy(usual.get(), OAMS_TRADITIONAL_GIS_ORDER);
  mapping = OSRGetDataAxisToSRSAxisMapping(usual.get(), &count);
  return mapping != nullptr && count >= 2 && mapping[0] != first;
}

/// `source_crs`: what coordinates are in whatever the layer says; empty: what it says.
PlanUnits units_of(OGRSpatialReferenceH srs, const std::string& source_crs) {
  constexpr double kMetresPerDegree = 111'000;
  const bool degrees = source_crs.empty() ? srs != nullptr && OSRIsGeographic(srs) != 0
                                          : is_geographic(normalise_crs(source_crs));
  if (degrees) return {is_north_first(srs), kMetresPerDegree, 1};
  double length = !source_crs.empty() ? linear_unit_metres(normalise_crs(source_crs))
                  : srs == nullptr    ? 1
                                      : OSRGetLinearUnits(srs, nullptr);
  if (!(length > 0)) length = 1;  // unknown
  return {is_north_first(srs), length, length};
}

/// Whether a file that says degrees holds numbers that are none, other than a few broken ones.
class DegreesCheck {
 public:
  explicit DegreesCheck(bool geojson) {
    // RFC 7946 allows -180 to 180, which some exceed a little at that meridian; elsewhere 0 to 360
    // is in use too.
    const double limit = geojson ? 181.0 : 360.0;
    globe_ = {-limit, -90, limit, 90};
  }
  void add(const Bounds2& box) {
    constexpr double kWidest = 0.5;  // degrees: no building is so wide, but many are so many metres
    ++count_;
    if (!globe_.covers(box)) ++outside_;
    if (!globe_.covers(box) || std::max(box.width(), box.height()) > kWidest) ++others_;
  }
  bool are_none() const { return outside_ > 0 && 2 * others_ > count_; }

 private:
  Bounds2 globe_;
  std::size_t count_ = 0, outside_ = 0, others_ = 0;
};

/// Reads all features of one layer.
class LayerReader {
 public:
  /// `box`: where features matter, in the layer's coordinates; empty: everywhere.
  LayerReader(const fs::path& path, const FootprintLayer& source,
              const ReadFootprintsOptions& options, const VectorFile& file, const Bounds2& box,
              FootprintsInput& result)
      : path_(path),
        source_(source),
        layer_(source.get()),
        id_field_(find_attribute(path, layer_, options.id_attribute)),
        real_ids_(is_real(layer_, id_field_)),
        single_ids_(real_ids_ && OGR_Fld_GetSubType(definition(layer_, id_field_)) == OFSTFloat32),
        heights_(path, layer_, options),
        attributes_(layer_, options.attributes, result.attributes),
        id_name_(options.id_attribute),
        units_(units_of(source.reference_system(), options.source_crs)),
        shells_by_turn_(is_of_format(file.dataset.get(), "ESRI Shapefile")),
        box_(box),
        degrees_(is_of_format(file.dataset.get(), "GeoJSON")),
        result_(result),
        marks_(layer_) {
    if (!file.is_osm) return;
    OGRFeatureDefnH columns = OGR_L_GetLayerDefn(layer_);
    osm_relation_ = OGR_FD_GetFieldIndex(columns, "osm_id");
    osm_way_ = OGR_FD_GetFieldIndex(columns, "osm_way_id");
  }

  /// `counted`: whether the format tells how many features there are.
  /// `geometries`: whether failures at these cost nothing but their feature.
  void read(gdal::QuietErrors& errors, bool counted, bool geometries) {
    errors.reset();
    const std::int64_t expected = OGR_L_GetFeatureCount(layer_, FALSE);
    if (errors.failures() > 0)
      fail_input(path_, "cannot be read to its end" + errors.reason() + kGetAgain);
    OGR_L_ResetReading(layer_);
    for (;;) {
      const std::size_t known = errors.passed_over().size();
      const gdal::Feature feature{OGR_L_GetNextFeature(layer_)};
      for (std::size_t k = known; k < errors.passed_over().size(); ++k)
        drop_passed_over(errors.passed_over()[k]);
      if (feature == nullptr) break;
      ++result_.features_read;
      add(feature.get());
    }
    const std::int64_t failures =
        geometries ? errors.failures(gdal::About::kAnything) : errors.failures();
    // Lines that are not JSON are passed over, and counted by nobody.
    const bool lost =
        errors.first(gdal::About::kAnything).find("JSON parsing error") != std::string::npos;
    const bool is_short = result_.features_read < expected;
    if ((counted && is_short) || (failures > 0 && (lost || expected < 0 || is_short)))
      fail_input(path_, fmt::format("reading ends after {} features{}{}{}", result_.features_read,
                                    expected < 0 ? "" : fmt::format(" of {}", expected),
                                    errors.reason(), kGetAgain));
    if (errors.failures() > 0) warn_of_errors(errors.failures(), errors.first());
    report();
  }

  /// Of the buildings of an OpenStreetMap file that have no area, or not all of it.
  void account_for_osm(const VectorFile& file) {
    result_.features_read += std::ssize(file.osm_lost);
    for (const Dropped& lost : file.osm_lost)
      drop(ids_.unique(lost.source_id), lost.reason, -1, lost.cause);
    if (const std::vector<std::string>& ways = file.osm_incomplete; !ways.empty())
      warn("osm_nodes_missing", std::ssize(ways),
           fmt::format(
               "{} buildings lack corners, as the file lacks their nodes (first: {}); get an "
               "extract with complete ways",
               ways.size(), ways.front()));
  }

  /// Parts stand for the outlines that they fill.
  void settle_parts() {
    const std::size_t before = result_.dropped.size();
    put_parts_for_outlines(parts_, result_);
    if (const std::size_t outlined = result_.dropped.size() - before; outlined > 0)
      warn("outlines_of_parts", static_cast<std::int64_t>(outlined),
           fmt::format("{} outlines are dropped, as their parts stand for them", outlined));
  }

  /// What all features say of degrees.
  const DegreesCheck& degrees() const { return degrees_; }

  /// Of what was read with errors.
  void warn_of_errors(std::int64_t count, const std::string& first) {
    warn("footprints_read_errors", count,
         fmt::format("{} errors while reading (first: {})", count, first));
  }

 private:
  /// `message`: "Geometry of feature NUMBER NAME cannot be parsed: WHY. Skipping to next feature."
  void drop_passed_over(const std::string& message) {
    constexpr std::string_view kBegin = "Geometry of feature ", kWhy = " cannot be parsed: ";
    std::string_view text = message;
    if (text.starts_with(kBegin)) text.remove_prefix(kBegin.size());
    std::string reason = "geometry that cannot be read";
    const std::string_view number = text.substr(0, text.find(' '));
    if (const std::size_t why = text.find(kWhy); why != text.npos) {
      const std::string_view name = text.substr(0, why);
      text = text.substr(why + kWhy.size());
      reason += fmt::format(" (feature {}: {})", name, text.substr(0, text.find(". Skipping")));
    }
    ++result_.features_read;
    drop(ids_.unique(std::string(number)), std::move(reason));
  }

  void drop(std::string id, std::string reason, std::int64_t row = -1,
            DropCause cause = DropCause::kUnusable) {
    result_.dropped.push_back({{std::move(id), std::move(reason), cause}, row});
  }

  void drop_beyond(const std::string& id) {
    if (beyond_++ < kMostListedBeyond)
      drop(ids_.unique(id), kOutsideReason, -1, DropCause::kOutside);
    else
      ++result_.unlisted;
  }

  /// "way/7", "relation/3"; else the feature number.
  std::string number_of(OGRFeatureH feature) const {
    for (const auto& [kind, field] :
         {std::pair{"relation", osm_relation_}, std::pair{"way", osm_way_}})
      if (field >= 0 && OGR_F_IsFieldSetAndNotNull(feature, field) != 0)
        return fmt::format("{}/{}", kind, OGR_F_GetFieldAsString(feature, field));
    return std::to_string(OGR_F_GetFID(feature));
  }

  /// Empty without geometry.
  Bounds2 box_of(OGRGeometryH geometry) const {
    if (geometry == nullptr || OGR_G_IsEmpty(geometry) != 0) return Bounds2::nothing();
    OGREnvelope box;
    OGR_G_GetEnvelope(geometry, &box);
    if (units_.north_first) return {box.MinY, box.MinX, box.MaxY, box.MaxX};
    return {box.MinX, box.MinY, box.MaxX, box.MaxY};
  }

  void add(OGRFeatureH feature) {
    const std::string id = feature_id(feature);
    const OGRGeometryH geometry = source_.geometry_of(feature);
    if (const Bounds2 box = box_of(geometry); !box.empty()) {
      degrees_.add(box);
      if (!box_.empty() && !box.intersects(box_)) {
        heights_.read(feature, id);
        drop_beyond(id);
        return;
      }
    }
    const std::int64_t row = result_.attributes.empty() ? -1 : rows_++;
    attributes_.read(feature);
    FlatGeometry flat = flatten(geometry, units_);
    if (flat.is_body)
      ++bodies_;
    else if (shells_by_turn_)
      mend_turned_rings(flat.parts);
    else
      mend_order_of_rings(flat.parts);
    if (flat.parts.empty()) {
      drop(ids_.unique(id), std::move(flat.reason), row);
      return;
    }
    if (flat.other_parts > 0) ++mixed_;
    if (flat.is_of_lines) ++lines_;
    courtyards_ += flat.courtyards;
    FeatureMarks marks = marks_.read(feature);
    if (!marks.below_ground.empty()) {
      ++below_ground_;
      drop(ids_.unique(id), std::move(marks.below_ground), row, DropCause::kNotABuilding);
      return;
    }
    const StatedHeight height = heights_.read(feature, id);
    for (std::size_t k = 0; k < flat.parts.size(); ++k) {
      PolygonPart& part = flat.parts[k];
      std::string part_id = ids_.unique(k == 0 ? id : fmt::format("{}#{}", id, k + 1));
      if (!part.reason.empty()) {
        drop(std::move(part_id), std::move(part.reason), row);
        continue;
      }
      if (units_.north_first) for_each_vertex(part.polygon, [](Point2& p) { std::swap(p.x, p.y); });
      result_.features.push_back(
          {std::move(part_id), std::move(part.polygon), height.metres, row, height.from_floors});
      result_.features.back().is_open_below = marks.is_open_below;
      parts_.push_back(marks.is_part);
    }
  }

  std::string feature_id(OGRFeatureH feature) {
    if (id_field_ >= 0) {
      if (OGR_F_IsFieldSetAndNotNull(feature, id_field_) != 0) {
        std::string id = real_ids_
                             ? number_id(OGR_F_GetFieldAsDouble(feature, id_field_), single_ids_)
                             : gdal::utf8(OGR_F_GetFieldAsString(feature, id_field_));
        if (!id.empty()) return id;
      }
      ++without_id_;
    }
    return number_of(feature);
  }

  void report() {
    if (ids_.duplicates() > 0)
      warn("duplicate_ids", ids_.duplicates(),
           fmt::format("{} ids are repeated{}; further ones get the suffixes '~2', '~3', ...",
                       ids_.duplicates(),
                       id_name_.empty() ? "" : " (attribute '" + id_name_ + "')"));
    const auto tell = [&](const char* code, std::int64_t count, const std::string& what) {
      if (count > 0) warn(code, count, fmt::format("{} {}", count, what));
    };
    tell("missing_ids", without_id_,
         "features have no value in '" + id_name_ + "'; their ids are feature numbers");
    tell("mixed_geometry", mixed_,
         "features have points or lines beside their polygons; only the polygons are read");
    tell("parts_as_yards", courtyards_,
         "parts lie within another part and turn against it; they became its courtyards");
    tell("outlines_from_lines", lines_, "features are closed lines, which are taken for outlines");
    tell("footprints_from_bodies", bodies_,
         "features are 3D bodies; their footprints are the outlines of their ground faces; set "
         "layer to one of footprints if there is one");
    tell("below_ground", below_ground_,
         "features are below ground by their attributes and are dropped");
    for (Warning& warning : heights_.warnings()) result_.warnings.push_back(std::move(warning));
  }

  void warn(const char* code, std::int64_t count, const std::string& message) {
    result_.warnings.push_back({code, count, one_line(path_.string() + ": " + message)});
  }

  const fs::path& path_;
  const FootprintLayer& source_;
  OGRLayerH layer_;
  int id_field_;
  bool real_ids_;
  bool single_ids_;
  HeightReader heights_;
  AttributeReader attributes_;
  std::int64_t rows_ = 0;  ///< Of the attributes.
  std::string id_name_;
  PlanUnits units_;
  bool shells_by_turn_;  ///< The format tells shells from holes by their turn.
  Bounds2 box_;
  DegreesCheck degrees_;
  FootprintsInput& result_;
  UniqueIds ids_;
  std::int64_t beyond_ = 0;
  std::int64_t without_id_ = 0;
  std::int64_t mixed_ = 0;
  std::int64_t courtyards_ = 0;
  std::int64_t bodies_ = 0;
  std::int64_t lines_ = 0;
  int osm_relation_ = kNoField;  ///< Columns of OpenStreetMap's numbers.
  int osm_way_ = kNoField;
  MarkReader marks_;
  std::vector<bool> parts_;  ///< Per feature kept.
  std::int64_t below_ground_ = 0;
};

Bounds2 bounds_of(std::vector<Footprint>& features) {
  Bounds2 box = Bounds2::nothing();
  for (Footprint& feature : features)
    for_each_vertex(feature.polygon, [&](const Point2& p) { box.extend(p); });
  return box;
}

void settle_crs(const fs::path& path, const ReadFootprintsOptions& options, bool is_implausible,
                FootprintsInput& result) {
  if (is_implausible) {
    result.warnings.push_back(
        {"footprints_crs_implausible", 1,
         fmt::format(
             "{}: says {}, but x {} .. {}, y {} .. {} are not degrees; its CRS is ignored, name "
             "it with footprints_crs",
             path.string(), crs_name(result.crs), result.bounds.xmin, result.bounds.xmax,
             result.bounds.ymin, result.bounds.ymax)});
    result.crs.clear();
    return;
  }
  if (result.crs.empty())
    result.warnings.push_back(
        {"footprints_crs_unknown", 1,
         path.string() + ": states no CRS" +
             (options.target_crs.empty() ? "; name it with footprints_crs"
                                         : fmt::format(": taken from the points ({}); if it is "
                                                       "another, name it with footprints_crs",
                                                       crs_name(options.target_crs)))});
}

/// Where features matter, in the coordinates of `crs`; empty: everywhere.
Bounds2 box_to_read(const ReadFootprintsOptions& options, const std::string& crs) {
  if (options.within.empty() || crs.empty()) return Bounds2::nothing();
  constexpr double kMargin = 100;  // metres: sides bend on their way to another system
  const Bounds2 box = options.within.grown(kMargin);
  const bool is_projected = !is_geographic(crs) && is_true_to_scale(crs, box);
  const std::string from = normalise_crs(options.within_crs);
  if (!from.empty() && !(options.own_crs_first && is_projected)) {
    try {
      return reproject_box(box, from, crs);
    } catch (const Error&) {
      return Bounds2::nothing();  // a local system, which nothing leads to: told when it matters
    }
  }
  return is_projected && is_metre(linear_unit_metres(crs)) ? box : Bounds2::nothing();
}

/// Where the accurate way to another datum needs a grid that is not there.
void warn_of_missing_grid(const fs::path& path, const std::string& target,
                          FootprintsInput& result) {
  const auto grid = find_missing_grid(result.crs, target, result.bounds);
  if (!grid) return;
  result.warnings.push_back(
      {"grid_missing", 1,
       one_line(fmt::format(
           "{}: from {} to {} PROJ lacks the grid {}, so positions may be off by {}instead of "
           "{:g} m; install it (projsync --file {}, or the package proj-data)",
           path.string(), crs_name(result.crs), crs_name(target), grid->name,
           grid->accuracy < 0 ? "metres " : fmt::format("{:g} m and more ", grid->accuracy),
           std::max(grid->accuracy_with, 0.0), grid->name))});
}

void reproject_features(const fs::path& path, const std::string& target, FootprintsInput& result) {
  warn_of_missing_grid(path, target, result);
  std::vector<Point2> points;
  for (Footprint& feature : result.features)
    for_each_position(feature, [&](const Point2& p) { points.push_back(p); });
  try {
    points = reproject(points, result.crs, target);
  } catch (const Error& error) {
    fail_input(path,
               fmt::format("{}; name the CRS of the footprints with footprints_crs, that of the "
                           "points with points_crs",
                           error.what()));
  }
  std::size_t next = 0;
  std::vector<Footprint> kept;
  kept.reserve(result.features.size());
  for (Footprint& feature : result.features) {
    bool good = true;
    for_each_position(feature, [&](Point2& p) {
      p = points[next++];
      good = good && std::isfinite(p.x);
    });
    if (good)
      kept.push_back(std::move(feature));
    else
      result.dropped.push_back(
          {{std::move(feature.source_id), "coordinates that cannot be reprojected"},
           feature.feature});
  }
  result.features = std::move(kept);
  result.crs = target;
  result.bounds = bounds_of(result.features);
}

}  // namespace

void reproject_footprints(FootprintsInput& footprints, const std::string& target_crs) {
  const std::string target = normalise_crs(target_crs);
  if (same_horizontal_crs(footprints.crs, target))
    footprints.crs = target;
  else
    reproject_features(footprints.source, target, footprints);
}

FootprintsInput read_open_vector(const fs::path& path, const VectorFile& file,
                                 gdal::QuietErrors& errors, const ReadFootprintsOptions& options) {
  const std::string target = normalise_crs(options.target_crs);
  const FootprintLayer source(path, file.dataset.get(), options.layer);
  if (!options.where.empty() &&
      OGR_L_SetAttributeFilter(source.get(), options.where.c_str()) != OGRERR_NONE)
    fail_input(
        path, fmt::format("`where`: {}{}; write it as in \"status = 'built'\"{}", options.where,
                          errors.reason(),
                          file.is_osm || is_of_format(file.dataset.get(), "CSV")
                              ? ", and numbers, which are text here, as in \"CAST(height AS float) "
                                "> 5\""
                              : ""));
  FootprintsInput result;
  result.source = path.string();
  result.layer = gdal::utf8(OGR_L_GetName(source.get()));
  result.crs = options.source_crs.empty() ? gdal::canonical_name(source.reference_system(), target)
                                          : normalise_crs(options.source_crs);
  const Bounds2 box = box_to_read(options, result.crs);
  LayerReader reader(path, source, options, file, box, result);
  reader.read(errors, is_of_format(file.dataset.get(), "FlatGeobuf"),
              drops_geometries(file.dataset.get()));
  reader.account_for_osm(file);
  reader.settle_parts();
  // Where features are parsed again as they are read, that has told of them.
  if (file.opening_errors > 0 && errors.failures() == 0)
    reader.warn_of_errors(file.opening_errors, file.first_error);
  if (const std::string why = why_incomplete(path); !why.empty())
    result.warnings.push_back({"footprints_fewer", 1, one_line(path.string() + ": " + why)});
  const bool is_implausible = options.source_crs.empty() && !result.crs.empty() &&
                              is_geographic(result.crs) && reader.degrees().are_none();
  if (is_implausible && !box.empty()) {
    ReadFootprintsOptions everywhere = options;
    everywhere.within = Bounds2::nothing();
    return read_open_vector(path, file, errors, everywhere);
  }
  result.bounds = bounds_of(result.features);
  settle_crs(path, options, is_implausible, result);
  if (!target.empty() && !result.crs.empty()) reproject_footprints(result, target);
  return result;
}

FootprintsInput read_footprints(const fs::path& path, const ReadFootprintsOptions& options) {
  // GDAL ends the program where a small allocation of its own fails.
  const ForeignCode gdal_code(path.c_str());
  gdal::initialise();
  if (is_city_model(path)) return read_model_footprints(path, options);
  normalise_crs(options.target_crs);  // what is wrong with a setting is told before files are read
  gdal::QuietErrors errors;
  const gdal::ConfigOption by_layer("OGR_INTERLEAVED_READING", "NO");
  const gdal::ConfigOption nothing_beside("CPL_VSIL_GZIP_WRITE_PROPERTIES", "NO");
  const gdal::ConfigOption on("GML_SKIP_CORRUPTED_FEATURES", "YES");
  // Of shapefiles, whose systems have no codes: canonical_name() looks for one if it has to.
  const gdal::ConfigOption no_search("USE_OSR_FIND_MATCHES", "NO");
  const VectorFile file = open_vector(path, errors, !options.source_crs.empty());
  return read_open_vector(path, file, errors, options);
}

}  // namespace tetropolis
