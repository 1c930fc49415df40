#include "city/roofs/label_cells.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "tetropolis/city/heights.h"

#include "city/roofs/plane_fit.h"
#include "core/infinity.h"

namespace tetropolis {

namespace {

constexpr double kStep = 1;  ///< Metres: LoD1.3 tells heights that differ by that apart.
/// m^3: squared misfit times area that joining regions may cost, per metre of border that goes.
constexpr double kJoinCost = 0.05;

RoofPlane flat_roof(Point2 at, double elevation) { return {at, elevation, 0, 0}; }

/// Regions that are joined one pair after the other.
class Joining {
 public:
  Joining(const RoofInput& input, const RoofCells& cells, const LabelOptions& options,
          RoofRegions& regions)
      : input_(input), options_(options), regions_(regions) {
    const std::size_t n = regions.roofs.size();
    parent_.resize(n);
    for (std::size_t r = 0; r < n; ++r) parent_[r] = static_cast<RoofRegion>(r);
    borders_.resize(n);
    points_.resize(n);
    areas_.assign(n, 0);
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const RoofRegion r = regions.of_cell[c];
      areas_[index(r)] += cells.area(static_cast<CellNumber>(c));
      for (const std::uint32_t p : cells.points[c]) points_[index(r)].push_back(p);
      for (std::size_t e = 0; e < 3; ++e)
        if (const CellNumber d = cells.neighbours[c][e]; d >= 0 && regions.of_cell[index(d)] != r)
          borders_[index(r)][regions.of_cell[index(d)]] +=
              cells.edge_length(static_cast<CellNumber>(c), e);
    }
    version_.assign(n, 0);
  }

  void run() {
    join_small();
    for (std::size_t r = 0; r < parent_.size(); ++r)
      if (is_root(r)) queue_pairs(static_cast<RoofRegion>(r));
    while (!queue_.empty()) {
      const Pair pair = *queue_.begin();
      queue_.erase(queue_.begin());
      if (!is_root(index(pair.a)) || !is_root(index(pair.b)) ||
          version_[index(pair.a)] != pair.version_a || version_[index(pair.b)] != pair.version_b)
        continue;
      join(pair.a, pair.b, joint_roof(pair.a, pair.b));
      queue_pairs(pair.a);
    }
    renumber();
  }

 private:
  struct Pair {
    double cost;
    RoofRegion a, b;
    std::uint32_t version_a, version_b;
    friend bool operator<(const Pair& p, const Pair& q) {
      return std::tie(p.cost, p.a, p.b, p.version_a, p.version_b) <
             std::tie(q.cost, q.a, q.b, q.version_a, q.version_b);
    }
  };

  bool is_root(std::size_t r) const { return parent_[r] == static_cast<RoofRegion>(r); }
  RegionRoof& roof(RoofRegion r) { return regions_.roofs[index(r)]; }

  double misfit(const RoofPlane& plane, RoofRegion r) const {
    double sum = 0;
    for (const std::uint32_t p : points_[index(r)])
      sum += std::min(std::abs(height_above(plane, input_.points.values[p])), kPointCap);
    return sum;
  }

  PlaneFit fit_of(RoofRegion r, Point2 about) {
    constexpr double kNear = 0.5;  // metres
    PlaneFit fit(about);
    for (const std::uint32_t p : points_[index(r)])
      if (std::abs(height_above(roof(r).plane, input_.points.values[p])) < kNear)
        fit.add(input_.points.values[p]);
    return fit;
  }

  double percentile_of(std::initializer_list<RoofRegion> list) const {
    std::vector<double> heights;
    for (const RoofRegion r : list)
      for (const std::uint32_t p : points_[index(r)]) heights.push_back(input_.points.values[p][2]);
    return percentile(heights, options_.percentile);
  }

  RegionRoof joint_roof(RoofRegion a, RoofRegion b) {
    RegionRoof result = roof(a);
    if (areas_[index(b)] > areas_[index(a)]) result.member = roof(b).member;
    if (options_.lod == Lod::k1_3) {
      if (!points_[index(a)].empty() || !points_[index(b)].empty())
        result.plane.elevation = percentile_of({a, b});
    } else {
      PlaneFit fit = fit_of(a, roof(a).plane.at);
      fit += fit_of(b, roof(a).plane.at);
      if (fit.count() >= 5)
        if (const RoofPlane plane = fit.plane(); slope_of(plane) < kMaxRoofSlope)
          result.plane = plane;
    }
    return result;
  }

