#include "tetropolis/city/clean.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "city/simplify/overlay.h"
#include "city/simplify/repair.h"
#include "clean_ring.h"
#include "geometry/geos.h"
#include "geometry/predicates.h"
#include "grid_geometry.h"
#include "outline.h"

namespace tetropolis {

namespace {

/// Half the side of the squares that join parts which touch: 3 cm, so that what they add is less
/// than footprints are precise to, and more than what cleaning may take away again (2 cm).
constexpr double kBridge = 0.03 * grid::kSteps;

/// Crossings of edges above which rings are the outline of nothing. Tangles of real data have a
/// few; repairing a scribble takes minutes.
constexpr int kMostCrossings = 10000;

/// Whether edges cross more often than that.
bool is_scribble(const Polygon& polygon) {
  struct Edge {
    Point2 a, b;
    Bounds2 box = Bounds2::nothing();
  };
  std::vector<Edge> edges;
  for_each_edge(polygon, [&](Point2 a, Point2 b) {
    Edge& edge = edges.emplace_back(Edge{a, b});
    edge.box.extend(a);
    edge.box.extend(b);
  });
  std::sort(edges.begin(), edges.end(),
            [](const Edge& e, const Edge& f) { return e.box.xmin < f.box.xmin; });
  int crossings = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Edge& e = edges[i];
    for (std::size_t j = i + 1; j < edges.size() && edges[j].box.xmin <= e.box.xmax; ++j) {
      const Edge& f = edges[j];
      if (!e.box.intersects(f.box) || orient2d(e.a, e.b, f.a) * orient2d(e.a, e.b, f.b) >= 0 ||
          orient2d(f.a, f.b, e.a) * orient2d(f.a, f.b, e.b) >= 0)
        continue;
      if (++crossings > kMostCrossings) return true;
    }
  }
  return false;
}

const char* unusable_coordinate(const Polygon& polygon) {
  const char* reason = nullptr;
  for_each_ring(polygon, [&](const Ring& ring) {
    for (const Point2 p : ring) {
      if (!std::isfinite(p.x) || !std::isfinite(p.y))
        reason = "non-finite coordinate";
      else if (reason == nullptr &&
               !(std::abs(p.x) <= grid::kMaxCoordinate && std::abs(p.y) <= grid::kMaxCoordinate))
        reason = "coordinate beyond 1e9 m";
    }
  });
  return reason;
}

void orient(Ring& ring, bool counter_clockwise) {
  // The first vertex stays first.
  if ((signed_area(ring) > 0) != counter_clockwise && !ring.empty())
    std::reverse(ring.begin() + 1, ring.end());
}

/// Without duplicates and spikes, oriented; holes that vanish are left out.
Polygon without_duplicates(const Polygon& polygon) {
  Polygon result{without_duplicates(polygon.outer), {}};
  orient(result.outer, true);
  for (const Ring& hole : polygon.holes) {
    Ring ring = without_duplicates(hole);
    if (ring.size() < 3) continue;
    orient(ring, false);
    result.holes.push_back(std::move(ring));
  }
  return result;
}

Polygon without_parallels(const Polygon& polygon, double tolerance) {
  Polygon result{without_parallels(polygon.outer, tolerance), {}};
  for (const Ring& hole : polygon.holes) result.holes.push_back(without_parallels(hole, tolerance));
  return result;
}

bool valid(const Polygon& steps) {
  const std::vector<Polygon> one{grid::to_metres(steps)};
  return steps.outer.size() >= 3 && footprint_defects(one, 1).empty();
}

/// Squares over the places where rings touch.
std::vector<Polygon> bridges(const std::vector<Polygon>& parts) {
  const Outline outline = make_outline(pointers_to(parts), 4 * kBridge);
  std::vector<Polygon> squares;
  for (const NearPair& pair : near_pairs(outline, 2)) {
    const Point2 p = outline.at(pair.vertex);
    squares.push_back({{{p.x - kBridge, p.y - kBridge},
                        {p.x + kBridge, p.y - kBridge},
                        {p.x + kBridge, p.y + kBridge},
                        {p.x - kBridge, p.y + kBridge}},
                       {}});
  }
  return squares;
}

/// Without the holes that touch a ring: what is left between walls drawn twice are holes of no
/// width that a bridge cannot close, it only moves their end.
void fill_touching_holes(std::vector<Polygon>& parts) {
  const Outline outline = make_outline(pointers_to(parts), 4 * kBridge);
  std::vector<std::uint8_t> touching(outline.first.size(), 0);
  for (const NearPair& pair : near_pairs(outline, 2))
    for (const OutlineVertex at : {pair.vertex, pair.edge}) touching[outline.ring_of(at)] = 1;
  std::size_t ring = 0;
  for (Polygon& part : parts) {
    ++ring;  // the outer one
    std::vector<Ring> kept;
    for (Ring& hole : part.holes)
      if (touching[ring++] == 0) kept.push_back(std::move(hole));
    part.holes = std::move(kept);
  }
}

/// The largest part; adds the area of the others to `lost`.
Polygon kept_part(const std::vector<Polygon>& parts, double& lost) {
  const Polygon& kept = largest(parts);
  lost += total_area(parts) - area(kept);
  return kept;
}

struct Repaired {
  Polygon polygon;
  double lost = 0;  ///< Area of the parts that were given up.
};

/// A valid polygon from invalid rings (steps), or nothing.
std::optional<Repaired> repaired(const Polygon& polygon) {
  const geos::Result made = geos::make_valid(polygon);
  if (!made || made->empty()) return std::nullopt;
  std::vector<Polygon> parts = unite_on_grid(*made);
  double lost = 0;
  // Bridges may touch what is beside them, which takes others; then holes that touch are filled,
  // and at last one part stands for all.
  constexpr int kAttempts = 5, kWithHolesFilled = 2;
  for (int attempt = 0; attempt < kAttempts && !parts.empty(); ++attempt) {
    if (attempt >= kWithHolesFilled) fill_touching_holes(parts);
    if (attempt == kAttempts - 1) parts = {kept_part(parts, lost)};
    const std::vector<Polygon> squares = bridges(parts);
    if (squares.empty()) {
      double others = lost;
      Polygon result = without_duplicates(kept_part(parts, others));
      if (valid(result)) return Repaired{std::move(result), others};
    }
    parts.insert(parts.end(), squares.begin(), squares.end());
    parts = unite_on_grid(parts);
  }
  if (parts.empty()) return std::nullopt;
  Polygon shell = without_duplicates(Polygon{kept_part(parts, lost).outer, {}});
  if (!valid(shell)) return std::nullopt;
  return Repaired{std::move(shell), lost};
}

CleanedFootprint unusable(std::string reason) {
  CleanedFootprint result;
  result.reason = std::move(reason);
  return result;
}

/// Without the holes that leave nothing of the shell each by itself; without any if there are none
/// of these.
Polygon without_equal_holes(const Polygon& raw) {
  Polygon rest{raw.outer, {}};
  const auto leaves_nothing = [&](const Ring& hole) {
    try {
      return !repaired(without_duplicates(grid::to_steps(Polygon{raw.outer, {hole}})));
    } catch (const Error&) {
      return true;
    }
  };
  for (const Ring& hole : raw.holes)
    if (!leaves_nothing(hole)) rest.holes.push_back(hole);
  if (rest.holes.size() == raw.holes.size()) rest.holes.clear();
  return rest;
}

}  // namespace

