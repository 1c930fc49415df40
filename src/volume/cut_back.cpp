#include "tetropolis/volume/cut_back.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/sort_once.h"
#include "rising.h"

namespace tetropolis {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

CutSources cut_back(const GroundMesh& mesh, std::span<const BuildingIndex> building,
                    std::span<const double> roofs, const CutMarks& marks, const CutSlopes& slopes,
                    std::vector<double>& ground) {
  constexpr double kWorthwhile = 1e-6;                   // metres
  std::vector<double> start(ground.size(), kInfinity);   // of slopes: where marked, or cut already
  std::vector<std::int32_t> changed(ground.size(), -1);  // in which sweep, last
  std::vector<std::uint8_t> is_source(ground.size(), 0), has_lowered(ground.size(), 0);
  const auto at_marked_roof = [&](std::size_t v) {
    return building[v] != kNoBuilding && !marks.roofs.empty() &&
           marks.roofs[static_cast<std::size_t>(building[v])] != 0;
  };
  const auto is_foot = [&](std::size_t v) {
    return !marks.feet.empty() && marks.feet[v] < kInfinity;
  };
  for (std::size_t v = 0; v < start.size(); ++v) {
    if (at_marked_roof(v)) start[v] = roofs[static_cast<std::size_t>(building[v])];
    if (is_foot(v)) {
      if (marks.feet[v] < ground[v] - kWorthwhile) {
        has_lowered[v] = 1;
        ground[v] = marks.feet[v];
      }
      start[v] = std::min(start[v], ground[v]);
    }
    if (start[v] == kInfinity) continue;
    is_source[v] = 1;
    changed[v] = 0;
  }
  const double beyond = std::max(slopes.at_start, slopes.beyond);
  const auto lower = [&](std::size_t v, std::size_t a, std::size_t b) {
    const double slope = is_source[a] != 0 || is_source[b] != 0 ? slopes.at_start : beyond;
    const double most =
        highest_at(mesh.vertices[v], mesh.vertices[a], start[a], mesh.vertices[b], start[b], slope);
    if (!(most < ground[v] - kWorthwhile)) return false;
    ground[v] = most;
    start[v] = std::min(start[v], most);
    for (const std::size_t u : {a, b}) has_lowered[u] |= is_source[u];
    return true;
  };
  bool again = true;
  for (std::int32_t sweep = 1; again; ++sweep) {
    again = false;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto corner = [&](std::size_t k) {
        return static_cast<std::size_t>(mesh.triangles[t][k % 3]);
      };
      const auto is_recent = [&](std::size_t k) { return changed[corner(k)] >= sweep - 1; };
      if (mesh.region[t] != kNoBuilding || !(is_recent(0) || is_recent(1) || is_recent(2)))
        continue;
      for (std::size_t i = 0; i < 3; ++i) {
        if (!lower(corner(i), corner(i + 1), corner(i + 2))) continue;
        changed[corner(i)] = sweep;
        again = true;
      }
    }
  }
  CutSources sources;
  for (std::size_t v = 0; v < ground.size(); ++v) {
    if (has_lowered[v] == 0) continue;
    if (is_foot(v)) sources.feet.push_back({mesh.vertices[v].x, mesh.vertices[v].y, marks.feet[v]});
    if (at_marked_roof(v)) sources.roofs.push_back(building[v]);
  }
  sort_once(sources.roofs);
  return sources;
}

}  // namespace tetropolis