  /// What joining costs; infinity where the two are not to be joined.
  double cost(RoofRegion a, RoofRegion b, double border) {
    if (options_.lod == Lod::k1_3) {
      if (roof(a).member != roof(b).member) return kInfinity;
      const double step = std::abs(roof(a).plane.elevation - roof(b).plane.elevation);
      return step < kStep ? step : kInfinity;
    }
    if (options_.lod != Lod::k2_2 || roof(a).lod != Lod::k2_2 || roof(b).lod != Lod::k2_2)
      return kInfinity;
    const PlaneFit first = fit_of(a, roof(a).plane.at), second = fit_of(b, roof(a).plane.at);
    if (first.count() < 5 || second.count() < 5) return kInfinity;
    PlaneFit both = first;
    both += second;
    if (slope_of(both.plane()) > kMaxRoofSlope) return kInfinity;
    const double worse =
        (both.sum_of_squares() - first.sum_of_squares() - second.sum_of_squares()) /
        std::max(input_.density(index(roof(a).member)), input_.density(index(roof(b).member)));
    const double rate = worse / border;
    return rate < kJoinCost ? rate : kInfinity;
  }

  void queue_pairs(RoofRegion r) {
    for (const auto& [other, border] : borders_[index(r)]) {
      const RoofRegion a = std::min(r, other), b = std::max(r, other);
      if (const double c = cost(a, b, border); std::isfinite(c))
        queue_.insert({c, a, b, version_[index(a)], version_[index(b)]});
    }
  }

  void join(RoofRegion kept, RoofRegion gone, const RegionRoof& result) {
    roof(kept) = result;
    parent_[index(gone)] = kept;
    ++version_[index(kept)];
    areas_[index(kept)] += areas_[index(gone)];
    points_[index(kept)].insert(points_[index(kept)].end(), points_[index(gone)].begin(),
                                points_[index(gone)].end());
    points_[index(gone)].clear();
    for (const auto& [other, border] : borders_[index(gone)]) {
      borders_[index(other)].erase(gone);
      if (other == kept) continue;
      borders_[index(kept)][other] += border;
      borders_[index(other)][kept] += border;
    }
    borders_[index(gone)].clear();
  }

  /// Slivers between members that overlap go to the neighbour that fits best.
  void join_small() {
    for (;;) {
      RoofRegion least = -1;
      for (std::size_t r = 0; r < parent_.size(); ++r)
        if (is_root(r) && areas_[r] < options_.min_area && !borders_[r].empty() &&
            (least < 0 || areas_[r] < areas_[index(least)]))
          least = static_cast<RoofRegion>(r);
      if (least < 0) return;
      RoofRegion best = -1;
      double best_cost = kInfinity;
      for (const auto& [other, border] : borders_[index(least)]) {
        const double c =
            misfit(roof(other).plane, least) / input_.density(index(roof(least).member)) -
            kBorderCost * border;
        if (c < best_cost) best_cost = c, best = other;
      }
      join(best, least, roof(best));
    }
  }

  void renumber() {
    std::vector<RoofRegion> number(parent_.size(), -1);
    std::vector<RegionRoof> roofs;
    for (std::size_t r = 0; r < parent_.size(); ++r)
      if (is_root(r)) {
        number[r] = static_cast<RoofRegion>(roofs.size());
        roofs.push_back(regions_.roofs[r]);
      }
    for (RoofRegion& r : regions_.of_cell) {
      while (!is_root(index(r))) r = parent_[index(r)];
      r = number[index(r)];
    }
    regions_.roofs = std::move(roofs);
  }

