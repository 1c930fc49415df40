#include "tetropolis/io/vector/city_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "tetropolis/city/roof_summary.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/file/write_file.h"

#include "core/text.h"
#include "feature_attributes.h"
#include "io/crs/gdal_support.h"
#include "io/file/atomic_file.h"
#include "polygon_geometry.h"

namespace tetropolis {

namespace {

/// Below SQLite's 2,000 columns of a table, less those of ours.
constexpr std::size_t kMostAttributes = 1900;

/// Columns that buildings have in all layers.
constexpr std::array kHeightColumns = {"h_ground", "h_roof", "n_ground_points", "n_roof_points",
                                       "flags"};

/// A layer that is being written; fields are set in the order in which they were added.
class Layer {
 public:
  Layer(GDALDatasetH dataset, const char* name, OGRSpatialReferenceH srs) {
    layer_ = GDALDatasetCreateLayer(dataset, name, srs, wkbPolygon, nullptr);
    good_ = layer_ != nullptr;
  }

  void add_field(const std::string& name, OGRFieldType type, OGRFieldSubType subtype = OFSTNone) {
    if (!good_) return;
    OGRFieldDefnH field = OGR_Fld_Create(name.c_str(), type);
    OGR_Fld_SetSubType(field, subtype);
    good_ = OGR_L_CreateField(layer_, field, FALSE) == OGRERR_NONE;
    OGR_Fld_Destroy(field);
  }
  void add_height_fields() {
    for (const char* name : kHeightColumns)
      add_field(name, name[0] == 'h' ? OFTReal : name[0] == 'n' ? OFTInteger64 : OFTString);
  }

  void begin() {
    if (!good_) return;
    feature_.reset(OGR_F_Create(OGR_L_GetLayerDefn(layer_)));
    next_ = 0;
  }
  void set(const std::string& text) {
    if (feature_) OGR_F_SetFieldString(feature_.get(), next_++, text.c_str());
  }
  void set(std::int64_t value) {
    if (feature_) OGR_F_SetFieldInteger64(feature_.get(), next_++, value);
  }
  void set(double value) {
    if (feature_) OGR_F_SetFieldDouble(feature_.get(), next_++, value);
  }
  void set_null() { ++next_; }
  void set_heights(const Building& building) {
    set(building.h_ground);
    set(building.h_roof);
    set(building.n_ground_points);
    set(building.n_roof_points);
    set(fmt::format("{}", fmt::join(flag_names(building.flags), ",")));
  }
  void set_geometry(const Polygon& polygon, Point2 origin) {
    if (feature_) OGR_F_SetGeometryDirectly(feature_.get(), polygon_geometry(polygon, origin));
  }
  void end() {
    if (!feature_) return;
    good_ = OGR_L_CreateFeature(layer_, feature_.get()) == OGRERR_NONE;
    feature_.reset();
  }

  bool good() const { return good_; }

 private:
  OGRLayerH layer_;
  bool good_;
  gdal::Feature feature_;
  int next_ = 0;
};

/// Names of columns that SQLite takes for different ones.
class ColumnNames {
 public:
  explicit ColumnNames(std::span<const char* const> taken) {
    for (const char* name : taken) taken_.insert(name);
  }
  std::string unique(const std::string& wanted) {
    const std::string base = wanted.empty() ? "attribute" : wanted;
    std::string name = base;
    for (int k = 2; !taken_.insert(lower_case(name)).second; ++k)
      name = fmt::format("{}_{}", base, k);
    return name;
  }

