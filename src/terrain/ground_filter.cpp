#include "tetropolis/terrain/ground_filter.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "tetropolis/geometry/polygon.h"
#include "tetropolis/terrain/dtm.h"
#include "tetropolis/terrain/raster.h"

#include "cells.h"
#include "core/parallel.h"
#include "depressions.h"
#include "ground_segments.h"
#include "low_outliers.h"
#include "morphology.h"
#include "plane.h"

namespace tetropolis {

namespace {

constexpr double kMostCells = 134217728.0;  // 2^27
constexpr std::size_t kPointGrain = std::size_t{1} << 15;

/// Metres: cells are not made wider than this for sparse clouds.
constexpr double kCoarsest = 4.0;

/// Metres: footprints with coordinates beyond this are dropped when they are cleaned, and far
/// beyond it differences of coordinates overflow.
constexpr double kMostCoordinate = 1e9;

using Candidates = std::vector<std::uint8_t>;

Candidates find_candidates(const PointCloud& cloud, const GroundFilterOptions& options) {
  const ClassTable wanted = class_table(options.classes);
  Candidates mask(cloud.size(), 0);
  parallel_chunks(cloud.size(), kPointGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) mask[p] = wanted[cloud.classification[p]] ? 1 : 0;
  });
  return mask;
}

Bounds2 extent_of(const PointCloud& cloud, const Candidates& mask) {
  return parallel_reduce_ordered(
      cloud.size(), kPointGrain, Bounds2::nothing(),
      [&](std::size_t begin, std::size_t end) {
        Bounds2 box = Bounds2::nothing();
        for (std::size_t p = begin; p < end; ++p)
          if (mask[p] != 0) box.extend(Point2{cloud.x[p], cloud.y[p]});
        return box;
      },
      [](Bounds2 a, const Bounds2& b) {
        a.extend(b);
        return a;
      });
}

Frame make_frame(const Bounds2& box, double cell, double window,
                 const std::optional<Point2>& anchor = {}) {
  const Bounds2 grown = box.grown(window + cell);
  Frame frame;
  frame.cell = std::max(cell, std::sqrt(grown.width() * grown.height() / kMostCells));
  frame.anchor = anchor.value_or(Point2{grown.xmin, grown.ymin});
  const auto cells = [&](double offset) { return std::floor(offset / frame.cell); };
  frame.first_i = cells(grown.xmin - frame.anchor.x);
  frame.first_j = cells(grown.ymin - frame.anchor.y);
  frame.nx = static_cast<std::int32_t>(cells(grown.xmax - frame.anchor.x) - frame.first_i) + 1;
  frame.ny = static_cast<std::int32_t>(cells(grown.ymax - frame.anchor.y) - frame.first_j) + 1;
  return frame;
}

/// The edge of a square with one candidate on average, where there are any.
double mean_spacing(const PointCloud& cloud, const Candidates& mask, const Bounds2& box) {
  constexpr double kBlock = 8;  // metres
  const Frame blocks = make_frame(box, kBlock, 0);
  std::vector<std::uint8_t> seen(
      static_cast<std::size_t>(blocks.nx) * static_cast<std::size_t>(blocks.ny), 0);
  std::int64_t candidates = 0;
  for (std::size_t p = 0; p < cloud.size(); ++p) {
    if (mask[p] == 0) continue;
    ++candidates;
    seen[blocks.at(cloud.x[p], cloud.y[p])] = 1;
  }
  const auto occupied = static_cast<double>(std::count(seen.begin(), seen.end(), std::uint8_t{1}));
  return blocks.cell * std::sqrt(occupied / static_cast<double>(candidates));
}

/// The lowest candidate of each cell, NaN without any.
HeightGrid lowest_points(const PointCloud& cloud, const Candidates& mask, const Frame& frame) {
  HeightGrid grid{frame.nx, frame.ny, {}};
  grid.values.assign(static_cast<std::size_t>(frame.nx) * static_cast<std::size_t>(frame.ny),
                     std::numeric_limits<float>::quiet_NaN());
  for (std::size_t p = 0; p < cloud.size(); ++p) {
    if (mask[p] == 0) continue;
    float& lowest = grid.values[frame.at(cloud.x[p], cloud.y[p])];
    const auto z = static_cast<float>(cloud.z[p]);
    if (!(lowest <= z)) lowest = z;
  }
  return grid;
}

