#include "vector_layers.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tetropolis/io/vector/vector.h"

#include "core/foreign_code.h"
#include "io/file/input_file.h"
#include "vector_geometry.h"
#include "vector_open.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

OGRLayerH find_layer(const fs::path& path, GDALDatasetH dataset, const std::string& wanted) {
  std::vector<std::string> all;
  std::vector<std::string> names;
  OGRLayerH found = nullptr;
  for (int i = 0; i < GDALDatasetGetLayerCount(dataset); ++i) {
    OGRLayerH layer = GDALDatasetGetLayer(dataset, i);
    if (layer == nullptr) continue;
    all.push_back(gdal::utf8(OGR_L_GetName(layer)));
    if (!wanted.empty() && all.back() == wanted) return layer;
    if (polygon_field(layer) < 0) continue;
    names.push_back(all.back());
    found = layer;
  }
  if (!wanted.empty())
    fail_input(path, fmt::format("has no layer '{}'; it has: {}", wanted, fmt::join(all, ", ")));
  if (names.size() > 1)
    fail_input(path, fmt::format("has several layers of polygons; set layer to one of: {}",
                                 fmt::join(names, ", ")));
  if (found != nullptr) return found;
  if (all.size() == 1 &&
      OGR_FD_GetGeomFieldCount(OGR_L_GetLayerDefn(GDALDatasetGetLayer(dataset, 0))) > 0)
    return GDALDatasetGetLayer(dataset, 0);
  if (is_of_format(dataset, "CSV"))
    fail_input(path, "has no column of polygons; call it WKT and write them as POLYGON((...))");
  fail_input(path, all.empty() ? std::string("has no layers; name a file with building polygons")
                               : fmt::format("has no layer of polygons, only {}; name a file with "
                                             "building polygons",
                                             fmt::join(all, ", ")));
}

}  // namespace

FootprintLayer::FootprintLayer(const fs::path& path, GDALDatasetH dataset,
                               const std::string& wanted)
    : layer_(find_layer(path, dataset, wanted)) {
  if (OGR_FD_GetGeomFieldCount(OGR_L_GetLayerDefn(layer_)) > 1)
    field_ = std::max(polygon_field(layer_), 0);
}

OGRSpatialReferenceH FootprintLayer::reference_system() const {
  // Some drivers (MIF) have it at the layer only.
  if (field_ == 0) return OGR_L_GetSpatialRef(layer_);
  return OGR_GFld_GetSpatialRef(OGR_FD_GetGeomFieldDefn(OGR_L_GetLayerDefn(layer_), field_));
}

std::vector<VectorLayer> list_layers(const fs::path& path) {
  const ForeignCode gdal_code(path.c_str());
  gdal::initialise();
  gdal::QuietErrors errors;
  const gdal::ConfigOption nothing_beside("CPL_VSIL_GZIP_WRITE_PROPERTIES", "NO");
  const VectorFile file = open_vector(path, errors);
  std::vector<VectorLayer> layers;
  for (int i = 0; i < GDALDatasetGetLayerCount(file.dataset.get()); ++i) {
    OGRLayerH layer = GDALDatasetGetLayer(file.dataset.get(), i);
    if (layer == nullptr) continue;
    VectorLayer& summary = layers.emplace_back();
    summary.name = gdal::utf8(OGR_L_GetName(layer));
    OGRFeatureDefnH definition = OGR_L_GetLayerDefn(layer);
    const int field = polygon_field(layer);
    summary.holds_polygons = field >= 0;
    summary.geometry = OGRGeometryTypeToName(
        field > 0 ? OGR_GFld_GetType(OGR_FD_GetGeomFieldDefn(definition, field))
                  : OGR_L_GetGeomType(layer));
    summary.features = OGR_L_GetFeatureCount(layer, 0);
    for (int f = 0; f < OGR_FD_GetFieldCount(definition); ++f)
      summary.attributes.push_back(
          gdal::utf8(OGR_Fld_GetNameRef(OGR_FD_GetFieldDefn(definition, f))));
  }
  return layers;
}

}  // namespace tetropolis
