#include "city/roofs/divide_ground.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "city/footprint_index.h"
#include "city/roofs/clear_lines.h"
#include "city/roofs/partition.h"
#include "city/roofs/region_points.h"
#include "core/infinity.h"
#include "geometry/geos.h"
#include "geometry/vec2.h"

namespace tetropolis {

namespace {

using NodeId = Partition::NodeId;
using EdgeId = Partition::EdgeId;
using Steps = std::pair<std::int64_t, std::int64_t>;  // a place on the grid of coordinates

// Regions of the partition, before connected areas get numbers of their own: open ground, and a
// kind + 1. To the machinery of roofs a kind is a flat roof, so many metres high.
constexpr double kStorey = 10;
constexpr double kMostGivenUp = 30;  // squares of the clearance

Steps steps(Point2 p) {
  return {std::llround(p.x / kCoordinateStep), std::llround(p.y / kCoordinateStep)};
}

RegionRoof roof_of(Partition::Region kind) { return {{{}, kStorey * kind, 0, 0}, 0, Lod::kBlock}; }

/// Valid areas that meet the domain.
std::vector<SurfaceArea> usable(std::span<const SurfaceArea> areas, const Bounds2& domain) {
  std::vector<SurfaceArea> result;
  for (const SurfaceArea& given : areas) {
    if (!bounds(given.area).intersects(domain)) continue;
    const geos::Result valid = geos::make_valid(given.area);
    if (!valid) continue;
    for (const Polygon& part : *valid) result.push_back({given.kind, part});
  }
  return result;
}

/// The lines of all areas, footprints and sides, as a partition.
class Lines {
 public:
  Lines(const std::vector<SurfaceArea>& areas, std::span<const Polygon> footprints,
        const Domain& domain, double clearance)
      : partition_(domain.bounds(), clearance) {
    const Polygon outline = domain.outline();
    note_corners(outline);
    std::vector<Polygon> all{outline};
    std::vector<const Polygon*> of_areas, of_footprints;
    for (const Polygon& footprint : footprints) {
      note_corners(footprint);
      all.push_back(footprint);
      of_footprints.push_back(&footprint);
    }
    for (const SurfaceArea& area : areas) {
      all.push_back(area.area);
      of_areas.push_back(&area.area);
    }
    const geos::Result faces = geos::faces(all, kCoordinateStep);
    if (!faces)
      throw Error(ErrorKind::kInput, "surface_layers: the outlines cannot be brought together");
    const FootprintIndex area_at(of_areas, 0), footprint_at(of_footprints, 0);
    std::map<std::pair<NodeId, NodeId>, Partition::Region> left;
    for (const Polygon& face : *faces) {
      const Point2 inside = interior_point(face);
      bool is_building = !domain.encloses(inside);
      footprint_at.at(inside, [&](BuildingIndex, bool) { is_building = true; });
      if (is_building) continue;
      Partition::Region region = 0;
      area_at.at(inside, [&](BuildingIndex i, bool) {
        const auto kind = static_cast<Partition::Region>(areas[i].kind) + 1;
        region = region == 0 ? kind : std::min(region, kind);
      });
      if (region > 0) given_[static_cast<std::size_t>(region) - 1] += area(face);
      for_each_edge(face, [&](Point2 p, Point2 q) { left[{node(p), node(q)}] = region; });
    }
    for (const auto& [side, region] : left) {
      const auto other = left.find({side.second, side.first});
      if (other == left.end()) {
        partition_.put_on_outline(side.first);
        partition_.put_on_outline(side.second);
        partition_.add_edge(side.first, side.second, region, Partition::kOutside);
      } else if (side.first < side.second && region != other->second) {
        partition_.add_edge(side.first, side.second, region, other->second);
      }
    }
    put_on_outlines();
    partition_.tidy();
  }

  Partition& partition() { return partition_; }
  const std::array<double, 3>& given() const { return given_; }

 private:
  void note_corners(const Polygon& polygon) {
    for_each_edge(polygon, [&](Point2 p, Point2) { corners_.emplace(steps(p), p); });
  }

  NodeId node(Point2 p) {
    const auto [place, is_new] = nodes_.try_emplace(steps(p), Partition::kNone);
    if (is_new) {
      const auto corner = corners_.find(steps(p));
      const bool is_corner = corner != corners_.end();
      place->second = partition_.add_node(is_corner ? corner->second : p, is_corner, is_corner);
    }
    return place->second;
  }

  /// What is on an outline lies between corners, on the straight line.
  void put_on_outlines() {
    std::map<NodeId, NodeId> next;  // along outlines
    for (const Partition::Edge& edge : partition_.edges())
      if (edge.alive && edge.is_outline())
        next[edge.left == Partition::kOutside ? edge.b : edge.a] =
            edge.left == Partition::kOutside ? edge.a : edge.b;
    for (const auto& [corner, first] : next) {
      if (!partition_.node(corner).corner) continue;
      std::vector<NodeId> between;
      NodeId n = first;
      while (!partition_.node(n).corner && between.size() <= next.size()) {
        between.push_back(n);
        const auto after = next.find(n);
        if (after == next.end()) break;
        n = after->second;
      }
      for (const NodeId k : between)
        partition_.put_back(
            k, nearest_on_segment(partition_.at(k), partition_.at(corner), partition_.at(n)));
    }
  }

