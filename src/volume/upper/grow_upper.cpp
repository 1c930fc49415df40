#include "grow_upper.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "tetropolis/core/error.h"

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

/// Nodes, fans and cells are numbered column by column and upwards, as those below: what is near
/// has numbers that are.
UpperMesh mesh_of(FrontPhases phases, const ColumnMesh& mesh) {
  const std::size_t columns = mesh.vertex_count();
  // Per column, and one more: where its own begin.
  struct Counts {
    std::uint32_t nodes = 0, fans = 0, cells = 0, others = 0;
  };
  std::vector<Counts> first(columns + 1);
  std::size_t others = 0;  // the greatest of all
  for (const std::vector<FrontSteps>& parts : phases)
    for (const FrontSteps& part : parts)
      for (const FrontStep& step : part.steps) {
        Counts& after = first[step.vertex + 1];
        after.nodes += step.is_end() ? 0 : 1;
        ++after.fans;
        after.cells += static_cast<std::uint32_t>(step.cells());
        after.others += static_cast<std::uint32_t>(step.others());
        others += static_cast<std::size_t>(step.others());
      }
  if (others > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorKind::kUsage,
                "the mesh would have more than three billion cells above the buildings; raise "
                "mesh_size or lower domain_height");
  for (std::size_t v = 0; v < columns; ++v) {
    const Counts& before = first[v];
    Counts& after = first[v + 1];
    after.nodes += before.nodes;
    after.fans += before.fans;
    after.cells += before.cells;
    after.others += before.others;
  }
  const Counts all = first.back();
  UpperMesh upper;
  if (all.fans == 0) return upper;
  upper.z.resize(all.nodes);
  upper.vertex.resize(all.nodes);
  upper.fans.resize(all.fans + std::size_t{1});
  upper.fans.back() = {UpperPlace::none(), UpperPlace::none(), all.cells, all.others};
  upper.others.resize(all.others);
  upper.over_lid.assign(mesh.triangle_count(), kNoCell);
  const CellIndex lowest = cell_offsets(mesh).back();
  std::vector<Counts> next(first.begin(), first.end() - 1);
  const auto place = [&](VertexIndex v) {
    if (next[v].nodes == first[v].nodes) return UpperPlace(v.value());
    return UpperPlace(columns + next[v].nodes - 1);
  };
  const auto take = [&](const FrontSteps& part) {
    const VertexIndex* other = part.others.data();
    for (const FrontStep& step : part.steps) {
      const VertexIndex v = step.vertex;
      Counts& own = next[v];
      UpperFan& fan = upper.fans[own.fans++];
      fan = {place(v), UpperPlace::none(), own.cells, own.others};
      own.cells += static_cast<std::uint32_t>(step.cells());
      for (std::int32_t k = 0; k < step.others(); ++k) upper.others[own.others++] = place(*other++);
      if (step.is_end()) continue;
      upper.z[own.nodes] = step.to;
      upper.vertex[own.nodes++] = v;
      fan.up = place(v);
    }
    for (const CoveredTriangle& covered : part.covered)
      upper.over_lid[covered.triangle] = lowest + first[covered.vertex].cells + covered.nth;
  };
  for (std::vector<FrontSteps>& parts : phases)
    parallel_in_order(parts.size(), [&](std::size_t i) {
      take(parts[i]);
      parts[i] = {};
    });
  for (std::size_t f = 0; f + 1 < upper.fans.size(); ++f)
    while (upper.fan_of_block.size() * UpperMesh::kBlock < upper.fans[f + 1].cell)
      upper.fan_of_block.push_back(static_cast<std::uint32_t>(f));
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
