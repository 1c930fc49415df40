#include "tetropolis/terrain/dtm.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tetropolis/core/error.h"

#include "core/parallel.h"
#include "core/whole.h"
#include "core/wide.h"

namespace tetropolis {

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kMaxNodes = 2147483647.0;
constexpr double kVoid = 20;  // metres

/// "class 1 (200 points), class 6 (10 points)", or "no points".
std::string describe_classes(const PointCloud& cloud) {
  std::array<std::int64_t, 256> counts{};
  for (const std::uint8_t code : cloud.classification) ++counts[code];
  std::vector<std::string> parts;
  for (std::size_t code = 0; code < counts.size(); ++code)
    if (counts[code] > 0) parts.push_back(fmt::format("class {} ({} points)", code, counts[code]));
  return parts.empty() ? "no points" : fmt::format("{}", fmt::join(parts, ", "));
}

/// Nodes along one axis: at anchor + (first + i) * step for i in [0, count), all whole numbers.
/// What is nearest is told from the anchor, so that grids of one anchor agree to the last bit.
struct Axis {
  double anchor;
  double step;
  double first;
  double count;

  double start() const { return anchor + first * step; }

  /// Index of the node nearest to a coordinate; ties go up. Below 0 or from `count` on if there is
  /// no such node.
  double nearest(double x) const { return whole((x - anchor) / step + 0.5) - first; }
};

struct Axes {
  Axis x;
  Axis y;
};

/// Just enough nodes to cover the domain.
Axes axes_over(const Bounds2& domain, double step, const std::optional<Point2>& given) {
  const Point2 anchor = given.value_or(Point2{domain.xmin, domain.ymin});
  const auto cover = [&](double from, double low, double high) {
    constexpr double kRounding = 1e-9;  // steps
    const double first = std::floor((low - from) / step + kRounding);
    const double last = std::ceil((high - from) / step - kRounding);
    return Axis{from, step, first, std::max(last - first + 1, 1.0)};
  };
  return {cover(anchor.x, domain.xmin, domain.xmax), cover(anchor.y, domain.ymin, domain.ymax)};
}

/// The nodes nearest to points; -1 where there is none.
TETROPOLIS_WIDE void find_nodes(const Axes& given, std::span<const PointCoordinate> x,
                                std::span<const PointCoordinate> y, std::int32_t* nodes) {
  const Axes axes = given;  // a copy, which is not written through `nodes`
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double i = axes.x.nearest(x[k]), j = axes.y.nearest(y[k]);
    // One choice after the other, for the loop to be vectorised.
    double node = j * axes.x.count + i;
    node = i >= 0 ? node : -1.0;
    node = i < axes.x.count ? node : -1.0;
    node = j >= 0 ? node : -1.0;
    node = j < axes.y.count ? node : -1.0;
    nodes[k] = static_cast<std::int32_t>(node);
  }
}

/// Adds heights and counts of the ground points to the nodes and returns how many there were. One
/// thread: the sums then have one order, and this takes a fraction of the time of reading the
/// points. (Points first shared out to bands of rows, and those binned by two threads in the same
/// order, took as long for 10 million in flight order, and twice as long in random order.)
std::int64_t bin_points(const PointCloud& cloud, const std::array<bool, 256>& is_ground,
                        const Axes& axes, Raster& sums, std::vector<std::uint32_t>& counts,
                        const Progress& progress) {
  constexpr std::size_t kPointsPerPoll = std::size_t{1} << 20;
  constexpr std::size_t kBlock = 1024, kAhead = 16;
  std::array<std::int32_t, kBlock + kAhead> nodes{};
  std::int64_t binned = 0;
  for (std::size_t begin = 0; begin < cloud.size(); begin += kBlock) {
    if (begin % kPointsPerPoll == 0)
      progress.update(static_cast<double>(begin) / static_cast<double>(cloud.size()));
    const std::size_t size = std::min(kBlock, cloud.size() - begin);
    find_nodes(axes, {cloud.x.data() + begin, size}, {cloud.y.data() + begin, size}, nodes.data());
    for (std::size_t k = 0; k < size; ++k) {
      // Memory is what this waits for.
      const auto ahead = static_cast<std::size_t>(std::max(nodes[k + kAhead], 0));
      __builtin_prefetch(&sums.values[ahead], 1);
      __builtin_prefetch(&counts[ahead], 1);
      if (nodes[k] < 0 || !is_ground[cloud.classification[begin + k]]) continue;
      const auto node = static_cast<std::size_t>(nodes[k]);
      sums.values[node] += cloud.z[begin + k];
      ++counts[node];
      ++binned;
    }
  }
  return binned;
}

