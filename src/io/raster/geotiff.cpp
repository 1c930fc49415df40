#include "tetropolis/io/raster/geotiff.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/io/crs/crs.h"

#include "core/foreign_code.h"
#include "io/crs/gdal_support.h"
#include "io/file/atomic_file.h"
#include "io/file/input_file.h"
#include "raster_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDomainItem = "TETROPOLIS_DOMAIN";

/// A coordinate that came back from a file: the exact multiple of kCoordinateStep if it is one but
/// for rounding, else itself.
double restore(double value) {
  const double snapped = snap_coordinate(value);
  return std::abs(snapped - value) < 1e-7 ? snapped : value;
}

// --- writing ---

void describe(GDALDatasetH dataset, const Raster& raster, Point2 origin, const std::string& crs,
              const std::optional<Bounds2>& domain) {
  const double half = raster.step / 2;
  std::array<double, 6> transform = {origin.x + raster.x0 - half,
                                     raster.step,
                                     0,
                                     origin.y + raster.y0 + (raster.ny - 1) * raster.step + half,
                                     0,
                                     -raster.step};
  GDALSetGeoTransform(dataset, transform.data());
  if (!crs.empty()) GDALSetSpatialRef(dataset, gdal::parse_srs(crs).get());
  GDALSetRasterNoDataValue(GDALGetRasterBand(dataset, 1), kRasterNodata);
  if (domain) {
    const std::string text =
        fmt::format("{:.17g},{:.17g},{:.17g},{:.17g}", origin.x + domain->xmin,
                    origin.y + domain->ymin, origin.x + domain->xmax, origin.y + domain->ymax);
    GDALSetMetadataItem(dataset, kDomainItem, text.c_str(), nullptr);
  }
}

/// Whether single precision has every value.
bool fits_single(const Raster& raster) {
  constexpr double kMost = std::numeric_limits<float>::max();
  return std::all_of(raster.values.begin(), raster.values.end(), [](double value) {
    if (!std::isfinite(value)) return true;
    return std::abs(value) <= kMost && static_cast<double>(static_cast<float>(value)) == value;
  });
}

template <typename Value>
bool write_values(GDALDatasetH dataset, const Raster& raster) {
  GDALRasterBandH band = GDALGetRasterBand(dataset, 1);
  const auto nx = static_cast<std::size_t>(raster.nx);
  std::vector<Value> row(nx);
  for (std::int32_t line = 0; line < raster.ny; ++line) {
    const auto first = static_cast<std::size_t>(raster.ny - 1 - line) * nx;
    for (std::size_t i = 0; i < nx; ++i) {
      const double value = raster.values[first + i];
      row[i] = static_cast<Value>(std::isfinite(value) ? value : kRasterNodata);
    }
    // A block is a row. Written at once, it takes up no memory among GDAL's.
    if (GDALWriteBlock(band, 0, line, row.data()) != CE_None) return false;
  }
  return true;
}

// --- reading ---

struct Grid {
  std::array<double, 6> transform{};
  int nx = 0;
  int ny = 0;
};

Grid check_grid(const fs::path& path, GDALDatasetH dataset) {
  Grid grid;
  grid.nx = GDALGetRasterXSize(dataset);
  grid.ny = GDALGetRasterYSize(dataset);
  if (const int bands = GDALGetRasterCount(dataset); bands != 1)
    fail_input(path,
               fmt::format("has {} bands; name a raster whose only band is the elevation", bands));
  if (grid.nx < 1 || grid.ny < 1) fail_input(path, "has no pixels");
  if (static_cast<std::int64_t>(grid.nx) * grid.ny > (std::int64_t{1} << 31))
    fail_input(
        path, fmt::format("has too many pixels ({} x {}); cut it to the domain", grid.nx, grid.ny));
  if (GDALGetGeoTransform(dataset, grid.transform.data()) != CE_None)
    fail_input(path, "has no georeference; name a georeferenced GeoTIFF");
  const auto& t = grid.transform;
  if (!std::all_of(t.begin(), t.end(), [](double v) { return std::isfinite(v); }) || !(t[1] > 0))
    fail_input(path, "has an invalid georeference; rewrite it with gdalwarp");
  // What rounding leaves of a rotation moves no pixel by a thousandth.
  const double pixels = std::max(grid.nx, grid.ny);
  if (std::max(std::abs(t[2]), std::abs(t[4])) * pixels > 1e-3 * t[1] || t[5] >= 0)
    fail_input(path, "is rotated or south up; make it north up with gdalwarp");
  if (std::abs(t[1] + t[5]) > 1e-6 * t[1])
    fail_input(path, fmt::format("has pixels of {} x {}; make them square with gdalwarp -tr", t[1],
                                 -t[5]));
  return grid;
}

