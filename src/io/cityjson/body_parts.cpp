#include "body_parts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "tetropolis/geometry/polygon.h"

#include "city/part_tiling.h"
#include "city/roof_summary.h"
#include "geometry/geos.h"
#include "geometry/perimeter.h"

namespace tetropolis {

namespace {

constexpr double kSame = 0.01;          // metres
constexpr double kMostOffPlane = 0.05;  // metres
constexpr double kSteepest = 100;       // tangent; what is more is a wall
constexpr std::size_t kMostCorners = 10000;

/// What stands in the way of parts.
struct NoParts {
  std::string reason;
};

double distance(Point2 a, Point2 b) { return std::hypot(b.x - a.x, b.y - a.y); }

/// The vertices of all roofs in the plan, each once.
class PlanVertices {
 public:
  /// The number of the vertex at `p`, or within kSame of it.
  std::size_t add(Point2 p) {
    const auto cell_x = static_cast<std::int64_t>(std::floor(p.x / kSame));
    const auto cell_y = static_cast<std::int64_t>(std::floor(p.y / kSame));
    for (std::int64_t x = cell_x - 1; x <= cell_x + 1; ++x)
      for (std::int64_t y = cell_y - 1; y <= cell_y + 1; ++y) {
        const auto it = cells_.find({x, y});
        if (it == cells_.end()) continue;
        for (const std::size_t v : it->second)
          if (distance(places[v], p) <= kSame) return v;
      }
    if (places.size() == kMostCorners) throw NoParts{"more than 10,000 roof corners"};
    cells_[{cell_x, cell_y}].push_back(places.size());
    places.push_back(p);
    return places.size() - 1;
  }

  std::vector<Point2> places;

 private:
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::size_t>> cells_;
};

using IndexRing = std::vector<std::size_t>;

/// Without what runs to a vertex and straight back, or stays where it is.
IndexRing without_spikes(const IndexRing& ring) {
  IndexRing result;
  for (const std::size_t v : ring) {
    if (!result.empty() && result.back() == v) continue;
    if (result.size() > 1 && result[result.size() - 2] == v)
      result.pop_back();
    else
      result.push_back(v);
  }
  while (result.size() > 1 && result.back() == result.front()) result.pop_back();
  return result;
}

/// A roof in the plan, by numbers of vertices, and its plane.
struct PlanRoof {
  std::vector<IndexRing> rings;
  RoofPlane plane;
};

/// The plane with the least squares of vertical distances from the vertices of a face.
RoofPlane plane_of(const Face& face) {
  const std::vector<Point3>& outer = face.rings[0];
  const Point2 at{outer[0][0], outer[0][1]};
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
  for (const std::vector<Point3>& ring : face.rings)
    for (const Point3& p : ring) {
      const double u = p[0] - at.x, v = p[1] - at.y, w = p[2] - outer[0][2];
      n += 1;
      x += u;
      y += v;
      z += w;
      xx += u * u;
      xy += u * v;
      yy += v * v;
      xz += u * w;
      yz += v * w;
    }
  const double a = xx - x * x / n, b = xy - x * y / n, c = yy - y * y / n;
  const double d = xz - x * z / n, e = yz - y * z / n;
  const double determinant = a * c - b * b;
  if (!(determinant > 1e-9 * a * c)) throw NoParts{"a roof without area in the plan"};
  RoofPlane plane;
  plane.at = at;
  plane.slope_x = (d * c - e * b) / determinant;
  plane.slope_y = (a * e - b * d) / determinant;
  plane.elevation = outer[0][2] + (z - plane.slope_x * x - plane.slope_y * y) / n;
  if (!(std::hypot(plane.slope_x, plane.slope_y) <= kSteepest)) throw NoParts{"a vertical roof"};
  plane = snap_plane(plane);
  for (const std::vector<Point3>& ring : face.rings)
    for (const Point3& p : ring)
      if (!(std::abs(plane({p[0], p[1]}) - p[2]) <= kMostOffPlane))
        throw NoParts{"a roof that is not planar"};
  return plane;
}

class PartsBuilder {
 public:
  void add(const Face& face) {
    PlanRoof roof;
    for (const std::vector<Point3>& ring : face.rings) {
      IndexRing plan;
      for (const Point3& p : ring)
        plan.push_back(vertices_.add(snap_coordinate(Point2{p[0], p[1]})));
      plan = without_spikes(plan);
      if (plan.size() >= 3)
        roof.rings.push_back(std::move(plan));
      else if (roof.rings.empty())
        throw NoParts{"a roof without area in the plan"};
    }
    roof.plane = plane_of(face);
    roofs_.push_back(std::move(roof));
  }

  BodyParts build(const Polygon& ground, double low, Lod lod) {
    split_edges();
    BodyParts result;
    for (const PlanRoof& roof : roofs_) {
      RoofPart& part = result.parts.emplace_back();
      part.roof = roof.plane;
      part.lod = lod;
      part.rmse = std::numeric_limits<double>::quiet_NaN();
      part.outline.outer = places_of(roof.rings[0]);
      for (std::size_t r = 1; r < roof.rings.size(); ++r)
        part.outline.holes.push_back(places_of(roof.rings[r]));
      orient(part.outline);
      if (!(range_of(part).low > low + kMostOffPlane))
        throw NoParts{"a roof that is not above the ground"};
    }
    result.footprint = outline_of(result.parts);
    require_same_plan(result.footprint, ground);
    const std::string fault = tiling_fault(result.footprint, result.parts);
    if (!fault.empty()) throw NoParts{"roofs that " + fault};
    return result;
  }

