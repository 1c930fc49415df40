#include "turned_rings.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"
#include "geometry/perimeter.h"

namespace tetropolis {

namespace {

/// Whether all vertices of `inner` are in `outer`, whose outline is larger, and not in its holes.
bool encloses(const Polygon& outer, const Ring& inner) {
  if (!(std::abs(signed_area(outer.outer)) > std::abs(signed_area(inner)))) return false;
  return bounds(outer).contains(inner.front()) &&
         std::all_of(inner.begin(), inner.end(), [&](Point2 p) { return contains(outer, p); });
}

/// A hole that encloses its shell becomes the shell, if `turns` is so of the two.
template <typename Turns>
void put_widest_ring_first(Polygon& polygon, const Turns& turns) {
  for (Ring& hole : polygon.holes)
    if (turns(polygon.outer, hole) && encloses({hole, {}}, polygon.outer))
      std::swap(hole, polygon.outer);
}

/// Whether all of `inner` lies within `outer`, and no hole of that within it. A part that fills a
/// hole to its rim does not: vertices on the rim may count as inside, its middle does not.
bool encloses(const Polygon& outer, const Polygon& inner) {
  const Polygon covered{inner.outer, {}};
  return encloses(outer, inner.outer) && contains(outer, interior_point(covered)) &&
         std::none_of(outer.holes.begin(), outer.holes.end(), [&](const Ring& hole) {
           return contains(covered, interior_point({hole, {}}));
         });
}

bool turns_left(const PolygonPart& part) { return signed_area(part.polygon.outer) > 0; }

/// Calls visit(j, candidates) for the usable parts from west to east; all parts whose box reaches
/// that of j are among the candidates. A city may be one multipolygon: each part is compared with
/// its neighbours only.
template <typename Visit>
void sweep(const std::vector<Bounds2>& boxes, const Visit& visit) {
  const auto west = [&](std::size_t i) { return boxes[i].xmin; };
  std::vector<std::size_t> order;
  for (std::size_t j = 0; j < boxes.size(); ++j)
    if (!boxes[j].empty()) order.push_back(j);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return west(i) < west(j); });
  std::vector<std::size_t> begun;
  std::size_t next = 0, most_begun = 64;
  for (const std::size_t j : order) {
    for (; next < order.size() && west(order[next]) <= west(j); ++next)
      begun.push_back(order[next]);
    if (begun.size() > most_begun) {
      std::erase_if(begun, [&](std::size_t i) { return boxes[i].xmax < west(j); });
      most_begun = std::max<std::size_t>(64, 2 * begun.size());
    }
    visit(j, begun);
  }
}

enum class Turns { kTell, kSayNothing };

/// For each part the one that it is a courtyard of, or parts.size(): the smallest that encloses it,
/// if that is turned against it, as far as turns tell, and the part is not itself in a courtyard of
/// that.
std::vector<std::size_t> find_courtyards(const std::vector<PolygonPart>& parts, Turns turns) {
  std::vector<Bounds2> boxes;
  for (const PolygonPart& part : parts)
    boxes.push_back(part.reason.empty() ? bounds(part.polygon.outer) : Bounds2::nothing());
  const std::size_t none = parts.size();
  std::vector<std::size_t> courtyard_of(parts.size(), none);
  sweep(boxes, [&](std::size_t j, const std::vector<std::size_t>& candidates) {
    std::size_t depth = 0;
    std::pair least{kInfinity, none};
    for (const std::size_t i : candidates) {
      if (!boxes[i].covers(boxes[j]) || !encloses(parts[i].polygon, parts[j].polygon)) continue;
      ++depth;
      least = std::min(least, {std::abs(signed_area(parts[i].polygon.outer)), i});
    }
    const std::size_t around = least.second;
    if (depth % 2 == 0) return;
    if (turns == Turns::kSayNothing || turns_left(parts[around]) != turns_left(parts[j]))
      courtyard_of[j] = around;
  });
  // Parts that overlap may make a courtyard of a courtyard, which nobody would find again: it stays
  // a part.
  const std::vector<std::size_t> found = courtyard_of;
  for (std::size_t& around : courtyard_of)
    if (around != none && found[around] != none) around = none;
  return courtyard_of;
}

