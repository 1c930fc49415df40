#include "tetropolis/terrain/ground_filter.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>

#include "tetropolis/core/parallel.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/terrain/dtm.h"
#include "tetropolis/terrain/raster.h"

#include "cells.h"
#include "opening.h"
#include "plane.h"
#include "segments.h"

namespace tetropolis {

namespace {

constexpr double kMostCells = 134217728.0;  // 2^27
constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kPointGrain = std::size_t{1} << 15;
constexpr std::size_t kRowGrain = 32;

/// A lowest point is a pit unless this many cells, itself among them, hold one at most kPitRise
/// higher within kPitReach.
constexpr int kPitSupport = 4;
constexpr double kPitRise = 1.0;
constexpr double kPitReach = 10.0;

/// Where pits are many they support each other. So a pit is, too, what has higher points all around
/// and hardly any at its level, kPitRise up and down: in at most kMostAlone of the 25 cells around,
/// and in less than this area in square metres, if one of two holds:
constexpr std::int32_t kRing = 2;
constexpr int kMostAlone = 4;
constexpr double kMostAloneArea = 5;
/// - what is around is smooth, within this of a plane, as crowns are not;
constexpr double kRough = 0.5;
/// - within kPitReach its level has less than this share of the cells of the commonest one above.
constexpr double kPitShare = 0.06;

/// Where there are points in nearly all cells, what is left is looked at again, this often at most:
/// with its neighbours gone, one more pit may be alone. In sparse clouds yards would go that way.
constexpr int kPitRounds = 3;

/// Points are around if this share of the 24 cells has higher ones (or smooth ones), as far as they
/// can be expected to hold any: at water that returns little it is voids that are around.
constexpr double kSurrounded = 0.6;

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

Frame make_frame(const Bounds2& box, double cell, double window) {
  const Bounds2 grown = box.grown(window + cell);
  Frame frame;
  frame.cell = std::max(cell, std::sqrt(grown.width() * grown.height() / kMostCells));
  frame.x0 = grown.xmin;
  frame.y0 = grown.ymin;
  frame.nx = static_cast<std::int32_t>(grown.width() / frame.cell) + 1;
  frame.ny = static_cast<std::int32_t>(grown.height() / frame.cell) + 1;
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
                     kNanF);
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
  const auto first_centre = [&](double position, double start, std::int32_t cells) {
    return static_cast<std::int32_t>(std::clamp(std::ceil((position - start) / frame.cell - 0.5),
                                                0.0, static_cast<double>(cells)));
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
    const std::int32_t begin = std::max(first_centre(low, frame.y0, frame.ny) - 1, 0);
    const std::int32_t end = std::min(first_centre(high, frame.y0, frame.ny) + 1, frame.ny);
    for (std::int32_t j = begin; j < end; ++j) {
      const double y = frame.y0 + (j + 0.5) * frame.cell;
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
    std::fill(row + first_centre(crossings[k].x, frame.x0, frame.nx),
              row + first_centre(crossings[k + 1].x, frame.x0, frame.nx), std::uint8_t{1});
    k += 2;
  }
}

/// Whether enough cells around (i, j) hold points at most kPitRise higher. Rings from the inside
/// out: almost always the first one settles it.
bool is_supported(const HeightGrid& grid, std::int32_t i, std::int32_t j, std::int32_t reach) {
  const float most = grid.values[grid.index(i, j)] + static_cast<float>(kPitRise);
  int support = 1;
  const auto look = [&](std::int32_t ni, std::int32_t nj) {
    if (ni < 0 || nj < 0 || ni >= grid.nx || nj >= grid.ny) return;
    if (grid.values[grid.index(ni, nj)] <= most) ++support;
  };
  for (std::int32_t ring = 1; ring <= reach && support < kPitSupport; ++ring) {
    for (std::int32_t k = -ring; k <= ring; ++k) {
      look(i + k, j - ring);
      look(i + k, j + ring);
    }
    for (std::int32_t k = -ring + 1; k < ring; ++k) {
      look(i - ring, j + k);
      look(i + ring, j + k);
    }
  }
  return support >= kPitSupport;
}

/// What pits that are many are told by.
struct PitLimits {
  double higher = 0;   ///< Share of the cells around that have to hold higher points.
  int most_alone = 0;  ///< Cells that may share the level, at most.
};

/// Cells that are expected to hold points are 1 - exp(-cell^2 / spacing^2) of all.
PitLimits pit_limits(double cell, double spacing) {
  return {kSurrounded * (1 - std::exp(-(cell * cell) / (spacing * spacing))),
          static_cast<int>(std::min<double>(kMostAlone, kMostAloneArea / (cell * cell)))};
}

/// Columns and rows [i0, i1] x [j0, j1] of cells.
struct Block {
  std::int32_t i0, i1, j0, j1;

