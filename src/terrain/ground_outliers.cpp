#include "ground_outliers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "tetropolis/core/buffer.h"
#include "tetropolis/core/error.h"
#include "tetropolis/core/row_major.h"

#include "core/infinity.h"
#include "core/median.h"
#include "core/parallel.h"
#include "core/ragged_builder.h"
#include "core/shared_progress.h"
#include "core/whole.h"
#include "core/wide.h"

namespace tetropolis {

namespace {

using PointNumber = std::uint32_t;

constexpr std::array<std::uint8_t, 2> kGroundClasses{2, 9};    // classes
constexpr std::array<double, 5> kCells{4, 16, 64, 256, 1024};  // metres
constexpr double kHeight = 3.0;            // metres above or below the surroundings
constexpr double kSpreads = 6.0;           // times the median deviation there
constexpr std::size_t kEnough = 9;         // points in a neighbourhood that can be judged
constexpr double kLevel = 1.0;             // metres between points that support each other
constexpr std::size_t kLonely = 3;         // squares with support, at most, where points are dense
constexpr double kMostCells = 67108864.0;  // 2^26
constexpr std::size_t kRowGrain = 8;
constexpr std::size_t kPointGrain = std::size_t{1} << 16;
constexpr int kSquares = 4;  // along one side of a cell
constexpr std::size_t kAllSquares = std::size_t{9} * kSquares * kSquares;

std::int64_t whole_number(double x) { return static_cast<std::int64_t>(whole(x)); }

/// Calls use(p) for the points of some classes.
template <typename Use>
void for_each_of(const ClassTable& classes, const PointCloud& cloud, const Use& use) {
  for (std::size_t p = 0; p < cloud.size(); ++p)
    if (classes[cloud.classification[p]]) use(static_cast<PointNumber>(p));
}

/// Coordinates as the whole numbers that they are stored as.
std::int32_t tenths(PointCoordinate coordinate) { return std::bit_cast<std::int32_t>(coordinate); }

/// Of the points of some classes.
Bounds2 box_of(const PointCloud& cloud, const ClassTable& classes) {
  std::int32_t xmin = std::numeric_limits<std::int32_t>::max(), ymin = xmin;
  std::int32_t xmax = std::numeric_limits<std::int32_t>::min(), ymax = xmax;
  for_each_of(classes, cloud, [&](PointNumber p) {
    const std::int32_t x = tenths(cloud.x[p]), y = tenths(cloud.y[p]);
    xmin = std::min(xmin, x), xmax = std::max(xmax, x);
    ymin = std::min(ymin, y), ymax = std::max(ymax, y);
  });
  const auto metres = [](std::int32_t number) { return number / PointCoordinate::kPerMetre; };
  return {metres(xmin), metres(ymin), metres(xmax), metres(ymax)};
}

/// How cells are numbered.
struct Numbering {
  double cell;  ///< Metres.
  Point2 anchor;
  std::uint32_t columns;
  std::uint32_t before;  ///< The first cell, from the anchor.
};

TETROPOLIS_WIDE void number_cells(const Numbering& numbering, std::span<const PointCoordinate> x,
                                  std::span<const PointCoordinate> y, std::uint32_t* cells) {
  const auto [cell, anchor, columns, before] = numbering;
  const auto along = [size = cell](double offset) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(whole(offset / size)));
  };
  for (std::size_t k = 0; k < x.size(); ++k)
    cells[k] = along(y[k] - anchor.y) * columns + along(x[k] - anchor.x) - before;
}

using CellOfPoint = Buffer<std::uint32_t>;

/// Square cells over a box.
class Grid {
 public:
  Grid(const Bounds2& box, double cell, const std::optional<Point2>& anchor) : cell_(cell) {
    cell_ = std::max(cell_, std::sqrt(box.width() * box.height() / kMostCells));
    cell_ = std::max(cell_, std::max(box.width(), box.height()) / kMostCells);
    anchor_ = anchor.value_or(Point2{box.xmin, box.ymin});
    first_column_ = whole_number((box.xmin - anchor_.x) / cell_);
    first_row_ = whole_number((box.ymin - anchor_.y) / cell_);
    columns_ = whole_number((box.xmax - anchor_.x) / cell_) - first_column_ + 1;
    rows_ = whole_number((box.ymax - anchor_.y) / cell_) - first_row_ + 1;
  }

