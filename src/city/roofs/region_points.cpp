#include "city/roofs/region_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "tetropolis/city/heights.h"
#include "tetropolis/core/row_major.h"
#include "tetropolis/geometry/polygon.h"

#include "city/roofs/plane_fit.h"
#include "core/infinity.h"
#include "core/ragged_builder.h"
#include "core/sort_once.h"
#include "core/wide.h"
#include "geometry/predicates.h"
#include "geometry/vec2.h"

namespace tetropolis {

/// An edge from its lower end (x, y) on, up to `top`.
struct RisingEdge {
  RisingEdge(Point2 a, Point2 b) {
    if (a.y > b.y) std::swap(a, b);
    x = a.x, y = a.y, top = b.y, dx = b.x - a.x, dy = b.y - a.y;
    per_metre = dx / dy;  // Not used of level edges.
  }
  double at(double height) const { return x + (height - y) * per_metre; }
  double x, y, top, dx, dy, per_metre;
};

namespace {

constexpr double kCell = 1;    // metres
constexpr double kNear = 0.5;  // metres: what a plane is fitted to

double huber(double d) {
  constexpr double kSquare = 1;  // metres
  return d < kSquare ? d * d : kSquare * (2 * d - kSquare);
}

std::size_t slot(double distance, std::size_t count) {
  return std::min(static_cast<std::size_t>(std::max(distance, 0.0) / kCell), count - 1);
}

/// Points whose places in a triangle are told at a time.
constexpr std::size_t kBatch = 64;

/// As crosses_ray().
TETROPOLIS_INLINE std::int64_t crosses(const RisingEdge& e, double x, double y) {
  const std::int64_t is_beside = static_cast<std::int64_t>(e.y > y) ^ (e.top > y ? 1 : 0);
  return is_beside & (e.dx * (y - e.y) - (x - e.x) * e.dy > 0 ? 1 : 0);
}

std::array<RisingEdge, 3> edges_of(const std::array<Point2, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  return {RisingEdge(a, b), RisingEdge(b, c), RisingEdge(c, a)};
}

/// Of a triangle that gets another plane, apart from its points.
double cost_of_area(Point2 a, Point2 b, Point2 c, const RoofPlane& before, const RoofPlane& after) {
  constexpr double kShare = 0.1;
  const double size = std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
  const Point2 middle{(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3};
  return kShare * size * huber(std::abs(after(middle) - before(middle)));
}

/// By the even-odd rule, in a loop that becomes vectors. Returns how many are inside.
TETROPOLIS_WIDE std::int64_t find_inside(std::size_t count, const std::array<RisingEdge, 3>& edges,
                                         const double* __restrict x, const double* __restrict y,
                                         std::int64_t* __restrict is_inside) {
  const RisingEdge e0 = edges[0], e1 = edges[1], e2 = edges[2];
  std::int64_t sum = 0;
  for (std::size_t k = 0; k < count; ++k) {
    is_inside[k] = crosses(e0, x[k], y[k]) ^ crosses(e1, x[k], y[k]) ^ crosses(e2, x[k], y[k]);
    sum += is_inside[k];
  }
  return sum;
}

/// Calls visit(i) for those of `count` points that are in the triangle with these edges.
template <typename Visit>
void for_each_inside(const std::array<RisingEdge, 3>& edges, const double* x, const double* y,
                     std::size_t count, const Visit& visit) {
  std::array<std::int64_t, kBatch> is_inside;
  for (std::size_t i = 0; i < count; i += kBatch) {
    const std::size_t size = std::min(kBatch, count - i);
    if (find_inside(size, edges, x + i, y + i, is_inside.data()) == 0) continue;
    for (std::size_t k = 0; k < size; ++k)
      if (is_inside[k] != 0) visit(i + k);
  }
}

}  // namespace

RegionPoints::RegionPoints(const std::vector<Point3>& points, std::vector<double> weights,
                           std::vector<RoofRegion> region_of, std::vector<RegionRoof> roofs,
                           const Bounds2& box, double percentile, double cap)
    : points_(points),
      percentile_(percentile),
      cap_(cap),
      weight_(std::move(weights)),
      region_of_(std::move(region_of)),
      roofs_(std::move(roofs)),
      lists_(roofs_.size()),
      is_fitted_(roofs_.size(), 0),
      box_(box) {
  columns_ = static_cast<std::size_t>(box_.width() / kCell) + 1;
  rows_ = static_cast<std::size_t>(box_.height() / kCell) + 1;
  RaggedBuilder<std::uint32_t> builder(columns_ * rows_);
  const auto cell_of = [&](std::uint32_t p) {
    return row_major(slot(points_[p][0] - box_.xmin, columns_),
                     slot(points_[p][1] - box_.ymin, rows_), columns_);
  };
  const auto count = static_cast<std::uint32_t>(points_.size());
  for (std::uint32_t p = 0; p < count; ++p)
    if (region_of_[p] >= 0) builder.count(cell_of(p));
  builder.start();
  for (std::uint32_t p = 0; p < count; ++p) {
    if (region_of_[p] < 0) continue;
    builder.place(cell_of(p), p);
    lists_[index(region_of_[p])].push_back(p);
  }
  grid_ = builder.take();
  for (const std::uint32_t p : grid_.values) {
    x_.push_back(points_[p][0]);
    y_.push_back(points_[p][1]);
  }
}

template <typename Visit>
void RegionPoints::for_each_near(const Bounds2& box, const Visit& visit) const {
  const std::size_t west = slot(box.xmin - box_.xmin, columns_);
  const std::size_t east = slot(box.xmax - box_.xmin, columns_);
  const std::size_t north = slot(box.ymax - box_.ymin, rows_);
  for (std::size_t y = slot(box.ymin - box_.ymin, rows_); y <= north; ++y)
    for (std::size_t x = west; x <= east; ++x)
      for (const std::uint32_t p : grid_[row_major(x, y, columns_)]) visit(p);
}

template <typename Visit>
void RegionPoints::for_each_range(std::span<const RisingEdge> segments, double reach,
                                  const Visit& visit) const {
  constexpr double kRounding = 1e-6;  // far beyond, metres
  const double margin = reach + kRounding;
  double ymin = kInfinity, ymax = -kInfinity;
  for (const RisingEdge& e : segments) {
    ymin = std::min(ymin, e.y);
    ymax = std::max(ymax, e.top);
  }
  const std::size_t north = slot(ymax + margin - box_.ymin, rows_);
  for (std::size_t y = slot(ymin - margin - box_.ymin, rows_); y <= north; ++y) {
    // Cells at the rim take in what is beyond.
    const double low = y == 0 ? -kInfinity : box_.ymin + static_cast<double>(y) * kCell - margin;
    const double high =
        y + 1 == rows_ ? kInfinity : box_.ymin + static_cast<double>(y + 1) * kCell + margin;
    double xmin = kInfinity, xmax = -kInfinity;
    for (const RisingEdge& e : segments) {
      if (e.y > high || e.top < low) continue;
      const double first = e.y < low ? e.at(low) : e.x;
      const double last = e.top > high ? e.at(high) : e.x + e.dx;
      xmin = std::min({xmin, first, last});
      xmax = std::max({xmax, first, last});
    }
    if (xmin > xmax) continue;
    const std::size_t west = slot(xmin - margin - box_.xmin, columns_);
    const std::size_t east = slot(xmax + margin - box_.xmin, columns_);
    visit(static_cast<std::size_t>(grid_.offsets[row_major(west, y, columns_)]),
          static_cast<std::size_t>(grid_.offsets[row_major(east, y, columns_) + 1]));
  }
}

template <typename Visit>
void RegionPoints::for_each_in(const std::array<Point2, 3>& triangle, const Visit& visit) const {
  const std::array<RisingEdge, 3> edges = edges_of(triangle);
  for_each_range(edges, 0, [&](std::size_t begin, std::size_t end) {
    for_each_inside(edges, x_.data() + begin, y_.data() + begin, end - begin,
                    [&](std::size_t i) { visit(grid_.values[begin + i]); });
  });
}

double RegionPoints::cost(const RoofPlane& plane, std::uint32_t point) const {
  return weight_[point] * huber(std::abs(height_above(plane, points_[point])));
}

double RegionPoints::cost(const RoofPlane& plane, const std::vector<std::uint32_t>& points) const {
  double sum = 0;
  for (const std::uint32_t p : points) sum += cost(plane, p);
  return sum;
}

double RegionPoints::loss(const RoofPlane& plane, const std::vector<std::uint32_t>& points) const {
  double sum = 0;
  for (const std::uint32_t p : points) {
    const double d = std::min(std::abs(height_above(plane, points_[p])), cap_);
    sum += weight_[p] * d * d;
  }
  return sum;
}

std::vector<std::uint32_t> RegionPoints::points_of(RoofRegion r) const {
  std::vector<std::uint32_t> result;
  for (const std::uint32_t p : lists_[index(r)])
    if (region_of_[p] == r) result.push_back(p);
  sort_once(result);
  return result;
}

double RegionPoints::cost_of_triangle(Point2 a, Point2 b, Point2 c, RoofRegion from,
                                      RoofRegion to) const {
  if (from == to || from < 0 || to < 0) return 0;
  const RoofPlane& before = roof(from).plane;
  const RoofPlane& after = roof(to).plane;
  double sum = 0;
  for_each_in({a, b, c}, [&](std::uint32_t p) { sum += cost(after, p) - cost(before, p); });
  return sum + cost_of_area(a, b, c, before, after);
}

void RegionPoints::add_costs_of_moves(Point2 from, Point2 to, std::span<const Point2> places,
                                      RoofRegion left, RoofRegion right,
                                      std::span<double> sums) const {
  if (left == right || left < 0 || right < 0) return;
  const RoofPlane& before = roof(left).plane;
  const RoofPlane& after = roof(right).plane;
  double reach = 0;
  for (const Point2 place : places) reach = std::max(reach, distance(place, from));
  // What points near the line cost is found once.
  std::vector<double> x, y, costs;
  for_each_range(std::array{RisingEdge(from, to)}, reach, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      x.push_back(x_[i]);
      y.push_back(y_[i]);
      const std::uint32_t p = grid_.values[i];
      costs.push_back(cost(after, p) - cost(before, p));
    }
  });
  for (std::size_t n = 0; n < places.size(); ++n) {
    double sum = 0;
    for_each_inside(edges_of({from, to, places[n]}), x.data(), y.data(), x.size(),
                    [&](std::size_t i) { sum += costs[i]; });
    const bool is_left = orient2d(from, to, places[n]) > 0;
    sums[n] += (is_left ? sum : -sum) + cost_of_area(from, to, places[n], before, after);
  }
}