CleanedFootprint clean_footprint(const Polygon& raw, const CleanOptions& options) {
  if (const char* reason = unusable_coordinate(raw)) return unusable(reason);
  CleanedFootprint result;
  Polygon steps = without_duplicates(grid::to_steps(raw));
  if (steps.outer.size() < 3)
    return unusable(distinct_vertices(raw.outer) < 3 ? "fewer than 3 distinct vertices"
                                                     : "zero area");
  if (!valid(steps)) {
    if (is_scribble(steps))
      return unusable(fmt::format("outline crosses itself more than {} times", kMostCrossings));
    std::optional<Repaired> better;
    try {
      better = repaired(steps);
    } catch (const Error&) {  // GEOS could not unite the parts
    }
    // Holes that leave nothing of their shell are a mistake of the file, not a building of air.
    if (!better && !raw.holes.empty()) {
      CleanedFootprint shell = clean_footprint(without_equal_holes(raw), options);
      shell.repaired = shell.usable();
      return shell;
    }
    if (!better) return unusable("outline cannot be repaired: zero area or too tangled");
    steps = std::move(better->polygon);
    result.repaired = true;
    result.lost_area = better->lost / grid::kSquareMetre;
  }
  Polygon simple = without_duplicates(without_parallels(steps, options.parallel_tolerance));
  if (simple.holes.size() != steps.holes.size() || !valid(simple)) simple = std::move(steps);
  result.polygon = grid::to_metres(simple);
  return result;
}

}  // namespace tetropolis
