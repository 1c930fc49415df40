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

#include "opening.h"

namespace tetropolis {

namespace {

constexpr double kMostCells = 134217728.0;  // 2^27
constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kPointGrain = std::size_t{1} << 15;
constexpr std::size_t kRowGrain = 32;

/// A lowest point is believed if this many cells, itself among them, hold one at most kPitRise
/// higher within kPitReach.
constexpr int kPitSupport = 4;
constexpr double kPitRise = 1.0;
constexpr double kPitReach = 10.0;

constexpr double kStorey = 3.0;

/// Metres: cells are not made wider than this for sparse clouds.
constexpr double kCoarsest = 4.0;

/// Cells over the candidates and a margin around them.
struct Frame {
  double x0 = 0;
  double y0 = 0;
  double cell = 1;
  std::int32_t nx = 0;
  std::int32_t ny = 0;

  std::size_t at(double x, double y) const {
    const auto i = static_cast<std::int32_t>(std::clamp((x - x0) / cell, 0.0, nx - 1.0));
    const auto j = static_cast<std::int32_t>(std::clamp((y - y0) / cell, 0.0, ny - 1.0));
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
  }
};

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

/// Empties the cells whose centres lie in a footprint, by the even-odd rule along each row; broken
/// rings do no harm.
void empty_inside(const Polygon& footprint, const Frame& frame, HeightGrid& grid) {
  const auto first_centre = [&](double position, double start, std::int32_t cells) {
    return static_cast<std::int32_t>(std::clamp(std::ceil((position - start) / frame.cell - 0.5),
                                                0.0, static_cast<double>(cells)));
  };
  struct Crossing {
    std::int32_t row;
    double x;
  };
  std::vector<Crossing> crossings;
  for_each_edge(footprint, [&](Point2 a, Point2 b) {
    if (!std::isfinite(a.x + a.y + b.x + b.y)) return;
    // One row more to either side than the edge spans, against rounding.
    const auto [low, high] = std::minmax({a.y, b.y});
    const std::int32_t begin = std::max(first_centre(low, frame.y0, grid.ny) - 1, 0);
    const std::int32_t end = std::min(first_centre(high, frame.y0, grid.ny) + 1, grid.ny);
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
    float* row = grid.values.data() + grid.index(0, crossings[k].row);
    std::fill(row + first_centre(crossings[k].x, frame.x0, grid.nx),
              row + first_centre(crossings[k + 1].x, frame.x0, grid.nx), kNanF);
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

/// Empties the cells whose lowest point is a pit; returns how many.
std::int64_t remove_pits(HeightGrid& grid, double cell) {
  const auto reach = static_cast<std::int32_t>(std::max(std::ceil(kPitReach / cell), 2.0));
  std::vector<std::uint8_t> pit(grid.values.size(), 0);
  parallel_chunks(
      static_cast<std::size_t>(grid.ny), kRowGrain, [&](std::size_t begin, std::size_t end) {
        for (auto j = static_cast<std::int32_t>(begin); j < static_cast<std::int32_t>(end); ++j)
          for (std::int32_t i = 0; i < grid.nx; ++i) {
            const std::size_t c = grid.index(i, j);
            if (!std::isnan(grid.values[c]) && !is_supported(grid, i, j, reach)) pit[c] = 1;
          }
      });
  std::int64_t pits = 0;
  for (std::size_t c = 0; c < pit.size(); ++c) {
    if (pit[c] == 0) continue;
    grid.values[c] = kNanF;
    ++pits;
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

/// Least squares: height = rise_x * i + rise_y * j + height at cell (0, 0), over the cells (i, j)
/// that have a value and, from the second round on, lie below the plane before, as ground does.
struct Plane {
  double rise_x = 0;
  double rise_y = 0;
  double height = 0;

  double at(std::int32_t i, std::int32_t j) const { return rise_x * i + rise_y * j + height; }
};

/// Sums for the plane of least squares through points (x, y, z).
class PlaneFit {
 public:
  void add(double x, double y, double z) {
    n_ += 1, x_ += x, y_ += y, z_ += z;
    xx_ += x * x, xy_ += x * y, yy_ += y * y, xz_ += x * z, yz_ += y * z;
  }
  /// False, and nothing is changed, where there are too few points or they lie on one line.
  bool solve(Plane& plane) const {
    if (n_ < 3) return false;
    const double xx = xx_ - x_ * x_ / n_, xy = xy_ - x_ * y_ / n_, yy = yy_ - y_ * y_ / n_;
    const double xz = xz_ - x_ * z_ / n_, yz = yz_ - y_ * z_ / n_;
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 1e-9 * xx * yy)) return false;
    plane.rise_x = (xz * yy - yz * xy) / determinant;
    plane.rise_y = (yz * xx - xz * xy) / determinant;
    plane.height = (z_ - plane.rise_x * x_ - plane.rise_y * y_) / n_;
    return true;
  }

 private:
  double n_ = 0, x_ = 0, y_ = 0, z_ = 0;
  double xx_ = 0, xy_ = 0, yy_ = 0, xz_ = 0, yz_ = 0;
};

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

/// Calls use(n) for the cells n that share a side with cell c.
template <typename Use>
void for_each_neighbour(const Frame& frame, std::size_t c, const Use& use) {
  const auto columns = static_cast<std::size_t>(frame.nx);
  const std::size_t i = c % columns;
  if (i > 0) use(c - 1);
  if (i + 1 < columns) use(c + 1);
  if (c >= columns) use(c - columns);
  if (c + columns < columns * static_cast<std::size_t>(frame.ny)) use(c + columns);
}

/// 1 for the cells with their centres in a footprint.
std::vector<std::uint8_t> covered_cells(std::span<const Polygon> footprints, const Frame& frame) {
  HeightGrid open{frame.nx, frame.ny, {}};
  open.values.assign(static_cast<std::size_t>(frame.nx) * static_cast<std::size_t>(frame.ny), 0);
  for (const Polygon& footprint : footprints) empty_inside(footprint, frame, open);
  std::vector<std::uint8_t> covered(open.values.size());
  for (std::size_t c = 0; c < covered.size(); ++c) covered[c] = std::isnan(open.values[c]) ? 1 : 0;
  return covered;
}

/// Gives cells without a point the height of the nearest with one, by steps through such cells.
void spread(HeightGrid& grid, const std::vector<std::uint8_t>& barred, const Frame& frame) {
  std::vector<std::uint32_t> queue;
  for (std::size_t c = 0; c < barred.size(); ++c)
    if (barred[c] == 0 && !std::isnan(grid.values[c]))
      queue.push_back(static_cast<std::uint32_t>(c));
  for (std::size_t k = 0; k < queue.size(); ++k)
    for_each_neighbour(frame, queue[k], [&](std::size_t n) {
      if (barred[n] != 0 || !std::isnan(grid.values[n])) return;
      grid.values[n] = grid.values[queue[k]];
      queue.push_back(static_cast<std::uint32_t>(n));
    });
}

/// The greatest step from a cell to the next that a slope has; about half a storey, however coarse
/// the cells.
double greatest_step(const Frame& frame) {
  constexpr double kSteepest = 1.25, kRoughness = 0.3;  // rise over run; metres
  return std::min(kSteepest * frame.cell + kRoughness, 0.55 * kStorey);
}

constexpr double kLeastArea = 50;  // square metres that are more than a scrap
constexpr std::size_t kCellsPerPoll = std::size_t{1} << 20;

/// Takes back from the objects what rises gradually: a bank, dyke or hilltop that is narrower than
/// the window, or steeper than the slope. An object ends in walls (Sithole & Vosselman, "Filtering
/// of airborne laser scanner data based on segmented point clouds", ISPRS Archives 36(3/W19), 2005,
/// tell the two apart by the rims of segments). Segments are object cells joined by steps that a
/// slope has; of the steps from a segment down, at most one in ten may be one that only a wall has,
/// and it has to rise by more than two of the others within: a hedge or a terrace does not.
void keep_gentle_rises(const HeightGrid& lowest, const Frame& frame,
                       std::vector<std::uint8_t>& object, const Progress& progress) {
  constexpr std::int64_t kStepsPerWall = 9;
  constexpr double kStepsWithin = 2;
  constexpr std::uint8_t kSeen = 1, kKept = 2;
  const auto most = static_cast<float>(greatest_step(frame));
  const std::size_t cells = object.size();
  std::vector<std::uint8_t> state(cells, 0);
  std::vector<std::uint32_t> segment;  // cells; fewer than 2^32 by kMostCells
  for (std::size_t seed = 0; seed < cells; ++seed) {
    if (seed % kCellsPerPoll == 0) progress.update(0.8);
    if (object[seed] == 0 || state[seed] != 0 || std::isnan(lowest.values[seed])) continue;
    segment.assign(1, static_cast<std::uint32_t>(seed));
    state[seed] = kSeen;
    std::int64_t walls = 0, steps = 0;
    double down = 0;  // by steps
    float low = lowest.values[seed], high = low;
    for (std::size_t k = 0; k < segment.size(); ++k) {
      const std::size_t c = segment[k];
      low = std::min(low, lowest.values[c]);
      high = std::max(high, lowest.values[c]);
      for_each_neighbour(frame, c, [&](std::size_t n) {
        const float drop = lowest.values[c] - lowest.values[n];
        if (std::isnan(drop)) return;
        if (drop > most) {
          ++walls;
        } else if (object[n] == 0) {
          if (drop < 0) return;
          ++steps;
          down += static_cast<double>(drop);
        } else if (-drop <= most && state[n] == 0) {
          state[n] = kSeen;
          segment.push_back(static_cast<std::uint32_t>(n));
        }
      });
    }
    const double area = static_cast<double>(segment.size()) * frame.cell * frame.cell;
    const double rise = static_cast<double>(high - low);
    if (area >= kLeastArea && steps > kStepsPerWall * walls &&
        rise * static_cast<double>(steps) > kStepsWithin * down)
      for (const std::uint32_t c : segment) state[c] = kKept;
  }
  for (std::size_t c = 0; c < cells; ++c)
    if (state[c] == kKept) object[c] = 0;
}

/// At least `most` cells with ground (all within `reach`, if these are fewer), the nearest to the
/// segment by steps through anything. `seen` has one entry per cell, of which none is `stamp`.
std::vector<std::uint32_t> ground_around(const HeightGrid& lowest,
                                         const std::vector<std::uint8_t>& object,
                                         const Frame& frame,
                                         const std::vector<std::uint32_t>& segment,
                                         std::size_t most, double reach, std::uint32_t stamp,
                                         std::vector<std::uint32_t>& seen) {
  std::vector<std::uint32_t> ground, front = segment, next;
  for (const std::uint32_t c : segment) seen[c] = stamp;
  const auto steps = static_cast<int>(std::ceil(reach / frame.cell));
  for (int step = 0; step < steps && ground.size() < most; ++step) {
    next.clear();
    for (const std::uint32_t c : front)
      for_each_neighbour(frame, c, [&](std::size_t n) {
        if (seen[n] == stamp) return;
        seen[n] = stamp;
        next.push_back(static_cast<std::uint32_t>(n));
        if (object[n] == 0 && !std::isnan(lowest.values[n]))
          ground.push_back(static_cast<std::uint32_t>(n));
      });
    front.swap(next);
  }
  return ground;
}

/// How far the share of `cells` is at most above the plane through `ground`, which slopes as the
/// terrain does; a level one where it rises by less than `least_rise` a cell.
double quantile_above(const std::vector<std::uint32_t>& cells,
                      const std::vector<std::uint32_t>& ground, const HeightGrid& lowest,
                      double share, double least_rise) {
  const auto nx = static_cast<std::uint32_t>(lowest.nx);
  const std::uint32_t first = ground.front();
  const auto x = [&](std::uint32_t c) {
    return static_cast<double>(c % nx) - static_cast<double>(first % nx);
  };
  const auto y = [&](std::uint32_t c) {
    return static_cast<double>(c / nx) - static_cast<double>(first / nx);
  };
  const auto z = [&](std::uint32_t c) { return static_cast<double>(lowest.values[c]); };
  PlaneFit fit;
  for (const std::uint32_t c : ground) fit.add(x(c), y(c), z(c));
  Plane plane{0, 0, z(first)};
  // What is less is chance.
  if (fit.solve(plane) && std::hypot(plane.rise_x, plane.rise_y) < least_rise)
    plane = {0, 0, z(first)};
  std::vector<double> above;
  for (const std::uint32_t c : cells)
    if (!std::isnan(lowest.values[c]))
      above.push_back(z(c) - plane.height - plane.rise_x * x(c) - plane.rise_y * y(c));
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(above.size()));
  std::nth_element(above.begin(), above.begin() + rank, above.end());
  return above[static_cast<std::size_t>(rank)];
}

/// Makes objects of scraps: what openings left of podiums and halls that are in no footprint but
/// between them, where the voids of the footprints hold them up. A scrap is cells joined by steps
/// that a slope has, cut off by objects, footprints and walls, and a metre above most of the ground
/// nearby, after that ground's slope. All are judged before any goes.
void drop_scraps(const HeightGrid& lowest, std::vector<std::uint8_t> barred, const Frame& frame,
                 std::vector<std::uint8_t>& object, const Progress& progress) {
  constexpr double kRaised = 1, kReach = 30;  // metres
  constexpr double kLeastSlope = 0.08;
  constexpr double kLow = 0.1, kMostGround = 0.75;
  constexpr std::size_t kNearest = 200, kTooFew = 30;  // cells
  const auto most = static_cast<float>(greatest_step(frame));
  const double largest = kLeastArea / (frame.cell * frame.cell);
  const double least_rise = kLeastSlope * frame.cell;
  for (std::size_t c = 0; c < barred.size(); ++c) barred[c] |= object[c];
  HeightGrid full = lowest;
  spread(full, barred, frame);
  std::vector<std::uint32_t> seen(object.size(), 0), segment;
  std::vector<std::uint32_t> scraps;
  std::uint32_t stamp = 0;
  for (std::size_t seed = 0; seed < object.size(); ++seed) {
    if (seed % kCellsPerPoll == 0) progress.update(0.8);
    if (barred[seed] != 0) continue;
    segment.assign(1, static_cast<std::uint32_t>(seed));
    barred[seed] = 1;
    std::size_t known = 0;
    for (std::size_t k = 0; k < segment.size(); ++k) {
      const std::size_t c = segment[k];
      if (!std::isnan(lowest.values[c])) ++known;
      for_each_neighbour(frame, c, [&](std::size_t n) {
        if (barred[n] != 0 || std::abs(full.values[c] - full.values[n]) > most) return;
        barred[n] = 1;
        segment.push_back(static_cast<std::uint32_t>(n));
      });
    }
    if (known == 0 || static_cast<double>(known) > largest) continue;
    const std::vector<std::uint32_t> around =
        ground_around(lowest, object, frame, segment, kNearest, kReach, ++stamp, seen);
    if (around.size() < kTooFew ||
        quantile_above(segment, around, lowest, kLow, least_rise) <
            quantile_above(around, around, lowest, kMostGround, least_rise) + kRaised)
      continue;
    scraps.insert(scraps.end(), segment.begin(), segment.end());
  }
  for (const std::uint32_t c : scraps) object[c] = 1;
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
    const double cell = std::max(options.cell, std::min(mean_spacing(cloud, mask, box), kCoarsest));
    const Frame frame = make_frame(box, cell, options.window);
    const HeightGrid all = lowest_points(cloud, mask, frame);
    counts.cells = static_cast<std::int64_t>(all.values.size());
    progress.update(0.1);
    HeightGrid lowest = all;
    for (const Polygon& footprint : footprints) empty_inside(footprint, frame, lowest);
    if (is_empty(lowest)) lowest = all;
    HeightGrid believed = lowest;
    counts.pit_cells = remove_pits(believed, frame.cell);
    if (!is_empty(believed)) lowest = std::move(believed);
    HeightGrid surface = lowest;
    level(surface, frame, options.slope);
    fill_low(surface, options.slope * frame.cell);
    auto object = find_objects(std::move(surface), frame, options, progress);
    keep_gentle_rises(lowest, frame, object, progress);
    drop_scraps(lowest, covered_cells(footprints, frame), frame, object, progress);
    const Raster terrain = terrain_between(lowest, object, frame, progress);
    counts.ground_points = keep_near(cloud, terrain, options, mask);
  }
  progress.update(1);
  if (report != nullptr) *report = counts;
  return mask;
}

}  // namespace tetropolis