/// Sum and number of the filled ones among the 8 neighbours of a node.
struct Neighbours {
  double sum;
  int count;
};

/// Opposite neighbours are added first, so that mirroring the raster changes no bit of the sum.
Neighbours filled_neighbours(const Raster& raster, std::int32_t i, std::int32_t j) {
  const bool west = i > 0;
  const bool east = i + 1 < raster.nx;
  const bool south = j > 0;
  const bool north = j + 1 < raster.ny;
  const std::ptrdiff_t row = raster.nx;
  const double* node = raster.values.data() + (j * row + i);
  int count = 0;
  const bool inside = west && east && south && north;
  const auto value = [&](bool exists, std::ptrdiff_t offset) {
    if (!inside && !exists) return 0.0;
    // Without a branch: which nodes are filled is not to be guessed.
    const bool is_filled = !std::isnan(node[offset]);
    count += is_filled ? 1 : 0;
    return is_filled ? node[offset] : 0.0;
  };
  const double horizontal = value(west, -1) + value(east, 1);
  const double vertical = value(south, -row) + value(north, row);
  const double rising = value(south && west, -row - 1) + value(north && east, row + 1);
  const double falling = value(north && west, row - 1) + value(south && east, -row + 1);
  return {(horizontal + vertical) + (rising + falling), count};
}

/// Empty nodes next to filled ones, in rows, with the means of these; and those next to none.
struct Front {
  std::vector<std::int32_t> nodes;
  std::vector<double> heights;
  std::vector<std::int32_t> others;

  void reserve(std::ptrdiff_t size) {  // what is not used takes up no memory
    nodes.reserve(static_cast<std::size_t>(size));
    heights.reserve(static_cast<std::size_t>(size));
  }
  void add(const Raster& raster, std::int32_t node) {
    const Neighbours around = filled_neighbours(raster, node % raster.nx, node / raster.nx);
    if (around.count == 0) {
      others.push_back(node);
      return;
    }
    nodes.push_back(node);
    heights.push_back(around.sum / around.count);
  }
  void fill(Raster& raster) const {
    for (std::size_t k = 0; k < nodes.size(); ++k)
      raster.values[static_cast<std::size_t>(nodes[k])] = heights[k];
  }
};

/// The empty nodes next to the front just filled, each once.
std::vector<std::int32_t> next_front(const Raster& raster, const std::vector<std::int32_t>& front,
                                     std::vector<bool>& queued) {
  std::vector<std::int32_t> next;
  for (const std::int32_t node : front) {
    const std::int32_t i = node % raster.nx;
    const std::int32_t j = node / raster.nx;
    for (std::int32_t nj = std::max(j - 1, 0); nj <= std::min(j + 1, raster.ny - 1); ++nj) {
      for (std::int32_t ni = std::max(i - 1, 0); ni <= std::min(i + 1, raster.nx - 1); ++ni) {
        const std::int32_t neighbour = nj * raster.nx + ni;
        if (queued[static_cast<std::size_t>(neighbour)] || !std::isnan(raster.at(ni, nj))) continue;
        queued[static_cast<std::size_t>(neighbour)] = true;
        next.push_back(neighbour);
      }
    }
  }
  return next;
}

/// Share of the squares of kVoid that have no value at all.
struct Voids {
  std::int64_t voids = 0;
  std::int64_t squares = 0;
};

Voids count_voids(const Raster& raster) {
  const auto side = std::max<std::int32_t>(1, static_cast<std::int32_t>(kVoid / raster.step));
  // What is left of a row beyond whole squares belongs to the last, or is one if it is half as
  // wide: the nodes on the domain's far side are no squares of their own.
  const auto begins = [&](std::int32_t nodes) {
    const std::int32_t count = std::max((nodes - 1 + side / 2) / side, 1);
    std::vector<std::int32_t> result;
    for (std::int32_t k = 0; k < count; ++k) result.push_back(k * side);
    result.push_back(nodes);
    return result;
  };
  const std::vector<std::int32_t> columns = begins(raster.nx), rows = begins(raster.ny);
  Voids result;
  for (std::size_t r = 0; r + 1 < rows.size(); ++r) {
    for (std::size_t c = 0; c + 1 < columns.size(); ++c) {
      bool is_void = true;
      for (std::int32_t j = rows[r]; is_void && j < rows[r + 1]; ++j)
        for (std::int32_t i = columns[c]; is_void && i < columns[c + 1]; ++i)
          is_void = std::isnan(raster.at(i, j));
      ++result.squares;
      result.voids += is_void ? 1 : 0;
    }
  }
  return result;
}

}  // namespace