  std::int64_t rows() const { return rows_; }
  std::int64_t columns() const { return columns_; }
  std::size_t size() const { return static_cast<std::size_t>(columns_ * rows_); }

  std::size_t cell(std::int64_t i, std::int64_t j) const { return row_major(i, j, columns_); }
  /// Of all points; nothing is told of those beyond the box.
  void find_cells(const PointCloud& cloud, CellOfPoint& cells) const {
    cells.resize(cloud.size());
    const auto columns = static_cast<std::uint32_t>(columns_);
    const auto before = static_cast<std::uint32_t>(first_row_ * columns_ + first_column_);
    parallel_chunks(cloud.size(), kPointGrain, [&](std::size_t begin, std::size_t end) {
      number_cells({cell_, anchor_, columns, before}, {cloud.x.data() + begin, end - begin},
                   {cloud.y.data() + begin, end - begin}, cells.data() + begin);
    });
  }

  /// Calls visit(cell) for cell (i, j) and the 8 around it.
  template <typename Visit>
  void around(std::int64_t i, std::int64_t j, const Visit& visit) const {
    for (std::int64_t nj = std::max<std::int64_t>(j - 1, 0); nj <= std::min(j + 1, rows_ - 1); ++nj)
      for (std::int64_t ni = std::max<std::int64_t>(i - 1, 0); ni <= std::min(i + 1, columns_ - 1);
           ++ni)
        visit(cell(ni, nj));
  }

  /// The square at (x, y) among the 12 x 12 around cell (i, j).
  std::size_t square(double x, double y, std::int64_t i, std::int64_t j) const {
    const auto along = [&](double offset, std::int64_t cell) {  // from the anchor
      const std::int64_t square =
          whole((offset / cell_ - static_cast<double>(cell - 1)) * kSquares);
      return std::clamp<std::int64_t>(square, 0, 3 * kSquares - 1);
    };
    return static_cast<std::size_t>(along(y - anchor_.y, j + first_row_) * 3 * kSquares +
                                    along(x - anchor_.x, i + first_column_));
  }

 private:
  double cell_;
  Point2 anchor_;
  std::int64_t first_column_ = 0;  ///< From the anchor.
  std::int64_t first_row_ = 0;
  std::int64_t columns_ = 0;
  std::int64_t rows_ = 0;
};

/// Of the points of a cell; heights in tenths of a millimetre.
struct CellHeights {
  std::int32_t low = std::numeric_limits<std::int32_t>::max();
  std::int32_t high = std::numeric_limits<std::int32_t>::min();
  std::uint32_t count = 0;
  std::uint32_t open = 0;  ///< Of them.

  void add(const CellHeights& more) {
    low = std::min(low, more.low);
    high = std::max(high, more.high);
    count += more.count;
    open += more.open;
  }
};

std::vector<CellHeights> heights_of(const Grid& grid, const CellOfPoint& cell_of,
                                    const PointCloud& cloud, const ClassTable& classes,
                                    const std::vector<std::uint8_t>& is_open) {
  std::vector<CellHeights> cells(grid.size());
  for_each_of(classes, cloud, [&](PointNumber p) {
    const std::int32_t z = tenths(cloud.z[p]);
    cells[cell_of[p]].add({z, z, 1, is_open[p]});
  });
  return cells;
}

/// What one chunk of rows found.
struct Findings {
  std::vector<PointNumber> outliers;
  std::vector<PointNumber> open;  ///< Too few neighbours to say.
};

/// What is to be done with a cell.
enum class Task : std::uint8_t {
  kNothing,
  kNext,   ///< Its neighbourhood has too few points to say: cells of the next size tell.
  kJudge,  ///< Something in its neighbourhood lies far from the rest.
};

/// Of cells that hold open points.
std::vector<Task> tasks_of(const Grid& grid, const std::vector<CellHeights>& cells, double height) {
  std::vector<Task> tasks(grid.size(), Task::kNothing);
  parallel_chunks(
      static_cast<std::size_t>(grid.rows()), kRowGrain, [&](std::size_t begin, std::size_t end) {
        for (auto j = static_cast<std::int64_t>(begin); j < static_cast<std::int64_t>(end); ++j)
          for (std::int64_t i = 0; i < grid.columns(); ++i) {
            const std::size_t own = grid.cell(i, j);
            if (cells[own].open == 0) continue;
            CellHeights near;
            grid.around(i, j, [&](std::size_t cell) { near.add(cells[cell]); });
            if (near.count < kEnough)
              tasks[own] = Task::kNext;
            else if (near.high / PointCoordinate::kPerMetre -
                         near.low / PointCoordinate::kPerMetre >
                     height)
              tasks[own] = Task::kJudge;
          }
      });
  return tasks;
}

