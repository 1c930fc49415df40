#include "close_gaps.h"

#include <cstddef>
#include <utility>

#include "tetropolis/geometry/polygon.h"

#include "city/edge_grid.h"
#include "city/grid_geometry.h"
#include "geometry/geos.h"

namespace tetropolis {

namespace {

constexpr double kOffsetRounding = 20;  // steps: how far offsets there and back may be off
constexpr double kOverlap = 5;

/// The walls of a polygon, to be asked which points are at them.
class Walls {
 public:
  explicit Walls(const Polygon& polygon) {
    for_each_edge(polygon, [&](Point2 a, Point2 b) { edges_.emplace_back(a, b); });
    double length = 0;
    for (const auto& [a, b] : edges_) length += grid::distance(a, b);
    const Bounds2 box = bounds(polygon);
    index_ = EdgeGrid(box, cell_size(box, length, edges_.size()), edges_.size());
    for (const LineIndex e : indices<LineIndex>(edges_.size()))
      index_.insert(e, edges_[e].first, edges_[e].second);
  }

  bool has(Point2 p) const {
    return index_.any(Bounds2{p.x, p.y, p.x, p.y}.grown(kOffsetRounding), [&](LineIndex e) {
      const Point2 q = grid::nearest_on_segment(p, edges_[e].first, edges_[e].second);
      return grid::distance(p, q) <= kOffsetRounding;
    });
  }

 private:
  std::vector<std::pair<Point2, Point2>> edges_;
  EdgeGrid index_;
};

/// In how many stretches the ring leaves the walls.
std::size_t mouths(const Ring& ring, const Walls& walls) {
  std::vector<bool> is_open;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2 a = ring[i], b = ring[(i + 1) % ring.size()];
    if (grid::distance(a, b) <= 2 * kOffsetRounding) continue;  // Its ends tell.
    is_open.push_back(!walls.has({(a.x + b.x) / 2, (a.y + b.y) / 2}));
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < is_open.size(); ++i)
    if (is_open[i] && !is_open[(i + 1) % is_open.size()]) ++count;
  return count;
}

}  // namespace

std::vector<Polygon> dead_end_fills(const Polygon& polygon, double width) {
  const std::vector<Polygon> whole{polygon};
  const auto offset = [](const geos::Result& polygons, double by) {
    return polygons ? geos::offset(*polygons, by) : std::nullopt;
  };
  const geos::Result closed = offset(geos::offset(whole, width / 2 - 1), 1 - width / 2);
  if (!closed) return {};
  // Without the films along walls that rounding leaves.
  const geos::Result gaps = offset(offset(geos::subtract(*closed, whole, 0), -kOffsetRounding),
                                   kOffsetRounding + kOverlap);
  if (!gaps || gaps->empty()) return {};
  const Walls walls(polygon);
  std::vector<Polygon> fills;
  for (const Polygon& gap : *gaps)
    if (gap.holes.empty() && mouths(gap.outer, walls) <= 1) fills.push_back(gap);
  return fills;
}

}  // namespace tetropolis
