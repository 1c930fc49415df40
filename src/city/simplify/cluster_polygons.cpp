#include "cluster_polygons.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "tetropolis/geometry/polygon.h"

#include "city/grid_geometry.h"
#include "city/outline.h"
#include "core/disjoint_sets.h"
#include "core/parallel.h"

namespace tetropolis {

namespace {

/// Puts `sets` together with those that body(begin, end, sets) makes of copies of them in chunks of
/// [0, work). Which sets come out depends on no order.
template <typename Body>
void join_in_chunks(std::size_t work, std::size_t size, DisjointSets& sets, const Body& body) {
  constexpr std::size_t kChunks = 8;  // each costs a list of all things, or of all edges
  const std::size_t grain = std::max<std::size_t>(grain_of_chunks(work, kChunks), 256);
  std::vector<DisjointSets> found((work + grain - 1) / grain, DisjointSets(0));
  parallel_chunks(work, grain, [&](std::size_t begin, std::size_t end) {
    DisjointSets local = sets;
    body(static_cast<std::int32_t>(begin), static_cast<std::int32_t>(end), local);
    found[begin / grain] = std::move(local);
  });
  for (DisjointSets& local : found)
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(size); ++i)
      if (const std::int32_t root = local.root(i); root != i) sets.join(root, i);
}

/// Edges that are closer than `distance`, for all that `polygons` polygons have.
class NearEdges {
 public:
  NearEdges(const Outline& o, double distance, std::size_t polygons)
      : o_(o), distance_(distance), polygons_(polygons), group_(o.point.size()) {
    for (std::int32_t e = 0; e < o.vertex_count(); ++e) group_[at(e)] = o.group_of(e);
  }

  void join(DisjointSets& sets) {
    join_within_cells(sets);
    sort_cells(sets);
    join_in_chunks(group_.size(), polygons_, sets,
                   [&](std::int32_t begin, std::int32_t end, DisjointSets& local) {
                     for (std::int32_t e = begin; e < end; ++e) join_with_near(e, local);
                   });
  }

 private:
  /// Edges of one cell whose polygons are in one set.
  struct Run {
    std::int32_t root;
    std::size_t begin;  ///< In edges_; they end where the next run begins.
  };

  static std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

  bool are_near(std::int32_t e, std::int32_t f) const {
    return grid::are_near(o_.at(e), o_.at(o_.after(e)), o_.at(f), o_.at(o_.after(f)), distance_);
  }

  /// In each cell, joins edges to the first few others that are not joined yet. Where many lie on
  /// each other hardly any are left apart, and of the rest there are not too many pairs.
  void join_within_cells(DisjointSets& sets) const {
    constexpr std::size_t kFew = 8;
    std::vector<std::int32_t> apart;
    for (std::size_t cell = 0; cell < o_.grid.cell_count(); ++cell) {
      apart.clear();
      o_.grid.visit_cell(cell, [&](std::int32_t e) {
        const std::int32_t own = group_[at(e)];
        bool joined = false;
        for (const std::int32_t f : apart) {
          const std::int32_t other = group_[at(f)];
          if (sets.joined(own, other)) {
            joined = true;
          } else if (are_near(e, f)) {
            sets.join(own, other);
            joined = true;
          }
        }
        if (!joined && apart.size() < kFew) apart.push_back(e);
      });
    }
  }

  /// The edges of each cell by what they are joined to, so that all of one set are passed over at
  /// once.
  void sort_cells(DisjointSets& sets) {
    std::vector<std::pair<std::int32_t, std::int32_t>> edges;  // with the roots of their polygons
    first_run_.assign(1, 0);
    for (std::size_t cell = 0; cell < o_.grid.cell_count(); ++cell) {
      edges.clear();
      o_.grid.visit_cell(cell,
                         [&](std::int32_t e) { edges.emplace_back(sets.root(group_[at(e)]), e); });
      std::sort(edges.begin(), edges.end());
      for (std::size_t k = 0; k < edges.size(); ++k) {
        const auto [root, e] = edges[k];
        if (k == 0 || root != edges[k - 1].first) runs_.push_back({root, edges_.size()});
        edges_.push_back(e);
      }
      first_run_.push_back(runs_.size());
    }
    runs_.push_back({-1, edges_.size()});
  }

