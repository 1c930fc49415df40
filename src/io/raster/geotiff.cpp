#include "tetropolis/io/raster/geotiff.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/io/crs/crs.h"

#include "core/foreign_code.h"
#include "core/text.h"
#include "io/crs/gdal_support.h"
#include "io/file/atomic_file.h"
#include "io/file/input_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDomainItem = "TETROPOLIS_DOMAIN";
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

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

bool write_values(GDALDatasetH dataset, const Raster& raster) {
  GDALRasterBandH band = GDALGetRasterBand(dataset, 1);
  const auto nx = static_cast<std::size_t>(raster.nx);
  std::vector<double> row(nx);
  for (std::int32_t line = 0; line < raster.ny; ++line) {
    const auto first = static_cast<std::size_t>(raster.ny - 1 - line) * nx;
    for (std::size_t i = 0; i < nx; ++i) {
      const double value = raster.values[first + i];
      row[i] = std::isfinite(value) ? value : kRasterNodata;
    }
    if (GDALRasterIO(band, GF_Write, 0, line, raster.nx, 1, row.data(), raster.nx, 1, GDT_Float64,
                     0, 0) != CE_None)
      return false;
  }
  return true;
}

// --- reading ---

struct Grid {
  std::array<double, 6> transform{};
  int nx = 0;
  int ny = 0;
};

gdal::Dataset open_raster(const fs::path& path, const gdal::QuietErrors& errors) {
  require_ordinary_file(path);
  gdal::Dataset dataset(
      GDALOpenEx(path.c_str(), GDAL_OF_RASTER | GDAL_OF_VERBOSE_ERROR, nullptr, nullptr, nullptr));
  if (dataset == nullptr) fail_input(path, "not a raster" + errors.reason() + "; name a GeoTIFF");
  return dataset;
}

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

/// Values from the south-west, NaN where there is none.
std::vector<double> read_values(const fs::path& path, GDALDatasetH dataset, const Grid& grid,
                                const gdal::QuietErrors& errors) {
  GDALRasterBandH band = GDALGetRasterBand(dataset, 1);
  int has_nodata = 0;
  const double nodata = GDALGetRasterNoDataValue(band, &has_nodata);
  // A nodata value written as text need not be a float: compare as the band would store it.
  const bool single = GDALGetRasterDataType(band) == GDT_Float32;
  const double nodata_stored =
      single && std::abs(nodata) <= static_cast<double>(std::numeric_limits<float>::max())
          ? static_cast<double>(static_cast<float>(nodata))
          : nodata;
  const double scale = GDALGetRasterScale(band, nullptr);
  const double offset = GDALGetRasterOffset(band, nullptr);
  const auto nx = static_cast<std::size_t>(grid.nx);
  std::vector<double> values;
  try {
    values.resize(nx * static_cast<std::size_t>(grid.ny));
  } catch (const std::bad_alloc&) {
    fail_input(path, "does not fit into memory; cut it to the domain");
  }
  // A mask of its own says which pixels have a value, whatever these hold.
  const bool masked = (GDALGetMaskFlags(band) & (GMF_ALL_VALID | GMF_NODATA)) == 0;
  std::vector<std::uint8_t> mask(masked ? nx : 0);
  for (int line = 0; line < grid.ny; ++line) {
    double* row = values.data() + static_cast<std::size_t>(grid.ny - 1 - line) * nx;
    CPLErr outcome =
        GDALRasterIO(band, GF_Read, 0, line, grid.nx, 1, row, grid.nx, 1, GDT_Float64, 0, 0);
    if (outcome == CE_None && masked)
      outcome = GDALRasterIO(GDALGetMaskBand(band), GF_Read, 0, line, grid.nx, 1, mask.data(),
                             grid.nx, 1, GDT_Byte, 0, 0);
    if (outcome != CE_None)
      fail_input(path,
                 fmt::format("row {} cannot be read{}; the file is cut or broken, get it again",
                             line, errors.reason()));
    for (std::size_t i = 0; i < nx; ++i) {
      const bool missing = (has_nodata != 0 && (row[i] == nodata || row[i] == nodata_stored)) ||
                           (masked && mask[i] == 0);
      if (scale != 1 || offset != 0) row[i] = row[i] * scale + offset;
      if (missing || !std::isfinite(row[i])) row[i] = kNaN;
    }
  }
  return values;
}

