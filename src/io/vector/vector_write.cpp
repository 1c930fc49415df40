#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/file/atomic_file.h"
#include "tetropolis/io/vector/vector.h"

#include "core/text.h"
#include "io/crs/gdal_support.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// A hidden folder beside the target in which a format of several files grows.
class StagingFolder {
 public:
  explicit StagingFolder(const fs::path& target) {
    const fs::path parent = target.parent_path();
    for (int attempt = 0;; ++attempt) {
      path_ =
          parent / fmt::format(".{}.part-{}-{}", target.filename().string(), ::getpid(), attempt);
      std::error_code error;
      if (fs::create_directory(path_, error)) return;
      if (error) throw_cannot_write(target, error.message());
    }
  }
  ~StagingFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  StagingFolder(const StagingFolder&) = delete;
  StagingFolder& operator=(const StagingFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

const char* driver_of(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".shp") return "ESRI Shapefile";
  if (extension == ".gpkg") return "GPKG";
  if (extension == ".geojson" || extension == ".json") return "GeoJSON";
  throw Error(ErrorKind::kUsage, path.string() +
                                     ": footprints are written as .shp, .gpkg or "
                                     ".geojson; choose one of these");
}

void add_ring(OGRGeometryH polygon, const Ring& ring, Point2 origin) {
  OGRGeometryH line = OGR_G_CreateGeometry(wkbLinearRing);
  for (const Point2& p : ring) OGR_G_AddPoint_2D(line, origin.x + p.x, origin.y + p.y);
  OGR_G_CloseRings(line);
  OGR_G_AddGeometryDirectly(polygon, line);
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

struct Content {
  std::span<const Polygon> polygons;
  std::span<const std::string> ids;
  std::span<const double> heights;
  Point2 origin;
};

bool add_features(OGRLayerH layer, const Content& content) {
  for (std::size_t i = 0; i < content.polygons.size(); ++i) {
    OGRFeatureH feature = OGR_F_Create(OGR_L_GetLayerDefn(layer));
    OGRGeometryH polygon = OGR_G_CreateGeometry(wkbPolygon);
    add_ring(polygon, content.polygons[i].outer, content.origin);
    for (const Ring& hole : content.polygons[i].holes) add_ring(polygon, hole, content.origin);
    OGR_F_SetGeometryDirectly(feature, polygon);
    OGR_F_SetFieldString(feature, 0, content.ids[i].c_str());
    if (!content.heights.empty() && std::isfinite(content.heights[i]))
      OGR_F_SetFieldDouble(feature, 1, content.heights[i]);
    const bool good = OGR_L_CreateFeature(layer, feature) == OGRERR_NONE;
    OGR_F_Destroy(feature);
    if (!good) return false;
  }
  return true;
}

bool write_layer(GDALDatasetH dataset, const fs::path& path, const Content& content,
                 const std::string& crs) {
  gdal::StringList options;
  const std::string_view driver = driver_of(path);
  if (driver == "ESRI Shapefile")
    options.set("DBF_DATE_LAST_UPDATE", "1970-01-01").set("ENCODING", "UTF-8");
  if (driver == "GeoJSON") options.set("COORDINATE_PRECISION", "10");
  const gdal::Srs srs = crs.empty() ? nullptr : gdal::parse_srs(crs);
  OGRLayerH layer =
      GDALDatasetCreateLayer(dataset, path.stem().c_str(), srs.get(), wkbPolygon, options.get());
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

/// Moves the finished files into place one by one, by name, the one that makes the others a result
/// last. If it fails midway, a shapefile that was there before has some members of the new one.
void publish(const fs::path& folder, const fs::path& target) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end(), [&](const fs::path& a, const fs::path& b) {
    const bool a_last = a.filename() == target.filename();
    const bool b_last = b.filename() == target.filename();
    return a_last != b_last ? b_last : a < b;
  });
  for (const fs::path& file : files) {
    std::error_code error;
    fs::rename(file, target.parent_path() / file.filename(), error);
    if (error) throw_cannot_write(target, error.message());
  }
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
  const StagingFolder staging(path);
  gdal::QuietErrors errors;
  const gdal::ThreadOption fixed_date("OGR_CURRENT_DATE", "1970-01-01T00:00:00Z");
  gdal::Dataset dataset(GDALCreate(GDALGetDriverByName(driver),
                                   (staging.path() / path.filename()).c_str(), 0, 0, 0, GDT_Unknown,
                                   nullptr));
  if (dataset == nullptr) throw_cannot_write(path, errors.last());
  const bool written =
      write_layer(dataset.get(), path, {polygons, ids, heights, origin}, canonical);
  dataset.reset();  // Closing writes what is left, and may fail.
  if (!written || errors.failures() > 0) throw_cannot_write(path, errors.last());
  publish(staging.path(), path);
}

}  // namespace tetropolis
