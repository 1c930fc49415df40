#include "tetropolis/city/simplify/simplify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "chamfer.h"
#include "city/grid_geometry.h"
#include "city/outline.h"
#include "close_gaps.h"
#include "cluster_polygons.h"
#include "core/infinity.h"
#include "core/parallel.h"
#include "core/shared_progress.h"
#include "core/units.h"
#include "gap_fill.h"
#include "geometry/convex_hull.h"
#include "group.h"
#include "measure_changes.h"
#include "merge_polygons.h"
#include "overlay.h"
#include "repair.h"

namespace tetropolis {

namespace {

constexpr int kGentleRounds = 5;     ///< Gap fills whose reach doubles.
constexpr int kLocalHullRounds = 6;  ///< Hulls of surroundings whose radius doubles.
constexpr int kCloseRounds = 3;      ///< Fills of slots, which repairs may open again.
constexpr int kChamferRounds = 8;    ///< Corners whose neighbours change; two do nearly always.
/// Corners of footprints stay angles of cells, of which few are to be below 12 degrees.
constexpr double kSharpCornerDeg = 13.5;
/// What sharp corners without room for anything else may take with them; little of a building.
constexpr double kSmallArea = 25 * grid::kSquareMetre;
constexpr double kDomainMargin = 3;  ///< Steps, at the domain's boundary.
constexpr double kMaxShift = 0.02 * grid::kSteps;
constexpr const char* kTooThin = "too small or narrow for the merge distance";
constexpr const char* kAtBoundary = "closer than the merge distance to the domain boundary";

bool is_hull(MergeMethod method) {
  return method == MergeMethod::kUnionOfHulls || method == MergeMethod::kHull;
}

class Simplifier {
 public:
  Simplifier(std::span<const Polygon> cleaned, const Domain& domain, const SimplifyOptions& options,
             const Progress& progress);
  Simplification run();

 private:
  void clip_to_domain();
  std::vector<std::vector<std::size_t>> clusters() const;
  void count(const MergedPolygon& how);
  void merge_clusters();
  Outline repaired_outline(int round);
  void take_back(const Outline& outline);
  void apply_fills_and_cuts(std::vector<FillsAndCuts> repairs);
  bool apply(const FillsAndCuts& repairs, Group& group, std::vector<Group>& split_off) const;
  bool unite_close_groups(bool hulls);
  Group united(const std::vector<std::size_t>& parts, bool hulls);
  void repair_in_rounds();
  bool close_dead_ends();
  void repair_with_hulls();
  bool make_hull(Group& group);
  bool fill_courtyards_of_lost();
  void drop_vanished();
  void flag_moved();
  bool chamfer_corners();
  std::int64_t fill_sharp_courtyards(double least_angle);
  void drop_small();
  void drop(const Group& group, DropCause cause, const std::string& reason);
  void finish();

  double least_area() const { return options_.min_area * grid::kSquareMetre; }

