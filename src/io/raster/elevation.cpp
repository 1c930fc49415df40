#include "tetropolis/io/raster/elevation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/row_major.h"
#include "tetropolis/io/crs/crs.h"

#include "core/foreign_code.h"
#include "core/infinity.h"
#include "io/crs/gdal_support.h"
#include "io/file/input_file.h"
#include "io/file/input_paths.h"
#include "raster_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

constexpr double kMetresPerDegree = 111'320;

constexpr std::array<std::string_view, 14> kRasterEndings{".tif", ".tiff", ".vrt", ".asc", ".img",
                                                          ".hgt", ".dem",  ".xyz", ".bil", ".flt",
                                                          ".dt2", ".jp2",  ".grd", ".nc"};
constexpr FileKind kRasterFiles{"rasters", kRasterEndings};

/// Pixels of one grid, from the south-west; part of what a layer of tiles holds.
struct Layer {
  std::string crs;
  double x0 = 0;  ///< Of the south-western pixel's centre.
  double y0 = 0;
  double step_x = 1;
  double step_y = 1;
  std::int64_t nx = 0;
  std::int64_t ny = 0;
  std::vector<double> values;

  double at(std::int64_t i, std::int64_t j) const {
    if (i < 0 || j < 0 || i >= nx || j >= ny) return kNaN;
    return values[static_cast<std::size_t>(j * nx + i)];
  }
};

struct Tile {
  fs::path path;
  RasterHeader header;
};

double metres_per_unit(const std::string& crs) {
  if (crs.empty()) return 1;
  return is_geographic(crs) ? kMetresPerDegree : linear_unit_metres(crs);
}

/// Tiles of one system, with pixels of one size at whole steps from each other.
bool on_one_grid(const RasterHeader& a, const RasterHeader& b) {
  constexpr double kSame = 1e-6, kShift = 1e-3;
  const auto whole = [](double steps) { return std::abs(steps - std::round(steps)) <= kShift; };
  return a.crs == b.crs && std::abs(a.step_x - b.step_x) <= kSame * a.step_x &&
         std::abs(a.step_y - b.step_y) <= kSame * a.step_y &&
         whole((a.box.xmin - b.box.xmin) / a.step_x) && whole((a.box.ymax - b.box.ymax) / a.step_y);
}

/// What is no elevation on Earth.
class Markers {
 public:
  double checked(double value, const fs::path& path) {
    constexpr double kLowest = -1000, kHighest = 9000;  // metres
    if (!(value < kLowest) && !(value > kHighest)) return value;
    if (count_++ == 0) {
      first_ = value;
      path_ = path;
    }
    return kNaN;
  }
  void report(std::vector<Warning>& warnings) const {
    if (count_ == 0) return;
    warnings.push_back({"raster_no_elevation", count_,
                        fmt::format("{}: {} pixels hold what is no elevation, such as {:.6g}, and "
                                    "are taken for missing",
                                    path_.string(), count_, first_)});
  }

 private:
  std::int64_t count_ = 0;
  double first_ = 0;
  fs::path path_;
};