/// Sets to 1 the cells whose centres lie in a footprint, by the even-odd rule along each row;
/// broken rings do no harm, nor do coordinates that are no positions.
void cover(const Polygon& footprint, const Frame& frame, std::vector<std::uint8_t>& covered) {
  const auto first_centre = [&](double offset, double first, std::int32_t cells) {
    return static_cast<std::int32_t>(
        std::clamp(std::ceil(offset / frame.cell - 0.5) - first, 0.0, static_cast<double>(cells)));
  };
  const auto first_column = [&](double x) {
    return first_centre(x - frame.anchor.x, frame.first_i, frame.nx);
  };
  const auto first_row = [&](double y) {
    return first_centre(y - frame.anchor.y, frame.first_j, frame.ny);
  };
  const auto is_position = [](Point2 p) {
    return std::abs(p.x) <= kMostCoordinate && std::abs(p.y) <= kMostCoordinate;
  };
  struct Crossing {
    std::int32_t row;
    double x;
  };
  std::vector<Crossing> crossings;
  for_each_edge(footprint, [&](Point2 a, Point2 b) {
    if (!is_position(a) || !is_position(b)) return;
    // One row more to either side than the edge spans, against rounding.
    const auto [low, high] = std::minmax({a.y, b.y});
    const std::int32_t begin = std::max(first_row(low) - 1, 0);
    const std::int32_t end = std::min(first_row(high) + 1, frame.ny);
    for (std::int32_t j = begin; j < end; ++j) {
      const double y = frame.centre(0, j).y;
      if ((a.y <= y) != (b.y <= y))
        crossings.push_back({j, a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x)});
    }
  });
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
    return a.row < b.row || (a.row == b.row && a.x < b.x);
  });
  for (std::size_t k = 0; k + 1 < crossings.size();) {
    if (crossings[k].row != crossings[k + 1].row) {  // an odd number, because of an edge left out
      ++k;
      continue;
    }
    std::uint8_t* row = covered.data() + static_cast<std::size_t>(crossings[k].row) *
                                             static_cast<std::size_t>(frame.nx);
    std::fill(row + first_column(crossings[k].x), row + first_column(crossings[k + 1].x),
              std::uint8_t{1});
    k += 2;
  }
}

bool is_empty(const HeightGrid& grid) {
  return std::all_of(grid.values.begin(), grid.values.end(), [](float z) { return std::isnan(z); });
}

/// Gives each empty cell the least of z + rise * distance over the cells around its void, distances
/// within the void along the eight directions: the lowest surroundings win, as far as they reach.
/// Chamfer distances (Borgefors, "Distance transformations in digital images", 1986); passes are
/// repeated until nothing changes, because a void may wind.
void fill_low(HeightGrid& grid, double rise) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  const auto straight = static_cast<float>(rise);
  const auto diagonal = static_cast<float>(rise * std::sqrt(2.0));
  std::vector<std::uint8_t> is_void(grid.values.size(), 0);
  for (std::size_t c = 0; c < is_void.size(); ++c) {
    if (!std::isnan(grid.values[c])) continue;
    is_void[c] = 1;
    grid.values[c] = inf;
  }
  bool changed = true;
  const auto lower = [&](std::size_t c, float z) {
    if (is_void[c] == 0 || !(z < grid.values[c])) return;
    grid.values[c] = z;
    changed = true;
  };
  const auto pass = [&](std::int32_t way) {
    for (std::int32_t n = 0; n < grid.ny; ++n) {
      const std::int32_t j = way > 0 ? n : grid.ny - 1 - n;
      const std::int32_t before = j - way;
      const std::size_t row = grid.index(0, j);
      const auto at = [&](std::int32_t i) { return row + static_cast<std::size_t>(i); };
      if (before >= 0 && before < grid.ny) {
        const float* other = grid.values.data() + grid.index(0, before);
        for (std::int32_t i = 0; i < grid.nx; ++i) {
          if (is_void[at(i)] == 0) continue;
          lower(at(i), other[i] + straight);
          if (i > 0) lower(at(i), other[i - 1] + diagonal);
          if (i + 1 < grid.nx) lower(at(i), other[i + 1] + diagonal);
        }
      }
      for (std::int32_t i = 1; i < grid.nx; ++i) lower(at(i), grid.values[at(i - 1)] + straight);
      for (std::int32_t i = grid.nx - 2; i >= 0; --i)
        lower(at(i), grid.values[at(i + 1)] + straight);
    }
  };
  while (changed) {
    changed = false;
    pass(1);
    pass(-1);
  }
}

