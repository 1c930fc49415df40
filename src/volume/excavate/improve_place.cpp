#include "improve_place.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "core/infinity.h"
#include "core/units.h"
#include "find_sources.h"
#include "volume/column/ground_heights.h"
#include "volume/column/levels.h"
#include "volume/quality/improve_columns.h"
#include "volume/quality/measured_mesh.h"

namespace tetropolis {

namespace {

/// Excavations from one kind of source, at most: where ground was lowered, other cells change.
constexpr int kMostRounds = 8;

/// Degrees: slopes as steep as these mostly do. One of 56 excavates several times as much as one of
/// 75, and of a steep hillside most.
constexpr std::array kSteepSlopes{75.0, 66.0};

bool has_many_thin_cells(const FaultCounts& counts) {
  return counts.thin > 0 &&
         static_cast<double>(counts.thin) >= kShareOfFew * static_cast<double>(counts.cells);
}

/// What a place is to be worked on for; nothing if it is above the floor.
std::optional<Asked> missed(const FaultCounts& counts) {
  if (has_many_thin_cells(counts)) return Asked::kOfMost;
  if (counts.cells_outside(Asked::kFloor) > 0 || counts.steep_faces > 0) return Asked::kFloor;
  return std::nullopt;
}

/// Works on one place.
class Place {
 public:
  Place(Cutout cutout, std::vector<std::uint8_t> moved, const QualityFloorOptions& options,
        double cells_elsewhere, const Progress& progress)
      : now_{std::move(cutout.columns.plan), std::move(cutout.columns.mesh), std::move(moved), {}},
        fixed_(std::move(cutout.fixed)),
        options_(options),
        cells_elsewhere_(cells_elsewhere),
        progress_(progress),
        faults_(now_.mesh),
        work_left_(options.work) {}

  void run();
  /// Whether more has to be excavated than fits into the cutout.
  bool is_outgrown() const { return is_outgrown_; }
  PlaceOutcome outcome() { return std::move(now_); }

 private:
  std::optional<Asked> missed() const {
    return is_outgrown_ ? std::nullopt : tetropolis::missed(faults_.counts());
  }
  PlaceOutcome copy() const;
  void become(PlaceOutcome other);

  bool search(ImproveOptions options);
  void straighten_faces();

  /// What marks are made from: bad triangles, or those beside them, too.
  enum class Reach { kBad, kBeside };
  template <typename Mark>
  void excavate_from(const Mark& mark, Reach reach = Reach::kBad);
  void try_slope();
  bool try_marks(Asked asked, const ExcavationMarks& marks_before,
                 std::span<const std::uint8_t> bad_before);
  bool excavate_marked();
  bool is_at_rim(std::span<const double> excavated) const;

  PlaceOutcome now_;
  std::vector<std::uint8_t> fixed_;
  const QualityFloorOptions& options_;
  double cells_elsewhere_;
  const Progress& progress_;
  MeasuredMesh faults_;
  std::int64_t work_left_;
  bool is_outgrown_ = false;

