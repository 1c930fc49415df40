// The edges of a triangle surface, each with the faces along it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "core/ragged_builder.h"
#include "violations.h"

namespace tetropolis {

/// One side of a face, along an edge seen from its lower vertex.
struct EdgeUse {
  std::int64_t high;  ///< The edge's other vertex.
  bool forward;       ///< Whether the face runs from the lower to the higher vertex.
  std::size_t face;
};

/// Calls look(low, uses, violations) for every edge, where `uses` are the sides along it, forward
/// ones first and then by face. Calls come from several threads, each with violations of its own;
/// returned is their sum.
template <typename Triangle, typename Look>
std::vector<Violation> look_at_edges(const std::vector<Triangle>& triangles, std::size_t vertices,
                                     const Look& look) {
  const auto ends_of = [&](std::size_t side) {
    const Triangle& t = triangles[side / 3];
    return std::pair<std::int64_t, std::int64_t>(t[side % 3], t[(side + 1) % 3]);
  };
  const RaggedArray<std::uint32_t> rows =
      file_under_rows(3 * triangles.size(), vertices, [&](std::size_t side, const auto& use) {
        const auto [a, b] = ends_of(side);
        use(static_cast<std::size_t>(std::min(a, b)));
      });
  return sum_of_violations(
      vertices, [&](std::size_t begin, std::size_t end, std::vector<Violation>& violations) {
        std::vector<EdgeUse> uses;
        for (std::size_t low = begin; low < end; ++low) {
          uses.clear();
          for (const std::uint32_t item : rows[low]) {
            const std::size_t side = item;
            const auto [a, b] = ends_of(side);
            uses.push_back({std::max(a, b), a < b, side / 3});
          }
          std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
            return std::tuple(a.high, !a.forward, a.face) < std::tuple(b.high, !b.forward, b.face);
          });
          for (std::size_t i = 0, j = 0; i < uses.size(); i = j) {
            while (j < uses.size() && uses[j].high == uses[i].high) ++j;
            look(static_cast<std::int64_t>(low), std::span<const EdgeUse>(uses).subspan(i, j - i),
                 violations);
          }
        }
      });
}

}  // namespace tetropolis