/// Radii in cells: each, as long as they are small, then growing by a fifth.
std::vector<std::int32_t> window_radii(double window, double cell) {
  const auto last = static_cast<std::int32_t>(std::max(std::ceil(window / cell), 1.0));
  std::vector<std::int32_t> radii;
  for (std::int32_t r = 1; r < last; r += std::max(1, r / 5)) radii.push_back(r);
  radii.push_back(last);
  return radii;
}

/// The plane of least squares over the cells that have a value and, from the second round on, lie
/// below the plane before, as ground does.
Plane fit_plane(const HeightGrid& grid, const Frame& frame) {
  constexpr int kRounds = 3;  // buildings are above the second plane, trees above the third
  Plane plane;
  for (int round = 0; round < kRounds; ++round) {
    CellPlaneFit fit;
    std::size_t c = 0;
    for (std::int32_t j = 0; j < frame.ny; ++j) {
      for (std::int32_t i = 0; i < frame.nx; ++i, ++c) {
        const double value = static_cast<double>(grid.values[c]);
        if (std::isnan(value) || (round > 0 && value > plane.at(i, j))) continue;
        // Around the middle of the frame, so that no digits are lost.
        fit.add(i - 0.5 * frame.nx, j - 0.5 * frame.ny, value);
      }
    }
    if (!fit.solve(plane)) return plane;
    plane.height -= 0.5 * (plane.rise_x * frame.nx + plane.rise_y * frame.ny);
  }
  return plane;
}

/// Takes the slope of the whole terrain out of it where that is steep; whether it is.
bool level(HeightGrid& grid, const Frame& frame, const GroundFilterOptions& options) {
  Plane plane;
  if (options.tilt)
    plane = {options.tilt->x * frame.cell, options.tilt->y * frame.cell, 0};
  else
    plane = fit_plane(grid, frame);
  // Less leaves the filter most of the slope that it allows for.
  constexpr double kShare = 0.3;
  if (std::hypot(plane.rise_x, plane.rise_y) < kShare * options.slope * frame.cell) return false;
  std::size_t c = 0;
  for (std::int32_t j = 0; j < frame.ny; ++j)
    for (std::int32_t i = 0; i < frame.nx; ++i, ++c)
      grid.values[c] -= static_cast<float>(plane.at(i, j));
  return true;
}

/// 1 for the cells that an opening lowers by more than terrain of the given slope would be: that
/// slope times the window, at most a storey. The drop is that from the surface itself, not from the
/// opening before as in the paper: buildings that wear away step by step (at ragged rims, on
/// slopes) would never drop far at once.
std::vector<std::uint8_t> lowered_by_openings(HeightGrid surface, const Frame& frame,
                                              const GroundFilterOptions& options,
                                              const Progress& progress) {
  std::vector<float> original = surface.values;
  fill_depressions(surface, frame, options.window);
  fill_low(surface, options.slope * frame.cell);
  for (std::size_t c = 0; c < original.size(); ++c)
    if (std::isnan(original[c])) original[c] = surface.values[c];
  std::vector<std::uint8_t> object(original.size(), 0);
  const std::vector<std::int32_t> radii = window_radii(options.window, frame.cell);
  for (std::size_t k = 0; k < radii.size(); ++k) {
    progress.update(static_cast<double>(k) / static_cast<double>(radii.size()));
    open_with_octagon(surface, radii[k]);
    const auto most = static_cast<float>(std::min(options.slope * radii[k] * frame.cell, kStorey));
    for (std::size_t c = 0; c < object.size(); ++c)
      if (original[c] - surface.values[c] > most) object[c] = 1;
  }
  return object;
}