using PointsOfCells = RaggedArray<PointNumber, std::uint32_t>;

/// The points of those cells for whose tasks they are looked at.
PointsOfCells points_for(const std::vector<Task>& tasks, const Grid& grid,
                         const CellOfPoint& cell_of, const PointCloud& cloud,
                         const ClassTable& classes) {
  std::vector<std::uint8_t> wanted(grid.size(), 0);
  bool any = false;
  for (std::int64_t j = 0; j < grid.rows(); ++j)
    for (std::int64_t i = 0; i < grid.columns(); ++i) {
      const Task task = tasks[grid.cell(i, j)];
      if (task == Task::kNothing) continue;
      any = true;
      if (task == Task::kNext) wanted[grid.cell(i, j)] = 1;
      if (task == Task::kJudge) grid.around(i, j, [&](std::size_t cell) { wanted[cell] = 1; });
    }
  return ragged_from_pairs<PointNumber, std::uint32_t>(grid.size(), [&](const auto& use) {
    if (!any) return;
    for_each_of(classes, cloud, [&](PointNumber p) {
      if (wanted[cell_of[p]] != 0) use(cell_of[p], p);
    });
  });
}

/// Judges the points of cells of one size.
class Judge {
 public:
  Judge(const PointCloud& cloud, const Grid& grid, const PointsOfCells& cells,
        const std::vector<std::uint8_t>& is_open)
      : cloud_(cloud), grid_(grid), cells_(cells), is_open_(is_open) {}

  /// Adds the outliers of cell (i, j).
  void find(std::int64_t i, std::int64_t j, std::vector<PointNumber>& outliers) {
    heights_.clear();
    for_each_near(i, j, [&](PointNumber p) { heights_.push_back(cloud_.z[p]); });
    const double middle = median(heights_);
    double most = kHeight;
    const auto is_far = [&](PointNumber p) {
      return is_open_[p] != 0 && std::abs(cloud_.z[p] - middle) > most;
    };
    const std::span<const PointNumber> own = cells_[grid_.cell(i, j)];
    if (std::none_of(own.begin(), own.end(), is_far)) return;
    for (double& z : heights_) z = std::abs(z - middle);
    most = std::max(most, kSpreads * median(heights_));
    if (std::none_of(own.begin(), own.end(), is_far)) return;
    find_alone(i, j);
    for (const PointNumber p : own)
      if (is_far(p) && is_alone(cloud_.z[p]) && !is_surpassed(cloud_.z[p], middle))
        outliers.push_back(p);
  }

 private:
  struct Neighbour {
    double z;
    std::size_t square;
  };

  /// Calls use(p) for the points of the neighbourhood of cell (i, j).
  template <typename Use>
  void for_each_near(std::int64_t i, std::int64_t j, const Use& use) const {
    grid_.around(i, j, [&](std::size_t cell) {
      for (const PointNumber p : cells_[cell]) use(p);
    });
  }

  /// For the neighbourhood of a cell: which heights are alone, and the extremes of those that are
  /// not. A window moves over the points by height, so that as many as there may be at one place
  /// (a mast that is classed as ground) cost no more than others.
  void find_alone(std::int64_t i, std::int64_t j) {
    neighbours_.clear();
    for_each_near(i, j, [&](PointNumber p) {
      neighbours_.push_back({cloud_.z[p], grid_.square(cloud_.x[p], cloud_.y[p], i, j)});
    });
    std::sort(neighbours_.begin(), neighbours_.end(),
              [](const Neighbour& a, const Neighbour& b) { return a.z < b.z; });
    const std::size_t most = neighbours_.size() >= kAllSquares ? kLonely : 1;
    alone_.assign(neighbours_.size(), 0);
    highest_crowd_ = -kInfinity;
    lowest_crowd_ = kInfinity;
    std::array<std::size_t, kAllSquares> in_square{};
    std::size_t squares = 0, first = 0, last = 0;
    for (std::size_t k = 0; k < neighbours_.size(); ++k) {
      const double z = neighbours_[k].z;
      for (; last < neighbours_.size() && neighbours_[last].z - z <= kLevel; ++last)
        if (in_square[neighbours_[last].square]++ == 0) ++squares;
      for (; z - neighbours_[first].z > kLevel; ++first)
        if (--in_square[neighbours_[first].square] == 0) --squares;
      if (squares <= most) {
        alone_[k] = 1;
        continue;
      }
      highest_crowd_ = std::max(highest_crowd_, z);
      lowest_crowd_ = std::min(lowest_crowd_, z);
    }
  }

