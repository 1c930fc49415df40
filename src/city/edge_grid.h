// A uniform grid of segments that come and go.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "tetropolis/core/row_major.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Number of a segment in its list.
using LineIndex = Index<struct LineTag>;

/// A good size of cells for `count` segments of `length` in all: their mean length, or less where
/// segments are long and close to each other, but so that each is in a few dozen cells at most.
inline double cell_size(const Bounds2& box, double length, std::size_t count) {
  if (count == 0 || box.empty()) return 1;
  const double n = static_cast<double>(count), mean = length / n;
  const double spacing = std::sqrt(box.width() * box.height() / n);
  return std::max(std::min(mean, std::max(spacing, mean / 16)),
                  1e-9 * (box.width() + box.height()));
}

/// Segments by number. A segment is listed in every cell it passes through; segments outside the
/// box are listed in the cells at its rim, so none is ever lost.
class EdgeGrid {
 public:
  EdgeGrid() = default;

  /// Cells of about `cell` (made larger if there would be more than 4 per expected segment).
  EdgeGrid(const Bounds2& box, double cell, std::size_t expected_segments);

  void insert(LineIndex id, Point2 a, Point2 b);

  /// Precondition: `id` was inserted with the same a and b.
  void remove(LineIndex id, Point2 a, Point2 b);

  /// Calls visit(id) for every segment whose cells overlap `box`: a superset of those that meet it.
  /// The same id may come several times. The order depends on the history of calls only.
  template <typename Visit>
  void visit(const Bounds2& box, const Visit& visit_id) const {
    visit_cells(box, [&](std::size_t cell) { visit_cell(cell, visit_id); });
  }

  /// Whether is_wanted(id) for a segment whose cells overlap `box`; stops at the first.
  template <typename Predicate>
  bool any(const Bounds2& box, const Predicate& is_wanted) const {
    if (head_.empty()) return false;
    const std::int32_t x0 = column(box.xmin), x1 = column(box.xmax);
    const std::int32_t y0 = row(box.ymin), y1 = row(box.ymax);
    for (std::int32_t y = y0; y <= y1; ++y)
      for (std::int32_t x = x0; x <= x1; ++x)
        for (std::int32_t e = head_[index(x, y)]; e >= 0; e = entry(e).next)
          if (is_wanted(entry(e).id)) return true;
    return false;
  }

  /// Cells have the numbers from 0 on.
  std::size_t cell_count() const { return head_.size(); }

  /// Calls visit_cell(cell) for every cell that overlaps `box`.
  template <typename Visit>
  void visit_cells(const Bounds2& box, const Visit& visit_cell) const {
    if (head_.empty()) return;
    const std::int32_t x0 = column(box.xmin), x1 = column(box.xmax);
    const std::int32_t y0 = row(box.ymin), y1 = row(box.ymax);
    for (std::int32_t y = y0; y <= y1; ++y)
      for (std::int32_t x = x0; x <= x1; ++x) visit_cell(index(x, y));
  }

  /// Calls visit_cell(cell) for every cell that has points within `reach` of the segment a-b, and a
  /// few others. The box of a long slanted segment has many more.
  template <typename Visit>
  void visit_cells_near(Point2 a, Point2 b, double reach, const Visit& visit_cell) const {
    if (head_.empty()) return;
    if (a.y > b.y) std::swap(a, b);
    const double margin = reach + kSlack * cell_;
    const std::int32_t y0 = row(a.y - margin), y1 = row(b.y + margin);
    for (std::int32_t y = y0; y <= y1; ++y) {
      double xa = a.x, xb = b.x;
      // The part of the segment that is within reach of this row; rows at the rim have no end.
      const double low = y == 0 ? a.y : box_.ymin + y * cell_ - margin;
      const double high = y + 1 == rows_ ? b.y : box_.ymin + (y + 1) * cell_ + margin;
      if (b.y > a.y) {
        xa = a.x + std::clamp((low - a.y) / (b.y - a.y), 0.0, 1.0) * (b.x - a.x);
        xb = a.x + std::clamp((high - a.y) / (b.y - a.y), 0.0, 1.0) * (b.x - a.x);
      }
      const std::int32_t x0 = column(std::min(xa, xb) - margin);
      const std::int32_t x1 = column(std::max(xa, xb) + margin);
      for (std::int32_t x = x0; x <= x1; ++x) visit_cell(index(x, y));
    }
  }

  /// Calls visit_id(id) for every segment listed in the cell.
  template <typename Visit>
  void visit_cell(std::size_t cell, const Visit& visit_id) const {
    for (std::int32_t e = head_[cell]; e >= 0; e = entry(e).next) visit_id(entry(e).id);
  }

 private:
  static constexpr double kSlack = 1e-6;  ///< Of a cell, against rounding.

  struct Entry {
    LineIndex id;
    std::int32_t next;
  };

  Entry& entry(std::int32_t e) { return pool_[static_cast<std::size_t>(e)]; }
  const Entry& entry(std::int32_t e) const { return pool_[static_cast<std::size_t>(e)]; }
  std::size_t index(std::int32_t x, std::int32_t y) const { return row_major(x, y, columns_); }
  std::int32_t column(double x) const {
    return static_cast<std::int32_t>(
        std::clamp(std::floor((x - box_.xmin) / cell_), 0.0, static_cast<double>(columns_ - 1)));
  }
  std::int32_t row(double y) const {
    return static_cast<std::int32_t>(
        std::clamp(std::floor((y - box_.ymin) / cell_), 0.0, static_cast<double>(rows_ - 1)));
  }
  Bounds2 box_;
  double cell_ = 1;
  std::int32_t columns_ = 1;
  std::int32_t rows_ = 1;
  std::vector<std::int32_t> head_;  ///< First entry of each cell, row by row; -1 if empty.
  std::vector<Entry> pool_;
  std::int32_t free_ = -1;
};

}  // namespace tetropolis
