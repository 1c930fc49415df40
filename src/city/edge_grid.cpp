#include "city/edge_grid.h"

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

template <typename Visit>
void EdgeGrid::for_each_cell(Point2 a, Point2 b, const Visit& visit_cell) const {
  if (a.y > b.y) std::swap(a, b);
  const std::int32_t y0 = row(a.y), y1 = row(b.y);
  const double slack = kSlack * cell_;
  for (std::int32_t y = y0; y <= y1; ++y) {
    double xa = a.x, xb = b.x;
    if (y0 != y1 && b.y > a.y) {
      // The part of the segment within this row, a little enlarged against rounding.
      const double low = y == y0 ? a.y : box_.ymin + y * cell_ - slack;
      const double high = y == y1 ? b.y : box_.ymin + (y + 1) * cell_ + slack;
      const double t0 = std::clamp((low - a.y) / (b.y - a.y), 0.0, 1.0);
      const double t1 = std::clamp((high - a.y) / (b.y - a.y), 0.0, 1.0);
      xa = a.x + t0 * (b.x - a.x);
      xb = a.x + t1 * (b.x - a.x);
    }
    const std::int32_t x0 = column(std::min(xa, xb) - slack);
    const std::int32_t x1 = column(std::max(xa, xb) + slack);
    for (std::int32_t x = x0; x <= x1; ++x) visit_cell(index(x, y));
  }
}

void EdgeGrid::insert(std::int32_t id, Point2 a, Point2 b) {
  for_each_cell(a, b, [&](std::size_t cell) {
    std::int32_t entry = free_;
    if (entry >= 0) {
      free_ = pool_[static_cast<std::size_t>(entry)].next;
    } else {
      entry = static_cast<std::int32_t>(pool_.size());
      pool_.emplace_back();
    }
    pool_[static_cast<std::size_t>(entry)] = {id, head_[cell]};
    head_[cell] = entry;
  });
}

void EdgeGrid::remove(std::int32_t id, Point2 a, Point2 b) {
  for_each_cell(a, b, [&](std::size_t cell) {
    std::int32_t* link = &head_[cell];
    while (*link >= 0 && pool_[static_cast<std::size_t>(*link)].id != id)
      link = &pool_[static_cast<std::size_t>(*link)].next;
    assert(*link >= 0);
    if (*link < 0) return;
    const std::int32_t entry = *link;
    *link = pool_[static_cast<std::size_t>(entry)].next;
    pool_[static_cast<std::size_t>(entry)].next = free_;
    free_ = entry;
  });
}

}  // namespace tetropolis