  const RoofInput& input_;
  const LabelOptions& options_;
  RoofRegions& regions_;
  std::vector<RoofRegion> parent_;
  std::vector<std::map<RoofRegion, double>> borders_;
  std::vector<std::vector<std::uint32_t>> points_;
  std::vector<double> areas_;
  std::vector<std::uint32_t> version_;
  std::set<Pair> queue_;
};

/// The flat roof of all points of a member.
RegionRoof flat_member(const RoofInput& input, MemberNumber m, const LabelOptions& options) {
  RegionRoof roof;
  roof.member = m;
  roof.plane = flat_roof(input.members[index(m)]->outer.front(), options.fallback_height);
  constexpr std::size_t kFewest = 4;
  roof.lod = input.points[index(m)].size() < kFewest ? Lod::kBlock : Lod::k1_2;
  if (roof.lod == Lod::kBlock) return roof;
  std::vector<double> heights;
  for (const Point3& p : input.points[index(m)]) heights.push_back(p[2]);
  roof.plane.elevation = percentile(heights, options.percentile);
  return roof;
}

/// Gives every connected piece of cells of one region a number of its own.
void split_pieces(const RoofCells& cells, RoofRegions& regions) {
  std::vector<RoofRegion> number(cells.size(), -1);
  std::vector<RegionRoof> roofs;
  for (std::size_t start = 0; start < cells.size(); ++start) {
    if (number[start] >= 0) continue;
    const auto id = static_cast<RoofRegion>(roofs.size());
    roofs.push_back(regions.roofs[index(regions.of_cell[start])]);
    std::vector<std::size_t> stack{start};
    number[start] = id;
    while (!stack.empty()) {
      const std::size_t c = stack.back();
      stack.pop_back();
      for (const CellNumber d : cells.neighbours[c])
        if (d >= 0 && number[index(d)] < 0 && regions.of_cell[index(d)] == regions.of_cell[c]) {
          number[index(d)] = id;
          stack.push_back(index(d));
        }
    }
  }
  regions.of_cell = std::move(number);
  regions.roofs = std::move(roofs);
}

/// LoD1.3: regions of planes become flat.
void flatten(const RoofInput& input, const RoofCells& cells, const LabelOptions& options,
             RoofRegions& regions) {
  std::vector<std::vector<double>> heights(regions.roofs.size());
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (const std::uint32_t p : cells.points[c])
      heights[index(regions.of_cell[c])].push_back(input.points.values[p][2]);
  for (std::size_t r = 0; r < regions.roofs.size(); ++r) {
    RegionRoof& roof = regions.roofs[r];
    if (roof.lod != Lod::k2_2) continue;
    roof.lod = Lod::k1_3;
    roof.plane.slope_x = roof.plane.slope_y = 0;
    if (!heights[r].empty()) roof.plane.elevation = percentile(heights[r], options.percentile);
  }
}

/// The regions of members and their planes, joined where that costs little.
RoofRegions joined_regions(const RoofInput& input, const RoofCells& cells,
                           const std::vector<std::vector<CellNumber>>& own,
                           std::span<const MemberPlanes> chosen,
                           const std::vector<RegionRoof>& flat,
                           const std::vector<std::uint8_t>& stays_flat,
                           const LabelOptions& options) {
  RoofRegions regions;
  regions.of_cell.assign(cells.size(), 0);
  for (std::size_t m = 0; m < own.size(); ++m) {
    if (own[m].empty()) continue;
    const auto base = static_cast<RoofRegion>(regions.roofs.size());
    for (std::size_t i = 0; i < own[m].size(); ++i)
      regions.of_cell[index(own[m][i])] = base + (stays_flat[m] != 0 ? 0 : chosen[m].of_cell[i]);
    if (stays_flat[m] != 0)
      regions.roofs.push_back(flat[m]);
    else
      for (const RoofPlane& plane : chosen[m].planes)
        regions.roofs.push_back({plane, static_cast<MemberNumber>(m), Lod::k2_2});
  }
  split_pieces(cells, regions);
  if (options.lod == Lod::k1_3) flatten(input, cells, options, regions);
  Joining(input, cells, options, regions).run();
  return regions;
}

/// Whether a member's points fit one flat roof better than those of regions, which it may have in
/// common with others.
bool has_misfit(const RoofInput& input, const RoofCells& cells, const std::vector<CellNumber>& own,
                const RoofRegions& regions, const RegionRoof& flat) {
  double squares = 0, flat_squares = 0;
  for (const CellNumber c : own)
    for (const std::uint32_t p : cells.points[index(c)]) {
      const Point3& point = input.points.values[p];
      const double d = height_above(regions.roofs[index(regions.of_cell[index(c)])].plane, point);
      const double f = height_above(flat.plane, point);
      squares += d * d;
      flat_squares += f * f;
    }
  return is_misfit(squares, flat_squares);
}

}  // namespace

RoofRegions label_cells(const RoofInput& input, const RoofCells& cells,
                        std::span<const MemberPlanes> chosen, const LabelOptions& options) {
  const std::vector<std::vector<CellNumber>> own = cells.of_members(input.members.size());
  std::vector<RegionRoof> flat;
  std::vector<std::uint8_t> stays_flat;
  for (std::size_t m = 0; m < own.size(); ++m) {
    flat.push_back(flat_member(input, static_cast<MemberNumber>(m), options));
    stays_flat.push_back(options.lod == Lod::k1_2 || flat[m].lod == Lod::kBlock ||
                         chosen[m].planes.empty());
  }
  for (;;) {
    RoofRegions regions = joined_regions(input, cells, own, chosen, flat, stays_flat, options);
    bool any = false;
    for (std::size_t m = 0; m < own.size(); ++m)
      if (stays_flat[m] == 0 && has_misfit(input, cells, own[m], regions, flat[m]))
        stays_flat[m] = 1, any = true;
    if (!any) return regions;
  }
}

}  // namespace tetropolis
