#include "free_top.h"

#include <cmath>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

namespace tetropolis {

void limit_slope(const GroundMesh& mesh, const EdgeGraph& edges, double slope,
                 std::vector<double>& top) {
  constexpr double kNothing = 1e-6;  // metres
  const auto least_beside = [&](VertexIndex a, VertexIndex b) {
    const double drop = top[a] - top[b];
    if (!(drop > kNothing)) return top[b];
    const Point2 p = mesh.vertices[a], q = mesh.vertices[b];
    const double dx = q.x - p.x, dy = q.y - p.y;
    // Most edges are far from steep: no root for those.
    if (drop * drop < 0.99 * slope * slope * (dx * dx + dy * dy)) return top[b];
    const double least = top[a] - slope * std::sqrt(dx * dx + dy * dy);
    return least > top[b] + kNothing ? least : top[b];
  };
  // Highest first, so that each is raised but a few times.
  std::vector<std::pair<double, VertexIndex>> steep;
  for (const auto& [a, b] : edges.vertices) {
    if (least_beside(a, b) > top[b]) steep.emplace_back(top[a], a);
    if (least_beside(b, a) > top[a]) steep.emplace_back(top[b], b);
  }
  std::priority_queue highest(std::less<>{}, std::move(steep));
  while (!highest.empty()) {
    const auto [height, v] = highest.top();
    highest.pop();
    if (height < top[v]) continue;  // raised since
    const auto raise = [&, from = v](VertexIndex beside) {
      const double least = least_beside(from, beside);
      if (!(least > top[beside])) return;
      top[beside] = least;
      highest.emplace(least, beside);
    };
    for (const EdgeIndex e : edges.starting_at(v)) raise(edges.vertices[e][1]);
    for (const EdgeIndex e : edges.ends[v]) raise(edges.vertices[e][0]);
  }
}

}  // namespace tetropolis
