#include "laplace_coarsen.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"

namespace tetropolis {

namespace {

constexpr std::int32_t kNone = -1;
constexpr std::size_t kColumnsPerChunk = 2048;

/// Calls body(edge, neighbour) for the edges of column v.
template <typename Body>
void for_neighbours(const LevelGraph& graph, std::size_t v, const Body& body) {
  for (EdgeIndex e = graph.starts[v]; e < graph.starts[v + 1]; ++e)
    body(static_cast<std::size_t>(e), static_cast<std::size_t>(graph.edges[e][1]));
  for (std::int32_t i = graph.end_offsets[v]; i < graph.end_offsets[v + 1]; ++i) {
    const EdgeIndex e = graph.ends[i];
    body(static_cast<std::size_t>(e), static_cast<std::size_t>(graph.edges[e][0]));
  }
}

/// Aggregate of every column; their number. Roots are taken in the order of the columns, which is
/// one along a space-filling curve, and aggregates are numbered likewise.
std::pair<std::vector<std::int32_t>, std::int32_t> aggregate(const LevelGraph& graph,
                                                             const EdgeWeights& weights) {
  // A column takes its neighbours' value where it is tied to them; loose ends are left to others.
  constexpr float kWeak = 0.25F;
  std::vector<float> strongest(graph.columns, 0.0F);
  for (std::size_t v = 0; v < graph.columns; ++v)
    for_neighbours(graph, v, [&](std::size_t e, std::size_t) {
      strongest[v] = std::max(strongest[v], weights[e]);
    });
  const auto strong = [&](std::size_t e, std::size_t v) {
    return weights[e] > kWeak * strongest[v];
  };
  std::vector<std::int32_t> of(graph.columns, kNone);
  std::int32_t count = 0;
  for (std::size_t v = 0; v < graph.columns; ++v) {
    bool free = of[v] == kNone;
    if (free)
      for_neighbours(graph, v, [&](std::size_t e, std::size_t x) {
        if (of[x] != kNone && strong(e, v)) free = false;
      });
    if (!free) continue;
    of[v] = count;
    for_neighbours(graph, v, [&](std::size_t e, std::size_t x) {
      if (of[x] == kNone && strong(e, v)) of[x] = count;
    });
    ++count;
  }
  // The rest goes where it is drawn most; columns without neighbours stay by themselves.
  const std::vector<std::int32_t> cores = of;
  for (std::size_t v = 0; v < graph.columns; ++v) {
    if (of[v] != kNone) continue;
    float best = -1;
    for_neighbours(graph, v, [&](std::size_t e, std::size_t x) {
      if (cores[x] == kNone || weights[e] <= best) return;
      best = weights[e];
      of[v] = cores[x];
    });
    if (of[v] == kNone) of[v] = count++;
  }
  return {std::move(of), count};
}

using Entry = Interpolation::Entry;

void add_entry(std::vector<Entry>& row, std::int32_t column, float weight) {
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
                  const std::vector<std::int32_t>& aggregate_of, std::size_t v,
                  std::vector<Entry>& row) {
  constexpr float kStep = 0.75F, kSmall = 0.1F;
  row.clear();
  float total = 0;
  for_neighbours(graph, v, [&](std::size_t e, std::size_t) { total += weights[e]; });
  row.push_back({aggregate_of[v], total > 0 ? 1 - kStep : 1.0F});
  if (!(total > 0)) return;
  for_neighbours(graph, v, [&](std::size_t e, std::size_t x) {
    add_entry(row, aggregate_of[x], kStep * weights[e] / total);
  });
  std::erase_if(row, [](const Entry& entry) { return entry.weight < kSmall; });
  float kept = 0;
  for (const Entry& entry : row) kept += entry.weight;
  for (Entry& entry : row) entry.weight /= kept;
  std::sort(row.begin(), row.end(),
            [](const Entry& a, const Entry& b) { return a.column < b.column; });
}

void transpose(std::size_t coarse_columns, Interpolation& p) {
  p.fine_starts.assign(coarse_columns + 1, 0);
  for (const Entry& entry : p.coarse) ++p.fine_starts[static_cast<std::size_t>(entry.column) + 1];
  for (std::size_t c = 0; c < coarse_columns; ++c) p.fine_starts[c + 1] += p.fine_starts[c];
  p.fine.resize(p.coarse.size());
  std::vector<std::int32_t> next(p.fine_starts.begin(), p.fine_starts.end() - 1);
  for (std::size_t v = 0; v + 1 < p.coarse_starts.size(); ++v)
    for (std::int32_t i = p.coarse_starts[v]; i < p.coarse_starts[v + 1]; ++i) {
      const Entry& entry = p.coarse[static_cast<std::size_t>(i)];
      p.fine[static_cast<std::size_t>(next[static_cast<std::size_t>(entry.column)]++)] = {
          static_cast<std::int32_t>(v), entry.weight};
    }
}

Interpolation interpolation(const LevelGraph& graph, const EdgeWeights& weights,
                            const std::vector<std::int32_t>& aggregate_of, std::int32_t count) {
  const std::size_t chunks = (graph.columns + kColumnsPerChunk - 1) / kColumnsPerChunk;
  std::vector<std::vector<Entry>> parts(chunks);
  Interpolation p;
  p.coarse_starts.assign(graph.columns + 1, 0);
  parallel_chunks(graph.columns, kColumnsPerChunk, [&](std::size_t begin, std::size_t end) {
    auto& part = parts[begin / kColumnsPerChunk];
    part.reserve((end - begin) * 3);
    std::vector<Entry> row;
    for (std::size_t v = begin; v < end; ++v) {
      smoothed_row(graph, weights, aggregate_of, v, row);
      part.insert(part.end(), row.begin(), row.end());
      p.coarse_starts[v + 1] = static_cast<std::int32_t>(row.size());
    }
  });
  for (std::size_t v = 0; v < graph.columns; ++v) p.coarse_starts[v + 1] += p.coarse_starts[v];
  p.coarse.reserve(static_cast<std::size_t>(p.coarse_starts.back()));
  for (const auto& part : parts) p.coarse.insert(p.coarse.end(), part.begin(), part.end());
  transpose(static_cast<std::size_t>(count), p);
  return p;
}

}  // namespace

Interpolation coarsen(const LevelGraph& graph, const EdgeWeights& weights) {
  const auto [aggregate_of, count] = aggregate(graph, weights);
  return interpolation(graph, weights, aggregate_of, count);
}

}  // namespace tetropolis