  void join_with_near(std::int32_t e, DisjointSets& local) const {
    const std::int32_t own = group_[at(e)];
    const auto is_near = [&](std::int32_t f) { return f > e && are_near(e, f); };
    o_.grid.visit_cells_near(o_.at(e), o_.at(o_.after(e)), distance_, [&](std::size_t cell) {
      for (std::size_t r = first_run_[cell]; r < first_run_[cell + 1]; ++r) {
        if (local.joined(own, runs_[r].root)) continue;
        const auto begin = edges_.begin() + static_cast<std::ptrdiff_t>(runs_[r].begin);
        const auto end = edges_.begin() + static_cast<std::ptrdiff_t>(runs_[r + 1].begin);
        if (std::any_of(begin, end, is_near)) local.join(own, runs_[r].root);
      }
    });
  }

  const Outline& o_;
  double distance_;
  std::size_t polygons_;
  std::vector<std::int32_t> group_;     ///< The polygon of each edge.
  std::vector<std::size_t> first_run_;  ///< Of each cell, and one more.
  std::vector<Run> runs_;               ///< And one more.
  std::vector<std::int32_t> edges_;
};

/// Joins polygons to those that contain them: even-odd count, per other polygon, of the edges left
/// of a vertex. Boundaries of polygons not yet joined are apart, so any vertex will do, and one
/// polygon of all that are joined.
void join_contained(const Outline& o, std::span<const Polygon> polygons, DisjointSets& sets) {
  double widest = 0;
  std::vector<Bounds2> boxes;
  boxes.reserve(polygons.size());
  for (const Polygon& polygon : polygons) {
    boxes.push_back(bounds(polygon));
    widest = std::max(widest, boxes.back().width());
  }
  std::vector<std::uint8_t> is_first(polygons.size(), 0);
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(polygons.size()); ++i)
    is_first[static_cast<std::size_t>(i)] = sets.root(i) == i ? 1 : 0;
  const auto join = [&](std::int32_t begin, std::int32_t end, DisjointSets& local) {
    std::vector<std::int32_t> seen(o.point.size(), -1);
    std::vector<std::int32_t> crossed;
    for (std::int32_t r = begin; r < end; ++r) {
      const auto ring = static_cast<std::size_t>(r);
      if (o.is_hole[ring] != 0 || is_first[static_cast<std::size_t>(o.group[ring])] == 0) continue;
      const Point2 p = o.at(o.first[ring]);
      crossed.clear();
      o.grid.visit({p.x - widest, p.y, p.x, p.y}, [&](std::int32_t e) {
        if (seen[static_cast<std::size_t>(e)] == r) return;
        seen[static_cast<std::size_t>(e)] = r;
        // Of polygons around p the search sees all edges left of p; of others perhaps not.
        if (!boxes[static_cast<std::size_t>(o.group_of(e))].contains(p)) return;
        if (grid::crossing_side(o.at(e), o.at(o.after(e)), p) < 0) crossed.push_back(o.group_of(e));
      });
      std::sort(crossed.begin(), crossed.end());
      for (std::size_t i = 0; i < crossed.size();) {
        std::size_t j = i;
        while (j < crossed.size() && crossed[j] == crossed[i]) ++j;
        if ((j - i) % 2 == 1) local.join(o.group[ring], crossed[i]);
        i = j;
      }
    }
  };
  join_in_chunks(o.first.size(), polygons.size(), sets, join);
}

}  // namespace

std::vector<std::int32_t> cluster_polygons(std::span<const Polygon> polygons, double distance) {
  const Outline o = outline_for(pointers_to(polygons), distance);
  DisjointSets sets(polygons.size());
  NearEdges(o, distance, polygons.size()).join(sets);
  join_contained(o, polygons, sets);
  std::vector<std::int32_t> cluster(polygons.size());
  std::int32_t count = 0;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    const auto root = static_cast<std::size_t>(sets.root(static_cast<std::int32_t>(i)));
    cluster[i] = root == i ? count++ : cluster[root];
  }
  return cluster;
}

}  // namespace tetropolis