RegionRoof RegionPoints::fitted(const std::vector<RegionRoof>& candidates,
                                const std::vector<std::uint32_t>& points) const {
  RegionRoof best = candidates.front();
  if (points.empty() || best.lod == Lod::kBlock) return best;
  if (best.lod != Lod::k2_2) {
    std::vector<double> heights;
    for (const std::uint32_t p : points) heights.push_back(points_[p][2]);
    best.plane.elevation = percentile(heights, percentile_);
    return best;
  }
  double least = loss(best.plane, points);
  const auto consider = [&](const RoofPlane& plane) {
    if (const double cost = loss(plane, points); cost < least) least = cost, best.plane = plane;
  };
  const auto fit_near = [&](const RoofPlane& plane, double near) {
    PlaneFit fit(plane.at);
    for (const std::uint32_t p : points)
      if (std::abs(height_above(plane, points_[p])) < near) fit.add(points_[p]);
    if (fit.count() < 5) return;
    if (const RoofPlane better = fit.plane(); slope_of(better) < kMaxRoofSlope) consider(better);
  };
  for (std::size_t k = 1; k < candidates.size(); ++k) consider(candidates[k].plane);
  for (const RegionRoof& candidate : candidates) fit_near(candidate.plane, kNear);
  fit_near(best.plane, cap_);
  fit_near(best.plane, cap_);
  return best;
}

