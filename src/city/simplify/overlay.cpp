#include "overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "city/clean_ring.h"
#include "city/footprint_index.h"
#include "city/grid_geometry.h"
#include "city/outline.h"
#include "cluster_polygons.h"
#include "core/parallel.h"
#include "core/sort_once.h"
#include "geometry/geos.h"

namespace tetropolis {

namespace {

using geos::comes_before;

/// Whether polygons on the grid are valid and disjoint but for points at which they may touch.
bool are_valid(std::span<const Polygon> polygons) {
  // Whether edges touch at all is decided much faster than whether they may.
  std::vector<Polygon> metres;
  for (const Polygon& polygon : polygons) metres.push_back(grid::to_metres(polygon));
  return footprint_defects(metres, 1).empty() || geos::is_valid(polygons);
}

/// Rounds to the grid. Slivers narrower than a step, which walls that meet up to rounding leave, go
/// flat and away. False if what is left is not valid.
bool round_to_grid(std::vector<Polygon>& polygons) {
  bool exact = true;
  const auto round = [&](Ring& ring) {
    for (Point2& p : ring) {
      const Point2 q = grid::rounded(p);
      exact = exact && p == q;
      p = q;
    }
    const std::size_t before = ring.size();
    ring = without_duplicates(ring);
    exact = exact && ring.size() == before;
  };
  for (Polygon& polygon : polygons) {
    for_each_ring(polygon, round);
    std::erase_if(polygon.holes, [](const Ring& hole) { return hole.empty(); });
  }
  std::erase_if(polygons, [](const Polygon& polygon) { return polygon.outer.empty(); });
  return exact || are_valid(polygons);
}

[[noreturn]] void give_up(std::span<const Polygon> polygons) {
  const Point2 corner = polygons.empty() ? Point2{} : grid::to_metres(polygons[0].outer[0]);
  throw Error(ErrorKind::kGuarantee,
              fmt::format("footprints: GEOS cannot overlay those at ({:.2f}, {:.2f}) from the "
                          "origin; change min_building_distance or leave them out, and report it",
                          corner.x, corner.y));
}

bool is_on_grid(std::span<const Polygon> polygons) {
  bool all = true;
  for (const Polygon& polygon : polygons)
    for_each_edge(polygon, [&](Point2 a, Point2) { all = all && a == grid::rounded(a); });
  return all;
}

/// A result, rounded to the grid and without slivers; where that is not valid, with them, or noded
/// on the grid, which is much less work than the operation.
geos::Result rounded(const geos::Result& result) {
  if (!result) return std::nullopt;
  std::vector<Polygon> polygons = *result;
  if (round_to_grid(polygons)) return polygons;
  if (is_on_grid(*result) && are_valid(*result)) return result;
  return geos::unite(*result, 1.0);
}

/// The first of two results if GEOS has one, else the second, as second() gives it. `polygons` are
/// some of the operands.
template <typename Second>
std::vector<Polygon> or_else(std::span<const Polygon> polygons, geos::Result first,
                             const Second& second) {
  if (!first) first = second();
  if (!first) give_up(polygons);
  return std::move(*first);
}

constexpr std::size_t kFewPolygons = 256;

constexpr double kOverlayMargin = 2;  // steps, beyond any rounding

/// Boxes in the order of their left sides, to be asked which of them meet another.
class Boxes {
 public:
  explicit Boxes(std::vector<Bounds2> boxes) {
    for (std::size_t i = 0; i < boxes.size(); ++i)
      boxes_.emplace_back(boxes[i].grown(kOverlayMargin), i);
    std::sort(boxes_.begin(), boxes_.end(),
              [](const auto& a, const auto& b) { return a.first.xmin < b.first.xmin; });
    for (const auto& [box, i] : boxes_) widest_ = std::max(widest_, box.width());
  }
  /// The numbers of those that meet `box`, up to a margin, ascending.
  std::vector<std::size_t> meeting(const Bounds2& box) const {
    std::vector<std::size_t> found;
    visit(box, [&](std::size_t i) {
      found.push_back(i);
      return true;
    });
    std::sort(found.begin(), found.end());
    return found;
  }
  bool any_meets(const Bounds2& box) const {
    return !visit(box, [](std::size_t) { return false; });
  }