  /// Precondition: the height is that of a point of the neighbourhood.
  bool is_alone(double z) const {
    const auto at =
        std::lower_bound(neighbours_.begin(), neighbours_.end(), z,
                         [](const Neighbour& neighbour, double y) { return neighbour.z < y; });
    return alone_[static_cast<std::size_t>(at - neighbours_.begin())] != 0;
  }

  /// Whether a point that is not alone lies even further from the middle, on the same side.
  bool is_surpassed(double z, double middle) const {
    return z > middle ? highest_crowd_ > z : lowest_crowd_ < z;
  }

  const PointCloud& cloud_;
  const Grid& grid_;
  const PointsOfCells& cells_;
  const std::vector<std::uint8_t>& is_open_;
  std::vector<double> heights_;
  std::vector<Neighbour> neighbours_;  ///< By height.
  std::vector<std::uint8_t> alone_;    ///< Per neighbour.
  double highest_crowd_ = 0;
  double lowest_crowd_ = 0;
};

}  // namespace

std::vector<std::uint32_t> find_ground_outliers(const PointCloud& cloud,
                                                std::optional<Point2> anchor,
                                                const Progress& progress) {
  if (cloud.size() > std::numeric_limits<PointNumber>::max())
    throw Error(
        ErrorKind::kInput,
        fmt::format("{} points are more than can be numbered; give smaller bounds", cloud.size()));
  const ClassTable classes = class_table(kGroundClasses);
  const Bounds2 box = box_of(cloud, classes);
  std::vector<std::uint8_t> is_open(cloud.size(), 0);
  for_each_of(classes, cloud, [&](PointNumber p) { is_open[p] = 1; });
  CellOfPoint cell_of;
  std::vector<PointNumber> outliers;
  bool is_done = box.empty();
  for (std::size_t level = 0; level < kCells.size() && !is_done; ++level) {
    constexpr auto kLevels = static_cast<double>(kCells.size());
    const auto number = static_cast<double>(level);
    const Progress at_level = portion(progress, number / kLevels, (number + 1) / kLevels);
    at_level.update(0);
    const Grid grid(box, kCells[level], anchor);
    grid.find_cells(cloud, cell_of);
    const std::vector<Task> tasks =
        tasks_of(grid, heights_of(grid, cell_of, cloud, classes, is_open), kHeight);
    const PointsOfCells cells = points_for(tasks, grid, cell_of, cloud, classes);
    const auto rows = static_cast<std::size_t>(grid.rows());
    std::vector<Findings> chunks((rows + kRowGrain - 1) / kRowGrain);
    SharedProgress shared(at_level, grid.rows());
    parallel_chunks(rows, kRowGrain, [&](std::size_t begin, std::size_t end) {
      Judge judge(cloud, grid, cells, is_open);
      Findings& found = chunks[begin / kRowGrain];
      for (auto j = static_cast<std::int64_t>(begin); j < static_cast<std::int64_t>(end); ++j)
        for (std::int64_t i = 0; i < grid.columns(); ++i) {
          const std::size_t own = grid.cell(i, j);
          if (tasks[own] == Task::kJudge) judge.find(i, j, found.outliers);
          if (tasks[own] != Task::kNext) continue;
          for (const PointNumber p : cells[own])
            if (is_open[p] != 0) found.open.push_back(p);
        }
      shared.add(static_cast<std::int64_t>(end - begin));
    });
    std::fill(is_open.begin(), is_open.end(), std::uint8_t{0});
    is_done = true;
    for (const Findings& found : chunks) {
      outliers.insert(outliers.end(), found.outliers.begin(), found.outliers.end());
      for (const PointNumber p : found.open) is_open[p] = 1;
      is_done = is_done && found.open.empty();
    }
  }
  std::sort(outliers.begin(), outliers.end());
  progress.update(1);
  return outliers;
}

}  // namespace tetropolis
