#include "city/roofs/label_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "tetropolis/city/heights.h"
#include "tetropolis/geometry/polygon.h"

#include "city/roofs/max_flow.h"
#include "city/roofs/plane_fit.h"
#include "core/parallel.h"

namespace tetropolis {

namespace {

using Label = std::int32_t;

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

/// Costs are whole numbers of this share of a square metre.
constexpr double kPerSquareMetre = 1e4;
std::int32_t cost_of(double square_metres) {
  constexpr double kMost = 1e5;
  return static_cast<std::int32_t>(std::lround(std::min(square_metres, kMost) * kPerSquareMetre));
}

RoofPlane flat_roof(Point2 at, double elevation) { return {at, elevation, 0, 0}; }

/// The cells of one member, and the planes they choose from.
class MemberLabels {
 public:
  /// `own`: the member's cells. `place`: per cell of all, which of its member's it is. `planes`: at
  /// least one.
  MemberLabels(const RoofInput& input, const RoofCells& cells, const LabelOptions& options,
               MemberNumber member, const std::vector<CellNumber>& own,
               const std::vector<std::int32_t>& place, std::span<const DetectedPlane> planes)
      : points_(input.points.values),
        cells_(cells),
        options_(options),
        own_(own),
        density_(input.density(index(member))) {
    for (const Point3& p : input.points[index(member)]) {
      lowest_ = std::min(lowest_, p[2]);
      highest_ = std::max(highest_, p[2]);
    }
    for (const DetectedPlane& found : planes) {
      planes_.push_back(found.plane);
      boxes_.push_back(found.box);
    }
    labels_.assign(own_.size(), 0);
    steps_.assign(own_.size(), -1);
    node_.assign(own_.size(), -1);
    for (const CellNumber c : own_) {
      Sides& sides = sides_.emplace_back();
      for (std::size_t e = 0; e < 3; ++e) {
        const CellNumber n = cells.neighbours[index(c)][e];
        if (n < 0 || cells.member[index(n)] != member) continue;
        sides.neighbour[e] = place[index(n)];
        sides.border[e] = cost_of(options.border_cost * cells.edge_length(c, e));
      }
    }
  }

  MemberPlanes run() {
    constexpr int kRounds = 2;
    for (int round = 0; round < kRounds; ++round) {
      if (count() > 1) {
        set_costs();
        choose();
      }
      drop_small_pieces();
      fit_again();
    }
    return {std::move(planes_), std::move(labels_)};
  }

 private:
  /// Of a cell.
  struct Sides {
    /// Index of own_ across each edge; -1: outside or another member's.
    std::array<std::int32_t, 3> neighbour{-1, -1, -1};
    std::array<std::int32_t, 3> border{};  ///< What an edge costs where labels differ.
  };

  std::size_t count() const { return planes_.size(); }
  std::int32_t cost(std::size_t i, Label label) const {
    return costs_[index(label) * own_.size() + i];
  }
  std::int32_t neighbour(std::size_t i, std::size_t edge) const {
    return sides_[i].neighbour[edge];
  }
  std::int32_t border(std::size_t i, std::size_t edge) const { return sides_[i].border[edge]; }

  void set_costs() {
    costs_.assign(own_.size() * count(), 0);
    constexpr double kBeyond = 0.5;  // metres that a roof may leave the range of its points
    constexpr double kReach = 5;     // metres around its points where a plane may be a roof
    for (std::size_t i = 0; i < own_.size(); ++i) {
      const Point2 centre = cells_.centre(own_[i]);
      const double size = cells_.area(own_[i]);
      const auto number = static_cast<double>(cells_.points[index(own_[i])].size());
      for (std::size_t k = 0; k < count(); ++k) {
        std::int32_t& cost = costs_[k * own_.size() + i];
        if (!boxes_[k].grown(kReach).contains(centre)) {
          cost = cost_of(number / density_ + size);
          continue;
        }
        double sum = 0;
        for (const std::uint32_t p : cells_.points[index(own_[i])])
          sum += std::min(std::abs(height_above(planes_[k], points_[p])) / options_.cap, 1.0);
        const double z = planes_[k](centre);
        const bool beyond = z > highest_ + kBeyond || z < lowest_ - kBeyond;
        cost = cost_of(sum / density_ + (beyond ? size : 0));
      }
    }
  }