/// Lays the tiles of one grid side by side, as far as they reach into `wanted` (of their system).
/// Without values if none does.
Layer lay_out(std::span<const Tile> tiles, const Bounds2& wanted, Markers& markers) {
  const RasterHeader& anchor = tiles.front().header;
  Bounds2 all = Bounds2::nothing();
  for (const Tile& tile : tiles) all.extend(tile.header.box);
  const double margin_x = 2 * anchor.step_x, margin_y = 2 * anchor.step_y;
  const Bounds2 box = wanted.empty()
                          ? all
                          : all.intersection({wanted.xmin - margin_x, wanted.ymin - margin_y,
                                              wanted.xmax + margin_x, wanted.ymax + margin_y});
  Layer layer{anchor.crs, 0, 0, anchor.step_x, anchor.step_y, 0, 0, {}};
  if (box.empty()) return layer;
  // Columns run east, rows north, counted from the anchor's south-western pixel.
  const auto column = [&](double x) { return (x - anchor.box.xmin) / anchor.step_x; };
  const auto row = [&](double y) { return (y - anchor.box.ymin) / anchor.step_y; };
  constexpr double kShift = 1e-2;
  const auto first = [](double at) { return static_cast<std::int64_t>(std::floor(at + kShift)); };
  const auto last = [](double at) { return static_cast<std::int64_t>(std::ceil(at - kShift)); };
  const std::int64_t i0 = first(column(box.xmin)), i1 = last(column(box.xmax));
  const std::int64_t j0 = first(row(box.ymin)), j1 = last(row(box.ymax));
  if (i1 <= i0 || j1 <= j0) return layer;
  layer.nx = i1 - i0;
  layer.ny = j1 - j0;
  layer.x0 = anchor.box.xmin + (static_cast<double>(i0) + 0.5) * anchor.step_x;
  layer.y0 = anchor.box.ymin + (static_cast<double>(j0) + 0.5) * anchor.step_y;
  const double pixels = static_cast<double>(layer.nx) * static_cast<double>(layer.ny);
  if (pixels > static_cast<double>(std::int64_t{1} << 31))
    fail_input(
        tiles.front().path,
        fmt::format("has too many pixels ({} x {}); give smaller `bounds`", layer.nx, layer.ny));
  require_memory(tiles.front().path, 3 * sizeof(double) * pixels,
                 fmt::format("read {} x {} pixels", layer.nx, layer.ny), "give smaller `bounds`");
  layer.values.assign(static_cast<std::size_t>(layer.nx * layer.ny), kNaN);
  const gdal::QuietErrors errors;
  for (const Tile& tile : tiles) {
    const RasterHeader& header = tile.header;
    const auto left = std::llround(column(header.box.xmin)) - i0;
    const auto low = std::llround(row(header.box.ymin)) - j0;
    const std::int64_t a = std::max<std::int64_t>(left, 0),
                       b = std::min<std::int64_t>(left + header.nx, layer.nx);
    const std::int64_t c = std::max<std::int64_t>(low, 0),
                       d = std::min<std::int64_t>(low + header.ny, layer.ny);
    if (a >= b || c >= d) continue;
    const PixelWindow window{static_cast<int>(a - left), static_cast<int>(low + header.ny - d),
                             static_cast<int>(b - a), static_cast<int>(d - c)};
    const RasterFile file = open_elevations(tile.path, errors);
    const std::vector<double> values = read_window(tile.path, file.dataset(), window, errors);
    for (std::int64_t j = 0; j < d - c; ++j)
      for (std::int64_t i = 0; i < b - a; ++i) {
        double& target = layer.values[static_cast<std::size_t>((c + j) * layer.nx + a + i)];
        const double value = values[static_cast<std::size_t>(j * (b - a) + i)];
        if (std::isnan(target)) target = markers.checked(value * header.height_unit, tile.path);
      }
  }
  return layer;
}

/// NaN where there is no value. Bilinear: the mean of those pixels around that have one, by their
/// bilinear weights, provided that these are at least half of all.
double sample(const Layer& layer, Point2 p, Resampling resampling) {
  constexpr double kEnough = 0.5 - 1e-9;
  const double x = (p.x - layer.x0) / layer.step_x, y = (p.y - layer.y0) / layer.step_y;
  if (!(std::abs(x) < 1e9) || !(std::abs(y) < 1e9)) return kNaN;
  if (resampling == Resampling::kNearest) return layer.at(std::llround(x), std::llround(y));
  const auto i = static_cast<std::int64_t>(std::floor(x));
  const auto j = static_cast<std::int64_t>(std::floor(y));
  const double u = x - static_cast<double>(i), v = y - static_cast<double>(j);
  const std::array<std::pair<double, double>, 4> corners{{{(1 - u) * (1 - v), layer.at(i, j)},
                                                          {u * (1 - v), layer.at(i + 1, j)},
                                                          {(1 - u) * v, layer.at(i, j + 1)},
                                                          {u * v, layer.at(i + 1, j + 1)}}};
  double weight = 0, sum = 0;
  for (const auto& [share, value] : corners)
    if (share > 0 && !std::isnan(value)) {
      weight += share;
      sum += share * value;
    }
  return weight >= kEnough ? sum / weight : kNaN;
}

/// The layer as it is: square pixels, metres, the target's system.
Raster as_it_is(Layer layer, Point2 origin) {
  Raster raster;
  raster.nx = static_cast<std::int32_t>(layer.nx);
  raster.ny = static_cast<std::int32_t>(layer.ny);
  raster.x0 = layer.x0 - origin.x;
  raster.y0 = layer.y0 - origin.y;
  raster.step = layer.step_x;
  raster.values = std::move(layer.values);
  return raster;
}

