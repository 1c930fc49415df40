#include "ground_outliers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/row_major.h"

#include "core/infinity.h"
#include "core/median.h"
#include "core/parallel.h"
#include "core/ragged_builder.h"
#include "core/shared_progress.h"

namespace tetropolis {

namespace {

using PointNumber = std::uint32_t;

constexpr std::array<double, 5> kCells{4, 16, 64, 256, 1024};  // metres
constexpr std::size_t kEnough = 9;         // points in a neighbourhood that can be judged
constexpr double kLevel = 1.0;             // metres between points that support each other
constexpr std::size_t kLonely = 3;         // squares with support, at most, where points are dense
constexpr double kMostCells = 67108864.0;  // 2^26
constexpr std::size_t kRowGrain = 8;
constexpr int kSquares = 4;  // along one side of a cell
constexpr std::size_t kAllSquares = std::size_t{9} * kSquares * kSquares;

std::vector<PointNumber> ground_points(const PointCloud& cloud,
                                       const std::vector<std::uint8_t>& classes) {
  if (cloud.size() > std::numeric_limits<PointNumber>::max())
    throw Error(
        ErrorKind::kInput,
        fmt::format("{} points are more than can be numbered; give smaller bounds", cloud.size()));
  const ClassTable wanted = class_table(classes);
  std::vector<PointNumber> points;
  for (std::size_t p = 0; p < cloud.size(); ++p)
    if (wanted[cloud.classification[p]]) points.push_back(static_cast<PointNumber>(p));
  return points;
}

/// Ground points sorted into square cells.
class Cells {
 public:
  Cells(const PointCloud& cloud, std::span<const PointNumber> points, double cell,
        const std::optional<Point2>& anchor)
      : cloud_(cloud), cell_(cell) {
    Bounds2 box = Bounds2::nothing();
    for (const PointNumber p : points) box.extend(Point2{cloud.x[p], cloud.y[p]});
    cell_ = std::max(cell_, std::sqrt(box.width() * box.height() / kMostCells));
    cell_ = std::max(cell_, std::max(box.width(), box.height()) / kMostCells);
    anchor_ = anchor.value_or(Point2{box.xmin, box.ymin});
    first_column_ = whole_cells(box.xmin - anchor_.x);
    first_row_ = whole_cells(box.ymin - anchor_.y);
    columns_ = whole_cells(box.xmax - anchor_.x) - first_column_ + 1;
    rows_ = whole_cells(box.ymax - anchor_.y) - first_row_ + 1;
    cells_ = ragged_from_pairs<PointNumber, std::uint32_t>(
        static_cast<std::size_t>(columns_ * rows_), [&](const auto& use) {
          for (const PointNumber p : points) use(cell_of(p), p);
        });
  }

  std::int64_t rows() const { return rows_; }
  std::int64_t columns() const { return columns_; }

  std::span<const PointNumber> at(std::int64_t i, std::int64_t j) const {
    return cells_[row_major(i, j, columns_)];
  }

  /// Calls visit(points) for the cell and the 8 around it.
  template <typename Visit>
  void around(std::int64_t i, std::int64_t j, const Visit& visit) const {
    for (std::int64_t nj = std::max<std::int64_t>(j - 1, 0); nj <= std::min(j + 1, rows_ - 1); ++nj)
      for (std::int64_t ni = std::max<std::int64_t>(i - 1, 0); ni <= std::min(i + 1, columns_ - 1);
           ++ni)
        visit(at(ni, nj));
  }

  /// The square of point `p` among the 12 x 12 around cell (i, j).
  std::size_t square(PointNumber p, std::int64_t i, std::int64_t j) const {
    const auto along = [&](double offset, std::int64_t cell) {  // from the anchor
      const auto square = static_cast<std::int64_t>(
          std::floor((offset / cell_ - static_cast<double>(cell - 1)) * kSquares));
      return std::clamp<std::int64_t>(square, 0, 3 * kSquares - 1);
    };
    return static_cast<std::size_t>(along(cloud_.y[p] - anchor_.y, j + first_row_) * 3 * kSquares +
                                    along(cloud_.x[p] - anchor_.x, i + first_column_));
  }

 private:
  std::int64_t whole_cells(double length) const {
    return static_cast<std::int64_t>(std::floor(length / cell_));
  }
  std::size_t cell_of(PointNumber p) const {
    const std::int64_t i = whole_cells(cloud_.x[p] - anchor_.x) - first_column_;
    const std::int64_t j = whole_cells(cloud_.y[p] - anchor_.y) - first_row_;
    return row_major(i, j, columns_);
  }

