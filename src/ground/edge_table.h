// Edges of triangle lists by sorting: for checks, not for meshing.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "tetropolis/geometry/types.h"

#include "core/ragged_builder.h"
#include "core/sort_once.h"

namespace tetropolis {

/// Groups the edges of triangles by their two vertices.
class EdgeTable {
 public:
  /// Edge `edge` (opposite to vertex `edge`) of `triangle`; forward: it runs from low to high.
  struct Use {
    VertexIndex low;
    VertexIndex high;
    TriangleIndex triangle;
    std::uint8_t edge;
    bool forward;
  };

  explicit EdgeTable(std::span<const std::array<VertexIndex, 3>> triangles) {
    uses_.reserve(3 * triangles.size());
    for (const TriangleIndex t : indices<TriangleIndex>(triangles.size())) {
      for (std::uint8_t e = 0; e < 3; ++e) {
        const VertexIndex a = triangles[t][(e + 1) % 3], b = triangles[t][(e + 2) % 3];
        uses_.push_back({std::min(a, b), std::max(a, b), t, e, a < b});
      }
    }
    std::sort(uses_.begin(), uses_.end(), [](const Use& x, const Use& y) {
      if (x.low != y.low) return x.low < y.low;
      return x.high != y.high ? x.high < y.high : x.triangle < y.triangle;
    });
  }

  /// Calls visit(uses of one edge) for every edge, by ascending vertices.
  template <typename Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t i = 0, j = 0; i < uses_.size(); i = j) {
      while (j < uses_.size() && uses_[j].low == uses_[i].low && uses_[j].high == uses_[i].high)
        ++j;
      visit(std::span<const Use>(uses_).subspan(i, j - i));
    }
  }

 private:
  std::vector<Use> uses_;
};

/// A set of undirected edges.
class EdgeSet {
 public:
  explicit EdgeSet(std::span<const std::array<VertexIndex, 2>> edges) {
    for (const auto& e : edges) edges_.push_back(ordered(e[0], e[1]));
    sort_once(edges_);
  }
  bool contains(VertexIndex a, VertexIndex b) const {
    return std::binary_search(edges_.begin(), edges_.end(), ordered(a, b));
  }
  std::size_t size() const { return edges_.size(); }

 private:
  static std::pair<VertexIndex, VertexIndex> ordered(VertexIndex a, VertexIndex b) {
    return {std::min(a, b), std::max(a, b)};
  }
  std::vector<std::pair<VertexIndex, VertexIndex>> edges_;
};

/// The vertices joined to each vertex by edges of a list.
inline RaggedArray<VertexIndex> neighbours(std::size_t vertices,
                                           std::span<const std::array<VertexIndex, 2>> edges) {
  return ragged_from_pairs<VertexIndex>(vertices, [&](const auto& use) {
    for (const auto& e : edges) {
      use(e[0], e[1]);
      use(e[1], e[0]);
    }
  });
}

}  // namespace tetropolis
