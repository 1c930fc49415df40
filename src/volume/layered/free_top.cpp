#include "free_top.h"

#include <cmath>
#include <cstddef>
#include <queue>
#include <utility>

namespace tetropolis {

void limit_slope(const GroundMesh& mesh, const EdgeGraph& edges, double slope,
                 std::vector<double>& top) {
  constexpr double kNothing = 1e-6;  // metres
  // Highest first, so that none is raised more often than it has neighbours.
  std::priority_queue<std::pair<double, VertexIndex>> highest;
  const auto raise = [&](VertexIndex a, VertexIndex b) {
    const Point2 p = mesh.vertices[a], q = mesh.vertices[b];
    const double least = top[a] - slope * std::hypot(q.x - p.x, q.y - p.y);
    if (!(least > top[b] + kNothing)) return;
    top[b] = least;
    highest.emplace(least, b);
  };
  for (const auto& [a, b] : edges.vertices) {
    raise(a, b);
    raise(b, a);
  }
  while (!highest.empty()) {
    const auto [height, v] = highest.top();
    highest.pop();
    if (height < top[v]) continue;  // raised again since
    for (const EdgeIndex e : edges.starting_at(v)) raise(v, edges.vertices[e][1]);
    for (const EdgeIndex e : edges.ends[v]) raise(v, edges.vertices[e][0]);
  }
}

}  // namespace tetropolis
