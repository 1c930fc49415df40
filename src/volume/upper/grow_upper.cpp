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

/// Per column, and one more: where its own begin.
template <typename Count>
std::vector<std::int64_t> offsets(const std::vector<FrontSteps>& all, std::size_t columns,
                                  const Count& count) {
  std::vector<std::int64_t> begin(columns + 1, 0);
  for (const FrontSteps& part : all)
    for (const FrontStep& step : part.steps) begin[step.node.vertex + 1] += count(step);
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  return begin;
}

/// Nodes and cells are numbered column by column and upwards, as those below: what is near has
/// numbers that are.
UpperMesh mesh_of(const std::vector<FrontSteps>& all, const ColumnMesh& mesh) {
  const std::size_t columns = mesh.vertex_count();
  const auto first_point =
      offsets(all, columns, [](const FrontStep& step) { return step.is_end() ? 0 : 1; });
  const auto first_cell = offsets(all, columns, [](const FrontStep& step) { return step.cells(); });
  const auto node = [&](FrontNode n) {
    if (n.nth == 0) return mesh.top(n.vertex);
    return NodeIndex(mesh.column_nodes() + first_point[n.vertex] + n.nth - 1);
  };
  UpperMesh upper;
  upper.points.resize(static_cast<std::size_t>(first_point.back()));
  upper.vertex.resize(upper.points.size());
  upper.cells.resize(static_cast<std::size_t>(first_cell.back()));
  upper.over_lid.assign(mesh.triangle_count(), kNoCell);
  const std::int64_t lowest = cell_offsets(mesh).back().value();
  parallel_in_order(all.size(), [&](std::size_t i) {
    const FrontSteps& part = all[i];
    for (const FrontStep& step : part.steps) {
      const VertexIndex v = step.node.vertex;
      const NodeIndex own = node(step.node);
      const FrontNode* others = part.others.data() + step.others;
      auto cell = static_cast<std::size_t>(first_cell[v] + step.cells_before);
      const auto add = [&](FrontNode a, FrontNode b, NodeIndex last) {
        upper.cells[cell++] = {own, node(a), node(b), last};
      };
      if (step.is_end()) {
        for (std::int32_t k = 0; k < step.cells(); ++k, others += 3)
          add(others[0], others[1], node(others[2]));
        continue;
      }
      const NodeIndex top = node({v, step.node.nth + 1});
      const auto point = static_cast<std::size_t>(top.value() - mesh.column_nodes());
      const Point2 p = mesh.ground.vertices[v];
      upper.points[point] = {p.x, p.y, step.to};
      upper.vertex[point] = v;
      for (std::int32_t k = 0; k < step.around; ++k) add(others[k], others[k + 1], top);
    }
    for (const CoveredTriangle& covered : part.covered)
      upper.over_lid[covered.triangle] =
          CellIndex(lowest + first_cell[covered.vertex] + covered.nth);
  });
  return upper;
}

}  // namespace

UpperMesh grow_upper(const ColumnMesh& mesh, double top, std::size_t tiles) {
  if (tiles == 0) tiles = useful_tiles(mesh);
  std::vector<double> shares(mesh.vertex_count(), 1.0);
  std::vector<FrontSteps> best;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (int round = 0; round < kMostRounds && fewest > 0; ++round) {
    std::vector<FrontSteps> steps = climb_to_top(mesh, top, shares, tiles);
    std::vector<VertexIndex> poor;
    for (const FrontSteps& part : steps)
      poor.insert(poor.end(), part.poor.begin(), part.poor.end());
    if (poor.size() < fewest) {
      fewest = poor.size();
      best = std::move(steps);
    }
    sort_once(poor);
    for (const VertexIndex v : poor) shares[v] *= kShorter;
  }
  return mesh_of(best, mesh);
}

}  // namespace tetropolis
