// The cells of a mesh's upper part, fan by fan, and those below and beside them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "upper_faces.h"

namespace tetropolis {

/// Seen against its normal, counter-clockwise.
using UpperTriangle = std::array<UpperPlace, 3>;

/// The faces of a cell. Of a fan that goes up, two are between it and the cells before and after.
enum class FanFace : std::size_t { kBottom, kBefore, kTop, kAfter };

/// Its normal is outwards.
inline UpperTriangle fan_face(const UpperMesh::Cell& cell, FanFace face) {
  constexpr std::array<std::array<std::size_t, 3>, 4> kCorners{
      {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  const auto& corner = kCorners[static_cast<std::size_t>(face)];
  return {cell[corner[0]], cell[corner[1]], cell[corner[2]]};
}

inline UpperTriangle turned(const UpperTriangle& p, std::size_t by) {
  return {p[by], p[(by + 1) % 3], p[(by + 2) % 3]};
}

/// Not a std::optional of these, which compilers copy badly.
struct FanCell {
  static constexpr std::uint32_t kNone = 0xffffffff;
  std::uint32_t fan = kNone, cell = 0;
  bool is_found() const { return fan != kNone; }
};

/// A cell below a triangle.
struct CellBelow : FanCell {
  std::size_t turn = 0;  ///< Its top is the triangle turned by so many.
};

/// Finds cells by their tops. Takes a byte per cell, about.
class CellsByTop {
 public:
  explicit CellsByTop(const ColumnMesh& mesh);
  /// Precondition: the triangle is counter-clockwise from above. Not found if it is on the lid.
  /// Sooner if the corner `likely` is the one that has risen last.
  CellBelow find(const UpperTriangle& top, std::size_t likely = 0) const {
    for (std::size_t n = 0, i = likely; n < 3; ++n, i = (i + 1) % 3)
      if (top[i] >= columns_)
        if (const FanCell found = find_below(turned(top, i)); found.is_found())
          return {found, (i + 1) % 3};
    const UpperPlace highest = *std::max_element(top.begin(), top.end());
    for (std::size_t i = begin_[highest]; i < begin_[highest + 1]; ++i) {
      const UpperMesh::Cell cell = upper_.cell(at_ends_[i].fan, at_ends_[i].cell);
      const UpperTriangle other = fan_face(cell, FanFace::kTop);
      for (std::size_t turn = 0; turn < 3; ++turn)
        if (other == turned(top, turn)) return {at_ends_[i], turn};
    }
    return {};
  }

 private:
  /// Of the fan that goes up to the first corner.
  FanCell find_below(const UpperTriangle& top) const {
    const std::uint32_t f = fan_to_[top[0] - columns_];
    const UpperFan &fan = upper_.fans[f], &next = upper_.fans[f + 1];
    const UpperPlace* const other = upper_.others.data() + fan.other;
    for (std::uint32_t k = 0; k < next.cell - fan.cell; ++k)
      if (other[k] == top[1] && other[k + 1] == top[2]) return {f, fan.cell + k};
    return {};
  }

  const UpperMesh& upper_;
  std::size_t columns_;
  std::vector<std::uint32_t> fan_to_;  // per node
  // Per place and one more: where those begin whose fan ends and whose tops have no higher one.
  std::vector<std::uint32_t> begin_;
  std::vector<FanCell> at_ends_;
};

/// Calls visit(face) for the faces below and between the cells of fan f.
template <typename Visit>
void visit_faces_of(const UpperMesh& upper, const CellsByTop& tops, std::size_t f,
                    const Visit& visit) {
  using Cell = UpperMesh::Cell;
  const std::size_t first = upper.fans[f].cell, end = upper.fans[f + 1].cell;
  const auto below = [&](std::size_t c, const Cell& cell, FanFace face) {
    const UpperTriangle bottom = fan_face(cell, face);
    const FanCell found = tops.find({bottom[0], bottom[2], bottom[1]});
    if (!found.is_found()) return;
    const Cell other = upper.cell(found.fan, found.cell);
    if (c < found.cell)
      visit(InnerFace{{c, std::size_t{found.cell}}, {cell, other}, bottom});
    else
      visit(InnerFace{{std::size_t{found.cell}, c}, {other, cell}, fan_face(other, FanFace::kTop)});
  };
  const auto between = [&](std::size_t c, std::size_t d, FanFace face) {
    const Cell cell = upper.cell(f, c);
    visit(InnerFace{{c, d}, {cell, upper.cell(f, d)}, fan_face(cell, face)});
  };
  if (upper.fans[f].up.valid()) {
    for (std::size_t c = first; c < end; ++c) {
      below(c, upper.cell(f, c), FanFace::kBottom);
      if (c + 1 < end) between(c, c + 1, FanFace::kAfter);
    }
    if (upper.others[upper.fans[f].other] == upper.others[upper.fans[f + 1].other - 1])
      between(first, end - 1, FanFace::kBefore);
    return;
  }
  const UpperPlace* const corners = upper.others.data() + upper.fans[f].other;
  constexpr std::array kBelowTop{FanFace::kBottom, FanFace::kBefore, FanFace::kAfter};
  for (std::size_t c = first; c < end; ++c) {
    const Cell cell = upper.cell(f, c);
    for (const FanFace face : kBelowTop) {
      const UpperTriangle own = fan_face(cell, face);
      // All have the fan's node in common.
      const auto is_beyond = [&, x = own[1], y = own[2]](std::size_t d) {
        const UpperPlace* const o = corners + 3 * (d - first);
        return (o[0] == x && o[1] == y) || (o[1] == x && o[2] == y) || (o[2] == x && o[0] == y);
      };
      std::size_t d = first;
      while (d < end && !is_beyond(d)) ++d;
      if (d == end)
        below(c, cell, face);
      else if (d > c)
        between(c, d, face);
    }
  }
}

}  // namespace tetropolis
