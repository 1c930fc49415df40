#include "improve_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/infinity.h"
#include "core/units.h"
#include "volume/excavate/cut_back.h"
#include "volume/excavate/find_cuts.h"
#include "volume/quality/improve_columns.h"
#include "volume/quality/mesh_faults.h"

namespace tetropolis {

namespace {

/// Cells the report lists.
constexpr std::size_t kWorstCells = 10;

/// The share of cells that may have an angle below kLeastOfMost.
constexpr double kFewCells = 1e-4;

/// Times that columns are made anew, at most: where the ground was lowered, other cells change.
constexpr int kMostCuts = 8;

/// Degrees: cuts as steep as these mostly do. One of 56 digs several times as much away, and of a
/// steep hillside most.
constexpr std::array kSteepCuts{75.0, 66.0};

/// Cells that all searches of one try may look at (a cell takes some 70 ns): so many whatever the
/// mesh, and so many for each of its nodes, which has about five of its own.
constexpr std::int64_t kWork = 200'000'000;
constexpr std::int64_t kWorkPerNode = 20;

bool has_many_thin_cells(const FaultCounts& counts) {
  const double few = std::max(1.0, std::ceil(kFewCells * static_cast<double>(counts.cells)));
  return static_cast<double>(counts.thin) >= few;
}

/// What the mesh is to be worked on for; nothing if it is above the floor.
std::optional<Asked> missed(const FaultCounts& counts) {
  if (has_many_thin_cells(counts)) return Asked::kOfMost;
  if (counts.cells_outside(Asked::kFloor) > 0 || counts.steep_faces > 0) return Asked::kFloor;
  return std::nullopt;
}

/// Columns that are not alike in two meshes over the same ground mesh.
std::vector<VertexIndex> different_columns(const ColumnMesh& a, const ColumnMesh& b) {
  std::vector<VertexIndex> different;
  for (std::size_t v = 0; v < a.vertex_count(); ++v)
    if (!std::ranges::equal(a.floors_at(v), b.floors_at(v)) ||
        a.first[v + 1] - a.first[v] != b.first[v + 1] - b.first[v] ||
        !std::equal(a.z.begin() + a.first[v], a.z.begin() + a.first[v + 1],
                    b.z.begin() + b.first[v]))
      different.push_back(static_cast<VertexIndex>(v));
  return different;
}

class MeshImprover {
 public:
  MeshImprover(const MeshCityOptions& config, const Raster& dtm, const CitySize& size,
               Columns& columns, StepClock& clock, VolumeMeshFacts& volume)
      : config_(config),
        dtm_(dtm),
        size_(size),
        columns_(columns),
        clock_(clock),
        volume_(volume),
        faults_(clock.run("3.6", "find bad cells",
                          [&](const Progress&) { return MeshFaults(columns.mesh); })),
        work_(kWork + kWorkPerNode * columns.mesh.node_count()),
        work_left_(work_) {}

  void run() {
    move_nodes();
    make_room();
  }

 private:
  double valid_gap();
  void look_again(std::span<const VertexIndex> columns);
  std::vector<VertexIndex> search(const char* name, ImproveOptions options);
  void move_nodes();
  void straighten_faces(std::vector<VertexIndex>& improved);

  void make_room();
  ColumnPlanOptions cut_terrain_back();
  void try_cuts(ColumnPlanOptions& options);
  void take_cuts_back();
  /// What marks are made from: bad triangles, or those beside them, too.
  enum class Reach { kBad, kBeside };
  template <typename Mark>
  void cut_from(ColumnPlanOptions& options, const Mark& mark, Reach reach = Reach::kBad);
  bool cut_back(ColumnPlanOptions& options, Asked asked, const CutMarks& marks_before,
                std::span<const std::uint8_t> bad_before);
  bool make_cut_columns(const ColumnPlanOptions& options, Columns& before);

