#include "grow_upper.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "tetropolis/core/error.h"

#include "core/parallel.h"
#include "front.h"
#include "mend_front.h"

namespace tetropolis {

/// Nodes, fans and cells are numbered column by column and upwards, as those below: what is near
/// has numbers that are.
UpperMesh upper_of(FrontPhases phases, const ColumnMesh& mesh) {
  const std::size_t columns = mesh.vertex_count();
  for (std::vector<FrontSteps>& parts : phases)
    for (FrontSteps& part : parts) part.orders = {};
  // Per column, and one more: where its own begin.
  struct Counts {
    std::uint32_t nodes = 0, fans = 0, cells = 0, others = 0;
  };
  std::vector<Counts> first(columns + 1);
  std::size_t others = 0;  // the greatest of all
  for (const std::vector<FrontSteps>& parts : phases) {
    for (const FrontSteps& part : parts) others += part.others.size();
    // No two parts have steps of a column.
    parallel_in_order(parts.size(), [&](std::size_t i) {
      for (const FrontStep& step : parts[i].steps) {
        Counts& after = first[step.vertex + 1];
        after.nodes += step.is_end() ? 0 : 1;
        ++after.fans;
        after.cells += static_cast<std::uint32_t>(step.cells());
        after.others += static_cast<std::uint32_t>(step.others());
      }
    });
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
  std::vector<UpperPlace> place(columns);  // per column: its front's
  std::iota(place.begin(), place.end(), UpperPlace(0));
  const auto take = [&](const FrontSteps& part) {
    auto risen = part.risen.begin();
    std::uint32_t other = 0;
    const auto next_place = [&] {
      const VertexIndex u = part.others[other];
      const bool is_told = risen != part.risen.end() && risen->other == other;
      ++other;
      if (!is_told) return place[u];
      const std::int16_t times = (risen++)->times;
      if (times == 0) return UpperPlace(u.value());
      return UpperPlace(columns + first[u].nodes + static_cast<std::size_t>(times) - 1);
    };
    for (const FrontStep& step : part.steps) {
      const VertexIndex v = step.vertex;
      Counts& own = next[v];
      UpperFan& fan = upper.fans[own.fans++];
      fan = {place[v], UpperPlace::none(), own.cells, own.others};
      own.cells += static_cast<std::uint32_t>(step.cells());
      for (std::int32_t k = 0; k < step.others(); ++k) upper.others[own.others++] = next_place();
      if (step.is_end()) continue;
      upper.z[own.nodes] = step.to;
      upper.vertex[own.nodes] = v;
      fan.up = place[v] = UpperPlace(columns + own.nodes++);
    }
    for (const CoveredTriangle& covered : part.covered)
      upper.over_lid[covered.triangle] = lowest + first[covered.vertex].cells + covered.nth;
  };
  for (std::vector<FrontSteps>& parts : phases)
    parallel_in_order(parts.size(), [&](std::size_t i) {
      take(parts[i]);
      parts[i] = {};
    });
  upper.fan_of_block.resize((all.cells + UpperMesh::kBlock - 1) / UpperMesh::kBlock);
  parallel_chunks(all.fans, 65536, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      std::size_t block = (upper.fans[f].cell + UpperMesh::kBlock - 1) / UpperMesh::kBlock;
      for (; block * UpperMesh::kBlock < upper.fans[f + 1].cell; ++block)
        upper.fan_of_block[block] = static_cast<std::uint32_t>(f);
    }
  });
  return upper;
}

UpperMesh grow_upper(const ColumnMesh& mesh, double top, const Progress& progress,
                     std::size_t tiles) {
  if (tiles == 0) tiles = useful_tiles(mesh);
  FrontPhases phases;
  {
    FrontClimb climb(mesh, top, tiles, progress.cancelled);
    const std::vector<double> shares(mesh.vertex_count(), 1.0);
    phases = climb.to_top(shares);
    mend_front(mesh, top, climb, phases);
  }
  return upper_of(std::move(phases), mesh);
}

}  // namespace tetropolis