  PlaceOutcome unexcavated_;
  double slope_deg_ = 90;
  ExcavationMarks marks_;
};

PlaceOutcome Place::copy() const {
  return {now_.plan,
          gather_columns(fixed_.size(),
                         [&](VertexIndex v) {
                           return ColumnOf{&now_.mesh, v};
                         }),
          now_.moved, now_.sources};
}

/// Goes on from another outcome over the same ground mesh.
void Place::become(PlaceOutcome other) {
  other.mesh.ground = std::move(now_.mesh.ground);
  other.mesh.edges = std::move(now_.mesh.edges);
  const std::vector<VertexIndex> changed = different_columns(now_.mesh, other.mesh);
  now_ = std::move(other);
  faults_.look_again(now_.mesh, changed);
}

/// Whether it changed anything.
bool Place::search(ImproveOptions options) {
  options.most_cells = work_left_;
  options.fixed = fixed_;
  options.most_gap = options_.most_gap;
  const Improvement done = improve_columns(now_.mesh, options, progress_);
  work_left_ -= done.cells;
  for (const VertexIndex v : done.columns) now_.moved[v] = 1;
  faults_.look_again(now_.mesh, done.columns);
  return !done.columns.empty();
}

/// Works on faces beyond kMostNonOrthogonal, asking more and more of the cells there, too: better
/// cells have better faces. Keeps what leaves fewer of these faces and no worse cells.
void Place::straighten_faces() {
  constexpr double kStraight = 68;  // degrees, a little less than is allowed
  constexpr std::array kTargets{AngleBounds{12, 157}, AngleBounds{16, 152}, AngleBounds{20, 148}};
  for (const AngleBounds& target : kTargets) {
    const FaultCounts then = faults_.counts();
    if (then.steep_faces == 0) return;
    PlaceOutcome before = copy();
    const std::vector<std::uint8_t> steep = faults_.steep_triangles(now_.mesh);
    ImproveOptions options;
    options.least_deg = target.least;
    options.greatest_deg = target.greatest;
    options.straight_deg = kStraight;
    options.near = steep;
    if (!search(options)) continue;
    const FaultCounts now = faults_.counts();
    const bool is_better = now.steep_faces < then.steep_faces &&
                           now.cells_outside(Asked::kFloor) <= then.cells_outside(Asked::kFloor) &&
                           (has_many_thin_cells(then) || !has_many_thin_cells(now));
    if (!is_better) become(std::move(before));
  }
}

/// Whether the cutout is too small for what is marked, or for what was excavated from there.
bool Place::is_at_rim(std::span<const double> excavated) const {
  const auto is_marked = [&](const std::vector<std::uint8_t>& buildings, VertexIndex v) {
    const RegionIndex b = now_.plan.lowest_roof[v];
    return !buildings.empty() && b != kNoRegion && buildings[b] != 0;
  };
  for (const VertexIndex v : indices<VertexIndex>(fixed_.size()))
    if (fixed_[v] != 0 &&
        (excavated[v] < now_.plan.terrain[v] || is_marked(marks_.roofs, v) ||
         is_marked(marks_.walls, v) || (!marks_.toes.empty() && marks_.toes[v] < kInfinity)))
      return true;
  return false;
}

/// Makes the columns anew where the ground is another with the terrain excavated as marked, and
/// improves them. Leaves all as it is, with the result false, if that lowers nothing.
bool Place::excavate_marked() {
  std::vector<double> excavated = now_.plan.terrain;
  ExcavationSlopes slopes;
  slopes.at_source = std::tan(to_radians(slope_deg_));
  ExcavationSources sources =
      excavate(now_.mesh.ground, now_.plan.lowest_roof, now_.plan.roofs, marks_, slopes, excavated);
  if (is_at_rim(excavated)) {
    is_outgrown_ = true;
    return false;
  }
  ColumnPlanOptions options = options_.plan;
  options.excavated = excavated;
  options.deep_walls = marks_.walls;
  const ColumnPlan& old = unexcavated_.plan;
  ColumnPlan plan = old;
  plan_ground(now_.mesh.ground, options, plan);
  for (const VertexIndex v : indices<VertexIndex>(fixed_.size()))
    if (fixed_[v] != 0) {
      plan.ground[v] = old.ground[v];
      plan.rise[v] = old.rise[v];
    }
  if (plan.ground == now_.plan.ground) return false;
  if (options_.require_fits) options_.require_fits(cells_elsewhere_ + estimate_cells(plan));
  sources.roof_slopes_deg.assign(sources.roofs.size(), slope_deg_);
  sources.toe_slopes_deg.assign(sources.toes.size(), slope_deg_);

  ColumnMesh fresh = divide_columns(std::move(now_.mesh.ground), std::move(now_.mesh.edges), plan);
  place_nodes(fresh, plan);
  now_.mesh.ground = std::move(fresh.ground);
  now_.mesh.edges = std::move(fresh.edges);
  // Those beside them, too: they are moved for what was there.
  const auto& triangles = now_.mesh.ground.triangles;
  std::vector<std::uint8_t> near(triangles.size(), 0);
  for (const TriangleIndex t : indices<TriangleIndex>(near.size()))
    for (const VertexIndex v : triangles[t])
      if (plan.ground[v] != old.ground[v] || plan.rise[v] != old.rise[v]) near[t] = 1;
  near = with_neighbours(now_.mesh, near);
  std::vector<std::uint8_t> is_fresh(fixed_.size(), 0), moved = unexcavated_.moved;
  for (const TriangleIndex t : indices<TriangleIndex>(near.size()))
    for (const VertexIndex v : triangles[t]) {
      if (near[t] == 0 || fixed_[v] != 0) continue;
      is_fresh[v] = 1;
      moved[v] = 0;
    }
  ColumnMesh mesh = gather_columns(is_fresh.size(), [&](VertexIndex v) {
    return ColumnOf{is_fresh[v] != 0 ? &fresh : &unexcavated_.mesh, v};
  });
  // With walls of other heights, fronts may miss the edge of a roof that is not horizontal.
  std::swap(mesh.ground, now_.mesh.ground);
  std::swap(mesh.edges, now_.mesh.edges);
  const bool is_valid = passes_everywhere(mesh);
  std::swap(mesh.ground, now_.mesh.ground);
  std::swap(mesh.edges, now_.mesh.edges);
  if (!is_valid) return false;
  become({std::move(plan), std::move(mesh), std::move(moved), std::move(sources)});
  if (faults_.counts().cells_outside(Asked::kGood) > 0) {
    ImproveOptions search_options;
    search_options.near = near;
    search(search_options);
  }
  straighten_faces();
  return true;
}

/// Keeps the excavation if it leaves fewer triangles with cells below the floor; or as many, and
/// fewer faces beyond kMostNonOrthogonal; or as many of both, and fewer triangles with cells
/// outside the bounds; or as many of all, and the worst face less far beyond, so that the next one
/// may do. (Not fewer cells: over a triangle that is bad whatever is done, there is room for more
/// of them.) Else everything becomes as it was, the result is false, and of the marks those stay
/// that helped where they are.
bool Place::try_marks(Asked asked, const ExcavationMarks& marks_before,
                      std::span<const std::uint8_t> bad_before) {
  // Not at the price of cells that are bad by any measure.
  const auto bad = [&] {
    const FaultCounts counts = faults_.counts();
    return std::tuple(counts.triangles_outside(Asked::kFloor), has_many_thin_cells(counts),
                      counts.steep_faces, counts.triangles_outside(asked), counts.worst_face_deg);
  };
  const auto bad_then = bad();
  PlaceOutcome before = copy();
  if (!excavate_marked()) return false;
  if (bad() < bad_then) return true;
  keep_helpful_marks(
      now_.mesh, now_.plan.lowest_roof,
      {before.plan.ground, now_.plan.ground, bad_before, faults_.bad_triangles(now_.mesh, asked)},
      marks_before, marks_);
  become(std::move(before));
  return false;
}

/// Excavates from what `mark` marks, until the floor is met or that does not help. Where it helps
/// in one part of the place and not in another, the marks that do are tried again by themselves.
template <typename Mark>
void Place::excavate_from(const Mark& mark, Reach reach) {
  for (int round = 0; round < kMostRounds; ++round) {
    const std::optional<Asked> asked = missed();
    if (!asked) return;
    const std::vector<std::uint8_t> bad = faults_.bad_triangles(now_.mesh, *asked);
    const ExcavationMarks before = marks_;
    const std::int64_t marked = mark(reach == Reach::kBad ? bad : with_neighbours(now_.mesh, bad));
    if (marked == 0) return;
    const ExcavationMarks all = marks_;
    if (try_marks(*asked, before, bad)) continue;
    if (marks_ != all && marks_ != before && try_marks(*asked, before, bad)) continue;
    marks_ = before;
    return;
  }
}

/// Around roofs first, then from the toes of slopes and low walls.
void Place::try_slope() {
  using Bad = std::span<const std::uint8_t>;
  marks_.roofs.assign(now_.plan.roofs.parts(), 0);
  excavate_from([&](Bad bad) { return mark_buried_roofs(now_.mesh, now_.plan, bad, marks_); });
  marks_.toes.assign(now_.plan.ground.size(), kInfinity);
  const double slope = std::tan(to_radians(slope_deg_));
  // As few toes as do. Last those next to bad triangles: over level ground at the toe of a cliff
  // the columns of the toe, whose segments are as long as the cliff is high, make faces bad.
  for (const Reach reach : {Reach::kBad, Reach::kBeside})
    for (const double share : {0.0, 0.5})
      excavate_from(
          [&](Bad bad) {
            return mark_slope_toes(now_.mesh, now_.plan, bad, {slope, share}, marks_);
          },
          reach);
  // Where that is still too steep, more gently.
  for (const double degrees : {45.0, 30.0})
    for (const Reach reach : {Reach::kBad, Reach::kBeside})
      excavate_from(
          [&](Bad bad) {
            return mark_gentle(now_.mesh, now_.plan, bad, std::tan(to_radians(degrees)), marks_);
          },
          reach);
}

/// As steeply as leaves the place above the floor, or as gently as is allowed. What is left is dug
/// out at the walls, deeper than the buildings stand.
void Place::run() {
  straighten_faces();
  if (!missed()) return;
  unexcavated_ = copy();
  std::vector<double> slopes;
  for (const double degrees : kSteepSlopes)
    if (degrees > options_.gentlest_deg) slopes.push_back(degrees);
  if (options_.gentlest_deg < 90) slopes.push_back(options_.gentlest_deg);
  const std::int64_t work = work_left_;
  for (const double degrees : slopes) {
    become(unexcavated_);
    slope_deg_ = degrees;
    marks_ = {};
    work_left_ = work;
    try_slope();
    if (!missed()) return;
  }
  marks_.walls.assign(now_.plan.roofs.parts(), 0);
  excavate_from([&](std::span<const std::uint8_t> bad) {
    return mark_deep_walls(now_.mesh, now_.plan, bad, marks_);
  });
}

}  // namespace

std::optional<PlaceOutcome> improve_place(Cutout cutout, std::vector<std::uint8_t> moved,
                                          const QualityFloorOptions& options,
                                          double cells_elsewhere, const Progress& progress) {
  Place place(std::move(cutout), std::move(moved), options, cells_elsewhere, progress);
  place.run();
  if (place.is_outgrown()) return std::nullopt;
  return place.outcome();
}

}  // namespace tetropolis