/// On a grid of `step` over `box`, at whole steps of the target's coordinates. `layers`: the finest
/// first.
Raster sampled(std::span<const Layer> layers, const fs::path& first, const Bounds2& box,
               double step, const ReadElevationsOptions& options, const std::string& target) {
  const double i0 = std::floor(box.xmin / step), i1 = std::ceil(box.xmax / step);
  const double j0 = std::floor(box.ymin / step), j1 = std::ceil(box.ymax / step);
  const double nodes = (i1 - i0 + 1) * (j1 - j0 + 1);
  if (nodes > static_cast<double>(std::int64_t{1} << 31))
    fail_input(first, "has too many pixels; give smaller `bounds`");
  require_memory(first, 3 * sizeof(double) * nodes, fmt::format("sample {:.0f} pixels", nodes),
                 "give smaller `bounds`");
  Raster raster;
  raster.nx = static_cast<std::int32_t>(i1 - i0 + 1);
  raster.ny = static_cast<std::int32_t>(j1 - j0 + 1);
  raster.step = step;
  raster.x0 = i0 * step - options.origin.x;
  raster.y0 = j0 * step - options.origin.y;
  raster.values.assign(static_cast<std::size_t>(nodes), kNaN);
  std::vector<Point2> row(static_cast<std::size_t>(raster.nx));
  for (const Layer& layer : layers) {
    const bool same = target.empty() || layer.crs.empty() || same_horizontal_crs(layer.crs, target);
    constexpr std::int32_t kRows = 64;  // a transformation is made once for so many
    for (std::int32_t begin = 0; begin < raster.ny; begin += kRows) {
      const std::int32_t end = std::min(begin + kRows, raster.ny);
      row.clear();
      for (std::int32_t j = begin; j < end; ++j)
        for (std::int32_t i = 0; i < raster.nx; ++i)
          row.push_back({(i0 + i) * step, (j0 + j) * step});
      if (!same) row = reproject(row, target, layer.crs);
      for (std::size_t k = 0; k < row.size(); ++k) {
        double& value = raster.values[row_major(0, begin, raster.nx) + k];
        if (std::isnan(value) && std::isfinite(row[k].x))
          value = sample(layer, row[k], options.resampling);
      }
    }
  }
  return raster;
}

/// Of heights without a unit of their own, coordinates in feet tell it.
void settle_unit(Tile& tile, const std::string& crs, std::vector<Warning>& warnings) {
  RasterHeader& header = tile.header;
  if (header.height_unit < 0)
    fail_input(tile.path, "heights are depths, counted downwards; convert them to heights");
  const double across = crs.empty() || is_geographic(crs) ? 1 : linear_unit_metres(crs);
  const bool guessed = !header.states_height_unit && !is_metre(across) && across > 0;
  if (guessed) header.height_unit = across;
  if (is_metre(header.height_unit) ||
      (!warnings.empty() && warnings.back().code == "raster_units" && warnings.back().count++ > 0))
    return;
  warnings.push_back(
      {"raster_units", 1,
       fmt::format("{}: heights are {}in units of {:.10g} m and are converted to metres",
                   tile.path.string(), guessed ? "taken to be, as the coordinates are, " : "",
                   header.height_unit)});
}

}  // namespace

RasterHeader inspect_raster(const fs::path& path) {
  const ForeignCode gdal_code(path.c_str());
  gdal::initialise();
  const gdal::QuietErrors errors;
  return open_elevations(path, errors).header;
}

bool is_raster_name(const fs::path& path) { return kRasterFiles.has(path); }

std::vector<fs::path> expand_raster_paths(std::span<const std::string> arguments) {
  return expand_paths(arguments, kRasterFiles);
}

