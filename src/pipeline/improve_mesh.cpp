#include "improve_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/core/units.h"
#include "tetropolis/volume/cut_back.h"
#include "tetropolis/volume/find_cuts.h"
#include "tetropolis/volume/improve_columns.h"

namespace tetropolis {

namespace {

/// Cells the report lists.
constexpr std::size_t kWorstCells = 10;

/// The share of cells that may have an angle below kLeastOfMost.
constexpr double kFewCells = 1e-4;

/// Times that columns are made anew, at most: where the ground was lowered, other cells change.
constexpr int kMostCuts = 8;

/// Cells that all searches of a run may look at (a cell takes some 70 ns): so many whatever the
/// mesh, and so many for each of its nodes, which has about five of its own.
constexpr std::int64_t kWork = 200'000'000;
constexpr std::int64_t kWorkPerNode = 20;

/// Layers this much flatter than triangles are wide make flat cells everywhere, which no search
/// mends; a tenth of the work is enough to see that.
constexpr double kFlatLayers = 0.5;

std::int64_t work_for(const Config& config, std::int64_t nodes) {
  const bool is_hopeless =
      config.layer_height > 0 && config.layer_height < kFlatLayers * config.mesh_size;
  return (kWork + kWorkPerNode * nodes) / (is_hopeless ? 10 : 1);
}

bool is_within(const QualityHistogram& angles, const AngleBounds& bounds) {
  return angles.min_dihedral_deg() >= bounds.least && angles.max_dihedral_deg() <= bounds.greatest;
}

bool has_many_thin_cells(const MeshQuality& quality) {
  return quality.cells.histogram.dihedral_quantile_deg(kFewCells) < kLeastOfMost;
}

/// The bounds that the mesh is to be worked on for; nothing if it is above the floor.
std::optional<AngleBounds> missed_bounds(const MeshQuality& quality) {
  if (has_many_thin_cells(quality)) return AngleBounds{kLeastOfMost, kQualityFloor.greatest};
  if (quality.below_floor > 0 || quality.faces.above_70 > 0) return kQualityFloor;
  return std::nullopt;
}

class MeshImprover {
 public:
  MeshImprover(const Config& config, const Raster& dtm, const CitySize& size, Columns& columns,
               StepClock& clock, VolumeMeshReport& volume)
      : config_(config),
        dtm_(dtm),
        size_(size),
        columns_(columns),
        clock_(clock),
        volume_(volume),
        work_left_(work_for(config, columns.mesh.node_count())) {}

  MeshQuality run();

 private:
  MeshQuality with_faces(CellQuality cells);
  double valid_gap();
  std::vector<std::uint8_t> bad_triangles(const AngleBounds& bounds);
  CellQuality measured_cells();
  std::int64_t search(const char* name, ImproveOptions options);
  void move_nodes();
  void straighten_faces();

  void make_room();
  void cut_terrain_back(ColumnPlanOptions& options);
  template <typename Mark>
  void cut_from(ColumnPlanOptions& options, const Mark& mark);
  bool cut_back(ColumnPlanOptions& options, const AngleBounds& bounds, const CutMarks& marks_before,
                std::span<const std::uint8_t> bad_before);
  bool make_cut_columns(const ColumnPlanOptions& options, Columns& before);

