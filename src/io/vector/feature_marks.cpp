#include "feature_marks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/polygon.h"

#include "core/text.h"
#include "feature_heights.h"
#include "measure_text.h"
#include "polygon_geometry.h"

namespace tetropolis {

namespace {

int column(OGRLayerH layer, const char* name) {
  return OGR_FD_GetFieldIndex(OGR_L_GetLayerDefn(layer), name);
}

gdal::Geometry valid_geometry(const Polygon& polygon) {
  gdal::Geometry geometry(polygon_geometry(polygon));
  if (OGR_G_IsValid(geometry.get()) == 0) geometry.reset(OGR_G_MakeValid(geometry.get()));
  return geometry;
}

Ring ring_of(OGRGeometryH line) {
  Ring ring;
  for (int k = 0; k + 1 < OGR_G_GetPointCount(line); ++k)
    ring.push_back({OGR_G_GetX(line, k), OGR_G_GetY(line, k)});
  return ring;
}

void collect_polygons(OGRGeometryH geometry, double least, std::vector<Polygon>& polygons) {
  if (geometry == nullptr) return;
  if (wkbFlatten(OGR_G_GetGeometryType(geometry)) != wkbPolygon) {
    for (int k = 0; k < OGR_G_GetGeometryCount(geometry); ++k)
      collect_polygons(OGR_G_GetGeometryRef(geometry, k), least, polygons);
    return;
  }
  if (!(OGR_G_Area(geometry) > least)) return;
  Polygon polygon;
  polygon.outer = ring_of(OGR_G_GetGeometryRef(geometry, 0));
  for (int k = 1; k < OGR_G_GetGeometryCount(geometry); ++k)
    polygon.holes.push_back(ring_of(OGR_G_GetGeometryRef(geometry, k)));
  polygons.push_back(std::move(polygon));
}

}  // namespace

MarkReader::MarkReader(OGRLayerH layer)
    : location_(column(layer, "location")),
      layer_(column(layer, "layer")),
      underground_(column(layer, "is_underground")),
      part_(column(layer, "building:part")),
      building_(column(layer, "building")),
      building_id_(column(layer, "building_id")),
      levels_(column(layer, "building:levels")),
      below_(column(layer, "building:levels:underground")),
      tags_(column(layer, "other_tags")),
      min_height_(column(layer, "min_height")),
      min_level_(column(layer, "building:min_level")) {}

std::string MarkReader::text(OGRFeatureH feature, int field, const char* tag) const {
  const int source = field >= 0 ? field : tags_;
  if (source < 0 || OGR_F_IsFieldSetAndNotNull(feature, source) == 0) return {};
  const std::string value = gdal::utf8(OGR_F_GetFieldAsString(feature, source));
  return lower_case(field >= 0 ? value : value_of_tag(value, tag));
}

FeatureMarks MarkReader::read(OGRFeatureH feature) const {
  FeatureMarks marks;
  const std::string underground =
      underground_ >= 0 ? text(feature, underground_, "is_underground") : std::string();
  const std::string location = text(feature, location_, "location");
  const std::string layer = text(feature, layer_, "layer");
  if (underground == "1" || underground == "true" || underground == "yes")
    marks.below_ground = "below ground (is_underground)";
  else if (location == "underground" || location == "subsurface")
    marks.below_ground = fmt::format("below ground (location={})", location);
  else if (floors_of(layer) < 0)
    marks.below_ground = fmt::format("below ground (layer={})", layer);
  else if (floors_of(text(feature, levels_, "building:levels")) == 0 &&
           floors_of(text(feature, below_, "building:levels:underground")) > 0)
    marks.below_ground = "below ground (building:levels=0)";
  const std::string part = text(feature, part_, "building:part");
  const std::string building = text(feature, building_, "building");
  const bool is_osm_part = !part.empty() && part != "no" && (building.empty() || building == "no");
  const bool is_overture_part =
      underground_ >= 0 && building_id_ >= 0 && !text(feature, building_id_, "").empty();
  marks.is_part = is_osm_part || is_overture_part;
  // Below parts there mostly are others. Elsewhere a column min_height is of the roof.
  marks.is_open_below =
      !marks.is_part && (!building.empty() || underground_ >= 0) &&
      (building == "roof" || metres_of(text(feature, min_height_, "min_height"), 1) > 0 ||
       floors_of(text(feature, min_level_, "building:min_level")) > 0);
  return marks;
}

void put_parts_for_outlines(const std::vector<bool>& parts, FootprintsInput& input) {
  struct Box {
    Bounds2 box;
    std::size_t feature;
  };
  std::vector<Box> boxes;
  double widest = 0;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (parts[i]) {
      boxes.push_back({bounds(input.features[i].polygon), i});
      widest = std::max(widest, boxes.back().box.width());
    }
  if (boxes.empty()) return;
  std::sort(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) {
    return std::pair(a.box.xmin, a.feature) < std::pair(b.box.xmin, b.feature);
  });
  const gdal::QuietErrors errors;
  std::vector<Footprint> kept;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Footprint& feature = input.features[i];
    if (parts[i]) continue;
    const Bounds2 box = bounds(feature.polygon);
    gdal::Geometry whole, covered;
    const auto begin =
        std::lower_bound(boxes.begin(), boxes.end(), box.xmin - widest,
                         [](const Box& candidate, double x) { return candidate.box.xmin < x; });
    for (auto at = begin; at != boxes.end() && at->box.xmin <= box.xmax; ++at) {
      if (!at->box.intersects(box)) continue;
      if (whole == nullptr) whole = valid_geometry(feature.polygon);
      Footprint& part = input.features[at->feature];
      const gdal::Geometry shape = valid_geometry(part.polygon);
      if (whole == nullptr || shape == nullptr) continue;
      gdal::Geometry common(OGR_G_Intersection(whole.get(), shape.get()));
      constexpr double kMostly = 0.5;
      if (common == nullptr || OGR_G_Area(common.get()) <= kMostly * OGR_G_Area(shape.get()))
        continue;
      if (!(part.height > 0)) {
        part.height = feature.height;
        part.from_floors = feature.from_floors;
      }
      covered.reset(covered == nullptr ? common.release()
                                       : OGR_G_Union(covered.get(), common.get()));
    }
    if (covered == nullptr) {
      kept.push_back(std::move(feature));
      continue;
    }
    constexpr double kAll = 0.98, kSliver = 0.01;
    const double area = OGR_G_Area(whole.get());
    std::vector<Polygon> rest;
    if (OGR_G_Area(covered.get()) < kAll * area) {
      const gdal::Geometry left(OGR_G_Difference(whole.get(), covered.get()));
      collect_polygons(left.get(), kSliver * area, rest);
    }
    if (rest.empty()) {
      input.dropped.push_back(
          {{feature.source_id, "its parts stand for it", DropCause::kOutlined}, feature.feature});
      continue;
    }
    // Of several pieces the first keeps the id.
    for (std::size_t k = 0; k < rest.size(); ++k) {
      Footprint piece = feature;
      piece.polygon = std::move(rest[k]);
      if (k > 0) piece.source_id = fmt::format("{}#rest{}", feature.source_id, k + 1);
      kept.push_back(std::move(piece));
    }
  }
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (parts[i]) kept.push_back(std::move(input.features[i]));
  input.features = std::move(kept);
}

}  // namespace tetropolis