/// Breadth-first from all valid nodes at once, in row order. Returns how many were filled.
std::int64_t fill_missing(Raster& raster) {
  const std::int64_t nx = raster.nx;
  const std::int64_t ny = raster.ny;
  std::int64_t missing = 0;
  for (const double value : raster.values) missing += std::isnan(value) ? 1 : 0;
  if (missing == 0 || missing == nx * ny) return missing;
  const auto visit_neighbours = [&](std::int64_t node, const auto& visit) {
    const std::int64_t column = node % nx;
    const std::int64_t row = node / nx;
    for (std::int64_t j = std::max<std::int64_t>(row - 1, 0); j <= std::min(row + 1, ny - 1); ++j)
      for (std::int64_t i = std::max<std::int64_t>(column - 1, 0);
           i <= std::min(column + 1, nx - 1); ++i)
        if (j * nx + i != node) visit(static_cast<std::size_t>(j * nx + i));
  };
  std::deque<std::int64_t> queue;
  for (std::int64_t node = 0; node < nx * ny; ++node) {
    if (std::isnan(raster.values[static_cast<std::size_t>(node)])) continue;
    bool rim = false;
    visit_neighbours(node, [&](std::size_t other) { rim |= std::isnan(raster.values[other]); });
    if (rim) queue.push_back(node);
  }
  while (!queue.empty()) {
    const std::int64_t node = queue.front();
    queue.pop_front();
    visit_neighbours(node, [&](std::size_t other) {
      if (!std::isnan(raster.values[other])) return;
      raster.values[other] = raster.values[static_cast<std::size_t>(node)];
      queue.push_back(static_cast<std::int64_t>(other));
    });
  }
  return missing;
}

/// Metres per unit of the values: as the band says, else the vertical reference system, else 1;
/// negative where that counts downwards.
double height_unit(const fs::path& path, GDALDatasetH dataset) {
  constexpr double kFoot = 0.3048, kSurveyFoot = 1200.0 / 3937;
  constexpr std::pair<std::string_view, double> kUnits[] = {{"m", 1},
                                                            {"metre", 1},
                                                            {"meter", 1},
                                                            {"metres", 1},
                                                            {"meters", 1},
                                                            {"dm", 0.1},
                                                            {"cm", 0.01},
                                                            {"mm", 0.001},
                                                            {"km", 1000},
                                                            {"ft", kFoot},
                                                            {"foot", kFoot},
                                                            {"feet", kFoot},
                                                            {"us-ft", kSurveyFoot},
                                                            {"us_ft", kSurveyFoot},
                                                            {"ftus", kSurveyFoot},
                                                            {"us survey foot", kSurveyFoot}};
  const std::string name = lower_case(GDALGetRasterUnitType(GDALGetRasterBand(dataset, 1)));
  const double of_system = gdal::vertical_unit_metres(GDALGetSpatialRef(dataset));
  if (name.empty()) return of_system;
  // A band has no word for depths.
  for (const auto& [unit, metres] : kUnits)
    if (name == unit) return std::copysign(metres, of_system);
  fail_input(path, fmt::format("heights are in '{}', an unknown unit; convert them to metres",
                               first_bytes(name, 40)));
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
  const CPLConfigOptionSetter no_side_car("GDAL_PAM_ENABLED", "NO", false);
  CPLStringList options;
  options.SetNameValue("COMPRESS", "DEFLATE")
      .SetNameValue("PREDICTOR", "3")
      .SetNameValue("ZLEVEL", "6");
  options.SetNameValue("BIGTIFF", "IF_SAFER")
      .SetNameValue("GEOTIFF_VERSION", "1.1")
      .SetNameValue("NUM_THREADS", "1");
  gdal::Dataset dataset(GDALCreate(GDALGetDriverByName("GTiff"), memory.path("a.tif").c_str(),
                                   raster.nx, raster.ny, 1, GDT_Float64, options.List()));
  if (dataset == nullptr) throw_cannot_write(path, errors.last());
  describe(dataset.get(), raster, origin, canonical, domain);
  const bool written = write_values(dataset.get(), raster);
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
  raster.values = read_values(path, dataset.get(), grid, errors);
  raster.x0 = restore(t[0] + raster.step / 2 - origin.x);
  raster.y0 = restore(t[3] - raster.step / 2 - (raster.ny - 1) * raster.step - origin.y);
  result.filled = fill_missing(raster);
  if (result.filled == static_cast<std::int64_t>(raster.values.size()))
    fail_input(
        path, fmt::format("none of its {} pixels has a value; name another raster", result.filled));
  if (result.filled > 0)
    result.warnings.push_back(
        {"raster_filled", result.filled,
         fmt::format("{}: {} of {} pixels have no value; they take the nearest one", path.string(),
                     result.filled, raster.values.size())});
  result.crs = gdal::canonical_name(GDALGetSpatialRef(dataset.get()));
  result.height_unit = height_unit(path, dataset.get());
  result.domain = parse_domain(GDALGetMetadataItem(dataset.get(), kDomainItem, nullptr), origin);
  return result;
}

}  // namespace tetropolis
