#include "tetropolis/io/vector/footprint_table.h"

#include <cstddef>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

#include "core/foreign_code.h"
#include "io/crs/gdal_support.h"
#include "io/file/input_file.h"
#include "vector_open.h"
#include "vector_read.h"

namespace tetropolis {

namespace {

/// A column of texts under the name that `options` has for it.
struct Column {
  const char* name;
  const std::vector<std::string>& values;

  bool given() const { return *name != '\0' && !values.empty(); }
};

void require_length(const FootprintTable& table, const std::vector<std::string>& column,
                    const char* name) {
  if (column.empty() || column.size() == table.wkb.size()) return;
  throw Error(ErrorKind::kUsage, fmt::format("{}: {} {} for {} features; give one per feature",
                                             table.source, column.size(), name, table.wkb.size()));
}

void set_geometry(const FootprintTable& table, std::size_t row, OGRFeatureH feature) {
  const std::string& bytes = table.wkb[row];
  if (bytes.empty()) return;
  OGRGeometryH geometry = nullptr;
  if (OGR_G_CreateFromWkb(bytes.data(), nullptr, &geometry, static_cast<int>(bytes.size())) !=
          OGRERR_NONE ||
      geometry == nullptr)
    fail_input(table.source, fmt::format("feature {}: its geometry is no well-known binary", row));
  OGR_F_SetGeometryDirectly(feature, geometry);
}

/// A data set of GDAL's in memory with one layer.
gdal::Dataset dataset_of(const FootprintTable& table, const ReadFootprintsOptions& options) {
  // Since GDAL 3.11 the driver of rasters in memory has vectors as well.
  GDALDriverH driver = GDALGetDriverByName("Memory");
  if (driver == nullptr) driver = GDALGetDriverByName("MEM");
  gdal::Dataset dataset(driver == nullptr ? nullptr
                                          : GDALCreate(driver, "", 0, 0, 0, GDT_Unknown, nullptr));
  OGRLayerH layer = dataset == nullptr ? nullptr
                                       : GDALDatasetCreateLayer(dataset.get(), table.source.c_str(),
                                                                nullptr, wkbUnknown, nullptr);
  if (layer == nullptr) fail_input(table.source, "GDAL cannot hold footprints in memory");
  const Column columns[] = {{options.id_attribute.c_str(), table.ids},
                            {options.height_attribute.c_str(), table.heights}};
  for (const Column& column : columns)
    if (column.given() && OGR_FD_GetFieldIndex(OGR_L_GetLayerDefn(layer), column.name) < 0) {
      OGRFieldDefnH field = OGR_Fld_Create(column.name, OFTString);
      OGR_L_CreateField(layer, field, TRUE);
      OGR_Fld_Destroy(field);
    }
  for (std::size_t row = 0; row < table.wkb.size(); ++row) {
    const gdal::Feature feature(OGR_F_Create(OGR_L_GetLayerDefn(layer)));
    OGR_F_SetFID(feature.get(), static_cast<GIntBig>(row));
    set_geometry(table, row, feature.get());
    for (const Column& column : columns)
      if (column.given() && !column.values[row].empty())
        OGR_F_SetFieldString(feature.get(), OGR_F_GetFieldIndex(feature.get(), column.name),
                             column.values[row].c_str());
    if (OGR_L_CreateFeature(layer, feature.get()) != OGRERR_NONE)
      fail_input(table.source, fmt::format("feature {}: GDAL cannot hold it in memory", row));
  }
  return dataset;
}

}  // namespace

FootprintsInput take_footprints(const FootprintTable& table, const ReadFootprintsOptions& options) {
  const ForeignCode gdal_code(table.source.c_str());
  gdal::initialise();
  require_length(table, table.ids, "ids");
  require_length(table, table.heights, "heights");
  ReadFootprintsOptions reading = options;
  reading.layer.clear();
  if (reading.id_attribute.empty() && !table.ids.empty()) reading.id_attribute = "index";
  if (reading.source_crs.empty()) reading.source_crs = table.crs;
  gdal::QuietErrors errors;
  VectorFile file;
  file.dataset = dataset_of(table, reading);
  FootprintsInput result = read_open_vector(table.source, file, errors, reading);
  result.layer.clear();
  return result;
}

}  // namespace tetropolis