 private:
  std::set<std::string> taken_;
};

/// Where each feature of the input ended.
struct Fates {
  std::unordered_map<std::string_view, const Building*> raw;
  std::unordered_map<std::string_view, const Building*> city;
  std::unordered_map<std::string_view, const Dropped*> dropped;
};

template <typename Map>
auto find(const Map& map, const std::string& id) {
  const auto found = map.find(id);
  return found == map.end() ? nullptr : found->second;
}

Fates fates_of(const CityModel& raw, const CityModel& city) {
  Fates fates;
  for (const Building& building : raw.buildings)
    for (const std::string& id : building.source_ids) fates.raw.emplace(id, &building);
  for (const Building& building : city.buildings)
    for (const std::string& id : building.source_ids) fates.city.emplace(id, &building);
  for (const Dropped& dropped : city.dropped) fates.dropped.emplace(dropped.source_id, &dropped);
  return fates;
}

class FootprintsLayer {
 public:
  FootprintsLayer(GDALDatasetH dataset, OGRSpatialReferenceH srs, const Fates& fates,
                  const FootprintsInput& input)
      : layer_(dataset, "footprints", srs),
        fates_(fates),
        attributes_(
            std::span(input.attributes).first(std::min(input.attributes.size(), kMostAttributes))) {
    std::vector<const char*> ours{"fid", "geom", "source_id", "fate", "tetropolis_id"};
    ours.insert(ours.end(), kHeightColumns.begin(), kHeightColumns.end());
    ColumnNames names(ours);
    for (const AttributeColumn& column : attributes_)
      layer_.add_field(names.unique(column.name), field_type(column.type),
                       column.type == AttributeType::kBoolean ? OFSTBoolean : OFSTNone);
    for (const char* name : {"source_id", "fate", "tetropolis_id"})
      layer_.add_field(name, OFTString);
    layer_.add_height_fields();
  }

  /// `polygon`: null if there is none.
  void add(const std::string& id, std::int64_t row, const Polygon* polygon, Point2 origin) {
    const Dropped* dropped = find(fates_.dropped, id);
    if (dropped != nullptr && dropped->cause == DropCause::kOutside) return;
    layer_.begin();
    for (const AttributeColumn& column : attributes_) set(column, row);
    layer_.set(id);
    set_fate(id, dropped);
    if (polygon != nullptr) layer_.set_geometry(*polygon, origin);
    layer_.end();
  }

  bool good() const { return layer_.good(); }

 private:
  void set(const AttributeColumn& column, std::int64_t row) {
    const auto at = static_cast<std::size_t>(row);
    if (row < 0 || !column.known[at])
      layer_.set_null();
    else
      std::visit([&](const auto& values) { layer_.set(values[at]); }, column.values);
  }

  void set_fate(const std::string& id, const Dropped* dropped) {
    const Building* building = find(fates_.city, id);
    if (building != nullptr) {
      const bool is_merged = building->source_ids.size() > 1;
      layer_.set(is_merged ? "merged into " + building->id : std::string("kept"));
      layer_.set(building->id);
    } else {
      layer_.set("dropped: " + (dropped != nullptr ? dropped->reason : std::string()));
      layer_.set_null();
    }
    if (const Building* itself = find(fates_.raw, id)) layer_.set_heights(*itself);
  }

