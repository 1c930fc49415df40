#include "city/roofs/finish_parts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <utility>

#include "tetropolis/city/heights.h"
#include "tetropolis/geometry/polygon.h"

#include "city/grid_geometry.h"
#include "city/roofs/plane_fit.h"
#include "core/infinity.h"

namespace tetropolis {

namespace {

using NodeId = Partition::NodeId;
using EdgeId = Partition::EdgeId;

/// Per node of the outline: the next one along it, the polygon on the left.
std::vector<NodeId> walk_of(const Partition& lines) {
  std::vector<NodeId> next(lines.nodes().size(), Partition::kNone);
  for (const Partition::Edge& edge : lines.edges()) {
    if (!edge.alive) continue;
    if (edge.right == Partition::kOutside) next[edge.a] = edge.b;
    if (edge.left == Partition::kOutside) next[edge.b] = edge.a;
  }
  return next;
}

/// The point of the grid nearest to p that is not on the right of the line from a to b.
Point2 snap_inside(Point2 p, Point2 a, Point2 b) {
  const Point2 from = grid::to_steps(a), to = grid::to_steps(b);
  const Point2 exact{p.x * grid::kSteps, p.y * grid::kSteps}, middle = grid::to_steps(p);
  Point2 best = middle;
  double least = kInfinity;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const Point2 q{middle.x + dx, middle.y + dy};
      const double d = grid::squared_distance(q, exact);
      if (d < least && grid::orientation(from, to, q) >= 0) least = d, best = q;
    }
  return grid::to_metres(best);
}

void snap_nodes(Partition& lines, const std::vector<NodeId>& next) {
  for (NodeId n = 0; n < lines.nodes().size(); ++n)
    if (!lines.node(n).on_outline && !lines.node(n).edges.empty())
      lines.put_back(n, snap_coordinate(lines.at(n)));
  for (NodeId n = 0; n < lines.nodes().size(); ++n) {
    if (next[n] == Partition::kNone || !lines.node(n).corner) continue;
    NodeId end = next[n];
    while (!lines.node(end).corner) end = next[end];
    for (NodeId k = next[n]; k != end; k = next[k])
      lines.put_back(k, snap_inside(lines.at(k), lines.at(n), lines.at(end)));
  }
}

Polygon outline_of(const Polygon& footprint, const Partition& lines,
                   const std::vector<NodeId>& next) {
  std::map<std::pair<double, double>, NodeId> at;
  for (NodeId n = 0; n < lines.nodes().size(); ++n)
    if (lines.node(n).corner && next[n] != Partition::kNone) at[{lines.at(n).x, lines.at(n).y}] = n;
  const auto walked = [&](const Ring& ring) {
    Ring result;
    const NodeId start = at.at({ring.front().x, ring.front().y});
    NodeId n = start;
    do {
      result.push_back(lines.at(n));
      n = next[n];
    } while (n != start);
    return result;
  };
  Polygon result;
  result.outer = walked(footprint.outer);
  for (const Ring& hole : footprint.holes) result.holes.push_back(walked(hole));
  return result;
}

Polygon polygon_of(const Partition::Face& face, const Partition& lines) {
  Polygon result;
  for (const std::vector<NodeId>& ring : face.rings) {
    Ring points;
    for (const NodeId n : ring) points.push_back(lines.at(n));
    if (result.outer.empty())
      result.outer = std::move(points);
    else
      result.holes.push_back(std::move(points));
  }
  return result;
}

Point2 centroid(const Polygon& polygon) {
  const Point2 o = polygon.outer.front();
  double sum = 0, x = 0, y = 0;
  for_each_edge(polygon, [&](Point2 a, Point2 b) {
    const double cross = (a.x - o.x) * (b.y - o.y) - (b.x - o.x) * (a.y - o.y);
    sum += cross;
    x += cross * (a.x + b.x - 2 * o.x);
    y += cross * (a.y + b.y - 2 * o.y);
  });
  return {o.x + x / (3 * sum), o.y + y / (3 * sum)};
}

double rmse_of(const RoofPlane& plane, const std::vector<Point3>& points) {
  double sum = 0;
  for (const Point3& p : points) sum += height_above(plane, p) * height_above(plane, p);
  return std::sqrt(sum / static_cast<double>(points.size()));
}

/// The plane with its slope reduced about `pivot` until all corners are in the range.
RoofPlane tamed(const RoofPlane& plane, Point2 pivot, const Polygon& outline, double low,
                double high) {
  RoofPlane result = plane;
  result.at = pivot;
  result.elevation = std::clamp(plane(pivot), low, high);
  double share = 1;
  for_each_edge(outline, [&](Point2 p, Point2) {
    const double rise = plane.slope_x * (p.x - pivot.x) + plane.slope_y * (p.y - pivot.y);
    if (result.elevation + rise > high) share = std::min(share, (high - result.elevation) / rise);
    if (result.elevation + rise < low) share = std::min(share, (low - result.elevation) / rise);
  });
  result.slope_x *= share;
  result.slope_y *= share;
  return result;
}

/// Metres from its footprint's outline within which a point may be of a wall, or of a neighbour.
constexpr double kRim = 0.5;

/// Metres off a roof from which on a point is not of it.
constexpr double kStray = 2;

class Finishing {
 public:
  Finishing(const RoofInput& input, Partition& lines, RegionPoints& points,
            const FinishOptions& options)
      : input_(input), lines_(lines), points_(points), options_(options) {
    for (std::size_t m = 0; m < input.members.size(); ++m) {
      member_of_.insert(member_of_.end(), input.points[m].size(), m);
      std::vector<double> heights;
      for (const Point3& p : input.points[m]) heights.push_back(p[2]);
      flat_heights_.push_back(heights.empty() ? 0 : percentile(heights, options.percentile));
    }
  }