 private:
  template <typename Visit>
  bool visit(const Bounds2& box, const Visit& visit) const {
    auto it = std::lower_bound(boxes_.begin(), boxes_.end(), box.xmin - widest_,
                               [](const auto& entry, double x) { return entry.first.xmin < x; });
    for (; it != boxes_.end() && it->first.xmin <= box.xmax; ++it)
      if (it->first.intersects(box) && !visit(it->second)) return false;
    return true;
  }

  std::vector<std::pair<Bounds2, std::size_t>> boxes_;
  double widest_ = 0;
};

Boxes boxes_of(std::span<const Polygon> polygons) {
  std::vector<Bounds2> boxes;
  for (const Polygon& polygon : polygons) boxes.push_back(bounds(polygon));
  return Boxes(std::move(boxes));
}

/// The polygon of a union that covers `p`, or none.
Polygon* covering(std::vector<Polygon>& polygons, Point2 p) {
  for (Polygon& polygon : polygons)
    if (bounds(polygon).contains(p) && contains(polygon, p)) return &polygon;
  return nullptr;
}

/// What one list of an overlay has where nothing of the other one is: polygons, and holes in
/// others. The overlay would only carry them along, and in a dense city they are nearly all there
/// is; so they are taken out before and given back after it.
class Untouched {
 public:
  /// Takes them out of `polygons`.
  Untouched(std::vector<Polygon>& polygons, const Boxes& others) {
    const auto clear = std::stable_partition(
        polygons.begin(), polygons.end(),
        [&](const Polygon& polygon) { return others.any_meets(bounds(polygon)); });
    polygons_.assign(std::make_move_iterator(clear), std::make_move_iterator(polygons.end()));
    polygons.erase(clear, polygons.end());
    // What stands in such a hole is a bystander itself and gone by now.
    for (Polygon& polygon : polygons) {
      std::vector<Ring>& holes = polygon.holes;
      const auto rest = std::stable_partition(holes.begin(), holes.end(), [&](const Ring& hole) {
        return others.any_meets(bounds(hole));
      });
      if (rest == holes.end()) continue;
      const auto smaller = [](const Ring& a, const Ring& b) {
        return std::abs(signed_area(a)) < std::abs(signed_area(b));
      };
      const Point2 inside = interior_point({*std::max_element(rest, holes.end(), smaller), {}});
      holes_.push_back(
          {inside, {std::make_move_iterator(rest), std::make_move_iterator(holes.end())}});
      holes.erase(rest, holes.end());
    }
  }

  /// False if there is nothing to give holes back to: GEOS has lost it.
  bool give_back(std::vector<Polygon>& result) {
    for (Holes& group : holes_) {
      Polygon* owner = covering(result, group.inside);
      if (owner == nullptr) return false;
      std::vector<Ring>& holes = owner->holes;
      holes.insert(holes.end(), std::make_move_iterator(group.rings.begin()),
                   std::make_move_iterator(group.rings.end()));
      std::sort(holes.begin(), holes.end(), comes_before);
    }
    give_back_polygons(result);
    return true;
  }

  /// The same for polygons that may have fallen into parts.
  bool give_back_to_parts(std::vector<Polygon>& result) {
    std::vector<std::pair<Bounds2, Polygon*>> parts;
    for (Polygon& polygon : result) parts.emplace_back(bounds(polygon), &polygon);
    std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) {
      return a.first.width() * a.first.height() < b.first.width() * b.first.height();
    });
    // The largest part comes last, when no other one has the hole: it is asked once only.
    bool largest_is_owner = false;
    for (Holes& group : holes_) {
      for (Ring& hole : group.rings) {
        const Bounds2 box = bounds(hole);
        const auto owns = [&](const auto& part) {
          if (!part.first.covers(box)) return false;
          const bool last = part.second == parts.back().second;
          if (last && largest_is_owner) return true;
          if (!contains(*part.second, interior_point({hole, {}}))) return false;
          largest_is_owner = largest_is_owner || last;
          return true;
        };
        const auto owner = std::find_if(parts.begin(), parts.end(), owns);
        if (owner == parts.end()) return false;
        owner->second->holes.push_back(std::move(hole));
      }
    }
    for (Polygon& polygon : result)
      std::sort(polygon.holes.begin(), polygon.holes.end(), comes_before);
    give_back_polygons(result);
    return true;
  }

