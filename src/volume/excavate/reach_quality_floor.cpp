#include "reach_quality_floor.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "places.h"
#include "volume/column/ground_heights.h"
#include "volume/quality/improve_columns.h"
#include "volume/quality/measured_mesh.h"

namespace tetropolis {

namespace {

/// What became of places, by their vertices.
using Outcomes = std::map<std::vector<VertexIndex>, std::optional<PlaceOutcome>>;

/// Works on the places around the seeds; on those that outgrow their cutouts anew, in larger ones.
Outcomes improve_places(const Columns& columns, std::vector<std::uint8_t> seeds,
                        std::span<const std::uint8_t> moved, const QualityFloorOptions& options,
                        const Progress& progress) {
  std::mutex mutex;
  Progress cancellation;
  cancellation.cancelled = [&] {
    const std::lock_guard lock(mutex);
    return progress.cancelled && progress.cancelled();
  };
  const double cells = estimate_cells(columns.plan);
  Outcomes outcomes;
  for (bool is_outgrown = true; is_outgrown;) {
    Outcomes earlier = std::exchange(outcomes, {});
    std::vector<Outcomes::value_type*> jobs;
    for (std::vector<VertexIndex>& vertices : find_places(columns, seeds)) {
      if (auto node = earlier.extract(vertices)) {
        outcomes.insert(std::move(node));
      } else {
        jobs.push_back(&*outcomes.emplace(std::move(vertices), std::nullopt).first);
      }
    }
    parallel_in_order(jobs.size(), [&](std::size_t i) {
      auto& [vertices, outcome] = *jobs[i];
      Cutout cutout = cut_out(columns, vertices);
      std::vector<std::uint8_t> own_moved;
      for (const VertexIndex v : vertices) own_moved.push_back(moved[v]);
      const double elsewhere = cells - estimate_cells(cutout.columns.plan);
      outcome =
          improve_place(std::move(cutout), std::move(own_moved), options, elsewhere, cancellation);
    });
    is_outgrown = false;
    for (const auto* job : jobs) {
      if (job->second) continue;
      is_outgrown = true;
      for (const VertexIndex v : job->first) seeds[v] = 1;
    }
  }
  return outcomes;
}

/// Gives the mesh what became of its places, and measures that.
void take_outcomes(const Outcomes& outcomes, std::vector<std::uint8_t>& moved,
                   MeasuredMesh& measured, ImprovedColumns& result) {
  ColumnPlan& plan = result.columns.plan;
  ColumnMesh& mesh = result.columns.mesh;
  std::vector<ColumnOf> columns;
  for (const VertexIndex v : indices<VertexIndex>(moved.size())) columns.push_back({&mesh, v});
  std::vector<std::pair<BuildingIndex, double>> roofs;
  for (const auto& [vertices, outcome] : outcomes) {
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const VertexIndex v = vertices[i];
      columns[v] = {&outcome->mesh, VertexIndex(i)};
      plan.ground[v] = outcome->plan.ground[i];
      plan.rise[v] = outcome->plan.rise[i];
      moved[v] = outcome->moved[i];
    }
    const ExcavationSources& own = outcome->sources;
    for (std::size_t i = 0; i < own.roofs.size(); ++i)
      roofs.emplace_back(own.roofs[i], own.roof_slopes_deg[i]);
    ExcavationSources& all = result.excavated;
    all.toes.insert(all.toes.end(), own.toes.begin(), own.toes.end());
    all.toe_slopes_deg.insert(all.toe_slopes_deg.end(), own.toe_slopes_deg.begin(),
                              own.toe_slopes_deg.end());
  }
  std::sort(roofs.begin(), roofs.end());
  for (const auto& [roof, slope] : roofs) {
    result.excavated.roofs.push_back(roof);
    result.excavated.roof_slopes_deg.push_back(slope);
  }
  ColumnMesh improved = gather_columns(columns.size(), [&](VertexIndex v) { return columns[v]; });
  const std::vector<VertexIndex> changed = different_columns(mesh, improved);
  measured.forget(mesh, changed);
  improved.ground = std::move(mesh.ground);
  improved.edges = std::move(mesh.edges);
  mesh = std::move(improved);
  measured.look_again(mesh, changed);
}

}  // namespace

ImprovedColumns reach_quality_floor(Columns columns, const QualityFloorOptions& options,
                                    Steps& steps) {
  ImprovedColumns result;
  result.columns = std::move(columns);
  ColumnPlan& plan = result.columns.plan;
  ColumnMesh& mesh = result.columns.mesh;
  std::vector<std::uint8_t> moved(mesh.vertex_count(), 0);
  MeasuredMesh measured = steps.run("3.6", "measure cells and faces", [&](const Progress&) {
    return MeasuredMesh(mesh, MeasuredMesh::Counting::kHistogram);
  });
  if (measured.counts().cells_outside(Asked::kGood) > 0)
    steps.run("3.5", "improve cells", [&](const Progress& progress) {
      ImproveOptions improve;
      improve.most_gap = options.most_gap;
      improve.before_change = [&](std::span<const VertexIndex> changing) {
        measured.forget(mesh, changing);
      };
      const Improvement done = improve_columns(mesh, improve, progress);
      for (const VertexIndex v : done.columns) moved[v] = 1;
      measured.look_again(mesh, done.columns);
    });
  const std::vector<std::uint8_t> bad = measured.bad_triangles(mesh, Asked::kOfMost);
  if (std::find(bad.begin(), bad.end(), 1) != bad.end())
    steps.run("3.5", "improve bad places", [&](const Progress& progress) {
      std::vector<std::uint8_t> seeds(moved.size(), 0);
      for (const TriangleIndex t : indices<TriangleIndex>(bad.size()))
        for (const VertexIndex v : mesh.ground.triangles[t]) seeds[v] |= bad[t];
      take_outcomes(improve_places(result.columns, std::move(seeds), moved, options, progress),
                    moved, measured, result);
      count_lowered(mesh.ground, options.plan.minimum_wall, plan);
      if (options.require_fits) options.require_fits(estimate_cells(plan));
    });
  result.columns_improved = std::count(moved.begin(), moved.end(), 1);
  result.min_vertical_gap = steps.run("3.6", "check columns", [&](const Progress&) {
    const double gap = require_valid(mesh);
    result.quality = measured.quality(mesh, kWorstCells);
    return gap;
  });
  return result;
}

}  // namespace tetropolis