Elevations read_elevations(std::span<const fs::path> paths, const ReadElevationsOptions& options) {
  Elevations result;
  std::vector<Tile> tiles;
  const std::string source = normalise_crs(options.source_crs);
  result.crs = normalise_crs(options.target_crs);
  for (const fs::path& path : paths) {
    Tile& tile = tiles.emplace_back(Tile{path, inspect_raster(path)});
    if (!source.empty()) tile.header.crs = source;
    settle_unit(tile, tile.header.crs, result.warnings);
    const RasterHeader& first = tiles.front().header;
    if (tile.header.crs.empty() != first.crs.empty())
      fail_input(tile.header.crs.empty() ? path : tiles.front().path,
                 "states no CRS, while other rasters do; name it with raster_crs");
  }
  if (tiles.empty()) return result;
  std::sort(tiles.begin(), tiles.end(), [](const Tile& a, const Tile& b) {
    const auto key = [](const Tile& tile) {
      return std::tuple(tile.header.step_x * metres_per_unit(tile.header.crs), tile.header.crs,
                        tile.header.box.xmin, tile.header.box.ymin, tile.path);
    };
    return key(a) < key(b);
  });
  if (result.crs.empty()) result.crs = tiles.front().header.crs;
  const ForeignCode gdal_code(tiles.front().path.c_str());
  Markers markers;
  std::vector<Layer> layers;
  Bounds2 covered = Bounds2::nothing();
  for (std::size_t begin = 0; begin < tiles.size();) {
    const auto end = std::stable_partition(
        tiles.begin() + static_cast<std::ptrdiff_t>(begin), tiles.end(),
        [&](const Tile& tile) { return on_one_grid(tiles[begin].header, tile.header); });
    const std::span<const Tile> group{tiles.begin() + static_cast<std::ptrdiff_t>(begin), end};
    begin += group.size();
    const std::string& crs = group.front().header.crs;
    const Bounds2 wanted = reproject_box(options.box, result.crs, crs);
    if (wanted.empty() && !options.box.empty()) continue;
    Layer layer = lay_out(group, wanted, markers);
    if (layer.values.empty()) continue;
    const Bounds2 box{layer.x0, layer.y0,
                      layer.x0 + static_cast<double>(layer.nx - 1) * layer.step_x,
                      layer.y0 + static_cast<double>(layer.ny - 1) * layer.step_y};
    covered.extend(reproject_box(box, crs, result.crs));
    layers.push_back(std::move(layer));
  }
  markers.report(result.warnings);
  if (layers.empty())
    fail_input(paths.front(),
               fmt::format("{} no elevation in the domain, x {:.1f} .. {:.1f}, y {:.1f} .. {:.1f}; "
                           "check the CRS of both (raster_crs, footprints_crs)",
                           paths.size() > 1 ? "and the other rasters have" : "has",
                           options.box.xmin, options.box.xmax, options.box.ymin, options.box.ymax));
  const Layer& finest = layers.front();
  const bool same = result.crs.empty() || finest.crs.empty() || finest.crs == result.crs ||
                    same_horizontal_crs(finest.crs, result.crs);
  const bool square = std::abs(finest.step_x - finest.step_y) <= 1e-6 * finest.step_x;
  if (layers.size() == 1 && same && square) {
    result.raster = as_it_is(std::move(layers.front()), options.origin);
  } else {
    const double step = std::min(finest.step_x, finest.step_y) *
                        (same ? 1 : metres_per_unit(finest.crs)) /
                        (same ? 1 : metres_per_unit(result.crs));
    const Bounds2 box =
        options.box.empty() ? covered : covered.intersection(options.box.grown(2 * step));
    if (box.empty())
      fail_input(paths.front(), "has no elevation in the domain; check the CRS (raster_crs)");
    result.raster = sampled(layers, paths.front(), box, step, options, result.crs);
  }
  const Raster& raster = result.raster;
  const auto is_missing = [](double value) { return std::isnan(value); };
  if (std::all_of(raster.values.begin(), raster.values.end(), is_missing))
    fail_input(paths.front(), "has no value in the domain, only missing ones; name another raster");
  // Beyond the box there may be none: corners of what is turned by reprojection.
  const Bounds2 box = options.box.empty() ? raster.bounds().moved(options.origin) : options.box;
  for (std::int32_t j = 0; j < raster.ny; ++j)
    for (std::int32_t i = 0; i < raster.nx; ++i)
      if (is_missing(raster.at(i, j)) &&
          box.contains({raster.x0 + i * raster.step + options.origin.x,
                        raster.y0 + j * raster.step + options.origin.y}))
        ++result.missing;
  return result;
}

}  // namespace tetropolis