  const PointCloud& cloud_;
  double cell_;
  Point2 anchor_;
  std::int64_t first_column_ = 0;  ///< From the anchor.
  std::int64_t first_row_ = 0;
  std::int64_t columns_ = 0;
  std::int64_t rows_ = 0;
  RaggedArray<PointNumber, std::uint32_t> cells_;
};

/// What one chunk of rows found.
struct Findings {
  std::vector<PointNumber> outliers;
  std::vector<PointNumber> open;  ///< Too few neighbours to say.
};

/// Judges cells of one size.
class Judge {
 public:
  Judge(const PointCloud& cloud, const Cells& cells, const GroundOutlierOptions& options,
        const std::vector<std::uint8_t>& is_open)
      : cloud_(cloud), cells_(cells), options_(options), is_open_(is_open) {}

  void cell(std::int64_t i, std::int64_t j, Findings& findings) {
    const std::span<const PointNumber> own = cells_.at(i, j);
    if (std::none_of(own.begin(), own.end(), [&](PointNumber p) { return is_open_[p] != 0; }))
      return;
    double low = kInfinity, high = -low;
    std::size_t count = 0;
    cells_.around(i, j, [&](std::span<const PointNumber> points) {
      count += points.size();
      for (const PointNumber p : points) {
        low = std::min<double>(low, cloud_.z[p]);
        high = std::max<double>(high, cloud_.z[p]);
      }
    });
    if (count < kEnough) {
      for (const PointNumber p : own)
        if (is_open_[p] != 0) findings.open.push_back(p);
      return;
    }
    if (high - low <= options_.height) return;
    heights_.clear();
    cells_.around(i, j, [&](std::span<const PointNumber> points) {
      for (const PointNumber p : points) heights_.push_back(cloud_.z[p]);
    });
    const double middle = median(heights_);
    for (double& z : heights_) z = std::abs(z - middle);
    const double most = std::max(options_.height, options_.spreads * median(heights_));
    const auto is_far = [&](PointNumber p) {
      return is_open_[p] != 0 && std::abs(cloud_.z[p] - middle) > most;
    };
    if (std::none_of(own.begin(), own.end(), is_far)) return;
    find_alone(i, j);
    for (const PointNumber p : own)
      if (is_far(p) && is_alone(cloud_.z[p]) && !is_surpassed(cloud_.z[p], middle))
        findings.outliers.push_back(p);
  }

 private:
  struct Neighbour {
    double z;
    std::size_t square;
  };

  /// For the neighbourhood of a cell: which heights are alone, and the extremes of those that are
  /// not. A window moves over the points by height, so that as many as there may be at one place
  /// (a mast that is classed as ground) cost no more than others.
  void find_alone(std::int64_t i, std::int64_t j) {
    neighbours_.clear();
    cells_.around(i, j, [&](std::span<const PointNumber> points) {
      for (const PointNumber p : points)
        neighbours_.push_back({cloud_.z[p], cells_.square(p, i, j)});
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
  const Cells& cells_;
  const GroundOutlierOptions& options_;
  const std::vector<std::uint8_t>& is_open_;
  std::vector<double> heights_;
  std::vector<Neighbour> neighbours_;  ///< By height.
  std::vector<std::uint8_t> alone_;    ///< Per neighbour.
  double highest_crowd_ = 0;
  double lowest_crowd_ = 0;
};

}  // namespace

std::vector<std::uint32_t> find_ground_outliers(const PointCloud& cloud,
                                                const GroundOutlierOptions& options,
                                                const Progress& progress) {
  const std::vector<PointNumber> points = ground_points(cloud, options.classes);
  std::vector<PointNumber> outliers;
  std::vector<PointNumber> open = points;
  std::vector<std::uint8_t> is_open(cloud.size(), 0);
  for (std::size_t level = 0; level < kCells.size() && !open.empty(); ++level) {
    constexpr auto kLevels = static_cast<double>(kCells.size());
    const auto number = static_cast<double>(level);
    const Progress at_level = portion(progress, number / kLevels, (number + 1) / kLevels);
    at_level.update(0);
    for (const PointNumber p : open) is_open[p] = 1;
    const Cells cells(cloud, points, kCells[level], options.anchor);
    const auto rows = static_cast<std::size_t>(cells.rows());
    std::vector<Findings> chunks((rows + kRowGrain - 1) / kRowGrain);
    SharedProgress shared(at_level, cells.rows());
    parallel_chunks(rows, kRowGrain, [&](std::size_t begin, std::size_t end) {
      Judge judge(cloud, cells, options, is_open);
      for (std::size_t j = begin; j < end; ++j)
        for (std::int64_t i = 0; i < cells.columns(); ++i)
          judge.cell(i, static_cast<std::int64_t>(j), chunks[begin / kRowGrain]);
      shared.add(static_cast<std::int64_t>(end - begin));
    });
    for (const PointNumber p : open) is_open[p] = 0;
    open.clear();
    for (const Findings& found : chunks) {
      outliers.insert(outliers.end(), found.outliers.begin(), found.outliers.end());
      open.insert(open.end(), found.open.begin(), found.open.end());
    }
  }
  std::sort(outliers.begin(), outliers.end());
  progress.update(1);
  return outliers;
}

}  // namespace tetropolis
