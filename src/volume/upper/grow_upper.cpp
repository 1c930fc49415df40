#include "grow_upper.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/sort_once.h"
#include "front.h"

namespace tetropolis {

namespace {

// Found by trial, as in front.cpp.

/// Where the best is below the floor, it is all done again with segments shorter by this factor at
/// that column and beside it, so often at most.
constexpr double kShorter = 0.85;
constexpr int kMostRounds = 6;

using FrontPhases = std::vector<std::vector<FrontSteps>>;

/// Per column, and one more: where its own begin.
template <typename Count>
std::vector<std::int64_t> offsets(const FrontPhases& phases, std::size_t columns,
                                  const Count& count) {
  std::vector<std::int64_t> begin(columns + 1, 0);
  for (const std::vector<FrontSteps>& parts : phases)
    for (const FrontSteps& part : parts)
      for (const FrontStep& step : part.steps) begin[step.vertex + 1] += count(step);
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  return begin;
}

/// Nodes and cells are numbered column by column and upwards, as those below: what is near has
/// numbers that are.
UpperMesh mesh_of(FrontPhases phases, const ColumnMesh& mesh) {
  const std::size_t columns = mesh.vertex_count();
  const auto first_point =
      offsets(phases, columns, [](const FrontStep& step) { return step.is_end() ? 0 : 1; });
  const auto first_cell =
      offsets(phases, columns, [](const FrontStep& step) { return step.cells(); });
  UpperMesh upper;
  upper.points.resize(static_cast<std::size_t>(first_point.back()));
  upper.vertex.resize(upper.points.size());
  upper.cells.resize(static_cast<std::size_t>(first_cell.back()));
  upper.over_lid.assign(mesh.triangle_count(), kNoCell);
  const std::int64_t lowest = cell_offsets(mesh).back().value();
  // Where columns are: nodes above the lid, and the cell that is next.
  std::vector<std::int32_t> nth(columns, 0);
  std::vector<std::int64_t> next(first_cell.begin(), first_cell.end() - 1);
  const auto node = [&](VertexIndex v) {
    if (nth[v] == 0) return mesh.top(v);
    return NodeIndex(mesh.column_nodes() + first_point[v] + nth[v] - 1);
  };
  const auto take = [&](const FrontSteps& part) {
    const VertexIndex* others = part.others.data();
    for (const FrontStep& step : part.steps) {
      const VertexIndex v = step.vertex;
      const NodeIndex own = node(v);
      const auto add = [&](VertexIndex a, VertexIndex b, NodeIndex last) {
        upper.cells[static_cast<std::size_t>(next[v]++)] = {own, node(a), node(b), last};
      };
      if (step.is_end()) {
        for (std::int32_t k = 0; k < step.others(); k += 3)
          add(others[k], others[k + 1], node(others[k + 2]));
      } else {
        const auto point = static_cast<std::size_t>(first_point[v] + nth[v]++);
        const Point2 p = mesh.ground.vertices[v];
        upper.points[point] = {p.x, p.y, step.to};
        upper.vertex[point] = v;
        for (std::int32_t k = 0; k < step.around; ++k) add(others[k], others[k + 1], node(v));
      }
      others += step.others();
    }
    for (const CoveredTriangle& covered : part.covered)
      upper.over_lid[covered.triangle] =
          CellIndex(lowest + first_cell[covered.vertex] + covered.nth);
  };
  for (std::vector<FrontSteps>& parts : phases)
    parallel_in_order(parts.size(), [&](std::size_t i) {
      take(parts[i]);
      parts[i] = {};
    });
  return upper;
}

}  // namespace

UpperMesh grow_upper(const ColumnMesh& mesh, double top, std::size_t tiles) {
  if (tiles == 0) tiles = useful_tiles(mesh);
  std::vector<double> shares(mesh.vertex_count(), 1.0), best_shares;
  FrontPhases steps;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  bool is_best = false;  // Steps of one round are kept at a time.
  for (int round = 0; round < kMostRounds && fewest > 0; ++round) {
    steps.clear();
    steps = climb_to_top(mesh, top, shares, tiles);
    std::vector<VertexIndex> poor;
    for (const std::vector<FrontSteps>& parts : steps)
      for (const FrontSteps& part : parts)
        poor.insert(poor.end(), part.poor.begin(), part.poor.end());
    is_best = poor.size() < fewest;
    if (is_best) {
      fewest = poor.size();
      best_shares = shares;
    }
    sort_once(poor);
    for (const VertexIndex v : poor) shares[v] *= kShorter;
  }
  if (!is_best) steps = climb_to_top(mesh, top, best_shares, tiles);
  return mesh_of(std::move(steps), mesh);
}

}  // namespace tetropolis