RegionRoof RegionPoints::merged_roof(RoofRegion a, RoofRegion b,
                                     const std::vector<std::uint32_t>& points) const {
  if (roof(a).lod < roof(b).lod) std::swap(a, b);
  if (roof(a).lod == Lod::kBlock && cost_of_exchange(b, a) < cost_of_exchange(a, b)) return roof(b);
  return fitted({roof(a), roof(b)}, points);
}

double RegionPoints::cost_of_exchange(RoofRegion keep, RoofRegion gone) const {
  double sum = 0;
  for (const std::uint32_t p : lists_[index(gone)])
    if (region_of_[p] == gone) sum += cost(roof(keep).plane, p) - cost(roof(gone).plane, p);
  return sum;
}

double RegionPoints::cost_of_merging(RoofRegion a, RoofRegion b) const {
  if (roof(a).lod == Lod::kBlock && roof(b).lod == Lod::kBlock)
    return std::min(cost_of_exchange(a, b), cost_of_exchange(b, a));
  std::vector<std::uint32_t> both = points_of(a);
  const std::vector<std::uint32_t> second = points_of(b);
  const double before = cost(roof(a).plane, both) + cost(roof(b).plane, second);
  both.insert(both.end(), second.begin(), second.end());
  return cost(merged_roof(a, b, both).plane, both) - before;
}