  FinishedRoof run() {
    const std::vector<NodeId> next = walk_of(lines_);
    snap_nodes(lines_, next);
    result_.footprint = outline_of(input_.footprint, lines_, next);
    result_.squared_errors.assign(input_.members.size(), 0);
    result_.flat_squared_errors = result_.squared_errors;
    result_.counts.assign(input_.members.size(), 0);
    seen_ = strayed_ = result_.counts;
    for (const Partition::Face& face : lines_.faces())
      result_.parts.push_back(part_of(face.region, polygon_of(face, lines_)));
    constexpr std::int64_t kEnough = 10;  // points
    for (std::size_t m = 0; m < seen_.size(); ++m)
      if (seen_[m] >= kEnough && 2 * strayed_[m] > seen_[m])
        result_.lost.push_back(static_cast<MemberNumber>(m));
    return std::move(result_);
  }

 private:
  FinishedPart part_of(RoofRegion region, Polygon outline) {
    const RegionRoof& roof = points_.roof(region);
    const std::vector<std::uint32_t> list = points_.points_of(region);
    std::vector<Point3> inside, measured;
    for (const std::uint32_t p : list) {
      inside.push_back(input_.points.values[p]);
      if (is_measured(member_of_[p])) measured.push_back(inside.back());
    }
    FinishedPart finished;
    finished.member = measured.size() == list.size() ? roof.member : most_of(list);
    RoofPart& part = finished.part;
    part.outline = std::move(outline);
    part.lod = roof.lod;
    part.n_points = static_cast<std::int64_t>(measured.size());
    part.rmse = std::numeric_limits<double>::quiet_NaN();
    part.roof = roof.lod == Lod::k2_2 ? sloped(roof.plane, inside, part) : roof.plane;
    raise(part.roof, part.outline, finished);
    part.roof = snap_plane(part.roof);
    finished.mean_of_roof = part.roof(centroid(part.outline));
    if (!measured.empty()) part.rmse = rmse_of(part.roof, measured);
    double sum = 0, count = 0;
    for (const std::uint32_t p : list) {
      const Point3& point = input_.points.values[p];
      const std::size_t m = member_of_[p];
      ++seen_[m];
      if (finished.member != static_cast<MemberNumber>(m) &&
          std::abs(height_above(part.roof, point)) >= kStray)
        ++strayed_[m];
      if (!is_measured(m) || distance_to_boundary(*input_.members[m], {point[0], point[1]}) < kRim)
        continue;
      const double d = height_above(part.roof, point);
      result_.squared_errors[m] += d * d;
      result_.flat_squared_errors[m] +=
          (point[2] - flat_heights_[m]) * (point[2] - flat_heights_[m]);
      ++result_.counts[m];
      sum += d;
      ++count;
    }
    if (count > 0) finished.mean_above = sum / count;
    return finished;
  }

