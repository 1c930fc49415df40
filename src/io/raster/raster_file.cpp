#include "raster_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <deque>
#include <limits>
#include <new>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/infinity.h"
#include "core/text.h"
#include "io/deferred/gdal_functions.h"
#include "io/file/input_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

void require_sound(const fs::path& path, GDALDatasetH dataset) {
  if (const int bands = GDALGetRasterCount(dataset); bands != 1)
    fail_input(path,
               fmt::format("has {} bands; name a raster whose only band is the elevation", bands));
  if (GDALGetRasterXSize(dataset) < 1 || GDALGetRasterYSize(dataset) < 1)
    fail_input(path, "has no pixels");
  std::array<double, 6> t{};
  if (GDALGetGeoTransform(dataset, t.data()) != CE_None)
    fail_input(path, "has no georeference; name a georeferenced raster");
  if (!std::all_of(t.begin(), t.end(), [](double v) { return std::isfinite(v); }) ||
      t[1] * t[5] == t[2] * t[4])
    fail_input(path, "has an invalid georeference; rewrite it with gdalwarp");
}

/// But for what rounding leaves of a rotation, which moves no pixel by a thousandth.
bool is_upright(GDALDatasetH dataset) {
  std::array<double, 6> t{};
  GDALGetGeoTransform(dataset, t.data());
  const double pixels = std::max(GDALGetRasterXSize(dataset), GDALGetRasterYSize(dataset));
  return t[1] > 0 && t[5] < 0 &&
         std::max(std::abs(t[2]), std::abs(t[4])) * pixels <= 1e-3 * std::min(t[1], -t[5]);
}

}  // namespace

gdal::Dataset open_raster(const fs::path& path, const gdal::QuietErrors& errors) {
  require_ordinary_file(path);
  gdal::Dataset dataset(
      GDALOpenEx(path.c_str(), GDAL_OF_RASTER | GDAL_OF_VERBOSE_ERROR, nullptr, nullptr, nullptr));
  if (dataset == nullptr) fail_input(path, "not a raster" + errors.reason() + "; name a GeoTIFF");
  return dataset;
}

RasterFile open_elevations(const fs::path& path, const gdal::QuietErrors& errors) {
  RasterFile file;
  file.source = open_raster(path, errors);
  require_sound(path, file.source.get());
  if (!is_upright(file.source.get())) {
    gdal::StringList words;
    for (const char* word : {"-of", "VRT", "-r", "bilinear", "-ot", "Float64", "-dstnodata", "nan"})
      words.add(word);
    GDALWarpAppOptions* options = GDALWarpAppOptionsNew(words.list(), nullptr);
    GDALDatasetH sources = file.source.get();
    file.upright.reset(GDALWarp("", nullptr, 1, &sources, options, nullptr));
    GDALWarpAppOptionsFree(options);
    if (file.upright == nullptr)
      fail_input(path, "cannot be turned north up" + errors.reason() + "; do it with gdalwarp");
  }
  std::array<double, 6> t{};
  GDALGetGeoTransform(file.dataset(), t.data());
  RasterHeader& header = file.header;
  header.nx = GDALGetRasterXSize(file.dataset());
  header.ny = GDALGetRasterYSize(file.dataset());
  header.step_x = t[1];
  header.step_y = -t[5];
  header.box = {t[0], t[3] - header.ny * header.step_y, t[0] + header.nx * header.step_x, t[3]};
  header.crs = gdal::canonical_name(GDALGetSpatialRef(file.source.get()));
  const std::optional<double> unit = height_unit_of(path, file.source.get());
  header.height_unit = unit.value_or(1);
  header.states_height_unit = unit.has_value();
  return file;
}

std::vector<double> read_window(const fs::path& path, GDALDatasetH dataset,
                                const PixelWindow& window, const gdal::QuietErrors& errors) {
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
  const auto nx = static_cast<std::size_t>(window.columns);
  std::vector<double> values;
  try {
    values.resize(nx * static_cast<std::size_t>(window.rows));
  } catch (const std::bad_alloc&) {
    fail_input(path, "does not fit into memory; cut it to the domain");
  }
  // A mask of its own says which pixels have a value, whatever these hold.
  const bool masked = (GDALGetMaskFlags(band) & (GMF_ALL_VALID | GMF_NODATA)) == 0;
  std::vector<std::uint8_t> mask(masked ? nx : 0);
  for (int line = 0; line < window.rows; ++line) {
    double* row = values.data() + static_cast<std::size_t>(window.rows - 1 - line) * nx;
    CPLErr outcome = GDALRasterIO(band, GF_Read, window.column, window.row + line, window.columns,
                                  1, row, window.columns, 1, GDT_Float64, 0, 0);
    if (outcome == CE_None && masked)
      outcome = GDALRasterIO(GDALGetMaskBand(band), GF_Read, window.column, window.row + line,
                             window.columns, 1, mask.data(), window.columns, 1, GDT_Byte, 0, 0);
    if (outcome != CE_None)
      fail_input(path,
                 fmt::format("row {} cannot be read{}; the file is cut or broken, get it again",
                             window.row + line, errors.reason()));
    for (std::size_t i = 0; i < nx; ++i) {
      const bool missing = (has_nodata != 0 && (row[i] == nodata || row[i] == nodata_stored)) ||
                           (masked && mask[i] == 0);
      if (scale != 1 || offset != 0) row[i] = row[i] * scale + offset;
      if (missing || !std::isfinite(row[i])) row[i] = kNaN;
    }
  }
  return values;
}

std::int64_t fill_with_nearest(Raster& raster) {
  // Breadth-first from all valid nodes at once, in row order.
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

std::optional<double> height_unit_of(const fs::path& path, GDALDatasetH dataset) {
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
  OGRSpatialReferenceH srs = GDALGetSpatialRef(dataset);
  const double of_system = gdal::vertical_unit_metres(srs);
  if (name.empty() && gdal::vertical_name(srs).empty()) return std::nullopt;
  if (name.empty()) return of_system;
  // A band has no word for depths.
  for (const auto& [unit, metres] : kUnits)
    if (name == unit) return std::copysign(metres, of_system);
  fail_input(path, fmt::format("heights are in '{}', an unknown unit; convert them to metres",
                               first_bytes(name, 40)));
}

}  // namespace tetropolis