  Domain domain_;
  SimplifyOptions options_;
  const Progress& progress_;
  double epsilon_;      ///< Steps.
  Domain keep_inside_;  ///< Steps; a little less than allowed.
  GroupInput input_;
  std::vector<Group> groups_;
  RepairCounts counts_;
  Simplification result_;
};

void require_sensible(const Domain& domain, const SimplifyOptions& options) {
  if (!(options.min_distance >= 0.01 && options.min_distance <= 1000))
    throw Error(ErrorKind::kUsage, fmt::format("merge distance {} m: must be from 0.01 to 1000",
                                               options.min_distance));
  if (!(options.close_gaps >= 0 && options.close_gaps <= 1000))
    throw Error(ErrorKind::kUsage,
                fmt::format("gaps to close of {} m: must be from 0 to 1000", options.close_gaps));
  if (!domain.is_box())
    throw Error(ErrorKind::kUsage, "simplification: the domain is no box along the axes");
  if (options.growths < 1)
    throw Error(ErrorKind::kUsage, fmt::format("growths {}: must be at least 1", options.growths));
  if (!(options.min_area >= 0))
    throw Error(ErrorKind::kUsage,
                fmt::format("minimum footprint area {}: must not be negative", options.min_area));
  if (!(options.parallel_tolerance >= 0 && options.parallel_tolerance <= 0.5))
    throw Error(ErrorKind::kUsage, fmt::format("parallel tolerance {}: must be from 0 to 0.5 rad",
                                               options.parallel_tolerance));
}

/// The domain, a box, in steps.
Domain in_steps(const Domain& domain) {
  const Bounds2& box = domain.bounds();
  const Point2 low = grid::to_steps(Point2{box.xmin, box.ymin});
  const Point2 high = grid::to_steps(Point2{box.xmax, box.ymax});
  return {low.x, low.y, high.x, high.y};
}

Simplifier::Simplifier(std::span<const Polygon> cleaned, const Domain& domain,
                       const SimplifyOptions& options, const Progress& progress)
    : domain_(domain),
      options_(options),
      progress_(progress),
      // Not a step more where the product is a little above a whole number.
      epsilon_(std::ceil(options.min_distance * grid::kSteps - 1e-6)),
      keep_inside_(in_steps(domain).inset(epsilon_ + kDomainMargin)),
      input_(cleaned, keep_inside_) {}

void Simplifier::clip_to_domain() {
  for (Group& group : input_.single_groups()) {
    const bool is_clipped = (group.flags & kClipped) != 0;
    if (group.polygon.outer.empty()) {
      drop(group, is_clipped ? DropCause::kBoundary : DropCause::kUnusable,
           is_clipped ? kAtBoundary : "fewer than 3 distinct vertices");
      continue;
    }
    if (is_clipped) ++result_.stats.clipped;
    groups_.push_back(std::move(group));
  }
}

/// The members of each cluster of polygons closer than epsilon, in order.
std::vector<std::vector<std::size_t>> Simplifier::clusters() const {
  std::vector<Polygon> polygons;
  polygons.reserve(groups_.size());
  for (const Group& group : groups_) polygons.push_back(group.polygon);
  std::vector<std::vector<std::size_t>> parts;
  const std::vector<std::int32_t> cluster = cluster_polygons(polygons, epsilon_);
  for (std::size_t k = 0; k < cluster.size(); ++k) {
    const auto c = static_cast<std::size_t>(cluster[k]);  // numbered in order of first members
    if (c == parts.size()) parts.emplace_back();
    parts[c].push_back(k);
  }
  return parts;
}

void Simplifier::count(const MergedPolygon& how) {
  SimplifyStats& stats = result_.stats;
  switch (how.method) {
    case MergeMethod::kUnion:
      ++stats.merged_by_union;
      break;
    case MergeMethod::kGapFill:
      ++stats.merged_by_gap_fill[static_cast<std::size_t>(how.growths)];
      break;
    case MergeMethod::kBridge:
      ++stats.merged_by_bridge;
      break;
    case MergeMethod::kUnionOfHulls:
      ++stats.merged_by_hulls;
      break;
    case MergeMethod::kHull:
      ++stats.merged_by_hull;
      break;
  }
}

void Simplifier::merge_clusters() {
  const std::vector<std::vector<std::size_t>> parts = clusters();
  result_.stats.groups = std::ssize(parts);
  result_.stats.merged_by_gap_fill.assign(static_cast<std::size_t>(options_.growths) + 1, 0);
  std::vector<MergedPolygon> how(parts.size());
  const Progress merging = portion(progress_, 0.05, 0.35);
  SharedProgress shared(merging, std::ssize(parts));
  parallel_chunks(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      shared.add(1);
      if (parts[c].size() == 1) continue;
      std::vector<Polygon> members;
      for (const std::size_t i : parts[c]) members.push_back(groups_[i].polygon);
      how[c] = merge_polygons(members, epsilon_, options_.growths, [&] { shared.add(0); });
    }
  });
  std::vector<Group> merged(parts.size());
  for (std::size_t c = 0; c < parts.size(); ++c) {
    Group& group = merged[c];
    if (parts[c].size() == 1) {
      group = std::move(groups_[parts[c][0]]);
      continue;
    }
    group.flags = kMerged;
    for (const std::size_t i : parts[c]) {
      group.members.push_back(groups_[i].members[0]);
      group.flags |= groups_[i].flags;
    }
    group.polygon = std::move(how[c].polygon);
    group.input = std::move(how[c].input);
    if (is_hull(how[c].method)) group.flags |= kConvexHull;
    count(how[c]);
  }
  groups_ = std::move(merged);
  unite_close_groups(false);
}

