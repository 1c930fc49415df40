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
  const auto raise = [&](VertexIndex from, VertexIndex to) {
    const auto a = static_cast<std::size_t>(from), b = static_cast<std::size_t>(to);
    const Point2 p = mesh.vertices[a], q = mesh.vertices[b];
    const double least = top[a] - slope * std::hypot(q.x - p.x, q.y - p.y);
    if (!(least > top[b] + kNothing)) return;
    top[b] = least;
    highest.emplace(least, to);
  };
  for (const auto& [a, b] : edges.vertices) {
    raise(a, b);
    raise(b, a);
  }
  while (!highest.empty()) {
    const auto [height, v] = highest.top();
    highest.pop();
    const auto i = static_cast<std::size_t>(v);
    if (height < top[i]) continue;  // raised again since
    for (EdgeIndex e = edges.starts[i]; e < edges.starts[i + 1]; ++e)
      raise(v, edges.vertices[static_cast<std::size_t>(e)][1]);
    for (std::int32_t k = edges.end_offsets[i]; k < edges.end_offsets[i + 1]; ++k)
      raise(v,
            edges.vertices[static_cast<std::size_t>(edges.ends[static_cast<std::size_t>(k)])][0]);
  }
}

}  // namespace tetropolis