  void choose() {
    std::fill(labels_.begin(), labels_.end(), 0);
    own_costs_.assign(costs_.begin(), costs_.begin() + static_cast<std::ptrdiff_t>(own_.size()));
    for (Label k = 1; index(k) < count(); ++k)
      for (std::size_t i = 0; i < own_.size(); ++i)
        if (cost(i, k) < own_costs_[i]) set_label(i, k);
    constexpr int kRounds = 3;
    bool changed = true;
    for (int round = 0; round < kRounds && changed; ++round) {
      changed = false;
      for (Label k = 0; index(k) < count(); ++k) changed = expand(k) || changed;
    }
  }

  void set_label(std::size_t i, Label k) {
    labels_[i] = k;
    own_costs_[i] = cost(i, k);
  }

  /// The cells that may take a label: those near to such as have it or would rather have it.
  std::vector<std::int32_t> candidates(Label k) {
    constexpr std::int32_t kSteps = 6;
    std::vector<std::int32_t> queue;
    for (std::size_t i = 0; i < own_.size(); ++i)
      if (labels_[i] == k || cost(i, k) < own_costs_[i]) {
        steps_[i] = 0;
        queue.push_back(static_cast<std::int32_t>(i));
      }
    for (std::size_t q = 0; q < queue.size(); ++q) {
      const std::int32_t i = queue[q];
      if (steps_[index(i)] == kSteps) continue;
      for (std::size_t e = 0; e < 3; ++e)
        if (const std::int32_t n = neighbour(index(i), e); n >= 0 && steps_[index(n)] < 0) {
          steps_[index(n)] = steps_[index(i)] + 1;
          queue.push_back(n);
        }
    }
    for (const std::int32_t i : queue) steps_[index(i)] = -1;
    std::erase_if(queue, [&](std::int32_t i) { return labels_[index(i)] == k; });
    return queue;
  }

  /// The best change of cells to label k.
  bool expand(Label k) {
    const std::vector<std::int32_t> active = candidates(k);
    if (active.empty()) return false;
    for (std::size_t a = 0; a < active.size(); ++a)
      node_[index(active[a])] = static_cast<std::int32_t>(a);
    std::vector<std::int32_t> keep(active.size()), take(active.size());
    MaxFlow flow(active.size());
    for (std::size_t a = 0; a < active.size(); ++a) {
      const std::size_t i = index(active[a]);
      keep[a] += own_costs_[i];
      take[a] += cost(i, k);
      for (std::size_t e = 0; e < 3; ++e) {
        const std::int32_t n = neighbour(i, e);
        if (n < 0) continue;
        const std::int32_t w = border(i, e);
        const std::int32_t b = node_[index(n)];
        if (b < 0) {
          if (labels_[index(n)] != labels_[i]) keep[a] += w;
          if (labels_[index(n)] != k) take[a] += w;
        } else if (static_cast<std::size_t>(b) > a) {
          // Both keep: w if their labels differ; one takes: w; both: 0.
          const std::int32_t both_keep = labels_[i] != labels_[index(n)] ? w : 0;
          take[a] += w - both_keep;
          take[index(b)] -= w;
          flow.add_arc(static_cast<std::int32_t>(a), b, 2 * w - both_keep, 0);
        }
      }
    }
    for (std::size_t a = 0; a < active.size(); ++a) {
      const std::int32_t least = std::min(take[a], keep[a]);
      flow.add_terminal(static_cast<std::int32_t>(a), take[a] - least, keep[a] - least);
    }
    flow.run();
    bool changed = false;
    for (std::size_t a = 0; a < active.size(); ++a) {
      node_[index(active[a])] = -1;
      if (flow.on_source_side(static_cast<std::int32_t>(a))) continue;
      set_label(index(active[a]), k);
      changed = true;
    }
    return changed;
  }

  /// Numbers connected pieces of one label.
  void find_pieces() {
    piece_.assign(own_.size(), -1);
    piece_label_.clear();
    piece_area_.clear();
    for (std::size_t start = 0; start < own_.size(); ++start) {
      if (piece_[start] >= 0) continue;
      const auto id = static_cast<std::int32_t>(piece_label_.size());
      std::vector<std::size_t> stack{start};
      piece_[start] = id;
      double sum = 0;
      while (!stack.empty()) {
        const std::size_t i = stack.back();
        stack.pop_back();
        sum += cells_.area(own_[i]);
        for (std::size_t e = 0; e < 3; ++e)
          if (const std::int32_t n = neighbour(i, e);
              n >= 0 && piece_[index(n)] < 0 && labels_[index(n)] == labels_[i]) {
            piece_[index(n)] = id;
            stack.push_back(index(n));
          }
      }
      piece_label_.push_back(labels_[start]);
      piece_area_.push_back(sum);
    }
  }