Outline Simplifier::repaired_outline(int round) {
  std::vector<const Polygon*> polygons;
  polygons.reserve(groups_.size());
  for (const Group& group : groups_) polygons.push_back(&group.polygon);
  Outline outline = outline_for(polygons, epsilon_);
  // Gentle changes first, so that gap fills come before changes that cost more than they.
  constexpr std::array<double, 4> kCosts{0.5, 2, 8, kInfinity};
  RepairOptions options;
  options.epsilon = epsilon_;
  options.max_cost = kCosts[static_cast<std::size_t>(std::min(round, 3))] * epsilon_ * epsilon_;
  options.keep_inside = keep_inside_;
  options.parallel_tolerance = options_.parallel_tolerance;
  options.max_shift = kMaxShift;
  tidy_vertices(outline, options, counts_);
  if (round == 0) {
    // Outlines with far more vertices than epsilon allows are thinned at a finer scale first, where
    // each vertex has few others near it.
    RepairOptions fine = options;
    fine.epsilon = std::ceil(epsilon_ / 4);
    fine.max_cost /= 16;
    repair_vertices(outline, fine, counts_);
  }
  repair_vertices(outline, options, counts_);
  tidy_vertices(outline, options, counts_);
  return outline;
}

void Simplifier::take_back(const Outline& outline) {
  OutlineRing ring(0);
  for (std::size_t k = 0; k < groups_.size(); ++k) {
    const std::size_t rings = 1 + groups_[k].polygon.holes.size();
    if (outline.changed[k] != 0) {
      groups_[k].polygon = extract_polygon(outline, ring, rings);
      groups_[k].flags |= kRepaired;
    }
    ring += rings;
  }
}

/// False if nothing is left of the group. Parts that a cut has made independent go to `split_off`.
bool Simplifier::apply(const FillsAndCuts& repairs, Group& group,
                       std::vector<Group>& split_off) const {
  if (repairs.are_hulls) group.flags |= kConvexHull;
  std::vector<Polygon> parts{group.polygon};
  if (!repairs.fill.empty()) parts = add_on_grid(parts, repairs.fill);
  std::optional<Polygon> next = largest_of(parts);
  if (!next) return false;
  if (!repairs.cut.empty()) {
    const double before = area(*next);
    double taken = 0;
    for (const Polygon& cut : repairs.cut) taken += area(cut);
    const std::vector<Polygon> whole{*next};
    std::vector<Polygon> cut = subtract_on_grid(whole, repairs.cut);
    std::optional<Polygon> left = largest_of(cut);
    const double lost = before - (left ? area(*left) : 0.0) - taken;
    // Cutting may part what was not expected to part: then widen instead.
    if (lost > epsilon_ * epsilon_ && !repairs.widen.empty()) {
      std::optional<Polygon> wider = largest_of(add_on_grid(whole, repairs.widen));
      if (wider && area(*wider) - before < lost + taken) {
        left = std::move(wider);
        cut.clear();
      }
    }
    if (cut.size() > 1) split_off = input_.split(cut, least_area(), group);
    next = std::move(left);
  }
  if (next && !keep_inside_.covers(*next)) {
    const std::vector<Polygon> inside = input_.inside(*next);
    for (Group& part : input_.split(inside, least_area(), group))
      split_off.push_back(std::move(part));
    next = largest_of(inside);
  }
  if (!next) return false;
  group.polygon = std::move(*next);
  group.flags |= kRepaired;
  return true;
}

void Simplifier::apply_fills_and_cuts(std::vector<FillsAndCuts> repairs) {
  std::vector<std::size_t> work;
  for (std::size_t k = 0; k < repairs.size(); ++k)
    if (!repairs[k].fill.empty() || !repairs[k].cut.empty()) work.push_back(k);
  std::vector<std::vector<Group>> split_off(work.size());
  parallel_chunks(work.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (!apply(repairs[work[i]], groups_[work[i]], split_off[i])) groups_[work[i]].polygon = {};
  });
  for (std::vector<Group>& parts : split_off)
    for (Group& part : parts) groups_.push_back(std::move(part));
  for (const std::size_t k : work) {
    if (!repairs[k].are_hulls)
      result_.stats.gaps_filled +=
          static_cast<std::int64_t>(repairs[k].fill.size()) - repairs[k].widened;
    result_.stats.necks_widened += repairs[k].widened;
    result_.stats.arms_cut += static_cast<std::int64_t>(repairs[k].cut.size());
  }
}