 private:
  Ring places_of(const IndexRing& ring) const {
    Ring places;
    for (const std::size_t v : ring) places.push_back(vertices_.places[v]);
    return places;
  }

  /// Puts the vertices that lie on an edge into it.
  void split_edges() {
    by_x_.clear();
    for (std::size_t v = 0; v < vertices_.places.size(); ++v)
      by_x_.emplace_back(vertices_.places[v].x, v);
    std::sort(by_x_.begin(), by_x_.end());
    for (PlanRoof& roof : roofs_)
      for (IndexRing& ring : roof.rings) {
        IndexRing split;
        for (std::size_t i = 0; i < ring.size(); ++i) {
          split.push_back(ring[i]);
          for (const std::size_t v : vertices_on(ring[i], ring[(i + 1) % ring.size()]))
            split.push_back(v);
        }
        ring = without_spikes(split);
      }
  }

  /// In the order from a to b.
  std::vector<std::size_t> vertices_on(std::size_t from, std::size_t to) const {
    const Point2 a = vertices_.places[from], b = vertices_.places[to];
    const Bounds2 box =
        Bounds2{std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x), std::max(a.y, b.y)}
            .grown(kSame);
    std::vector<std::pair<double, std::size_t>> on;
    for (auto it =
             std::lower_bound(by_x_.begin(), by_x_.end(), std::pair{box.xmin, std::size_t{0}});
         it != by_x_.end() && it->first <= box.xmax; ++it) {
      const std::size_t v = it->second;
      const Point2 p = vertices_.places[v];
      if (v == from || v == to || !box.contains(p)) continue;
      if (distance_to_segment(p, a, b) <= kSame) on.emplace_back(distance(a, p), v);
    }
    std::sort(on.begin(), on.end());
    std::vector<std::size_t> result;
    for (const auto& [away, v] : on) result.push_back(v);
    return result;
  }

  /// What the parts cover, from the edges that one of them has alone.
  static Polygon outline_of(const std::vector<RoofPart>& parts) {
    const auto less = [](Point2 a, Point2 b) { return std::tie(a.y, a.x) < std::tie(b.y, b.x); };
    std::vector<std::pair<Point2, Point2>> edges;
    for (const RoofPart& part : parts)
      for_each_edge(part.outline, [&](Point2 a, Point2 b) { edges.emplace_back(a, b); });
    const auto is_less = [&](const auto& s, const auto& t) {
      return s.first == t.first ? less(s.second, t.second) : less(s.first, t.first);
    };
    std::sort(edges.begin(), edges.end(), is_less);
    std::vector<std::pair<Point2, Point2>> alone;
    for (const auto& edge : edges)
      if (!std::binary_search(edges.begin(), edges.end(), std::pair{edge.second, edge.first},
                              is_less))
        alone.push_back(edge);
    Polygon outline;
    std::vector<bool> used(alone.size(), false);
    for (std::size_t first = 0; first < alone.size(); ++first) {
      if (used[first]) continue;
      Ring ring;
      for (std::size_t at = first; !used[at];) {
        used[at] = true;
        ring.push_back(alone[at].first);
        const Point2 next = alone[at].second;
        const auto it =
            std::lower_bound(alone.begin(), alone.end(), next,
                             [&](const auto& edge, Point2 p) { return less(edge.first, p); });
        if (it == alone.end() || !(it->first == next) ||
            (it + 1 != alone.end() && (it + 1)->first == next))
          throw NoParts{"roofs that overlap, or touch in a point"};
        at = static_cast<std::size_t>(it - alone.begin());
      }
      if (signed_area(ring) < 0)
        outline.holes.push_back(std::move(ring));
      else if (outline.outer.empty())
        outline.outer = std::move(ring);
      else
        throw NoParts{"roofs that overlap, or leave gaps"};
    }
    if (outline.outer.empty()) throw NoParts{"roofs that overlap"};
    return outline;
  }

  static void require_same_plan(const Polygon& footprint, const Polygon& ground) {
    const std::span a(&footprint, 1), b(&ground, 1);
    const std::optional<std::vector<Polygon>> more =
        geos::is_valid(a) ? geos::subtract(a, b, 0) : std::nullopt;
    const std::optional<std::vector<Polygon>> less =
        geos::is_valid(a) ? geos::subtract(b, a, 0) : std::nullopt;
    if (!more || !less || total_area(*more) + total_area(*less) > kSame * perimeter(ground))
      throw NoParts{"roofs that stick out over the ground or do not cover it"};
  }

  PlanVertices vertices_;
  std::vector<PlanRoof> roofs_;
  std::vector<std::pair<double, std::size_t>> by_x_;
};

}  // namespace

BodyParts parts_of(std::span<const Face> faces, const Polygon& ground, double low, Lod lod) {
  try {
    PartsBuilder builder;
    std::size_t roofs = 0;
    for (const Face& face : faces) {
      if (!face.is_roof || face.rings.empty() || face.rings[0].size() < 3) continue;
      builder.add(face);
      ++roofs;
    }
    if (roofs == 0) throw NoParts{"no RoofSurface"};
    BodyParts result = builder.build(ground, low, lod);
    if (result.parts.size() == 1 && result.parts[0].roof.is_flat()) return {};
    return result;
  } catch (const NoParts& no) {
    return {{}, {}, no.reason};
  }
}

}  // namespace tetropolis
