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

using PolygonSets = DisjointSets<OutlinePolygon>;

/// Puts `sets` together with those that body(begin, end, sets) makes of copies of them in chunks of
/// [0, work). Which sets come out depends on no order.
template <typename Body>
void join_in_chunks(std::size_t work, std::size_t size, PolygonSets& sets, const Body& body) {
  constexpr std::size_t kChunks = 8;  // each costs a list of all things, or of all edges
  const std::size_t grain = std::max<std::size_t>(grain_of_chunks(work, kChunks), 256);
  std::vector<PolygonSets> found((work + grain - 1) / grain, PolygonSets(0));
  parallel_chunks(work, grain, [&](std::size_t begin, std::size_t end) {
    PolygonSets local = sets;
    body(begin, end, local);
    found[begin / grain] = std::move(local);
  });
  for (PolygonSets& local : found)
    for (const OutlinePolygon i : indices<OutlinePolygon>(size))
      if (const OutlinePolygon root = local.root(i); root != i) sets.join(root, i);
}

/// Edges that are closer than `distance`, for all that `polygons` polygons have.
class NearEdges {
 public:
  NearEdges(const Outline& o, double distance, std::size_t polygons)
      : o_(o), distance_(distance), polygons_(polygons), polygon_(o.point.size()) {
    for (const OutlineVertex e : o.vertices()) polygon_[e] = o.polygon_of(e);
  }

  void join(PolygonSets& sets) {
    join_within_cells(sets);
    sort_cells(sets);
    join_in_chunks(polygon_.size(), polygons_, sets,
                   [&](std::size_t begin, std::size_t end, PolygonSets& local) {
                     for (const OutlineVertex e : indices<OutlineVertex>(begin, end))
                       join_with_near(e, local);
                   });
  }

 private:
  /// Edges of one cell whose polygons are in one set.
  struct Run {
    OutlinePolygon root;
    std::size_t begin;  ///< In edges_; they end where the next run begins.
  };

  bool are_near(OutlineVertex e, OutlineVertex f) const {
    return grid::are_near(o_.at(e), o_.at(o_.after(e)), o_.at(f), o_.at(o_.after(f)), distance_);
  }

  /// In each cell, joins edges to the first few others that are not joined yet. Where many lie on
  /// each other hardly any are left apart, and of the rest there are not too many pairs.
  void join_within_cells(PolygonSets& sets) const {
    constexpr std::size_t kFew = 8;
    std::vector<OutlineVertex> apart;
    for (std::size_t cell = 0; cell < o_.grid.cell_count(); ++cell) {
      apart.clear();
      o_.grid.visit_cell(cell, [&](OutlineVertex e) {
        const OutlinePolygon own = polygon_[e];
        bool joined = false;
        for (const OutlineVertex f : apart) {
          const OutlinePolygon other = polygon_[f];
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
  void sort_cells(PolygonSets& sets) {
    std::vector<std::pair<OutlinePolygon, OutlineVertex>>
        edges;  // with the roots of their polygons
    first_run_.assign(1, 0);
    for (std::size_t cell = 0; cell < o_.grid.cell_count(); ++cell) {
      edges.clear();
      o_.grid.visit_cell(cell,
                         [&](OutlineVertex e) { edges.emplace_back(sets.root(polygon_[e]), e); });
      std::sort(edges.begin(), edges.end());
      for (std::size_t k = 0; k < edges.size(); ++k) {
        const auto [root, e] = edges[k];
        if (k == 0 || root != edges[k - 1].first) runs_.push_back({root, edges_.size()});
        edges_.push_back(e);
      }
      first_run_.push_back(runs_.size());
    }
    runs_.push_back({OutlinePolygon::none(), edges_.size()});
  }

  void join_with_near(OutlineVertex e, PolygonSets& local) const {
    const OutlinePolygon own = polygon_[e];
    const auto is_near = [&](OutlineVertex f) { return f > e && are_near(e, f); };
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
  std::vector<OutlinePolygon> polygon_;  ///< The polygon of each edge.
  std::vector<std::size_t> first_run_;   ///< Of each cell, and one more.
  std::vector<Run> runs_;                ///< And one more.
  std::vector<OutlineVertex> edges_;
};

/// Joins polygons to those that contain them: even-odd count, per other polygon, of the edges left
/// of a vertex. Boundaries of polygons not yet joined are apart, so any vertex will do, and one
/// polygon of all that are joined.
void join_contained(const Outline& o, std::span<const Polygon> polygons, PolygonSets& sets) {
  double widest = 0;
  std::vector<Bounds2> boxes;
  boxes.reserve(polygons.size());
  for (const Polygon& polygon : polygons) {
    boxes.push_back(bounds(polygon));
    widest = std::max(widest, boxes.back().width());
  }
  std::vector<std::uint8_t> is_first(polygons.size(), 0);
  for (const OutlinePolygon i : indices<OutlinePolygon>(polygons.size()))
    is_first[i] = sets.root(i) == i ? 1 : 0;
  const auto join = [&](std::size_t begin, std::size_t end, PolygonSets& local) {
    std::vector<OutlineRing> seen(o.point.size(), OutlineRing::none());
    std::vector<OutlinePolygon> crossed;
    for (const OutlineRing ring : indices<OutlineRing>(begin, end)) {
      if (o.is_hole[ring] != 0 || is_first[o.polygon[ring]] == 0) continue;
      const Point2 p = o.at(o.first[ring]);
      crossed.clear();
      o.grid.visit({p.x - widest, p.y, p.x, p.y}, [&](OutlineVertex e) {
        if (seen[e] == ring) return;
        seen[e] = ring;
        // Of polygons around p the search sees all edges left of p; of others perhaps not.
        if (!boxes[o.polygon_of(e)].contains(p)) return;
        if (grid::crossing_side(o.at(e), o.at(o.after(e)), p) < 0)
          crossed.push_back(o.polygon_of(e));
      });
      std::sort(crossed.begin(), crossed.end());
      for (std::size_t i = 0; i < crossed.size();) {
        std::size_t j = i;
        while (j < crossed.size() && crossed[j] == crossed[i]) ++j;
        if ((j - i) % 2 == 1) local.join(o.polygon[ring], crossed[i]);
        i = j;
      }
    }
  };
  join_in_chunks(o.first.size(), polygons.size(), sets, join);
}

}  // namespace

std::vector<std::int32_t> cluster_polygons(std::span<const Polygon> polygons, double distance) {
  const Outline o = outline_for(pointers_to(polygons), distance);
  PolygonSets sets(polygons.size());
  NearEdges(o, distance, polygons.size()).join(sets);
  join_contained(o, polygons, sets);
  std::vector<std::int32_t> cluster(polygons.size());
  std::int32_t count = 0;
  for (const OutlinePolygon i : indices<OutlinePolygon>(polygons.size())) {
    const OutlinePolygon root = sets.root(i);
    cluster[i] = root == i ? count++ : cluster[root];
  }
  return cluster;
}

}  // namespace tetropolis