  const MeshCityOptions& config_;
  const Raster& dtm_;
  const CitySize& size_;
  Columns& columns_;
  StepClock& clock_;
  VolumeMeshFacts& volume_;
  MeshFaults faults_;
  const std::int64_t work_;
  std::int64_t work_left_;
};

/// The least vertical gap, once elevations are found to increase up every column.
double MeshImprover::valid_gap() {
  return clock_.run("3.6", "check columns",
                    [&](const Progress&) { return require_valid(columns_.mesh); });
}

void MeshImprover::look_again(std::span<const VertexIndex> columns) {
  clock_.run("3.6", "find bad cells",
             [&](const Progress&) { faults_.look_again(columns_.mesh, columns); });
}

/// Returns the columns that changed.
std::vector<VertexIndex> MeshImprover::search(const char* name, ImproveOptions options) {
  options.most_cells = std::min(options.most_cells, work_left_);
  Improvement done = clock_.run("3.5", name, [&](const Progress& progress) {
    return improve_columns(columns_.mesh, options, progress);
  });
  work_left_ -= done.cells;
  return std::move(done.columns);
}

/// Makes thin cells and faces beyond kMostNonOrthogonal better if there are any.
void MeshImprover::move_nodes() {
  std::vector<VertexIndex> improved;
  if (faults_.counts().cells_outside(Asked::kGood) > 0) {
    const std::vector<VertexIndex> changed = search("improve cells", {});
    if (!changed.empty()) {
      improved = changed;
      volume_.min_vertical_gap = valid_gap();
      look_again(changed);
    }
  }
  straighten_faces(improved);
  std::sort(improved.begin(), improved.end());
  volume_.columns_improved = std::unique(improved.begin(), improved.end()) - improved.begin();
}

/// Works on faces beyond kMostNonOrthogonal, asking more and more of the cells there, too: better
/// cells have better faces. Keeps what leaves fewer of these faces and no worse cells, and adds its
/// columns to `improved`.
void MeshImprover::straighten_faces(std::vector<VertexIndex>& improved) {
  constexpr double kStraight = 68;  // degrees, a little less than is allowed
  constexpr std::array kTargets{AngleBounds{12, 157}, AngleBounds{16, 152}, AngleBounds{20, 148}};
  ColumnMesh& mesh = columns_.mesh;
  for (const AngleBounds& target : kTargets) {
    const FaultCounts then = faults_.counts();
    if (then.steep_faces == 0) return;
    // All that improve_columns changes.
    auto before = std::tuple(mesh.first, mesh.floors, mesh.z);
    ImproveOptions options;
    options.least_deg = target.least;
    options.greatest_deg = target.greatest;
    options.straight_deg = kStraight;
    const std::vector<std::uint8_t> steep = faults_.steep_triangles(mesh);
    options.near = steep;
    const std::vector<VertexIndex> changed = search("straighten faces", options);
    if (changed.empty()) continue;
    look_again(changed);
    const FaultCounts now = faults_.counts();
    if (now.steep_faces < then.steep_faces &&
        now.cells_outside(Asked::kFloor) <= then.cells_outside(Asked::kFloor) &&
        (has_many_thin_cells(then) || !has_many_thin_cells(now))) {
      volume_.min_vertical_gap = valid_gap();
      improved.insert(improved.end(), changed.begin(), changed.end());
      continue;
    }
    std::tie(mesh.first, mesh.floors, mesh.z) = std::move(before);
    look_again(changed);
  }
}

/// Makes the columns anew with the terrain cut back as `options` say; they were `before`. Leaves
/// all as it is, with the result false, if that lowers nothing. Too many cells for the memory are
/// an error: else the mesh would depend on the machine.
bool MeshImprover::make_cut_columns(const ColumnPlanOptions& options, Columns& before) {
  const GroundMesh& ground = columns_.mesh.ground;
  ColumnPlan plan = plan_columns(ground, dtm_, columns_.plan.roofs, columns_.plan.spacing, options);
  if (plan.ground == columns_.plan.ground) return false;
  require_cells_fit(config_, size_, static_cast<double>(ground.triangles.size()),
                    estimate_cells(plan));
  plan.top = columns_.plan.top;
  before = std::exchange(columns_, {});
  columns_.plan = std::move(plan);
  columns_.mesh =
      divide_columns(std::move(before.mesh.ground), std::move(before.mesh.edges), columns_.plan);
  place_nodes(columns_.mesh, columns_.plan);
  return true;
}

/// Keeps the cut if it leaves fewer triangles with cells below the floor; or as many, and fewer
/// faces beyond kMostNonOrthogonal; or as many of both, and fewer triangles with cells outside the
/// bounds; or as many of all, and the worst face less far beyond, so that the next cut may do. (Not
/// fewer cells: over a triangle that is bad whatever is done, a cut leaves room for more of them.)
/// Else everything becomes as it was, the result is false, and of the marks those stay that helped
/// where they are.
bool MeshImprover::cut_back(ColumnPlanOptions& options, Asked asked, const CutMarks& marks_before,
                            std::span<const std::uint8_t> bad_before) {
  // Not at the price of cells that are bad by any measure.
  const auto bad = [&] {
    const FaultCounts counts = faults_.counts();
    return std::tuple(counts.triangles_outside(Asked::kFloor), has_many_thin_cells(counts),
                      counts.steep_faces, counts.triangles_outside(asked), counts.worst_face_deg);
  };
  const auto bad_then = bad();
  const VolumeMeshFacts volume_before = volume_;
  Columns before;
  if (!clock_.run("3.3", "cut terrain back",
                  [&](const Progress&) { return make_cut_columns(options, before); }))
    return false;
  look_again(different_columns(before.mesh, columns_.mesh));
  volume_.min_vertical_gap = valid_gap();
  move_nodes();
  if (bad() < bad_then) return true;
  keep_helpful_marks(columns_.mesh, columns_.plan.lowest_roof,
                     {before.plan.ground, columns_.plan.ground, bad_before,
                      faults_.bad_triangles(columns_.mesh, asked)},
                     marks_before, options.cut);
  before.mesh.ground = std::move(columns_.mesh.ground);
  before.mesh.edges = std::move(columns_.mesh.edges);
  std::swap(columns_, before);
  look_again(different_columns(before.mesh, columns_.mesh));
  volume_ = volume_before;
  return false;
}

/// Cuts back from what `mark` marks, until the floor is met or a cut does not help. Where cuts help
/// in one part of the city and not in another, those that do are tried again by themselves.
template <typename Mark>
void MeshImprover::cut_from(ColumnPlanOptions& options, const Mark& mark, Reach reach) {
  for (int round = 0; round < kMostCuts; ++round) {
    const std::optional<Asked> asked = missed(faults_.counts());
    if (!asked) return;
    const std::vector<std::uint8_t> bad = faults_.bad_triangles(columns_.mesh, *asked);
    const CutMarks before = options.cut;
    const std::int64_t marked = reach == Reach::kBad
                                    ? mark(bad, options.cut)
                                    : mark(with_neighbours(columns_.mesh, bad), options.cut);
    if (marked == 0) return;
    const CutMarks all = options.cut;
    if (cut_back(options, *asked, before, bad)) continue;
    if (options.cut != all && options.cut != before && cut_back(options, *asked, before, bad))
      continue;
    options.cut = before;
    return;
  }
}

/// Where cells or faces are below the floor, cuts the terrain back, as long as that makes fewer:
/// around roofs below it first, then from the feet of cliffs and low walls. What is left is dug out
/// at the walls, deeper than the buildings stand.
void MeshImprover::make_room() {
  ColumnPlanOptions options = cut_terrain_back();
  options.cut.walls.assign(columns_.plan.roofs.size(), 0);
  cut_from(options, [&](std::span<const std::uint8_t> bad, CutMarks& marks) {
    return mark_deep_walls(columns_.mesh, columns_.plan, bad, marks);
  });
}

/// As steeply as leaves the mesh above the floor, or as the settings say; returns what was done.
ColumnPlanOptions MeshImprover::cut_terrain_back() {
  MeshCityOptions config = config_;
  if (config_.cut_slope_deg >= 90 || !missed(faults_.counts())) return plan_options(config);
  const std::int64_t work_left = work_left_;
  for (const double degrees : kSteepCuts) {
    if (config_.cut_slope_deg >= degrees) continue;
    config.cut_slope_deg = volume_.cut_slope_deg = degrees;
    ColumnPlanOptions steep = plan_options(config);
    try_cuts(steep);
    if (!missed(faults_.counts())) return steep;
    take_cuts_back();
    work_left_ = work_left;
  }
  volume_.cut_slope_deg = config_.cut_slope_deg;
  ColumnPlanOptions options = plan_options(config_);
  try_cuts(options);
  return options;
}

/// As if nothing had been cut.
void MeshImprover::take_cuts_back() {
  Columns cut;
  if (!clock_.run("3.3", "take cuts back",
                  [&](const Progress&) { return make_cut_columns(plan_options(config_), cut); }))
    return;
  look_again(different_columns(cut.mesh, columns_.mesh));
  volume_.min_vertical_gap = valid_gap();
  work_left_ = work_;
  move_nodes();
}

void MeshImprover::try_cuts(ColumnPlanOptions& options) {
  options.cut.roofs.assign(columns_.plan.roofs.size(), 0);
  cut_from(options, [&](std::span<const std::uint8_t> bad, CutMarks& marks) {
    return mark_buried_roofs(columns_.mesh, columns_.plan, bad, marks);
  });
  options.cut.feet.assign(columns_.plan.ground.size(), kInfinity);
  // As few feet as do. Last those next to bad triangles: over level ground at the foot of a cliff
  // the columns of the foot, whose segments are as long as the cliff is high, make faces bad.
  for (const Reach reach : {Reach::kBad, Reach::kBeside})
    for (const double share : {0.0, 0.5})
      cut_from(
          options,
          [&](std::span<const std::uint8_t> bad, CutMarks& marks) {
            return mark_feet(columns_.mesh, columns_.plan, bad,
                             {options.cut_slopes.at_start, share}, marks);
          },
          reach);
  // Where that is still too steep, more gently.
  for (const double degrees : {45.0, 30.0})
    for (const Reach reach : {Reach::kBad, Reach::kBeside})
      cut_from(
          options,
          [&](std::span<const std::uint8_t> bad, CutMarks& marks) {
            return mark_gentle(columns_.mesh, columns_.plan, bad, std::tan(to_radians(degrees)),
                               marks);
          },
          reach);
}

}  // namespace

MeshQuality improve_mesh(const MeshCityOptions& config, const Raster& dtm, const CitySize& size,
                         Columns& columns, StepClock& clock, VolumeMeshFacts& volume) {
  if (config.layering != Layering::kUniform)
    MeshImprover(config, dtm, size, columns, clock, volume).run();
  MeshQuality quality;
  quality.cells = clock.run("3.6", "measure cells", [&](const Progress&) {
    return measure_cells(columns.mesh, kWorstCells);
  });
  quality.faces = clock.run("3.6", "measure faces",
                            [&](const Progress&) { return measure_faces(columns.mesh); });
  return quality;
}

namespace {

/// The bounds that cells of the mesh miss; nothing if it is above the floor.
std::optional<AngleBounds> missed_bounds(const MeshQuality& quality) {
  const QualityHistogram& angles = quality.cells.histogram;
  if (angles.dihedral_quantile_deg(kFewCells) < kLeastOfMost)
    return AngleBounds{kLeastOfMost, kQualityFloor.greatest};
  if (angles.min_dihedral_deg() < kQualityFloor.least ||
      angles.max_dihedral_deg() > kQualityFloor.greatest || quality.faces.above_70 > 0)
    return kQualityFloor;
  return std::nullopt;
}

/// The settings that alone make bad cells, if there are any.
std::string unusual_settings(const MeshCityOptions& config) {
  std::string text;
  if (config.layering == Layering::kUniform) text += "; layering = \"graded\" gives better ones";
  if (config.min_angle_deg < 20)
    text += fmt::format("; min_angle {:g} is small", config.min_angle_deg);
  const double share = config.layer_height / config.mesh_size;
  // Graded layers take a large height as an upper limit only.
  const bool tall = share > 2 && config.layering == Layering::kUniform;
  if (config.layer_height > 0 && (share < 0.5 || tall))
    text += fmt::format("; layer_height {:g} is far from mesh_size {:g}", config.layer_height,
                        config.mesh_size);
  return text;
}

}  // namespace

void warn_below_floor(const MeshCityOptions& config, const ColumnMesh& mesh,
                      const MeshQuality& quality, std::vector<Warning>& warnings) {
  const std::optional<AngleBounds> bounds = missed_bounds(quality);
  if (const double skewness = quality.faces.worst.skewness; skewness >= kMostSkewed)
    warnings.push_back({"faces_skewed", 1,
                        fmt::format("a face, or more, has a skewness of {:.2f}, where less than {} "
                                    "is meant for all; a smaller mesh_size may help",
                                    skewness, kMostSkewed)});
  if (!bounds) return;
  const QualityHistogram& angles = quality.cells.histogram;
  if (const std::int64_t bad = count_bad_cells(mesh, *bounds); bad > 0)
    warnings.push_back(
        {"below_quality_floor", bad,
         fmt::format(
             "cells have dihedral angles outside of {} to {} degrees (least {:.2f}, greatest "
             "{:.2f}), where {} to {} are meant for all and {} for all but one in ten thousand; "
             "worst_cells in the report has the worst and why{}",
             bounds->least, bounds->greatest, angles.min_dihedral_deg(), angles.max_dihedral_deg(),
             kQualityFloor.least, kQualityFloor.greatest, kLeastOfMost, unusual_settings(config))});
  if (quality.faces.above_70 > 0)
    warnings.push_back(
        {"faces_non_orthogonal", quality.faces.above_70,
         fmt::format(
             "faces between cells are more than {} degrees non-orthogonal (the worst "
             "{:.2f}), at steep ground, buried roofs or, in uniform layers, low walls; a smaller "
             "mesh_size may help{}",
             kMostNonOrthogonal, quality.faces.worst.non_orthogonality_deg,
             unusual_settings(config))});
}

}  // namespace tetropolis