 private:
  void give_back_polygons(std::vector<Polygon>& result) {
    result.insert(result.end(), std::make_move_iterator(polygons_.begin()),
                  std::make_move_iterator(polygons_.end()));
  }

  struct Holes {
    Point2 inside;  ///< Of one of them.
    std::vector<Ring> rings;
  };
  std::vector<Polygon> polygons_;
  std::vector<Holes> holes_;
};

/// By their first vertices, which are the lowest in what comes from GEOS.
void sort_polygons(std::vector<Polygon>& polygons) {
  std::sort(polygons.begin(), polygons.end(),
            [](const Polygon& p, const Polygon& q) { return comes_before(p.outer, q.outer); });
}

/// Union of two lists of polygons with disjoint interiors. To be checked: edges that are cut are
/// bent, by less than a step but as a whole, and may meet what had been taken out.
geos::Result join(std::vector<Polygon> a, std::vector<Polygon> b) {
  const Boxes boxes_a = boxes_of(a), boxes_b = boxes_of(b);
  Untouched of_a(a, boxes_b), of_b(b, boxes_a);
  geos::Result result = geos::join(a, b, 1.0);
  if (!result || !of_a.give_back(*result) || !of_b.give_back(*result)) return std::nullopt;
  sort_polygons(*result);
  return result;
}

/// `a`, which are such polygons, less `b`. To be checked as well.
geos::Result subtract(std::vector<Polygon> a, std::span<const Polygon> b) {
  Untouched of_a(a, boxes_of(b));
  geos::Result result = geos::subtract(a, b, 1.0);
  if (!result || !of_a.give_back_to_parts(*result)) return std::nullopt;
  sort_polygons(*result);
  return result;
}

/// The result if it is valid, else second().
template <typename Second>
geos::Result checked(geos::Result result, const Second& second) {
  return result && are_valid(*result) ? std::move(result) : second();
}

/// Gap fills, to be asked which of them meet a hole. Boxes of long slanted ones meet nearly all
/// others.
class FillFinder {
 public:
  explicit FillFinder(std::span<const Polygon> fills)
      : fills_(fills),
        boxes_(boxes_of(fills)),
        outline_(outline_for(pointers_to(fills), kOverlayMargin)) {}

  /// Those that meet the hole, up to a margin, or stand within it, or it within them; in order.
  std::vector<Polygon> meeting(const Ring& hole) const {
    const Bounds2 box = bounds(hole);
    std::vector<std::size_t> found;
    for (std::size_t k = 0; k < hole.size(); ++k) {
      const Point2 a = hole[k], b = hole[(k + 1) % hole.size()];
      outline_.grid.visit_cells_near(a, b, kOverlayMargin, [&](std::size_t cell) {
        outline_.grid.visit_cell(cell, [&](OutlineVertex e) {
          if (grid::are_near(a, b, outline_.at(e), outline_.at(outline_.after(e)), kOverlayMargin))
            found.push_back(outline_.polygon_of(e));
        });
      });
    }
    for (const std::size_t i : boxes_.meeting(box)) {
      const Bounds2 other = bounds(fills_[i]);
      if ((box.covers(other) && grid::is_inside(hole, fills_[i].outer[0])) ||
          (other.covers(box) && contains(fills_[i], hole[0])))
        found.push_back(i);
    }
    sort_once(found);
    std::vector<Polygon> meeting;
    for (const std::size_t i : found) meeting.push_back(fills_[i]);
    return meeting;
  }

 private:
  std::span<const Polygon> fills_;
  Boxes boxes_;
  Outline outline_;
};