/// Unites groups that overlap or are closer than epsilon, with their convex hull if `hulls`, until
/// none are; each pass leaves fewer groups. Gap fills and hulls may reach across other groups,
/// which pairs of near vertices and edges would not show.
bool Simplifier::unite_close_groups(bool hulls) {
  for (bool any = false;; any = true) {
    if (progress_.cancelled && progress_.cancelled()) throw Cancelled();
    const std::vector<std::vector<std::size_t>> parts = clusters();
    if (parts.size() == groups_.size()) return any;
    result_.stats.merged_late += static_cast<std::int64_t>(groups_.size() - parts.size());
    std::vector<Group> next;
    next.reserve(parts.size());
    for (const std::vector<std::size_t>& part : parts) next.push_back(united(part, hulls));
    groups_ = std::move(next);
    if (hulls) drop_vanished();
  }
}

Group Simplifier::united(const std::vector<std::size_t>& parts, bool hulls) {
  if (parts.size() == 1) return std::move(groups_[parts[0]]);
  Group merged;
  merged.flags = kMerged;
  std::vector<Polygon> polygons;
  for (const std::size_t k : parts) {
    Group& group = groups_[k];
    merged.flags |= group.flags;
    merged.shares_input = merged.shares_input || group.shares_input;
    merged.courtyards_filled = merged.courtyards_filled || group.courtyards_filled;
    merged.members.insert(merged.members.end(), group.members.begin(), group.members.end());
    merged.input.insert(merged.input.end(), group.input.begin(), group.input.end());
    polygons.push_back(std::move(group.polygon));
  }
  std::sort(merged.members.begin(), merged.members.end());
  if (merged.shares_input) merged.input = unite_or_largest(merged.input);
  if (!hulls) {
    MergedPolygon how = merge_polygons(polygons, epsilon_, options_.growths);
    if (is_hull(how.method)) merged.flags |= kConvexHull;
    merged.polygon = std::move(how.polygon);
    return merged;
  }
  for (const Polygon& polygon : polygons)
    merged.polygon.outer.insert(merged.polygon.outer.end(), polygon.outer.begin(),
                                polygon.outer.end());
  if (!make_hull(merged)) merged.polygon = {};
  return merged;
}

/// Houses around small courtyards that have lost most of their area, or all of it, since neither
/// wings nor courtyards are wide enough, get another chance as one block. Each once, and only where
/// that changes less and the courtyards are large enough to be the reason. Whether there are any.
bool Simplifier::fill_courtyards_of_lost() {
  constexpr double kLeastShare = 0.1;
  bool any = false;
  for (Group& group : groups_) {
    const double whole = total_area(group.input), left = area(group.polygon);
    if (group.courtyards_filled || left >= 0.5 * whole) continue;
    std::vector<Polygon> blocks;
    for (const Polygon& polygon : group.input) blocks.push_back({polygon.outer, {}});
    if (blocks.size() > 1) blocks = unite_on_grid(blocks);
    for (Polygon& block : blocks) block.holes.clear();
    const double courtyards = total_area(blocks) - whole;
    std::optional<Polygon> block = largest_of(blocks);
    if (!block || !(courtyards >= kLeastShare * whole && courtyards < whole - left)) continue;
    group.polygon = std::move(*block);
    group.flags |= kRepaired;
    group.courtyards_filled = any = true;
  }
  return any;
}

void Simplifier::drop_vanished() {
  for (const Group& group : groups_)
    if (group.polygon.outer.size() < 3) drop(group, DropCause::kTooNarrow, kTooThin);
  std::erase_if(groups_, [](const Group& group) { return group.polygon.outer.size() < 3; });
}

void Simplifier::repair_in_rounds() {
  double reach = epsilon_ * (1 + 1e-3);
  double radius = 2 * epsilon_;
  for (int round = 0; round < kGentleRounds + kLocalHullRounds; ++round) {
    progress_.update(0.4 + 0.4 * round / (kGentleRounds + kLocalHullRounds));
    const Outline outline = repaired_outline(round);
    take_back(outline);
    const std::vector<NearPair> pairs = near_pairs(outline, epsilon_);
    result_.stats.rounds = round + 1;
    if (pairs.empty()) {
      if (!fill_courtyards_of_lost()) return;
      drop_vanished();
      unite_close_groups(false);
      continue;
    }
    if (round < kGentleRounds) {
      apply_fills_and_cuts(fills_and_cuts(outline, pairs, epsilon_, reach));
      if (round > 0) reach *= 2;
    } else {
      result_.stats.local_hulls += static_cast<std::int64_t>(pairs.size());
      apply_fills_and_cuts(hulls_around(outline, pairs, radius));
      radius *= 2;
    }
    fill_courtyards_of_lost();
    drop_vanished();
    unite_close_groups(false);
  }
}

