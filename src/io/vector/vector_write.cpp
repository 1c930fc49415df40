#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/file/write_file.h"
#include "tetropolis/io/vector/vector.h"

#include "core/text.h"
#include "io/crs/gdal_support.h"
#include "io/file/atomic_file.h"
#include "polygon_geometry.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

const char* driver_of(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".shp") return "ESRI Shapefile";
  if (extension == ".gpkg") return "GPKG";
  if (extension == ".geojson" || extension == ".json") return "GeoJSON";
  throw Error(ErrorKind::kUsage, path.string() +
                                     ": footprints are written as .shp, .gpkg or "
                                     ".geojson; choose one of these");
}

/// Adds one field to the layer; the names are ours, so the drivers keep them.
bool add_field(OGRLayerH layer, const char* name, OGRFieldType type, int width, int precision) {
  OGRFieldDefnH field = OGR_Fld_Create(name, type);
  OGR_Fld_SetWidth(field, width);
  OGR_Fld_SetPrecision(field, precision);
  const bool good = OGR_L_CreateField(layer, field, TRUE) == OGRERR_NONE;
  OGR_Fld_Destroy(field);
  return good;
}

struct Features {
  std::span<const Polygon> polygons;
  std::span<const std::string> ids;
  std::span<const double> heights;
  Point2 origin;
};

bool add_features(OGRLayerH layer, const Features& content) {
  for (std::size_t i = 0; i < content.polygons.size(); ++i) {
    OGRFeatureH feature = OGR_F_Create(OGR_L_GetLayerDefn(layer));
    OGR_F_SetGeometryDirectly(feature, polygon_geometry(content.polygons[i], content.origin));
    OGR_F_SetFieldString(feature, 0, content.ids[i].c_str());
    if (!content.heights.empty() && std::isfinite(content.heights[i]))
      OGR_F_SetFieldDouble(feature, 1, content.heights[i]);
    const bool good = OGR_L_CreateFeature(layer, feature) == OGRERR_NONE;
    OGR_F_Destroy(feature);
    if (!good) return false;
  }
  return true;
}

bool write_layer(GDALDatasetH dataset, const fs::path& path, const Features& content,
                 const std::string& crs) {
  gdal::StringList options;
  const std::string_view driver = driver_of(path);
  if (driver == "ESRI Shapefile")
    options.set("DBF_DATE_LAST_UPDATE", "1970-01-01").set("ENCODING", "UTF-8");
  if (driver == "GeoJSON") options.set("COORDINATE_PRECISION", "10");
  const gdal::Srs srs = crs.empty() ? nullptr : gdal::parse_srs(crs);
  OGRLayerH layer =
      GDALDatasetCreateLayer(dataset, path.stem().c_str(), srs.get(), wkbPolygon, options.list());
  if (layer == nullptr) return false;
  std::size_t longest = 1;
  for (const std::string& id : content.ids) longest = std::max(longest, id.size());
  const int width =
      driver == "ESRI Shapefile" ? static_cast<int>(std::min<std::size_t>(longest, 254)) : 0;
  if (!add_field(layer, "id", OFTString, width, 0)) return false;
  const bool shapefile = driver == "ESRI Shapefile";
  if (!content.heights.empty() &&
      !add_field(layer, "height", OFTReal, shapefile ? 24 : 0, shapefile ? 15 : 0))
    return false;
  if (OGR_L_StartTransaction(layer) != OGRERR_NONE) CPLErrorReset();
  return add_features(layer, content) && OGR_L_CommitTransaction(layer) == OGRERR_NONE;
}

/// Puts the finished files into place, the one that makes the others a result last. If it fails
/// midway, a shapefile that was there before has some members of the new one.
void publish(const gdal::MemoryFolder& folder, const fs::path& target) {
  const std::string last = target.filename().string();
  for (const std::string& name : folder.names())
    if (name != last) write_file(target.parent_path() / name, folder.bytes(name));
  write_file(target, folder.bytes(last));
}

}  // namespace

void write_footprints(const fs::path& path, std::span<const Polygon> polygons,
                      std::span<const std::string> ids, std::span<const double> heights,
                      Point2 origin, const std::string& crs) {
  if (ids.size() != polygons.size() || !(heights.empty() || heights.size() == polygons.size()))
    throw Error(ErrorKind::kUsage,
                fmt::format("{}: {} ids and {} heights for {} polygons; give one of each",
                            path.string(), ids.size(), heights.size(), polygons.size()));
  gdal::initialise();
  const char* driver = driver_of(path);
  const std::string canonical = normalise_crs(crs);
  const gdal::MemoryFolder folder;
  gdal::QuietErrors errors;
  const gdal::ConfigOption fixed_date("OGR_CURRENT_DATE", "1970-01-01T00:00:00Z");
  gdal::Dataset dataset(GDALCreate(GDALGetDriverByName(driver),
                                   folder.path(path.filename().string()).c_str(), 0, 0, 0,
                                   GDT_Unknown, nullptr));
  if (dataset == nullptr) throw_cannot_write(path, errors.last());
  const bool written =
      write_layer(dataset.get(), path, {polygons, ids, heights, origin}, canonical);
  dataset.reset();  // Closing writes what is left, and may fail.
  if (!written || errors.failures() > 0) throw_cannot_write(path, errors.last());
  publish(folder, path);
}

}  // namespace tetropolis