  Layer layer_;
  const Fates& fates_;
  std::span<const AttributeColumn> attributes_;
};

bool add_footprints(GDALDatasetH dataset, OGRSpatialReferenceH srs, const Fates& fates,
                    const FootprintsInput& input, Point2 origin) {
  FootprintsLayer layer(dataset, srs, fates, input);
  for (const Footprint& feature : input.features)
    layer.add(feature.source_id, feature.feature, &feature.polygon, origin);
  for (const UnusableFootprint& unusable : input.dropped)
    layer.add(unusable.source_id, unusable.feature, nullptr, origin);
  return layer.good();
}

bool add_buildings(GDALDatasetH dataset, OGRSpatialReferenceH srs, const CityModel& city) {
  Layer layer(dataset, "buildings", srs);
  layer.add_field("tetropolis_id", OFTString);
  layer.add_field("n_sources", OFTInteger64);
  layer.add_field("source_ids", OFTString);
  layer.add_height_fields();
  for (const Building& building : city.buildings) {
    layer.begin();
    layer.set(building.id);
    layer.set(static_cast<std::int64_t>(building.source_ids.size()));
    layer.set(nlohmann::json(building.source_ids)
                  .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    layer.set_heights(building);
    layer.set_geometry(building.footprint, city.origin);
    layer.end();
  }
  return layer.good();
}

/// Nothing if no building has parts.
bool add_parts(GDALDatasetH dataset, OGRSpatialReferenceH srs, const CityModel& city) {
  if (std::none_of(city.buildings.begin(), city.buildings.end(),
                   [](const Building& building) { return !building.parts.empty(); }))
    return true;
  Layer layer(dataset, "parts", srs);
  layer.add_field("tetropolis_id", OFTString);
  layer.add_field("part", OFTInteger64);
  for (const char* name : {"source_id", "lod"}) layer.add_field(name, OFTString);
  for (const char* name : {"slope", "azimuth", "area", "rmse"}) layer.add_field(name, OFTReal);
  layer.add_field("n_points", OFTInteger64);
  for (const char* name : {"h_min", "h_max"}) layer.add_field(name, OFTReal);
  const auto set_or_null = [&](std::optional<double> value) {
    if (value && std::isfinite(*value))
      layer.set(*value);
    else
      layer.set_null();
  };
  for (const Building& building : city.buildings)
    for (std::size_t k = 0; k < building.parts.size(); ++k) {
      const RoofPart& part = building.parts[k];
      const RoofRange range = range_of(part);
      layer.begin();
      layer.set(building.id);
      layer.set(static_cast<std::int64_t>(k));
      layer.set(part.source_id);
      layer.set(std::string(name_of(part.lod)));
      layer.set(slope_degrees(part.roof));
      set_or_null(azimuth_degrees(part.roof));
      layer.set(area(part.outline));
      set_or_null(part.rmse);
      layer.set(part.n_points);
      layer.set(range.low);
      layer.set(range.high);
      layer.set_geometry(part.outline, city.origin);
      layer.end();
    }
  return layer.good();
}

bool add_dropped(GDALDatasetH dataset, OGRSpatialReferenceH srs, const CityModel& city,
                 const FootprintsInput& input) {
  std::unordered_map<std::string_view, const Polygon*> polygons;
  for (const Footprint& feature : input.features)
    polygons.emplace(feature.source_id, &feature.polygon);
  Layer layer(dataset, "dropped", srs);
  for (const char* name : {"source_id", "cause", "reason"}) layer.add_field(name, OFTString);
  for (const Dropped& dropped : city.dropped) {
    if (dropped.cause == DropCause::kOutside) continue;
    layer.begin();
    layer.set(dropped.source_id);
    layer.set(std::string(name_of(dropped.cause)));
    layer.set(dropped.reason);
    if (const Polygon* polygon = find(polygons, dropped.source_id))
      layer.set_geometry(*polygon, city.origin);
    layer.end();
  }
  return layer.good();
}

}  // namespace

void write_city_layers(const std::filesystem::path& path, const CityModel& raw,
                       const CityModel& city, const FootprintsInput& footprints) {
  gdal::initialise();
  const std::string crs = normalise_crs(city.crs);
  const gdal::MemoryFolder folder;
  const std::string name = path.filename().string();
  gdal::QuietErrors errors;
  const gdal::ConfigOption fixed_date("OGR_CURRENT_DATE", "1970-01-01T00:00:00Z");
  // To check that there are none, GDAL reads the tiling schemes of its data folder.
  const gdal::ConfigOption unchecked("GDAL_VALIDATE_CREATION_OPTIONS", "NO");
  gdal::Dataset dataset(GDALCreate(GDALGetDriverByName("GPKG"), folder.path(name).c_str(), 0, 0, 0,
                                   GDT_Unknown, nullptr));
  if (dataset == nullptr) throw_cannot_write(path, errors.last());
  const gdal::Srs srs = crs.empty() ? nullptr : gdal::parse_srs(crs);
  const Fates fates = fates_of(raw, city);
  const bool written = GDALDatasetStartTransaction(dataset.get(), FALSE) == OGRERR_NONE &&
                       add_footprints(dataset.get(), srs.get(), fates, footprints, city.origin) &&
                       add_buildings(dataset.get(), srs.get(), city) &&
                       add_parts(dataset.get(), srs.get(), city) &&
                       add_dropped(dataset.get(), srs.get(), city, footprints) &&
                       GDALDatasetCommitTransaction(dataset.get()) == OGRERR_NONE;
  dataset.reset();  // Closing writes what is left, and may fail.
  if (!written || errors.failures() > 0) throw_cannot_write(path, errors.last());
  write_file(path, folder.bytes(name));
}

}  // namespace tetropolis