/// Whether there were any.
bool Simplifier::close_dead_ends() {
  if (!(options_.close_gaps > options_.min_distance)) return false;
  const double width = options_.close_gaps * grid::kSteps;
  std::vector<FillsAndCuts> fills(groups_.size());
  parallel_chunks(groups_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      fills[k].fill = dead_end_fills(groups_[k].polygon, width);
  });
  std::int64_t count = 0;
  for (const FillsAndCuts& group : fills) count += std::ssize(group.fill);
  if (count == 0) return false;
  result_.stats.dead_ends_closed += count;
  apply_fills_and_cuts(std::move(fills));
  unite_close_groups(false);
  return true;
}

/// Replaces the polygon by its hull and lets short edges drop away; false if it vanishes.
bool Simplifier::make_hull(Group& group) {
  group.polygon = {convex_hull(group.polygon.outer), {}};
  group.flags |= kConvexHull | kRepaired;
  ++result_.stats.hull_repairs;
  if (group.polygon.outer.size() < 3) return false;
  Outline alone = make_outline({&group.polygon}, 4 * epsilon_);
  RepairOptions options;
  options.epsilon = epsilon_;
  options.max_cost = kInfinity;
  options.keep_inside = keep_inside_;
  repair_vertices(alone, options, counts_);
  group.polygon = extract_polygon(alone, OutlineRing(0), 1);
  return near_pairs(alone, epsilon_).empty();
}

void Simplifier::repair_with_hulls() {
  for (;;) {
    progress_.update(0.8);
    std::vector<const Polygon*> polygons;
    for (const Group& group : groups_) polygons.push_back(&group.polygon);
    const Outline outline = make_outline(polygons, 4 * epsilon_);
    const std::vector<NearPair> pairs = near_pairs(outline, epsilon_);
    std::vector<std::uint8_t> bad(groups_.size(), 0);
    for (const NearPair& pair : pairs) bad[outline.polygon_of(pair.vertex)] = 1;
    for (std::size_t k = 0; k < groups_.size(); ++k)
      if (bad[k] != 0 && !make_hull(groups_[k])) groups_[k].polygon = {};
    drop_vanished();
    if (!unite_close_groups(true)) return;
  }
}

/// Whether any corner was chamfered. Tidies what that leaves, and so on: a second run is idle.
bool Simplifier::chamfer_corners() {
  const ChamferOptions options{epsilon_, keep_inside_, to_radians(kSharpCornerDeg), kSmallArea};
  const auto is_sharp = [&](const Group& group) {
    return has_sharp_corner(group.polygon, options.least_angle);
  };
  if (std::none_of(groups_.begin(), groups_.end(), is_sharp)) return false;
  std::int64_t chamfered = 0;
  for (int round = 0; round < kChamferRounds; ++round) {
    progress_.update(0.82);
    Outline outline = repaired_outline(0);
    const std::int64_t now = tetropolis::chamfer_corners(outline, options);
    chamfered += now;
    take_back(outline);
    if (now == 0) break;
  }
  chamfered += fill_sharp_courtyards(options.least_angle);
  result_.stats.corners_chamfered += chamfered;
  return chamfered > 0;
}

/// Fills small courtyards whose sharp corners could not be chamfered, if nothing stands in them;
/// returns how many.
std::int64_t Simplifier::fill_sharp_courtyards(double least_angle) {
  std::int64_t filled = 0;
  for (Group& group : groups_)
    filled += static_cast<std::int64_t>(std::erase_if(group.polygon.holes, [&](const Ring& hole) {
      const Polygon courtyard{hole, {}};
      if (std::abs(signed_area(hole)) > kSmallArea || !has_sharp_corner(courtyard, least_angle))
        return false;
      const bool is_empty = std::none_of(groups_.begin(), groups_.end(), [&](const Group& other) {
        return &other != &group && contains(courtyard, other.polygon.outer.front());
      });
      if (is_empty) group.flags |= kRepaired;
      return is_empty;
    }));
  return filled;
}

void Simplifier::drop(const Group& group, DropCause cause, const std::string& reason) {
  for (const BuildingIndex member : group.members)
    result_.dropped.push_back({member, reason, cause});
  result_.stats.area_before += total_area(group.input) / grid::kSquareMetre;
  result_.stats.area_dropped += total_area(group.input) / grid::kSquareMetre;
}

