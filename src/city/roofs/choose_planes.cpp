#include "city/roofs/choose_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

#include "tetropolis/geometry/types.h"

#include "city/roofs/max_flow.h"
#include "city/roofs/plane_fit.h"
#include "core/infinity.h"
#include "core/parallel.h"

namespace tetropolis {

namespace {

using Label = std::int32_t;

/// Costs are whole numbers of this share of a square metre.
constexpr double kPerSquareMetre = 1e4;
std::int32_t cost_of(double square_metres) {
  constexpr double kMost = 1e5;
  return static_cast<std::int32_t>(std::lround(std::min(square_metres, kMost) * kPerSquareMetre));
}

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
        sides.border[e] = cost_of(kBorderCost * cells.edge_length(c, e));
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
          sum += std::min(std::abs(height_above(planes_[k], points_[p])) / kPointCap, 1.0);
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
  double lowest_ = kInfinity;
  double highest_ = -kInfinity;
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

}  // namespace

std::vector<MemberPlanes> choose_planes(const RoofInput& input, const RoofCells& cells,
                                        std::span<const std::vector<DetectedPlane>> detected,
                                        const LabelOptions& options) {
  std::vector<MemberPlanes> chosen(input.members.size());
  const std::vector<std::vector<CellNumber>> own = cells.of_members(input.members.size());
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

}  // namespace tetropolis