  /// Pieces that are too small take the label of the neighbour that costs least.
  void drop_small_pieces() {
    for (;;) {
      find_pieces();
      const auto least = std::min_element(piece_area_.begin(), piece_area_.end());
      if (piece_area_.size() <= 1 || *least >= options_.min_area) return;
      std::vector<std::int32_t> small;
      for (std::size_t p = 0; p < piece_area_.size(); ++p)
        if (piece_area_[p] < options_.min_area) small.push_back(static_cast<std::int32_t>(p));
      std::stable_sort(small.begin(), small.end(), [&](std::int32_t a, std::int32_t b) {
        return piece_area_[index(a)] < piece_area_[index(b)];
      });
      if (!drop_first_with_neighbours(small)) return;
    }
  }

  bool drop_first_with_neighbours(const std::vector<std::int32_t>& small) {
    // Pieces beside each other are not dropped at once: what a neighbour becomes is not known yet.
    std::vector<std::uint8_t> touched(piece_area_.size(), 0);
    std::vector<std::vector<std::size_t>> cells_of(piece_area_.size());
    for (std::size_t i = 0; i < own_.size(); ++i) cells_of[index(piece_[i])].push_back(i);
    bool any = false;
    for (const std::int32_t p : small) {
      if (touched[index(p)] != 0) continue;
      std::map<Label, std::int64_t> costs;
      std::set<std::int32_t> beside;
      for (const std::size_t i : cells_of[index(p)])
        for (std::size_t e = 0; e < 3; ++e)
          if (const std::int32_t n = neighbour(i, e); n >= 0 && piece_[index(n)] != p) {
            costs[labels_[index(n)]] -= border(i, e);
            beside.insert(piece_[index(n)]);
          }
      if (costs.empty()) continue;
      for (auto& [label, sum] : costs)
        for (const std::size_t i : cells_of[index(p)]) sum += cost(i, label);
      const Label best =
          std::min_element(costs.begin(), costs.end(), [](const auto& a, const auto& b) {
            return a.second < b.second;
          })->first;
      for (const std::size_t i : cells_of[index(p)]) labels_[i] = best;
      touched[index(p)] = 1;
      for (const std::int32_t n : beside) touched[index(n)] = 1;
      any = true;
    }
    return any;
  }

  /// A plane per piece, fitted to what is near to the one it had.
  void fit_again() {
    constexpr double kNear = 0.5;  // metres
    std::vector<RoofPlane> fitted;
    std::vector<PlaneFit> fits;
    for (std::size_t p = 0; p < piece_label_.size(); ++p)
      fits.emplace_back(planes_[index(piece_label_[p])].at);
    boxes_.assign(piece_label_.size(), Bounds2::nothing());
    for (std::size_t i = 0; i < own_.size(); ++i)
      boxes_[index(piece_[i])].extend(cells_.centre(own_[i]));
    for (std::size_t i = 0; i < own_.size(); ++i)
      for (const std::uint32_t p : cells_.points[index(own_[i])])
        if (std::abs(height_above(planes_[index(labels_[i])], points_[p])) < kNear)
          fits[index(piece_[i])].add(points_[p]);
    const double need = std::max(5.0, options_.min_area * density_);
    for (std::size_t p = 0; p < piece_label_.size(); ++p) {
      RoofPlane plane = planes_[index(piece_label_[p])];
      if (fits[p].count() >= need)
        if (const RoofPlane better = fits[p].plane(); slope_of(better) < kMaxRoofSlope)
          plane = better;
      fitted.push_back(plane);
    }
    planes_ = std::move(fitted);
    labels_ = piece_;
  }

  const std::vector<Point3>& points_;
  const RoofCells& cells_;
  const LabelOptions& options_;
  const std::vector<CellNumber>& own_;
  std::vector<Sides> sides_;
  double density_;
  double lowest_ = std::numeric_limits<double>::infinity();
  double highest_ = -std::numeric_limits<double>::infinity();
  std::vector<RoofPlane> planes_;
  std::vector<Bounds2> boxes_;           ///< Per plane: of what it was found at.
  std::vector<std::int32_t> costs_;      ///< Per plane and cell.
  std::vector<Label> labels_;            ///< Per cell.
  std::vector<std::int32_t> own_costs_;  ///< Per cell, of its label: while labels are chosen.
  std::vector<std::int32_t> piece_;      ///< Per cell.
  std::vector<Label> piece_label_;
  std::vector<double> piece_area_;
  std::vector<std::int32_t> steps_, node_;  ///< Per cell, -1 but while a label expands.
};

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

  double density(MemberNumber m) const {
    return std::max(0.05, static_cast<double>(input_.points[index(m)].size()) /
                              area(*input_.members[index(m)]));
  }