  bool is_measured(std::size_t member) const {
    return input_.sources[member] == RoofSource::kMeasured;
  }

  /// The member that most of the points are of; of as many, the first.
  MemberNumber most_of(const std::vector<std::uint32_t>& list) const {
    std::map<std::size_t, std::size_t> counts;
    for (const std::uint32_t p : list) ++counts[member_of_[p]];
    const auto most =
        std::max_element(counts.begin(), counts.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    return static_cast<MemberNumber>(most->first);
  }

  /// A plane whose corners stay near to what points say, or a flat roof where that fits better.
  RoofPlane sloped(const RoofPlane& plane, const std::vector<Point3>& inside, RoofPart& part) {
    constexpr double kNear = 0.5, kBeyond = 0.5;  // metres
    Point2 pivot = centroid(part.outline);
    double low = kInfinity, high = -low, x = 0, y = 0, count = 0;
    for (const Point3& p : inside) {
      if (std::abs(height_above(plane, p)) > kNear) continue;
      low = std::min(low, p[2]);
      high = std::max(high, p[2]);
      x += p[0], y += p[1], ++count;
    }
    if (count == 0) {
      part.lod = Lod::k1_2;
      return {pivot, plane(pivot), 0, 0};
    }
    pivot = {x / count, y / count};
    const RoofPlane result = tamed(plane, pivot, part.outline, low - kBeyond, high + kBeyond);
    std::vector<double> heights;
    for (const Point3& p : inside) heights.push_back(p[2]);
    const RoofPlane flat{pivot, percentile(heights, options_.percentile), 0, 0};
    if (rmse_of(result, inside) <= rmse_of(flat, inside)) return result;
    // A plane through part of the points only: one through all of them may do.
    PlaneFit fit(pivot);
    for (const Point3& p : inside) fit.add(p);
    if (const RoofPlane all = fit.plane(); slope_of(all) < kMaxRoofSlope) {
      const RoofPlane mean = tamed(all, pivot, part.outline, low - kBeyond, high + kBeyond);
      if (rmse_of(mean, inside) <= rmse_of(flat, inside)) return mean;
    }
    part.lod = Lod::k1_2;
    return flat;
  }

  void raise(RoofPlane& roof, const Polygon& outline, FinishedPart& finished) const {
    double lowest = kInfinity;
    for_each_edge(outline, [&](Point2 p, Point2) { lowest = std::min(lowest, roof(p)); });
    if (lowest >= options_.lowest) return;
    finished.raised = true;
    const Point2 middle = centroid(outline);
    roof = tamed(roof, middle, outline, options_.lowest, kInfinity);
  }

  const RoofInput& input_;
  Partition& lines_;
  RegionPoints& points_;
  const FinishOptions& options_;
  std::vector<std::size_t> member_of_;        ///< Per point.
  std::vector<double> flat_heights_;          ///< Per member.
  std::vector<std::int64_t> seen_, strayed_;  ///< Per member: points, those off parts of others.
  FinishedRoof result_;
};

}  // namespace

double FinishedRoof::misfit(std::size_t member) const {
  const double squares = squared_errors[member], flat = flat_squared_errors[member];
  if (!has_fit(member) || !is_misfit(squares, flat)) return 0;
  const auto n = static_cast<double>(counts[member]);
  return std::sqrt(squares / n) - std::sqrt(flat / n);
}

double FinishedRoof::misfit() const {
  double sum = 0;
  for (std::size_t m = 0; m < counts.size(); ++m) sum += misfit(m);
  return sum;
}

FinishedRoof finish_parts(const RoofInput& input, Partition& lines, RegionPoints& points,
                          const FinishOptions& options) {
  return Finishing(input, lines, points, options).run();
}

}  // namespace tetropolis
