#include "clean_ring.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <queue>
#include <tuple>
#include <vector>

#include "tetropolis/city/clean.h"

#include "core/infinity.h"
#include "grid_geometry.h"

namespace tetropolis {

namespace {

constexpr double kSame = kNearDuplicate * grid::kSteps;
constexpr double kMaxHeight = 0.02 * grid::kSteps;
/// Vertices within half a millimetre of the line are there by rounding, whatever their angle.
constexpr double kRoundingOfBase = 0.0005 * grid::kSteps;
constexpr double kMaxDrift = kMaxOutlineShift * grid::kSteps;

/// Whether the outline a, b, c goes to b and straight back.
bool is_spike(Point2 a, Point2 b, Point2 c) {
  if (grid::dot(b, a, c) <= 0) return false;
  return std::min(grid::point_segment_distance(a, b, c), grid::point_segment_distance(c, b, a)) < 1;
}

}  // namespace

std::size_t distinct_vertices(const Ring& ring) {
  Ring found;
  for (const Point2 p : ring) {
    if (std::find(found.begin(), found.end(), p) != found.end()) continue;
    found.push_back(p);
    if (found.size() == 3) break;
  }
  return found.size();
}

Ring without_duplicates(const Ring& ring) {
  Ring result;
  result.reserve(ring.size());
  // A stack: whatever a spike's removal brings together is compared again.
  const auto settle = [&] {
    for (;;) {
      const std::size_t n = result.size();
      if (n >= 2 && grid::distance(result[n - 2], result[n - 1]) < kSame) {
        result.pop_back();
      } else if (n >= 3 && is_spike(result[n - 3], result[n - 2], result[n - 1])) {
        result.erase(result.end() - 2);
      } else {
        return;
      }
    }
  };
  for (const Point2 p : ring) {
    result.push_back(p);
    settle();
  }
  // The same across the seam.
  std::size_t begin = 0;
  for (bool again = true; again && result.size() - begin >= 3;) {
    const std::size_t n = result.size();
    again = true;
    if (grid::distance(result[n - 1], result[begin]) < kSame ||
        is_spike(result[n - 2], result[n - 1], result[begin]))
      result.pop_back();
    else if (is_spike(result[n - 1], result[begin], result[begin + 1]))
      ++begin;
    else
      again = false;
  }
  result.erase(result.begin(), result.begin() + static_cast<std::ptrdiff_t>(begin));
  if (result.size() < 3) result.clear();
  return result;
}

Ring without_parallels(const Ring& ring, double tolerance) {
  struct Entry {
    double height;
    std::size_t vertex;
    std::uint32_t version;
    bool operator<(const Entry& other) const {
      return std::tie(other.height, other.vertex) < std::tie(height, vertex);
    }
  };
  const std::size_t n = ring.size();
  const double slope = std::tan(tolerance);
  std::vector<std::size_t> next(n), prev(n);
  std::vector<double> drift(n, 0);  // of what the edge that starts here has replaced, at most
  std::vector<std::uint32_t> version(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    next[i] = (i + 1) % n;
    prev[i] = (i + n - 1) % n;
  }
  const auto height = [&](std::size_t i) {
    const Point2 u = ring[prev[i]], p = ring[i], w = ring[next[i]];
    const double twice = grid::twice_area(u, p, w), base = grid::distance(u, w);
    const double along = (p.x - u.x) * (w.x - p.x) + (p.y - u.y) * (w.y - p.y);
    if (along <= 0 || twice > kMaxHeight * base) return kInfinity;
    if (twice > slope * along && twice > kRoundingOfBase * base) return kInfinity;
    const double h = twice / base;
    return h + std::max(drift[prev[i]], drift[i]) <= kMaxDrift ? h : kInfinity;
  };
  std::priority_queue<Entry> queue;
  const auto add = [&](std::size_t i) {
    const double h = height(i);
    ++version[i];
    if (h < kInfinity) queue.push({h, i, version[i]});
  };
  for (std::size_t i = 0; i < n; ++i) add(i);
  std::vector<std::uint8_t> gone(n, 0);
  std::size_t left = n;
  while (!queue.empty() && left > 3) {
    const Entry top = queue.top();
    queue.pop();
    const std::size_t i = top.vertex;
    if (gone[i] != 0 || version[i] != top.version) continue;
    gone[i] = 1;
    --left;
    const std::size_t u = prev[i], w = next[i];
    drift[u] = std::max(drift[u], drift[i]) + top.height;
    next[u] = w;
    prev[w] = u;
    add(u);
    add(w);
  }
  Ring result;
  for (std::size_t i = 0; i < n; ++i)
    if (gone[i] == 0) result.push_back(ring[i]);
  return result;
}

}  // namespace tetropolis
