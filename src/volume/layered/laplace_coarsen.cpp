#include "laplace_coarsen.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "core/ragged_builder.h"

namespace tetropolis {

namespace {

constexpr std::size_t kColumnsPerPart = 2048;

/// Calls body(edge, neighbour) for the edges of column v.
template <typename Body>
void for_neighbours(const LevelGraph& graph, std::size_t v, const Body& body) {
  for (const EdgeIndex e : graph.starting_at(v)) body(e, graph.edges[e][1]);
  for (const EdgeIndex e : graph.ending_at(v)) body(e, graph.edges[e][0]);
}

/// Aggregate of every column; their number. Roots are taken in the order of the columns, which is
/// one along a space-filling curve, and aggregates are numbered likewise.
std::pair<std::vector<VertexIndex>, std::size_t> aggregate(const LevelGraph& graph,
                                                           const EdgeWeights& weights) {
  // A column takes its neighbours' value where it is tied to them; loose ends are left to others.
  constexpr float kWeak = 0.25F;
  std::vector<float> strongest(graph.columns, 0.0F);
  for (std::size_t v = 0; v < graph.columns; ++v)
    for_neighbours(graph, v, [&](EdgeIndex e, VertexIndex) {
      strongest[v] = std::max(strongest[v], weights[e]);
    });
  const auto strong = [&](EdgeIndex e, std::size_t v) { return weights[e] > kWeak * strongest[v]; };
  std::vector<VertexIndex> of(graph.columns, kNoVertex);
  VertexIndex count{};
  for (std::size_t v = 0; v < graph.columns; ++v) {
    bool free = of[v] == kNoVertex;
    if (free)
      for_neighbours(graph, v, [&](EdgeIndex e, VertexIndex x) {
        if (of[x] != kNoVertex && strong(e, v)) free = false;
      });
    if (!free) continue;
    of[v] = count;
    for_neighbours(graph, v, [&](EdgeIndex e, VertexIndex x) {
      if (of[x] == kNoVertex && strong(e, v)) of[x] = count;
    });
    ++count;
  }
  // The rest goes where it is drawn most; columns without neighbours stay by themselves.
  const std::vector<VertexIndex> cores = of;
  for (std::size_t v = 0; v < graph.columns; ++v) {
    if (of[v] != kNoVertex) continue;
    float best = -1;
    for_neighbours(graph, v, [&](EdgeIndex e, VertexIndex x) {
      if (cores[x] == kNoVertex || weights[e] <= best) return;
      best = weights[e];
      of[v] = cores[x];
    });
    if (of[v] == kNoVertex) of[v] = count++;
  }
  return {std::move(of), count};
}

using Entry = Interpolation::Entry;

void add_entry(std::vector<Entry>& row, VertexIndex column, float weight) {
  for (Entry& entry : row)
    if (entry.column == column) {
      entry.weight += weight;
      return;
    }
  row.push_back({column, weight});
}

/// Row of column v: one damped Jacobi step on its aggregate's indicator; small weights are left
/// out and the others made to add up to one.
void smoothed_row(const LevelGraph& graph, const EdgeWeights& weights,
                  const std::vector<VertexIndex>& aggregate_of, std::size_t v,
                  std::vector<Entry>& row) {
  constexpr float kStep = 0.75F, kSmall = 0.1F;
  row.clear();
  float total = 0;
  for_neighbours(graph, v, [&](EdgeIndex e, VertexIndex) { total += weights[e]; });
  row.push_back({aggregate_of[v], total > 0 ? 1 - kStep : 1.0F});
  if (!(total > 0)) return;
  for_neighbours(graph, v, [&](EdgeIndex e, VertexIndex x) {
    add_entry(row, aggregate_of[x], kStep * weights[e] / total);
  });
  std::erase_if(row, [](const Entry& entry) { return entry.weight < kSmall; });
  float kept = 0;
  for (const Entry& entry : row) kept += entry.weight;
  for (Entry& entry : row) entry.weight /= kept;
  std::sort(row.begin(), row.end(),
            [](const Entry& a, const Entry& b) { return a.column < b.column; });
}

Interpolation interpolation(const LevelGraph& graph, const EdgeWeights& weights,
                            const std::vector<VertexIndex>& aggregate_of, std::size_t count) {
  const std::size_t chunks = (graph.columns + kColumnsPerPart - 1) / kColumnsPerPart;
  std::vector<std::vector<Entry>> parts(chunks);
  Interpolation p;
  std::vector<std::int32_t>& offsets = p.coarse.offsets;
  offsets.assign(graph.columns + 1, 0);
  parallel_chunks(graph.columns, kColumnsPerPart, [&](std::size_t begin, std::size_t end) {
    auto& part = parts[begin / kColumnsPerPart];
    part.reserve((end - begin) * 3);
    std::vector<Entry> row;
    for (std::size_t v = begin; v < end; ++v) {
      smoothed_row(graph, weights, aggregate_of, v, row);
      part.insert(part.end(), row.begin(), row.end());
      offsets[v + 1] = static_cast<std::int32_t>(row.size());
    }
  });
  for (std::size_t v = 0; v < graph.columns; ++v) offsets[v + 1] += offsets[v];
  p.coarse.values.reserve(static_cast<std::size_t>(offsets.back()));
  for (const auto& part : parts)
    p.coarse.values.insert(p.coarse.values.end(), part.begin(), part.end());
  p.fine = ragged_from_pairs<Entry, std::int32_t>(count, [&](const auto& use) {
    for (const VertexIndex v : indices<VertexIndex>(graph.columns))
      for (const Entry& entry : p.coarse[v]) use(entry.column, Entry{v, entry.weight});
  });
  return p;
}

}  // namespace

Interpolation coarsen(const LevelGraph& graph, const EdgeWeights& weights) {
  const auto [aggregate_of, count] = aggregate(graph, weights);
  return interpolation(graph, weights, aggregate_of, count);
}

}  // namespace tetropolis