  int cells() const { return (i1 - i0 + 1) * (j1 - j0 + 1); }
  /// Those within kRing of a cell.
  Block around(std::int32_t i, std::int32_t j) const {
    return {std::max(i - kRing, i0), std::min(i + kRing, i1), std::max(j - kRing, j0),
            std::min(j + kRing, j1)};
  }
  /// How many cells around one, itself left out, are the given share.
  int share(double share) const { return static_cast<int>(std::ceil(share * (cells() - 1))); }
};

/// The least block with all cells that hold points: beyond the rim of the cloud there is nothing to
/// be expected. Precondition: there are some.
Block block_with_points(const HeightGrid& grid) {
  Block block{grid.nx, -1, grid.ny, -1};
  for (std::int32_t j = 0; j < grid.ny; ++j)
    for (std::int32_t i = 0; i < grid.nx; ++i) {
      if (std::isnan(grid.values[grid.index(i, j)])) continue;
      block.i0 = std::min(block.i0, i);
      block.i1 = std::max(block.i1, i);
      block.j0 = std::min(block.j0, j);
      block.j1 = j;
    }
  return block;
}

/// Whether the cells around (i, j) hold higher points and next to none at its level.
bool is_surrounded(const HeightGrid& grid, std::int32_t i, std::int32_t j, const Block& around,
                   const PitLimits& limits) {
  const float z = grid.values[grid.index(i, j)];
  const auto rise = static_cast<float>(kPitRise);
  const int needed = around.share(limits.higher);
  int left = around.cells();
  int higher = 0, level = 0;
  for (std::int32_t nj = around.j0; nj <= around.j1; ++nj)
    for (std::int32_t ni = around.i0; ni <= around.i1; ++ni) {
      const float other = grid.values[grid.index(ni, nj)];
      if (other > z + rise)
        ++higher;
      else if (other >= z - rise && ++level > limits.most_alone)
        return false;
      if (higher + --left < needed) return false;
    }
  return true;
}

float median(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Whether the cells around (i, j) lie in one plane above it, as many as are needed. The plane is
/// that of the medians, which other pits and roofs do not tilt. `room` is to work in.
bool is_under_plane(const HeightGrid& grid, std::int32_t i, std::int32_t j, const Block& around,
                    const PitLimits& limits, std::vector<float>& room) {
  const auto at = [&](std::int32_t ni, std::int32_t nj) { return grid.values[grid.index(ni, nj)]; };
  const auto rise_along = [&](std::int32_t di, std::int32_t dj) {
    room.clear();
    for (std::int32_t nj = around.j0; nj <= around.j1 - dj; ++nj)
      for (std::int32_t ni = around.i0; ni <= around.i1 - di; ++ni) {
        const float step = at(ni + di, nj + dj) - at(ni, nj);
        if (!std::isnan(step)) room.push_back(step);
      }
    return room.empty() ? 0 : median(room);
  };
  const float rise_x = rise_along(1, 0), rise_y = rise_along(0, 1);
  room.clear();
  for (std::int32_t nj = around.j0; nj <= around.j1; ++nj)
    for (std::int32_t ni = around.i0; ni <= around.i1; ++ni) {
      const float level =
          at(ni, nj) - rise_x * static_cast<float>(ni - i) - rise_y * static_cast<float>(nj - j);
      if (!std::isnan(level)) room.push_back(level);
    }
  const float plane = median(room);
  if (plane - at(i, j) <= static_cast<float>(kPitRise)) return false;
  const auto smooth = std::count_if(room.begin(), room.end(), [&](float level) {
    return std::abs(level - plane) <= static_cast<float>(kRough);
  });
  return smooth >= around.share(limits.higher);
}

/// Whether few cells within `reach` share the level of (i, j), compared with the commonest level
/// above. `higher` is room to work in.
bool is_rare(const HeightGrid& grid, std::int32_t i, std::int32_t j, std::int32_t reach,
             std::vector<float>& higher) {
  const float z = grid.values[grid.index(i, j)];
  const auto rise = static_cast<float>(kPitRise);
  higher.clear();
  int level = 0;
  for (std::int32_t nj = std::max(j - reach, 0); nj <= std::min(j + reach, grid.ny - 1); ++nj)
    for (std::int32_t ni = std::max(i - reach, 0); ni <= std::min(i + reach, grid.nx - 1); ++ni) {
      const float other = grid.values[grid.index(ni, nj)];
      if (other > z + rise)
        higher.push_back(other);
      else if (other >= z - rise)
        ++level;
    }
  if (level < kPitSupport) return true;
  const double most = static_cast<double>(level) / kPitShare;
  if (static_cast<double>(higher.size()) <= most) return false;
  std::sort(higher.begin(), higher.end());
  std::size_t commonest = 0;
  for (std::size_t first = 0, last = 0; last < higher.size(); ++last) {
    while (higher[last] - higher[first] > 2 * rise) ++first;
    commonest = std::max(commonest, last - first + 1);
  }
  return static_cast<double>(commonest) > most;
}

/// The cells within kRing of these.
std::vector<std::uint8_t> cells_near(const std::vector<std::uint8_t>& chosen,
                                     const HeightGrid& grid) {
  std::vector<std::uint8_t> near(chosen.size(), 0);
  for (std::size_t c = 0; c < chosen.size(); ++c) {
    if (chosen[c] == 0) continue;
    const auto nx = static_cast<std::size_t>(grid.nx);
    const auto i = static_cast<std::int32_t>(c % nx), j = static_cast<std::int32_t>(c / nx);
    const std::int32_t i0 = std::max(i - kRing, 0), i1 = std::min(i + kRing, grid.nx - 1);
    for (std::int32_t nj = std::max(j - kRing, 0); nj <= std::min(j + kRing, grid.ny - 1); ++nj)
      std::fill(near.begin() + static_cast<std::ptrdiff_t>(grid.index(i0, nj)),
                near.begin() + static_cast<std::ptrdiff_t>(grid.index(i1, nj)) + 1,
                std::uint8_t{1});
  }
  return near;
}

/// Empties the cells whose lowest point is a pit; returns how many. `all` has the lowest points of
/// the cells in footprints, too.
std::int64_t remove_pits(HeightGrid& grid, HeightGrid all, double cell, double spacing) {
  const auto reach = static_cast<std::int32_t>(std::max(std::ceil(kPitReach / cell), 2.0));
  const PitLimits limits = pit_limits(cell, spacing);
  const Block block = block_with_points(all);
  const int rounds = limits.most_alone == kMostAlone ? kPitRounds : 1;
  std::vector<std::uint8_t> open(grid.values.size(), 1);
  std::int64_t pits = 0;
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::uint8_t> pit(grid.values.size(), 0);
    parallel_chunks(
        static_cast<std::size_t>(grid.ny), kRowGrain, [&](std::size_t begin, std::size_t end) {
          std::vector<float> room;
          for (auto j = static_cast<std::int32_t>(begin); j < static_cast<std::int32_t>(end); ++j)
            for (std::int32_t i = 0; i < grid.nx; ++i) {
              const std::size_t c = grid.index(i, j);
              if (open[c] == 0 || std::isnan(grid.values[c])) continue;
              const Block around = block.around(i, j);
              if (!is_supported(grid, i, j, reach) ||
                  (is_surrounded(all, i, j, around, limits) &&
                   (is_under_plane(all, i, j, around, limits, room) ||
                    is_rare(grid, i, j, reach, room))))
                pit[c] = 1;
            }
        });
    std::int64_t found = 0;
    for (std::size_t c = 0; c < pit.size(); ++c) {
      if (pit[c] == 0) continue;
      grid.values[c] = all.values[c] = kNanF;
      ++found;
    }
    pits += found;
    if (found == 0) break;
    if (round + 1 < rounds) open = cells_near(pit, grid);
  }
  return pits;
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
  Plane plane;
  for (int round = 0; round < 3; ++round) {
    PlaneFit fit;
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

/// Takes the slope of the whole terrain out of it where that is steep: there an opening would cut
/// off the uphill rim, which nothing higher is next to.
void level(HeightGrid& grid, const Frame& frame, double slope) {
  const Plane plane = fit_plane(grid, frame);
  if (std::hypot(plane.rise_x, plane.rise_y) < 0.3 * slope * frame.cell) return;
  std::size_t c = 0;
  for (std::int32_t j = 0; j < frame.ny; ++j)
    for (std::int32_t i = 0; i < frame.nx; ++i, ++c)
      grid.values[c] -= static_cast<float>(plane.at(i, j));
}

/// 1 for the cells that an opening lowers by more than terrain of the given slope would be: that
/// slope times the window, at most a storey. The drop is that from the surface itself, not from the
/// opening before as in the paper: buildings that wear away step by step (at ragged rims, on
/// slopes) would never drop far at once.
std::vector<std::uint8_t> find_objects(HeightGrid surface, const Frame& frame,
                                       const GroundFilterOptions& options,
                                       const Progress& progress) {
  std::vector<std::uint8_t> object(surface.values.size(), 0);
  const std::vector<float> original = surface.values;
  const std::vector<std::int32_t> radii = window_radii(options.window, frame.cell);
  for (std::size_t k = 0; k < radii.size(); ++k) {
    progress.update(0.2 + 0.6 * static_cast<double>(k) / static_cast<double>(radii.size()));
    open_with_octagon(surface, radii[k]);
    const auto most = static_cast<float>(std::min(options.slope * radii[k] * frame.cell, kStorey));
    for (std::size_t c = 0; c < object.size(); ++c)
      if (original[c] - surface.values[c] > most) object[c] = 1;
  }
  return object;
}

/// The terrain through the cells that have points and are no objects.
Raster terrain_between(const HeightGrid& lowest, const std::vector<std::uint8_t>& object,
                       const Frame& frame, const Progress& progress) {
  Raster terrain{frame.nx,   frame.ny, frame.x0 + frame.cell / 2, frame.y0 + frame.cell / 2,
                 frame.cell, {}};
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

/// Keeps in `mask` the points that lie on the terrain; returns how many.
std::int64_t keep_near(const PointCloud& cloud, const Raster& terrain,
                       const GroundFilterOptions& options, Candidates& mask) {
  return parallel_reduce_ordered(
      cloud.size(), kPointGrain, std::int64_t{0},
      [&](std::size_t begin, std::size_t end) {
        std::int64_t kept = 0;
        for (std::size_t p = begin; p < end; ++p) {
          if (mask[p] == 0) continue;
          const Point2 position{cloud.x[p], cloud.y[p]};
          const double off = std::abs(cloud.z[p] - sample(terrain, position));
          const bool near =
              off <= options.tolerance ||
              off <= options.tolerance + options.tolerance_per_slope * slope_at(terrain, position);
          mask[p] = near ? 1 : 0;
          kept += near ? 1 : 0;
        }
        return kept;
      },
      [](std::int64_t a, std::int64_t b) { return a + b; });
}

}  // namespace

std::vector<std::uint8_t> filter_ground(const PointCloud& cloud,
                                        std::span<const Polygon> footprints,
                                        const GroundFilterOptions& options,
                                        const Progress& progress, GroundFilterReport* report) {
  assert(options.cell > 0 && options.window > 0 && options.slope > 0);
  GroundFilterReport counts;
  progress.update(0);
  Candidates mask = find_candidates(cloud, options);
  counts.candidates = std::count(mask.begin(), mask.end(), std::uint8_t{1});
  if (counts.candidates > 0) {
    const Bounds2 box = extent_of(cloud, mask);
    // With many empty cells slopes would fall to pieces.
    const double spacing = mean_spacing(cloud, mask, box);
    const double cell = std::max(options.cell, std::min(spacing, kCoarsest));
    const Frame frame = make_frame(box, cell, options.window);
    HeightGrid all = lowest_points(cloud, mask, frame);
    counts.cells = static_cast<std::int64_t>(all.values.size());
    progress.update(0.1);
    std::vector<std::uint8_t> covered(all.values.size(), 0);
    for (const Polygon& footprint : footprints) cover(footprint, frame, covered);
    HeightGrid lowest = all;
    for (std::size_t c = 0; c < covered.size(); ++c)
      if (covered[c] != 0) lowest.values[c] = kNanF;
    if (is_empty(lowest)) lowest = all;
    HeightGrid believed = lowest;
    counts.pit_cells = remove_pits(believed, std::move(all), frame.cell, spacing);
    if (!is_empty(believed)) lowest = std::move(believed);
    HeightGrid surface = lowest;
    level(surface, frame, options.slope);
    fill_low(surface, options.slope * frame.cell);
    auto object = find_objects(std::move(surface), frame, options, progress);
    keep_gentle_rises(lowest, frame, object, progress);
    drop_scraps(lowest, std::move(covered), frame, object, progress);
    const Raster terrain = terrain_between(lowest, object, frame, progress);
    counts.ground_points = keep_near(cloud, terrain, options, mask);
  }
  progress.update(1);
  if (report != nullptr) *report = counts;
  return mask;
}

}  // namespace tetropolis