  double misfit(const RoofPlane& plane, RoofRegion r) const {
    double sum = 0;
    for (const std::uint32_t p : points_[index(r)])
      sum += std::min(std::abs(height_above(plane, input_.points.values[p])), options_.cap);
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
    constexpr double kNever = std::numeric_limits<double>::infinity();
    if (options_.lod == Lod::k1_3) {
      if (roof(a).member != roof(b).member) return kNever;
      const double step = std::abs(roof(a).plane.elevation - roof(b).plane.elevation);
      return step < options_.step ? step : kNever;
    }
    if (options_.lod != Lod::k2_2 || roof(a).lod != Lod::k2_2 || roof(b).lod != Lod::k2_2)
      return kNever;
    const PlaneFit first = fit_of(a, roof(a).plane.at), second = fit_of(b, roof(a).plane.at);
    if (first.count() < 5 || second.count() < 5) return kNever;
    PlaneFit both = first;
    both += second;
    if (slope_of(both.plane()) > kMaxRoofSlope) return kNever;
    const double worse =
        (both.sum_of_squares() - first.sum_of_squares() - second.sum_of_squares()) /
        std::max(density(roof(a).member), density(roof(b).member));
    const double rate = worse / border;
    return rate < options_.join_cost ? rate : kNever;
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
      double best_cost = std::numeric_limits<double>::infinity();
      for (const auto& [other, border] : borders_[index(least)]) {
        const double c = misfit(roof(other).plane, least) / density(roof(least).member) -
                         options_.border_cost * border;
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

std::vector<std::vector<CellNumber>> cells_of_members(const RoofInput& input,
                                                      const RoofCells& cells) {
  std::vector<std::vector<CellNumber>> own(input.members.size());
  for (std::size_t c = 0; c < cells.size(); ++c)
    own[index(cells.member[c])].push_back(static_cast<CellNumber>(c));
  return own;
}

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
bool is_misfit(const RoofInput& input, const RoofCells& cells, const std::vector<CellNumber>& own,
               const RoofRegions& regions, const RegionRoof& flat) {
  constexpr double kWorse = 1.05 * 1.05;  // of mean squares
  double squares = 0, flat_squares = 0;
  for (const CellNumber c : own)
    for (const std::uint32_t p : cells.points[index(c)]) {
      const Point3& point = input.points.values[p];
      const double d = height_above(regions.roofs[index(regions.of_cell[index(c)])].plane, point);
      const double f = height_above(flat.plane, point);
      squares += d * d;
      flat_squares += f * f;
    }
  return squares > kWorse * flat_squares;
}

}  // namespace

std::vector<MemberPlanes> choose_planes(const RoofInput& input, const RoofCells& cells,
                                        std::span<const std::vector<DetectedPlane>> detected,
                                        const LabelOptions& options) {
  std::vector<MemberPlanes> chosen(input.members.size());
  const std::vector<std::vector<CellNumber>> own = cells_of_members(input, cells);
  std::vector<std::int32_t> place(cells.size());
  for (const std::vector<CellNumber>& list : own)
    for (std::size_t i = 0; i < list.size(); ++i)
      place[index(list[i])] = static_cast<std::int32_t>(i);
  parallel_chunks(own.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      if (!own[k].empty() && !detected[k].empty())
        chosen[k] = MemberLabels(input, cells, options, static_cast<MemberNumber>(k), own[k], place,
                                 detected[k])
                        .run();
  });
  return chosen;
}

RoofRegions label_cells(const RoofInput& input, const RoofCells& cells,
                        std::span<const MemberPlanes> chosen, const LabelOptions& options) {
  const std::vector<std::vector<CellNumber>> own = cells_of_members(input, cells);
  std::vector<RegionRoof> flat;
  for (std::size_t m = 0; m < own.size(); ++m)
    flat.push_back(flat_member(input, static_cast<MemberNumber>(m), options));
  std::vector<std::uint8_t> stays_flat(own.size(), 0);
  for (std::size_t m = 0; m < own.size(); ++m)
    stays_flat[m] =
        options.lod == Lod::k1_2 || flat[m].lod == Lod::kBlock || chosen[m].planes.empty();
  for (;;) {
    RoofRegions regions = joined_regions(input, cells, own, chosen, flat, stays_flat, options);
    bool any = false;
    for (std::size_t m = 0; m < own.size(); ++m)
      if (stays_flat[m] == 0 && is_misfit(input, cells, own[m], regions, flat[m]))
        stays_flat[m] = 1, any = true;
    if (!any) return regions;
  }
}

}  // namespace tetropolis