/// What `fills` leave of the holes of `whole`: hole by hole, at the same time. None where GEOS
/// gives up, or where a fill stands free in a hole.
std::optional<std::vector<Ring>> holes_left(const Polygon& whole, std::span<const Polygon> fills) {
  const FillFinder finder(fills);
  std::vector<std::vector<Ring>> left(whole.holes.size());
  std::vector<char> simple(whole.holes.size(), 1);
  parallel_chunks(whole.holes.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t h = begin; h < end; ++h) {
      const Ring& hole = whole.holes[h];
      const std::vector<Polygon> near = finder.meeting(hole);
      if (near.empty()) {
        left[h] = {hole};
        continue;
      }
      const Polygon open{{hole.rbegin(), hole.rend()}, {}};
      const geos::Result rest = geos::subtract({&open, 1}, near, 1.0);
      simple[h] = rest && std::all_of(rest->begin(), rest->end(),
                                      [](const Polygon& part) { return part.holes.empty(); });
      if (simple[h] == 0) continue;
      for (const Polygon& part : *rest) {
        // Clockwise, from the same vertex on.
        Ring ring(part.outer.rbegin(), part.outer.rend());
        std::rotate(ring.begin(), ring.end() - 1, ring.end());
        left[h].push_back(std::move(ring));
      }
    }
  });
  if (std::find(simple.begin(), simple.end(), 0) != simple.end()) return std::nullopt;
  std::vector<Ring> holes;
  for (std::vector<Ring>& rings : left)
    holes.insert(holes.end(), std::make_move_iterator(rings.begin()),
                 std::make_move_iterator(rings.end()));
  return holes;
}

/// The fills that are not wholly within `shell`, a polygon without holes.
std::vector<Polygon> fills_at(const Polygon& shell, std::span<const Polygon> fills) {
  std::vector<Bounds2> edges;
  for_each_edge(shell, [&](Point2 a, Point2 b) { edges.push_back(grid::box_of(a, b)); });
  const Boxes boxes(std::move(edges));
  const Polygon* const shells[] = {&shell};
  const FootprintIndex index(shells, 0);
  const auto is_inside = [&](Point2 p) {
    bool inside = false;
    index.at(p, [&](BuildingIndex, bool found) { inside = found; });
    return inside;
  };
  std::vector<Polygon> at;
  for (const Polygon& fill : fills)
    if (boxes.any_meets(bounds(fill)) || !is_inside(fill.outer[0])) at.push_back(fill);
  return at;
}

constexpr std::size_t kManyHoles = 32;

/// Union of one polygon with many holes, and fills, of which `united` is the union: the holes
/// less the fills (as they were given: united they may be one polygon, which every hole would
/// meet), and the outer ring with what of the union leaves it.
geos::Result join_with_fills(const Polygon& whole, std::span<const Polygon> fills,
                             std::span<const Polygon> united) {
  if (whole.holes.size() < kManyHoles) return std::nullopt;
  std::optional<std::vector<Ring>> holes = holes_left(whole, fills);
  if (!holes) return std::nullopt;
  const Polygon shell{whole.outer, {}};
  geos::Result result = join({shell}, fills_at(shell, united));
  if (!result) return std::nullopt;
  Polygon* owner = covering(*result, interior_point({whole.holes[0], {}}));
  if (owner == nullptr) return std::nullopt;
  owner->holes.insert(owner->holes.end(), std::make_move_iterator(holes->begin()),
                      std::make_move_iterator(holes->end()));
  std::sort(owner->holes.begin(), owner->holes.end(), comes_before);
  return result;
}

/// Union in floating point: of many polygons by halves of the plane, at the same time.
geos::Result unite_halves(std::vector<Polygon> polygons, const Bounds2& box, const Poll& poll) {
  if (poll) poll();
  if (polygons.size() <= kFewPolygons) return geos::unite(polygons, 0);
  const bool wide = box.width() > box.height();
  const auto key = [&](const Polygon& polygon) {
    const Bounds2 b = bounds(polygon);
    return wide ? b.xmin + b.xmax : b.ymin + b.ymax;
  };
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < polygons.size(); ++i) order.emplace_back(key(polygons[i]), i);
  const auto half = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
  std::nth_element(order.begin(), half, order.end());
  const double cut = half->first / 2;
  std::array<std::vector<Polygon>, 2> halves;
  for (auto it = order.begin(); it != order.end(); ++it)
    halves[it < half ? 0 : 1].push_back(std::move(polygons[it->second]));
  std::array<Bounds2, 2> boxes{box, box};
  (wide ? boxes[0].xmax : boxes[0].ymax) = cut;
  (wide ? boxes[1].xmin : boxes[1].ymin) = cut;
  std::array<geos::Result, 2> united;
  parallel_chunks(2, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t h = begin; h < end; ++h)
      united[h] = unite_halves(std::move(halves[h]), boxes[h], poll);
  });
  if (!united[0] || !united[1]) return std::nullopt;
  if (poll) poll();
  return join(std::move(*united[0]), std::move(*united[1]));
}

