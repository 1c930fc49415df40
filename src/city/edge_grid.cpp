#include "edge_grid.h"

#include <cassert>

namespace tetropolis {

EdgeGrid::EdgeGrid(const Bounds2& box, double cell, std::size_t expected_segments)
    : box_(box), cell_(cell) {
  if (box_.empty()) box_ = {0, 0, 1, 1};
  const double limit = 4.0 * static_cast<double>(expected_segments) + 64.0;
  const double cells = (box_.width() / cell_ + 1) * (box_.height() / cell_ + 1);
  if (cells > limit) cell_ *= std::sqrt(cells / limit);
  // Very long and thin boxes still exceed the limit after scaling both directions alike.
  cell_ = std::max({cell_, box_.width() / limit, box_.height() / limit});
  columns_ = static_cast<std::int32_t>(box_.width() / cell_) + 1;
  rows_ = static_cast<std::int32_t>(box_.height() / cell_) + 1;
  head_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), -1);
  pool_.reserve(2 * expected_segments);
}

void EdgeGrid::insert(LineIndex id, Point2 a, Point2 b) {
  visit_cells_near(a, b, 0, [&](std::size_t cell) {
    std::int32_t e = free_;
    if (e >= 0) {
      free_ = entry(e).next;
    } else {
      e = static_cast<std::int32_t>(pool_.size());
      pool_.emplace_back();
    }
    entry(e) = {id, head_[cell]};
    head_[cell] = e;
  });
}

void EdgeGrid::remove(LineIndex id, Point2 a, Point2 b) {
  visit_cells_near(a, b, 0, [&](std::size_t cell) {
    std::int32_t* link = &head_[cell];
    while (*link >= 0 && entry(*link).id != id) link = &entry(*link).next;
    assert(*link >= 0);
    if (*link < 0) return;
    const std::int32_t e = *link;
    *link = entry(e).next;
    entry(e).next = free_;
    free_ = e;
  });
}

}  // namespace tetropolis