  Partition partition_;
  std::map<Steps, Point2> corners_;
  std::map<Steps, NodeId> nodes_;
  std::array<double, 3> given_{};
};

/// Places that show what is where, and the area that each stands for: closely within a few
/// clearances of the lines inside, where areas change, and far apart elsewhere.
struct Places {
  std::vector<Point3> points;  ///< As of roofs.
  std::vector<double> area;
  std::vector<RoofRegion> region;
};

Places places_in(const Partition& lines, const Bounds2& box, double clearance) {
  const double reach = 3 * clearance, step = clearance / 2;
  constexpr std::int64_t kFar = 20;  // steps
  std::set<Steps> near;
  const auto row = [&](double x) { return static_cast<std::int64_t>(std::floor(x / step)); };
  for (const Partition::Edge& edge : lines.edges()) {
    if (!edge.alive || edge.is_outline()) continue;
    const Point2 a = lines.at(edge.a), b = lines.at(edge.b);
    const double pieces = std::max(1.0, std::ceil(distance(a, b) / reach));
    for (double k = 0; k < pieces; ++k) {
      const auto at = [&](double t) {
        return Point2{a.x + (b.x - a.x) * t / pieces, a.y + (b.y - a.y) * t / pieces};
      };
      const Point2 p = at(k), q = at(k + 1);
      for (std::int64_t j = row(std::min(p.y, q.y) - reach); j <= row(std::max(p.y, q.y) + reach);
           ++j)
        for (std::int64_t i = row(std::min(p.x, q.x) - reach); i <= row(std::max(p.x, q.x) + reach);
             ++i)
          near.insert({i, j});
    }
  }
  Places places;
  const auto add = [&](std::int64_t i, std::int64_t j, double area) {
    const Point2 p{(static_cast<double>(i) + 0.5) * step, (static_cast<double>(j) + 0.5) * step};
    const Partition::Region region = lines.region_at(p);
    if (region == Partition::kOutside) return;
    places.points.push_back({p.x, p.y, kStorey * region});
    places.area.push_back(area);
    places.region.push_back(region);
  };
  for (const auto& [i, j] : near) add(i, j, step * step);
  const double far_area = step * step * static_cast<double>(kFar * kFar);
  const auto first = [&](double low) { return row(low) - ((row(low) % kFar) + kFar) % kFar; };
  for (std::int64_t j = first(box.ymin); j <= row(box.ymax); j += kFar)
    for (std::int64_t i = first(box.xmin); i <= row(box.xmax); i += kFar)
      if (!near.contains({i, j})) add(i, j, far_area);
  return places;
}

/// The areas without a square around each place.
std::vector<SurfaceArea> without(const std::vector<SurfaceArea>& areas,
                                 const std::vector<Point2>& places, double width) {
  std::vector<SurfaceArea> result;
  for (const SurfaceArea& area : areas) {
    std::vector<Polygon> squares;
    const Bounds2 box = bounds(area.area);
    for (const Point2 p : places) {
      const Bounds2 square = Bounds2{p.x, p.y, p.x, p.y}.grown(width / 2);
      if (square.intersects(box)) squares.push_back(rectangle(square));
    }
    if (squares.empty()) {
      result.push_back(area);
      continue;
    }
    const geos::Result rest = geos::subtract({&area.area, 1}, squares, kCoordinateStep);
    if (!rest) continue;
    for (const Polygon& part : *rest) result.push_back({area.kind, part});
  }
  return result;
}

}  // namespace

Surfaces divide_ground(std::span<const SurfaceArea> areas, std::span<const Polygon> footprints,
                       const Domain& domain, double clearance) {
  constexpr double kLeastSquares = 10;
  constexpr int kTries = 12;
  Surfaces result;
  std::vector<SurfaceArea> left = usable(areas, domain.bounds());
  if (left.empty()) return result;
  std::vector<RegionRoof> roofs;
  for (Partition::Region kind = 0; kind <= 3; ++kind) roofs.push_back(roof_of(kind));
  ClearLinesOptions options;
  options.clearance = clearance + kForRounding;
  options.min_area = kLeastSquares * clearance * clearance;
  options.min_angle = 30;  // as much as meshes can be asked for
  // Where only giving up a large area would help, a little of it goes, and more at each try.
  options.most_cost = kMostGivenUp * clearance * clearance * kStorey;
  options.polish = false;
  std::optional<Lines> lines;
  std::optional<Places> places;
  std::optional<RegionPoints> points;
  for (int k = 1;; ++k) {
    if (k == kTries) options.most_cost = kInfinity;
    lines.emplace(left, footprints, domain, clearance);
    if (k == 1) result.area_given = lines->given();
    places = places_in(lines->partition(), domain.bounds(), clearance);
    points.emplace(places->points, places->area, places->region, roofs, domain.bounds(), 50,
                   kStorey);
    const std::vector<Point2> hard = clear_lines(lines->partition(), *points, options);
    if (hard.empty()) break;
    left = without(left, hard, (2 + 2 * k) * clearance);
  }
  const Partition& partition = lines->partition();
  const RegionPoints& regions = *points;

  std::map<Partition::Region, std::int32_t> number{{Partition::kOutside, SurfaceLine::kBeyond}};
  for (const auto& [region, size] : partition.areas()) {
    const auto kind =
        static_cast<std::size_t>(std::llround(regions.roof(region).plane.elevation / kStorey));
    number[region] = SurfaceLine::kOpenGround;
    if (kind == 0) continue;
    number[region] = static_cast<std::int32_t>(result.kinds.size());
    result.kinds.push_back(static_cast<SurfaceKind>(kind - 1));
    result.area_meshed[kind - 1] += size;
  }
  for (const Partition::Edge& edge : partition.edges()) {
    if (!edge.alive) continue;
    const std::int32_t to_left = number[edge.left], to_right = number[edge.right];
    if (to_left != to_right)
      result.lines.push_back({partition.at(edge.a), partition.at(edge.b), to_left, to_right});
  }
  return result;
}

}  // namespace tetropolis