/// As GEOS returns rings: from the lowest, then leftmost vertex on.
void start_at_lowest(Ring& ring) {
  std::rotate(
      ring.begin(),
      std::min_element(ring.begin(), ring.end(),
                       [](Point2 a, Point2 b) { return a.y < b.y || (a.y == b.y && a.x < b.x); }),
      ring.end());
}

/// Moves what is apart from all others of many polygons to `apart`, as a union would return it.
/// GEOS compares all walls whose boxes meet, and boxes of rings around each other all do.
void take_out_apart(std::vector<Polygon>& polygons, std::vector<Polygon>& apart) {
  const std::vector<std::int32_t> cluster = cluster_polygons(polygons, kOverlayMargin);
  std::vector<std::int32_t> size(polygons.size(), 0);
  for (const std::int32_t c : cluster) ++size[static_cast<std::size_t>(c)];
  std::size_t kept = 0;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    if (size[static_cast<std::size_t>(cluster[i])] > 1) {
      if (kept != i) polygons[kept] = std::move(polygons[i]);
      ++kept;
      continue;
    }
    Polygon& polygon = apart.emplace_back(std::move(polygons[i]));
    for_each_ring(polygon, start_at_lowest);
    std::sort(polygon.holes.begin(), polygon.holes.end(), comes_before);
  }
  polygons.resize(kept);
}

}  // namespace

std::vector<Polygon> unite_on_grid(std::span<const Polygon> polygons, const Poll& poll) {
  std::vector<Polygon> together(polygons.begin(), polygons.end()), apart;
  if (polygons.size() > kFewPolygons) take_out_apart(together, apart);
  const Bounds2 box = grid::box_around(together);
  geos::Result united = unite_halves(std::move(together), box, poll);
  if (united && !apart.empty()) {
    united->insert(united->end(), std::make_move_iterator(apart.begin()),
                   std::make_move_iterator(apart.end()));
    sort_polygons(*united);
  }
  if (united) united = rounded(united);
  const auto on_grid = [&] { return geos::unite(polygons, 1.0); };
  if (polygons.size() > kFewPolygons) united = checked(std::move(united), on_grid);
  return or_else(polygons, std::move(united), on_grid);
}

std::vector<Polygon> unite_or_largest(std::span<const Polygon> polygons, const Poll& poll) {
  std::vector<Polygon> united = unite_on_grid(polygons, poll);
  if (united.empty() && !polygons.empty()) united = {largest(polygons)};
  return united;
}

std::vector<Polygon> add_on_grid(std::span<const Polygon> a, std::span<const Polygon> b) {
  const std::vector<Polygon> united = unite_on_grid(b);
  geos::Result sum = a.size() == 1 ? join_with_fills(a[0], b, united) : std::nullopt;
  if (!sum) sum = join({a.begin(), a.end()}, united);
  sum = checked(std::move(sum), [&] { return geos::join(a, united, 1.0); });
  return or_else(a, rounded(sum), [&] { return rounded(geos::join(a, united, 0)); });
}

std::vector<Polygon> subtract_on_grid(std::span<const Polygon> a, std::span<const Polygon> b) {
  const auto whole = [&] { return geos::subtract(a, b, 1.0); };
  return or_else(a, rounded(checked(subtract({a.begin(), a.end()}, b), whole)),
                 [&] { return rounded(geos::subtract(a, b, 0)); });
}

std::vector<Polygon> intersect_on_grid(std::span<const Polygon> a, std::span<const Polygon> b) {
  return or_else(a, rounded(geos::intersect(a, b, 1.0)),
                 [&] { return rounded(geos::intersect(a, b, 0)); });
}

}  // namespace tetropolis
