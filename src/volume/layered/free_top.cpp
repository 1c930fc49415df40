#include "free_top.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include "core/parallel.h"

namespace tetropolis {

namespace {

class SlopeLimit {
 public:
  SlopeLimit(const GroundMesh& mesh, const EdgeGraph& edges, double slope, std::vector<double>& top)
      : mesh_(mesh), edges_(edges), slope_(slope), top_(top) {}

  /// By edges between the vertices [begin, end): an algorithm of Dijkstra's, highest first.
  /// Precondition: within runs of `settled` vertices none asks for more.
  void raise(std::size_t begin, std::size_t end, std::size_t settled) {
    std::vector<std::pair<double, VertexIndex>> steep;
    for (const VertexIndex a : indices<VertexIndex>(begin, end))
      for (EdgeIndex e = edges_.starts[a + 1]; e > edges_.starts[a];) {
        e = e - 1;
        const VertexIndex b = edges_.vertices[e][1];
        if (b >= end) continue;
        if (std::size_t{b} / settled == std::size_t{a} / settled) break;  // nor do those before
        if (least_beside(a, b) > top_[b]) steep.emplace_back(top_[a], a);
        if (least_beside(b, a) > top_[a]) steep.emplace_back(top_[b], b);
      }
    std::priority_queue highest(std::less<>{}, std::move(steep));
    while (!highest.empty()) {
      const auto [height, v] = highest.top();
      highest.pop();
      if (height < top_[v]) continue;  // raised since
      const auto raise_beside = [&, from = v](VertexIndex beside) {
        if (beside < begin || beside >= end) return;
        const double least = least_beside(from, beside);
        if (!(least > top_[beside])) return;
        top_[beside] = least;
        highest.emplace(least, beside);
      };
      for (const EdgeIndex e : edges_.starting_at(v)) raise_beside(edges_.vertices[e][1]);
      for (const EdgeIndex e : edges_.ends[v]) raise_beside(edges_.vertices[e][0]);
    }
  }

 private:
  /// The elevation that a asks of b, or what b has.
  double least_beside(VertexIndex a, VertexIndex b) const {
    const double drop = top_[a] - top_[b];
    if (!(drop > 0)) return top_[b];
    const Point2 p = mesh_.vertices[a], q = mesh_.vertices[b];
    const double dx = q.x - p.x, dy = q.y - p.y;
    // Most edges are far from steep: no root for those.
    if (drop * drop < 0.99 * slope_ * slope_ * (dx * dx + dy * dy)) return top_[b];
    return std::max(top_[a] - slope_ * std::sqrt(dx * dx + dy * dy), top_[b]);
  }

  const GroundMesh& mesh_;
  const EdgeGraph& edges_;
  double slope_;
  std::vector<double>& top_;
};

}  // namespace

void limit_slope(const GroundMesh& mesh, const EdgeGraph& edges, double slope,
                 std::vector<double>& top) {
  // What no edge of a part asks for is asked for by few of all. Sums along paths are the same in
  // whatever order, and so are the greatest.
  constexpr std::size_t kParts = 16;
  SlopeLimit limit(mesh, edges, slope, top);
  const std::size_t grain = std::max<std::size_t>(grain_of_chunks(top.size(), kParts), 1);
  parallel_chunks(top.size(), grain,
                  [&](std::size_t begin, std::size_t end) { limit.raise(begin, end, 1); });
  limit.raise(0, top.size(), grain);
}

}  // namespace tetropolis