bool RegionPoints::flatten(RoofRegion r) {
  RegionRoof& roof = roofs_[index(r)];
  if (roof.lod <= Lod::k1_2) return false;
  roof.lod = Lod::k1_2;
  roof.plane.slope_x = roof.plane.slope_y = 0;
  roof = fitted({roof}, points_of(r));
  return true;
}

void RegionPoints::merge(RoofRegion keep, RoofRegion gone) {
  std::vector<std::uint32_t> both = points_of(keep);
  const std::vector<std::uint32_t> second = points_of(gone);
  both.insert(both.end(), second.begin(), second.end());
  roofs_[index(keep)] = merged_roof(keep, gone, both);
  for (const std::uint32_t p : second) region_of_[p] = keep;
  lists_[index(keep)] = std::move(both);
  lists_[index(gone)].clear();
  is_fitted_[index(keep)] = is_fitted_[index(gone)] = 0;
}

void RegionPoints::update(const Bounds2& box, const Partition& lines) {
  for_each_near(box, [&](std::uint32_t p) {
    const Point2 q{points_[p][0], points_[p][1]};
    if (!box.contains(q)) return;
    const RoofRegion r = lines.region_at(q);
    if (r == region_of_[p]) return;
    if (region_of_[p] >= 0) is_fitted_[index(region_of_[p])] = 0;
    region_of_[p] = r;
    if (r < 0) return;
    lists_[index(r)].push_back(p);
    is_fitted_[index(r)] = 0;
  });
}

void RegionPoints::fit() {
  for (std::size_t r = 0; r < roofs_.size(); ++r) {
    if (is_fitted_[r] != 0) continue;
    lists_[r] = points_of(static_cast<RoofRegion>(r));
    const RoofPlane before = roofs_[r].plane;
    roofs_[r] = fitted({roofs_[r]}, lists_[r]);
    is_fitted_[r] = roofs_[r].plane == before ? 1 : 0;
  }
}

RegionPoints region_points(const RoofInput& input, const RoofCells& cells,
                           const RoofRegions& regions, double percentile, double cap) {
  std::vector<double> weights;
  for (std::size_t m = 0; m < input.members.size(); ++m) {
    const auto count = static_cast<double>(input.points[m].size());
    weights.insert(weights.end(), input.points[m].size(),
                   std::min(20.0, area(*input.members[m]) / std::max(count, 1.0)));
  }
  std::vector<RoofRegion> region_of(input.points.values.size(), -1);
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (const std::uint32_t p : cells.points[c]) region_of[p] = regions.of_cell[c];
  return {input.points.values,
          std::move(weights),
          std::move(region_of),
          regions.roofs,
          bounds(input.footprint),
          percentile,
          cap};
}

}  // namespace tetropolis
