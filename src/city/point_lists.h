// Compressed rows from one vector a building. Private to src/city.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/city/extract.h"

namespace tetropolis {

inline PointLists to_rows(const std::vector<std::vector<PointIndex>>& lists) {
  PointLists rows;
  for (const std::vector<PointIndex>& list : lists) {
    rows.indices.insert(rows.indices.end(), list.begin(), list.end());
    rows.offsets.push_back(static_cast<std::int64_t>(rows.indices.size()));
  }
  return rows;
}

}  // namespace tetropolis