Raster dtm_grid(const Bounds2& domain, double step, const std::optional<Point2>& anchor) {
  const auto [x, y] = axes_over(domain, step, anchor);
  if (!(step > 0) || domain.empty() || !std::isfinite(x.count * y.count))
    throw Error(ErrorKind::kUsage,
                fmt::format("no DTM of the domain {},{},{},{} with step {}: choose bounds with "
                            "xmin <= xmax and ymin <= ymax and a positive step",
                            domain.xmin, domain.ymin, domain.xmax, domain.ymax, step));
  if (x.count * y.count > kMaxNodes)
    throw Error(ErrorKind::kUsage,
                fmt::format("a DTM of {} x {} nodes is too large: choose a step above {} m or a "
                            "smaller domain",
                            x.count, y.count, step));
  Raster raster;
  raster.nx = static_cast<std::int32_t>(x.count);
  raster.ny = static_cast<std::int32_t>(y.count);
  raster.x0 = x.start();
  raster.y0 = y.start();
  raster.step = step;
  raster.values.assign(static_cast<std::size_t>(raster.nx) * static_cast<std::size_t>(raster.ny),
                       0);
  return raster;
}

Raster build_dtm(const PointCloud& cloud, const Bounds2& domain, const DtmOptions& options,
                 const Progress& progress, DtmReport* report) {
  Raster raster = dtm_grid(domain, options.step, options.anchor);
  const std::size_t nodes = raster.values.size();
  progress.update(0);
  std::int64_t ground_points = 0;
  std::int64_t empty = 0;
  {
    std::vector<std::uint32_t> counts(nodes, 0);
    ground_points = bin_points(cloud, class_table(options.classes),
                               axes_over(domain, options.step, options.anchor), raster, counts,
                               portion(progress, 0, 0.4));
    if (ground_points == 0)
      throw Error(ErrorKind::kInput,
                  fmt::format("the point cloud has no ground points (class {}) in the domain; all "
                              "in all it has {}: "
                              "name the classes that are ground, or classify the cloud first",
                              fmt::join(options.classes, ", "), describe_classes(cloud)));
    for (std::size_t node = 0; node < nodes; ++node) {
      empty += counts[node] == 0 ? 1 : 0;
      const double mean = raster.values[node] / counts[node];
      raster.values[node] = counts[node] == 0 ? kNan : mean;
    }
  }
  const Voids voids = count_voids(raster);
  progress.update(0.5);
  fill_empty_nodes(raster, portion(progress, 0.5, 1));
  if (report != nullptr)
    *report = {ground_points, static_cast<std::int64_t>(nodes),
               static_cast<double>(empty) / static_cast<double>(nodes), voids.voids,
               static_cast<double>(voids.voids) / static_cast<double>(voids.squares)};
  return raster;
}

void fill_empty_nodes(Raster& raster, const Progress& progress) {
  progress.update(0);
  constexpr std::size_t kRowGrain = 32;
  const auto nx = static_cast<std::size_t>(raster.nx), rows = static_cast<std::size_t>(raster.ny);
  std::vector<Front> chunks((rows + kRowGrain - 1) / kRowGrain);
  parallel_chunks(rows, kRowGrain, [&](std::size_t begin, std::size_t end) {
    Front& front = chunks[begin / kRowGrain];
    const double* const values = raster.values.data();
    front.reserve(std::count_if(values + begin * nx, values + end * nx,
                                [](double z) { return std::isnan(z); }));
    for (std::size_t node = begin * nx; node < end * nx; ++node)
      if (std::isnan(values[node])) front.add(raster, static_cast<std::int32_t>(node));
  });
  std::vector<std::int32_t> open;
  for (Front& chunk : chunks) {
    chunk.fill(raster);
    open.insert(open.end(), chunk.others.begin(), chunk.others.end());
    chunk = {};
  }
  Front front;
  for (const std::int32_t node : open) front.add(raster, node);
  std::vector<bool> queued(open.empty() ? 0 : raster.values.size(), false);
  std::size_t filled = 0;
  while (!front.nodes.empty()) {
    progress.update(static_cast<double>(filled) / static_cast<double>(open.size()));
    front.fill(raster);
    filled += front.nodes.size();
    const std::vector<std::int32_t> next = next_front(raster, front.nodes, queued);
    front = {};
    for (const std::int32_t node : next) front.add(raster, node);
  }
  assert(filled == open.size() && "a raster without any height cannot be filled");
  progress.update(1);
}

}  // namespace tetropolis
