#include "tetropolis/io/vector/footprint_table.h"

#include <cstddef>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

#include "core/foreign_code.h"
#include "feature_attributes.h"
#include "io/crs/gdal_support.h"
#include "io/file/input_file.h"
#include "vector_open.h"
#include "vector_read.h"

namespace tetropolis {

namespace {

void require_length(const FootprintTable& table, const std::vector<std::string>& column,
                    const char* name) {
  if (column.size() == table.wkb.size()) return;
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
  std::vector<const std::vector<std::string>*> columns;
  const auto add = [&](const std::string& name, AttributeType type,
                       const std::vector<std::string>& values) {
    OGRFieldDefnH field = OGR_Fld_Create(name.c_str(), field_type(type));
    if (type == AttributeType::kBoolean) OGR_Fld_SetSubType(field, OFSTBoolean);
    OGR_L_CreateField(layer, field, TRUE);
    OGR_Fld_Destroy(field);
    columns.push_back(&values);
  };
  if (!table.ids.empty()) add(options.id_attribute, AttributeType::kText, table.ids);
  for (const TableColumn& column : table.columns)
    if (table.ids.empty() || column.name != options.id_attribute)
      add(column.name, column.type, column.values);
  for (std::size_t row = 0; row < table.wkb.size(); ++row) {
    const gdal::Feature feature(OGR_F_Create(OGR_L_GetLayerDefn(layer)));
    OGR_F_SetFID(feature.get(), static_cast<GIntBig>(row));
    set_geometry(table, row, feature.get());
    for (std::size_t c = 0; c < columns.size(); ++c)
      if (const std::string& value = (*columns[c])[row]; !value.empty())
        OGR_F_SetFieldString(feature.get(), static_cast<int>(c), value.c_str());
    if (OGR_L_CreateFeature(layer, feature.get()) != OGRERR_NONE)
      fail_input(table.source, fmt::format("feature {}: GDAL cannot hold it in memory", row));
  }
  return dataset;
}

}  // namespace

FootprintsInput take_footprints(const FootprintTable& table, const ReadFootprintsOptions& options) {
  const ForeignCode gdal_code(table.source.c_str());
  gdal::initialise();
  if (!table.ids.empty()) require_length(table, table.ids, "ids");
  for (const TableColumn& column : table.columns)
    require_length(table, column.values, ("values of " + column.name).c_str());
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