/// What stands up from the terrain. Where that slopes as a whole an opening cuts off its uphill
/// rim, which nothing higher is next to; with the slope taken out of it, what cliffs and terraces
/// rise to leans back, and the opening cuts off that. Objects are what both ways find.
std::vector<std::uint8_t> find_objects(const HeightGrid& lowest, const Frame& frame,
                                       const GroundFilterOptions& options,
                                       const Progress& progress) {
  HeightGrid levelled = lowest;
  if (!level(levelled, frame, options))
    return lowered_by_openings(std::move(levelled), frame, options, progress);
  std::vector<std::uint8_t> object =
      lowered_by_openings(std::move(levelled), frame, options, portion(progress, 0, 0.5));
  const std::vector<std::uint8_t> as_it_is =
      lowered_by_openings(lowest, frame, options, portion(progress, 0.5, 1));
  for (std::size_t c = 0; c < object.size(); ++c) object[c] &= as_it_is[c];
  return object;
}

/// The terrain through the cells that have points and are no objects.
Raster terrain_between(const HeightGrid& lowest, const std::vector<std::uint8_t>& object,
                       const Frame& frame, const Progress& progress) {
  const Point2 first = frame.centre(0, 0);
  Raster terrain{frame.nx, frame.ny, first.x, first.y, frame.cell, {}};
  terrain.values.resize(lowest.values.size());
  for (std::size_t c = 0; c < terrain.values.size(); ++c)
    terrain.values[c] = object[c] != 0 ? std::numeric_limits<double>::quiet_NaN()
                                       : static_cast<double>(lowest.values[c]);
  fill_empty_nodes(terrain, {[&](double fraction) { progress.update(0.8 + 0.1 * fraction); }, {}});
  return terrain;
}

/// Steepness at a position, from central differences one cell long.
double slope_at(const Raster& terrain, Point2 p) {
  const double half = terrain.step / 2;
  const double dx = sample(terrain, {p.x + half, p.y}) - sample(terrain, {p.x - half, p.y});
  const double dy = sample(terrain, {p.x, p.y + half}) - sample(terrain, {p.x, p.y - half});
  return std::hypot(dx, dy) / terrain.step;
}

/// Keeps in `mask` the points that lie on the terrain.
void keep_near(const PointCloud& cloud, const Raster& terrain, const GroundFilterOptions& options,
               Candidates& mask) {
  parallel_chunks(cloud.size(), kPointGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      if (mask[p] == 0) continue;
      const Point2 position{cloud.x[p], cloud.y[p]};
      const double off = std::abs(cloud.z[p] - sample(terrain, position));
      const bool near =
          off <= options.tolerance ||
          off <= options.tolerance + options.tolerance_per_slope * slope_at(terrain, position);
      mask[p] = near ? 1 : 0;
    }
  });
}

}  // namespace

std::vector<std::uint8_t> filter_ground(const PointCloud& cloud,
                                        std::span<const Polygon> footprints,
                                        const GroundFilterOptions& options,
                                        const Progress& progress) {
  assert(options.cell > 0 && options.window > 0 && options.slope > 0);
  progress.update(0);
  Candidates mask = find_candidates(cloud, options);
  if (std::find(mask.begin(), mask.end(), 1) != mask.end()) {
    const Bounds2 box = extent_of(cloud, mask);
    // With many empty cells slopes would fall to pieces.
    const double spacing = options.spacing ? *options.spacing : mean_spacing(cloud, mask, box);
    const double cell = std::max(options.cell, std::min(spacing, kCoarsest));
    const Frame frame = make_frame(box, cell, options.window, options.anchor);
    HeightGrid all = lowest_points(cloud, mask, frame);
    progress.update(0.1);
    std::vector<std::uint8_t> covered(all.values.size(), 0);
    for (const Polygon& footprint : footprints) cover(footprint, frame, covered);
    HeightGrid lowest = all;
    for (std::size_t c = 0; c < covered.size(); ++c)
      if (covered[c] != 0) lowest.values[c] = std::numeric_limits<float>::quiet_NaN();
    if (is_empty(lowest)) lowest = all;
    HeightGrid believed = lowest;
    remove_low_outliers(believed, std::move(all), frame.cell, spacing);
    if (!is_empty(believed)) lowest = std::move(believed);
    auto object = find_objects(lowest, frame, options, portion(progress, 0.2, 0.8));
    restore_gentle_rises(lowest, frame, object, progress);
    reject_fragments(lowest, std::move(covered), frame, object, progress);
    const Raster terrain = terrain_between(lowest, object, frame, progress);
    keep_near(cloud, terrain, options, mask);
  }
  progress.update(1);
  return mask;
}

}  // namespace tetropolis