/// Makes holes of the courtyards, and parts of what stands in them, which was a hole in the
/// courtyard. Returns how many courtyards there are.
std::int64_t cut_out_courtyards(std::vector<PolygonPart>& parts,
                                const std::vector<std::size_t>& courtyard_of) {
  const std::size_t none = parts.size();
  std::vector<PolygonPart> in_courtyards;
  for (std::size_t j = 0; j < courtyard_of.size(); ++j) {
    if (courtyard_of[j] == none) continue;
    for (Ring& ring : parts[j].polygon.holes) in_courtyards.push_back({{std::move(ring), {}}, {}});
    parts[courtyard_of[j]].polygon.holes.push_back(std::move(parts[j].polygon.outer));
  }
  std::size_t j = 0;
  const std::size_t courtyards =
      std::erase_if(parts, [&](const PolygonPart&) { return courtyard_of[j++] != none; });
  std::move(in_courtyards.begin(), in_courtyards.end(), std::back_inserter(parts));
  return static_cast<std::int64_t>(courtyards);
}

/// Whether two faces lie above each other: then one is a roof.
bool lie_apart(const Face& a, const Face& b) {
  constexpr double kApart = 1;  // metres
  const auto [low_a, high_a] = elevations(a);
  const auto [low_b, high_b] = elevations(b);
  return low_a > high_b + kApart || low_b > high_a + kApart;
}

/// Mean width of what is left of a ring less one within it.
double width_between(const Ring& outer, const Ring& inner) {
  return 2 * (std::abs(signed_area(outer)) - std::abs(signed_area(inner))) /
         perimeter(Polygon{outer, {inner}});
}

}  // namespace

std::int64_t take_courtyards_for_holes(std::vector<PolygonPart>& parts,
                                       const std::vector<Face>& faces, double metres_per_unit) {
  constexpr double kLeastWing = 1;  // metres; eaves are less wide
  const auto alike = [&](const PolygonPart& part) {
    return turns_left(part) == turns_left(parts.front());
  };
  if (parts.size() < 2 || std::all_of(parts.begin(), parts.end(), alike)) return 0;
  std::vector<std::size_t> courtyard_of = find_courtyards(parts, Turns::kTell);
  for (std::size_t j = 0; j < courtyard_of.size(); ++j) {
    const std::size_t around = courtyard_of[j];
    if (around == parts.size()) continue;
    const double width =
        metres_per_unit * width_between(parts[around].polygon.outer, parts[j].polygon.outer);
    if (width < kLeastWing || (!faces.empty() && lie_apart(faces[around], faces[j])))
      courtyard_of[j] = parts.size();
  }
  return cut_out_courtyards(parts, courtyard_of);
}

void mend_order_of_rings(std::vector<PolygonPart>& parts) {
  const auto as_hole_and_shell = [](const Ring& first, const Ring& other) {
    return signed_area(first) < 0 && signed_area(other) > 0;
  };
  for (PolygonPart& part : parts)
    if (part.reason.empty()) put_widest_ring_first(part.polygon, as_hole_and_shell);
}

void mend_turned_rings(std::vector<PolygonPart>& parts) {
  const auto any = [](const Ring&, const Ring&) { return true; };
  for (PolygonPart& part : parts)
    if (part.reason.empty()) put_widest_ring_first(part.polygon, any);
  // All holes, by their turn: some are, and those lie within others.
  if (parts.size() > 1 && std::all_of(parts.begin(), parts.end(), turns_left))
    cut_out_courtyards(parts, find_courtyards(parts, Turns::kSayNothing));
}

}  // namespace tetropolis