std::optional<Bounds2> parse_domain(const char* text, Point2 origin) {
  if (text == nullptr) return std::nullopt;
  std::array<double, 4> v{};
  const char* at = text;
  const char* const end = text + std::strlen(text);
  for (std::size_t i = 0; i < v.size(); ++i) {
    const auto [next, error] = std::from_chars(at, end, v[i]);
    if (error != std::errc{} || !std::isfinite(v[i])) return std::nullopt;
    at = next;
    if (i + 1 < v.size() && (at == end || *at++ != ',')) return std::nullopt;
  }
  if (!(v[0] < v[2] && v[1] < v[3])) return std::nullopt;
  return Bounds2{restore(v[0] - origin.x), restore(v[1] - origin.y), restore(v[2] - origin.x),
                 restore(v[3] - origin.y)};
}

}  // namespace

void write_raster(const fs::path& path, const Raster& raster, Point2 origin, const std::string& crs,
                  const std::optional<Bounds2>& domain) {
  assert(raster.nx >= 1 && raster.ny >= 1 && raster.step > 0);
  assert(raster.values.size() ==
         static_cast<std::size_t>(raster.nx) * static_cast<std::size_t>(raster.ny));
  const std::string canonical = normalise_crs(crs);
  gdal::initialise();
  AtomicFile file(path);
  // GDAL's own writing to disk leaves some failures to libtiff, which prints them.
  const gdal::MemoryFolder memory;
  gdal::QuietErrors errors;
  // No side-car file, and one spelling of the keys whatever the machine's configuration.
  const gdal::ConfigOption no_side_car("GDAL_PAM_ENABLED", "NO");
  gdal::StringList options;
  options.set("BIGTIFF", "IF_SAFER").set("GEOTIFF_VERSION", "1.1").set("BLOCKYSIZE", "1");
  // Heights take longer to compress than to write; level ground does not.
  const auto is_first = [&](double height) { return height == raster.values.front(); };
  if (std::all_of(raster.values.begin(), raster.values.end(), is_first))
    options.set("COMPRESS", "DEFLATE");
  const bool is_single = fits_single(raster);
  gdal::Dataset dataset(GDALCreate(GDALGetDriverByName("GTiff"), memory.path("a.tif").c_str(),
                                   raster.nx, raster.ny, 1, is_single ? GDT_Float32 : GDT_Float64,
                                   options.list()));
  if (dataset == nullptr) throw_cannot_write(path, errors.last());
  describe(dataset.get(), raster, origin, canonical, domain);
  const bool written = is_single ? write_values<float>(dataset.get(), raster)
                                 : write_values<double>(dataset.get(), raster);
  dataset.reset();  // Closing writes what is left, and may fail.
  if (!written || errors.failures() > 0) throw_cannot_write(path, errors.last());
  file.write(memory.bytes("a.tif"));
  file.commit();
}

RasterInput read_raster(const fs::path& path, Point2 origin) {
  const ForeignCode gdal_code(path.c_str());
  gdal::initialise();
  const gdal::QuietErrors errors;
  const gdal::Dataset dataset = open_raster(path, errors);
  const Grid grid = check_grid(path, dataset.get());
  // A value, and its place in the queue of fill_missing.
  constexpr double kPerPixel = 16;
  require_memory(path, kPerPixel * grid.nx * grid.ny,
                 fmt::format("read {} x {} pixels", grid.nx, grid.ny), "cut it to the domain");
  const auto& t = grid.transform;
  RasterInput result;
  Raster& raster = result.raster;
  raster.nx = grid.nx;
  raster.ny = grid.ny;
  raster.step = t[1];
  raster.values = read_window(path, dataset.get(), {0, 0, grid.nx, grid.ny}, errors);
  raster.x0 = restore(t[0] + raster.step / 2 - origin.x);
  raster.y0 = restore(t[3] - raster.step / 2 - (raster.ny - 1) * raster.step - origin.y);
  result.filled = fill_with_nearest(raster);
  if (result.filled == static_cast<std::int64_t>(raster.values.size()))
    fail_input(
        path, fmt::format("none of its {} pixels has a value; name another raster", result.filled));
  if (result.filled > 0)
    result.warnings.push_back(
        {"raster_filled", result.filled,
         fmt::format("{}: {} of {} pixels have no value; they take the nearest one", path.string(),
                     result.filled, raster.values.size())});
  result.crs = gdal::canonical_name(GDALGetSpatialRef(dataset.get()));
  result.height_unit = height_unit_of(path, dataset.get()).value_or(1);
  result.domain = parse_domain(GDALGetMetadataItem(dataset.get(), kDomainItem, nullptr), origin);
  return result;
}

}  // namespace tetropolis