void Simplifier::drop_small() {
  for (;;) {
    progress_.update(0.82);
    bool any = false;
    for (Group& group : groups_) {
      const double size = area(group.polygon) / grid::kSquareMetre;
      if (size >= options_.min_area) continue;
      const double shown = std::floor(size * 10) / 10;  // 14.98 would be 15.0
      drop(group, DropCause::kTooSmall,
           fmt::format("area {:.1f} m2 below the minimum of {:g} m2", shown, options_.min_area));
      group.members.clear();
      any = true;
    }
    if (!any) return;
    std::erase_if(groups_, [](const Group& group) { return group.members.empty(); });
    // What is gone may have kept parallel edges apart: tidying again keeps a second run idle.
    const Outline outline = repaired_outline(0);
    take_back(outline);
  }
}

void Simplifier::finish() {
  SimplifyStats& stats = result_.stats;
  for (const Group& group : groups_)
    if ((group.flags & kConvexHull) != 0) ++stats.hulls;
  stats.vertices_dropped = counts_.dropped;
  stats.edges_merged = counts_.merged;
  stats.edges_slid = counts_.slid;
  stats.vertices_moved = counts_.moved;
  stats.holes_filled = counts_.filled;
  for (Group& group : groups_) {
    result_.footprints.push_back(grid::to_metres(group.polygon));
    result_.members.push_back(std::move(group.members));
    result_.flags.push_back(group.flags);
  }
  std::sort(result_.dropped.begin(), result_.dropped.end(),
            [](const DroppedFootprint& a, const DroppedFootprint& b) { return a.index < b.index; });
  Clearance clearance;
  std::vector<FootprintDefect> defects;  // clearance does not see edges that cross
  parallel_chunks(2, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t job = begin; job < end; ++job)
      if (job == 0)
        clearance = joint_clearance(result_.footprints, domain_);
      else
        defects = footprint_defects(result_.footprints, 1);
  });
  stats.min_clearance = clearance.distance;
  if (!is_clear(clearance.distance, options_.min_distance))
    throw Error(
        ErrorKind::kGuarantee,
        fmt::format("footprints: clearance {:.6f} m at ({:.4f}, {:.4f}) is below {} m after "
                    "simplification; report it",
                    clearance.distance, clearance.at.x, clearance.at.y, options_.min_distance));
  if (!defects.empty())
    throw Error(ErrorKind::kGuarantee, fmt::format("footprints: {} after simplification; report it",
                                                   defects.front().message));
}

/// By how far outlines are off their input: vertices on straight walls, which a union leaves, are
/// tidied away without a repair, and gaps between members filled with one. What shares its input
/// keeps the flag of what was done to it.
void Simplifier::flag_moved() {
  for (std::size_t k = 0; k < groups_.size(); ++k) {
    if (groups_[k].shares_input) continue;
    groups_[k].flags &= ~std::uint32_t{kRepaired};
    if (result_.changes[k].hausdorff_distance > kMaxShift / grid::kSteps)
      groups_[k].flags |= kRepaired;
  }
}

Simplification Simplifier::run() {
  progress_.update(0);
  clip_to_domain();
  progress_.update(0.05);
  merge_clusters();
  progress_.update(0.4);
  repair_in_rounds();
  for (int round = 0; round < kCloseRounds && close_dead_ends(); ++round) repair_in_rounds();
  repair_with_hulls();
  chamfer_corners();
  for (int round = 0; round < kChamferRounds; ++round) {
    drop_small();
    if (!chamfer_corners()) break;
  }
  drop_small();  // what chamfering, or the tidying before it, has left smaller
  progress_.update(0.85);
  std::sort(groups_.begin(), groups_.end(),
            [](const Group& a, const Group& b) { return a.members[0] < b.members[0]; });
  result_.changes = measure_changes(groups_, result_.stats, portion(progress_, 0.85, 0.95));
  flag_moved();
  finish();
  progress_.update(1);
  return std::move(result_);
}

}  // namespace

Simplification simplify_footprints(std::span<const Polygon> cleaned, const Domain& domain,
                                   const SimplifyOptions& options, const Progress& progress) {
  require_sensible(domain, options);
  return Simplifier(cleaned, domain, options, progress).run();
}

}  // namespace tetropolis
