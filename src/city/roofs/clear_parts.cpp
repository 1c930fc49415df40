#include "city/roofs/clear_parts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "tetropolis/city/roof_summary.h"
#include "tetropolis/city/roofs.h"
#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/geometry/polygon.h"

#include "city/part_lines.h"
#include "city/roofs/clear_lines.h"
#include "city/roofs/finish_parts.h"
#include "city/roofs/partition.h"
#include "city/roofs/plane_fit.h"
#include "city/roofs/region_points.h"
#include "city/roofs/separate_valleys.h"
#include "core/infinity.h"

namespace tetropolis {

namespace {

using NodeId = Partition::NodeId;
using EdgeId = Partition::EdgeId;
using Place = std::pair<double, double>;

Place place(Point2 p) { return {p.x, p.y}; }

/// The lines of parts; region k is part k. `outline`: the footprint's, of corners alone.
Partition lines_of(const Building& building, const Polygon& outline, double clearance) {
  std::set<Place> corners;
  for_each_edge(outline, [&](Point2 p, Point2) { corners.insert(place(p)); });
  std::set<Place> on_outline;
  for_each_edge(building.footprint, [&](Point2 p, Point2) { on_outline.insert(place(p)); });
  Partition lines(bounds(building.footprint), clearance);
  std::map<Place, NodeId> nodes;
  std::map<std::pair<NodeId, NodeId>, Partition::Region> left;
  for (std::size_t k = 0; k < building.parts.size(); ++k)
    for_each_edge(building.parts[k].outline, [&](Point2 p, Point2 q) {
      for (const Point2 v : {p, q})
        if (!nodes.contains(place(v)))
          nodes[place(v)] =
              lines.add_node(v, corners.contains(place(v)), on_outline.contains(place(v)));
      left[{nodes[place(p)], nodes[place(q)]}] = static_cast<Partition::Region>(k);
    });
  for (const auto& [side, region] : left) {
    const auto other = left.find({side.second, side.first});
    if (other == left.end())
      lines.add_edge(side.first, side.second, region, Partition::kOutside);
    else if (side.first < side.second)
      lines.add_edge(side.first, side.second, region, other->second);
  }
  // What is within a centimetre of a straight piece of the outline is on it from now on.
  const auto straighten = [&](const Ring& ring, const Ring& kept) {
    std::size_t k = 0;
    while (ring[k] != kept[0]) ++k;
    for (std::size_t i = 0, at = k; i < kept.size(); ++i) {
      const Point2 a = kept[i], b = kept[(i + 1) % kept.size()];
      for (at = (at + 1) % ring.size(); ring[at] != b; at = (at + 1) % ring.size())
        lines.put_back(nodes[place(ring[at])], nearest_on_segment(ring[at], a, b));
    }
  };
  straighten(building.footprint.outer, outline.outer);
  for (std::size_t h = 0; h < outline.holes.size(); ++h)
    straighten(building.footprint.holes[h], outline.holes[h]);
  lines.tidy();
  return lines;
}

/// Places in a polygon, in rows.
template <typename Visit>
void for_each_place(const Polygon& polygon, double step, const Visit& visit) {
  const Bounds2 box = bounds(polygon);
  for (double y = (std::floor(box.ymin / step) + 0.5) * step; y < box.ymax; y += step) {
    std::vector<double> crossings;
    for_each_edge(polygon, [&](Point2 a, Point2 b) {
      if ((a.y > y) != (b.y > y)) crossings.push_back(a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y));
    });
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t k = 0; k + 1 < crossings.size(); k += 2)
      for (double x = (std::floor(crossings[k] / step + 0.5) + 0.5) * step; x < crossings[k + 1];
           x += step)
        visit(Point2{x, y});
  }
}

/// As steep as cells bear, about a place.
RoofPlane gentler(const RoofPlane& plane, Point2 about) {
  RoofPlane result = plane;
  const double share = kMaxRoofSlope / slope_of(plane);
  if (share >= 1) return plane;
  result.at = about;
  result.elevation = plane(about);
  result.slope_x *= share;
  result.slope_y *= share;
  return result;
}

}  // namespace

bool clear_parts(Building& building, double clearance) {
  constexpr double kCap = 3;      // metres
  constexpr double kMinArea = 2;  // square metres
  const double size = area(building.footprint);
  if (size < 2 * kMinArea) return false;
  const Polygon outline = without_junctions(building.footprint);
  RoofPart whole;
  whole.outline = outline;
  if (!is_clear(line_clearance({&whole, 1}).distance, clearance)) return false;
  Partition lines = lines_of(building, outline, clearance);

  // The roofs, as a cloud would show them.
  constexpr double kStep = 0.4, kMostPerSide = 250;
  const double step = std::max(kStep, std::sqrt(size) / kMostPerSide);
  RoofInput input;
  input.footprint = outline;
  input.members = {&outline};
  std::vector<Point3> samples;
  std::vector<RoofRegion> region_of;
  std::vector<RegionRoof> roofs;
  double lowest = kInfinity;
  for (const RoofPart& part : building.parts) {
    lowest = std::min(lowest, range_of(part).low);
    const RoofPlane roof = gentler(part.roof, interior_point(part.outline));
    for_each_place(part.outline, step, [&](Point2 p) {
      samples.push_back({p.x, p.y, roof(p)});
      region_of.push_back(static_cast<RoofRegion>(roofs.size()));
    });
    roofs.push_back({roof, 0, Lod::k2_2});
  }
  if (samples.empty()) return false;
  input.points.push_back(samples);
  input.sources = {RoofSource::kMeasured};
  RegionPoints points(input.points.values, std::vector<double>(samples.size(), step * step),
                      region_of, roofs, bounds(building.footprint), 50, kCap);
  ClearLinesOptions options;
  options.clearance = clearance + kForRounding;
  options.min_area = kMinArea + kForRounding;
  clear_lines(lines, points, options);

  FinishedRoof finished = finish_parts(input, lines, points, {50, lowest});
  Building made = building;
  made.footprint = finished.footprint;
  made.parts.clear();
  for (FinishedPart& part : finished.parts) made.parts.push_back(std::move(part.part));
  if (!part_defects(std::span(&made, 1), clearance, kMinArea, 1).empty()) return false;
  separate_valleys(made, clearance, kMinArea);
  // Whose most of a part was.
  for (RoofPart& part : made.parts) {
    std::vector<std::size_t> share(building.parts.size(), 0);
    for (std::size_t p = 0; p < samples.size(); ++p)
      if (contains(part.outline, {samples[p][0], samples[p][1]}))
        ++share[static_cast<std::size_t>(region_of[p])];
    const auto largest = std::max_element(share.begin(), share.end()) - share.begin();
    const RoofPart& source = building.parts[static_cast<std::size_t>(largest)];
    part.source_id = source.source_id;
    part.lod = source.lod;
    part.n_points = source.n_points;
    part.rmse = source.rmse;
  }
  building = std::move(made);
  return true;
}

}  // namespace tetropolis
