#include "upper_fans.h"

#include <numeric>

namespace tetropolis {

CellsByTop::CellsByTop(const ColumnMesh& mesh)
    : upper_(mesh.upper), columns_(mesh.vertex_count()), fan_to_(upper_.nodes()) {
  begin_.assign(columns_ + upper_.nodes() + 1, 0);
  const auto for_each_at_end = [&](const auto& visit) {
    for (std::size_t f = 0; f + 1 < upper_.fans.size(); ++f) {
      if (upper_.fans[f].up.valid()) continue;
      for (std::size_t c = upper_.fans[f].cell; c < upper_.fans[f + 1].cell; ++c) {
        const UpperTriangle top = fan_face(upper_.cell(f, c), FanFace::kTop);
        visit(FanCell{static_cast<std::uint32_t>(f), static_cast<std::uint32_t>(c)},
              *std::max_element(top.begin(), top.end()));
      }
    }
  };
  for_each_at_end([&](const FanCell&, UpperPlace highest) { ++begin_[highest]; });
  std::inclusive_scan(begin_.begin(), begin_.end(), begin_.begin());
  at_ends_.resize(begin_.back());
  for_each_at_end(
      [&](const FanCell& cell, UpperPlace highest) { at_ends_[--begin_[highest]] = cell; });
  for (std::size_t f = 0; f + 1 < upper_.fans.size(); ++f)
    if (const UpperPlace up = upper_.fans[f].up; up.valid())
      fan_to_[up - columns_] = static_cast<std::uint32_t>(f);
}

}  // namespace tetropolis