  const Config& config_;
  const Raster& dtm_;
  const CitySize& size_;
  Columns& columns_;
  StepClock& clock_;
  VolumeMeshReport& volume_;
  MeshQuality quality_;
  std::int64_t work_left_;
};

MeshQuality MeshImprover::run() {
  if (config_.layering == Layering::kUniform) return with_faces(measured_cells());
  move_nodes();
  make_room();
  return std::move(quality_);
}

CellQuality MeshImprover::measured_cells() {
  return clock_.run("3.6", "measure cells",
                    [&](const Progress&) { return measure_cells(columns_.mesh, kWorstCells); });
}

/// The least vertical gap, once elevations are found to increase up every column.
double MeshImprover::valid_gap() {
  return clock_.run("3.6", "check columns",
                    [&](const Progress&) { return require_valid(columns_.mesh); });
}

std::vector<std::uint8_t> MeshImprover::bad_triangles(const AngleBounds& bounds) {
  return clock_.run("3.6", "find bad cells",
                    [&](const Progress&) { return find_bad_triangles(columns_.mesh, bounds); });
}

MeshQuality MeshImprover::with_faces(CellQuality cells) {
  return clock_.run("3.6", "measure faces", [&](const Progress&) {
    const std::int64_t below = is_within(cells.histogram, kQualityFloor)
                                   ? 0
                                   : count_bad_cells(columns_.mesh, kQualityFloor);
    return MeshQuality{std::move(cells), measure_faces(columns_.mesh), below};
  });
}

/// Returns how many columns changed.
std::int64_t MeshImprover::search(const char* name, ImproveOptions options) {
  options.most_cells = std::min(options.most_cells, work_left_);
  const Improvement done = clock_.run("3.5", name, [&](const Progress& progress) {
    return improve_columns(columns_.mesh, options, progress);
  });
  work_left_ -= done.cells;
  return done.columns_changed;
}

/// Measures the mesh, and makes thin cells and faces beyond kMostNonOrthogonal better if there are
/// any.
void MeshImprover::move_nodes() {
  volume_.columns_improved = 0;
  CellQuality cells = measured_cells();
  const ImproveOptions options;
  if (!is_within(cells.histogram, {options.least_deg, options.greatest_deg})) {
    volume_.columns_improved = search("improve cells", options);
    if (volume_.columns_improved > 0) {
      volume_.min_vertical_gap = valid_gap();
      cells = measured_cells();
    }
  }
  quality_ = with_faces(std::move(cells));
  straighten_faces();
}

/// Per triangle, 1: one of its columns is not as it was.
template <typename Before>
std::vector<std::uint8_t> changed_triangles(const ColumnMesh& mesh, const Before& before) {
  const auto& [first, roof, z] = before;
  std::vector<std::uint8_t> column(mesh.vertex_count(), 0), changed(mesh.triangle_count(), 0);
  for (std::size_t v = 0; v < column.size(); ++v)
    if (mesh.roof[v] != roof[v] || mesh.first[v + 1] - mesh.first[v] != first[v + 1] - first[v] ||
        !std::equal(mesh.z.begin() + mesh.first[v], mesh.z.begin() + mesh.first[v + 1],
                    z.begin() + first[v]))
      column[v] = 1;
  for (std::size_t t = 0; t < changed.size(); ++t)
    for (const VertexIndex v : mesh.ground.triangles[t])
      if (column[static_cast<std::size_t>(v)] != 0) changed[t] = 1;
  return changed;
}

/// Faces beyond kMostNonOrthogonal and cells below the floor, where triangles are marked.
struct Faults {
  std::int64_t faces = 0, cells = 0;
};

Faults count_faults(const ColumnMesh& mesh, std::span<const std::uint8_t> marked) {
  Faults faults{count_non_orthogonal(mesh, marked), 0};
  for (std::size_t t = 0; t < marked.size(); ++t)
    if (marked[t] != 0) faults.cells += count_bad_cells_over(mesh, t, kQualityFloor);
  return faults;
}

/// Works on faces beyond kMostNonOrthogonal, asking more and more of the cells there, too: better
/// cells have better faces. Keeps what leaves fewer of these faces and no worse cells.
void MeshImprover::straighten_faces() {
  constexpr double kStraight = 68;  // degrees, a little less than is allowed
  constexpr std::array kTargets{AngleBounds{12, 157}, AngleBounds{16, 152}, AngleBounds{20, 148}};
  ColumnMesh& mesh = columns_.mesh;
  std::vector<std::uint8_t> steep;  // triangles with such faces; empty: not known
  for (const AngleBounds& target : kTargets) {
    if (quality_.faces.above_70 == 0) return;
    // All that improve_columns changes.
    auto before = std::tuple(mesh.first, mesh.roof, mesh.z);
    ImproveOptions options;
    options.least_deg = target.least;
    options.greatest_deg = target.greatest;
    options.straight_deg = kStraight;
    if (steep.empty()) {
      steep.assign(mesh.triangle_count(), 0);
      clock_.run("3.6", "find bad cells",
                 [&](const Progress&) { mark_non_orthogonal(mesh, steep); });
    }
    options.near = steep;
    const std::int64_t changed = search("straighten faces", options);
    if (changed == 0) continue;
    // Most that does not help shows where it was done, without a look at the whole mesh.
    const std::vector<std::uint8_t> where = changed_triangles(mesh, before);
    const auto swap = [&] {
      std::swap(mesh.first, std::get<0>(before));
      std::swap(mesh.roof, std::get<1>(before));
      std::swap(mesh.z, std::get<2>(before));
    };
    const Faults after = count_faults(mesh, where);
    swap();
    const Faults then = count_faults(mesh, where);
    if (after.faces >= then.faces || after.cells > then.cells) continue;
    swap();
    const double gap = valid_gap();
    MeshQuality now = with_faces(measured_cells());
    if (now.faces.above_70 < quality_.faces.above_70 && now.below_floor <= quality_.below_floor &&
        (has_many_thin_cells(quality_) || !has_many_thin_cells(now))) {
      quality_ = std::move(now);
      steep.clear();
      volume_.min_vertical_gap = gap;
      volume_.columns_improved += changed;
    } else {
      swap();
    }
  }
}

/// Makes the columns anew with the terrain cut back as `options` say; they were `before`. Leaves
/// all as it is, with the result false, if that lowers nothing or takes too much memory.
bool MeshImprover::make_cut_columns(const ColumnPlanOptions& options, Columns& before) {
  const GroundMesh& ground = columns_.mesh.ground;
  ColumnPlan plan = plan_columns(ground, dtm_, columns_.plan.roofs, columns_.plan.spacing, options);
  if (plan.ground == columns_.plan.ground ||
      !cells_fit(config_, size_, static_cast<double>(ground.triangles.size()),
                 estimate_cells(plan)))
    return false;
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
bool MeshImprover::cut_back(ColumnPlanOptions& options, const AngleBounds& bounds,
                            const CutMarks& marks_before,
                            std::span<const std::uint8_t> bad_before) {
  // Not at the price of cells that are bad by any measure.
  const auto bad = [&] {
    return clock_.run("3.6", "count bad cells", [&](const Progress&) {
      const std::int64_t below_floor = count_bad_triangles(columns_.mesh, kQualityFloor);
      const bool is_floor = bounds.least == kQualityFloor.least;
      return std::tuple(below_floor, has_many_thin_cells(quality_), quality_.faces.above_70,
                        is_floor ? below_floor : count_bad_triangles(columns_.mesh, bounds),
                        std::max(quality_.faces.worst.non_orthogonality_deg, kMostNonOrthogonal));
    });
  };
  const auto bad_then = bad();
  const VolumeMeshReport volume_before = volume_;
  Columns before;
  if (!clock_.run("3.3", "cut terrain back",
                  [&](const Progress&) { return make_cut_columns(options, before); }))
    return false;
  MeshQuality quality_before = std::move(quality_);
  volume_.min_vertical_gap = valid_gap();
  move_nodes();
  if (bad() < bad_then) return true;
  const std::vector<std::uint8_t> bad_after = bad_triangles(bounds);
  keep_helpful_marks(columns_.mesh, columns_.plan.building,
                     {before.plan.ground, columns_.plan.ground, bad_before, bad_after},
                     marks_before, options.cut);
  before.mesh.ground = std::move(columns_.mesh.ground);
  before.mesh.edges = std::move(columns_.mesh.edges);
  columns_ = std::move(before);
  quality_ = std::move(quality_before);
  volume_ = volume_before;
  return false;
}

/// Cuts back from what `mark` marks, until the floor is met or a cut does not help. Where cuts help
/// in one part of the city and not in another, those that do are tried again by themselves.
template <typename Mark>
void MeshImprover::cut_from(ColumnPlanOptions& options, const Mark& mark) {
  for (int round = 0; round < kMostCuts; ++round) {
    const std::optional<AngleBounds> bounds = missed_bounds(quality_);
    if (!bounds) return;
    const std::vector<std::uint8_t> bad = bad_triangles(*bounds);
    const CutMarks before = options.cut;
    if (mark(bad, options.cut) == 0) return;
    const CutMarks all = options.cut;
    if (cut_back(options, *bounds, before, bad)) continue;
    if (options.cut != all && options.cut != before && cut_back(options, *bounds, before, bad))
      continue;
    options.cut = before;
    return;
  }
}

/// Where cells or faces are below the floor, cuts the terrain back, as long as that makes fewer:
/// around roofs below it first, then from the feet of cliffs and low walls. What is left is dug out
/// at the walls, deeper than the buildings stand.
void MeshImprover::make_room() {
  ColumnPlanOptions options = plan_options(config_);
  if (config_.cut_slope < 90) cut_terrain_back(options);
  options.cut.walls.assign(columns_.plan.roofs.size(), 0);
  cut_from(options, [&](std::span<const std::uint8_t> bad, CutMarks& marks) {
    return mark_deep_walls(columns_.mesh, columns_.plan, bad, marks);
  });
}

void MeshImprover::cut_terrain_back(ColumnPlanOptions& options) {
  options.cut.roofs.assign(columns_.plan.roofs.size(), 0);
  cut_from(options, [&](std::span<const std::uint8_t> bad, CutMarks& marks) {
    return mark_buried_roofs(columns_.mesh, columns_.plan, bad, marks);
  });
  options.cut.feet.assign(columns_.plan.ground.size(), std::numeric_limits<double>::infinity());
  // As few feet as do. Last those next to bad triangles: over level ground at the foot of a cliff
  // the columns of the foot, whose segments are as long as the cliff is high, make faces bad.
  for (const bool is_beside : {false, true})
    for (const double share : {0.0, 0.5})
      cut_from(options, [&](std::span<const std::uint8_t> bad, CutMarks& marks) {
        const FootRule rule{options.cut_slopes.at_start, share};
        if (!is_beside) return mark_feet(columns_.mesh, columns_.plan, bad, rule, marks);
        return mark_feet(columns_.mesh, columns_.plan, with_neighbours(columns_.mesh, bad), rule,
                         marks);
      });
  // Where that is still too steep, more gently.
  for (const double degrees : {45.0, 30.0})
    for (const bool is_beside : {false, true})
      cut_from(options, [&](std::span<const std::uint8_t> bad, CutMarks& marks) {
        const double slope = std::tan(to_radians(degrees));
        if (!is_beside) return mark_gentle(columns_.mesh, columns_.plan, bad, slope, marks);
        return mark_gentle(columns_.mesh, columns_.plan, with_neighbours(columns_.mesh, bad), slope,
                           marks);
      });
}

}  // namespace

MeshQuality improve_mesh(const Config& config, const Raster& dtm, const CitySize& size,
                         Columns& columns, StepClock& clock, VolumeMeshReport& volume) {
  return MeshImprover(config, dtm, size, columns, clock, volume).run();
}

namespace {

/// The settings that alone make bad cells, if there are any.
std::string unusual_settings(const Config& config) {
  std::string text;
  if (config.layering == Layering::kUniform) text += "; --layering graded gives better ones";
  if (config.min_angle < 20) text += fmt::format("; --min-angle {:g} is small", config.min_angle);
  const double share = config.layer_height / config.mesh_size;
  // Graded layers take a large height as an upper limit only.
  const bool tall = share > 2 && config.layering == Layering::kUniform;
  if (config.layer_height > 0 && (share < 0.5 || tall))
    text += fmt::format("; --layer-height {:g} is far from --mesh-size {:g}", config.layer_height,
                        config.mesh_size);
  return text;
}

}  // namespace

void warn_below_floor(const Config& config, const ColumnMesh& mesh, const MeshQuality& quality,
                      Report& report) {
  const std::optional<AngleBounds> bounds = missed_bounds(quality);
  if (const double skewness = quality.faces.worst.skewness; skewness >= kMostSkewed)
    report.warnings.push_back(
        {"faces_skewed", 1,
         fmt::format("a face, or more, has a skewness of {:.2f}, where less than {} "
                     "is meant for all; a smaller --mesh-size may help",
                     skewness, kMostSkewed)});
  if (!bounds) return;
  const QualityHistogram& angles = quality.cells.histogram;
  if (const std::int64_t bad = count_bad_cells(mesh, *bounds); bad > 0)
    report.warnings.push_back(
        {"below_quality_floor", bad,
         fmt::format(
             "cells have dihedral angles outside of {} to {} degrees (least {:.2f}, greatest "
             "{:.2f}), where {} to {} are meant for all and {} for all but one in ten thousand; "
             "worst_cells in the report has the worst and why{}",
             bounds->least, bounds->greatest, angles.min_dihedral_deg(), angles.max_dihedral_deg(),
             kQualityFloor.least, kQualityFloor.greatest, kLeastOfMost, unusual_settings(config))});
  if (quality.faces.above_70 > 0)
    report.warnings.push_back(
        {"faces_non_orthogonal", quality.faces.above_70,
         fmt::format(
             "faces between cells are more than {} degrees non-orthogonal (the worst "
             "{:.2f}), at steep ground, buried roofs or, in uniform layers, low walls; a smaller "
             "--mesh-size may help{}",
             kMostNonOrthogonal, quality.faces.worst.non_orthogonality_deg,
             unusual_settings(config))});
}

}  // namespace tetropolis
