#include "laplace_galerkin.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "core/parallel.h"
#include "core/ragged_builder.h"
#include "core/wide.h"
#include "laplace_rows.h"

namespace tetropolis {

namespace {

constexpr auto kNone = EdgeIndex::none();

/// Rows of consecutive coarse columns, edges by lower column in the order they were met.
struct Rows {
  struct Edge {
    VertexIndex upper;
    EdgeIndex met;  ///< Position of its bands.
  };
  std::size_t begin = 0;
  std::vector<std::int32_t> counts;  ///< Edges of each row.
  std::vector<Edge> edges;           ///< Ascending within a row.
  std::vector<float> bands;          ///< Three of m numbers an edge.
};

/// Makes the rows of the coarse columns [begin, end).
class RowBuilder {
 public:
  RowBuilder(const LevelMatrix& fine, const LevelGraph& graph, const Interpolation& p,
             LevelMatrix& coarse, Rows& rows)
      : fine_(fine),
        graph_(graph),
        p_(p),
        coarse_(coarse),
        rows_(rows),
        m_(fine.band()),
        met_(p.fine.size(), kNone) {}

  void build(std::size_t row) {
    const std::size_t first = rows_.edges.size();
    for (const auto& entry : p_.fine[row]) add_column(*this, row, entry.column, entry.weight);
    const auto begin = rows_.edges.begin() + static_cast<std::ptrdiff_t>(first);
    for (auto edge = begin; edge != rows_.edges.end(); ++edge) met_[edge->upper] = kNone;
    std::sort(begin, rows_.edges.end(),
              [](const Rows::Edge& a, const Rows::Edge& b) { return a.upper < b.upper; });
    rows_.counts.push_back(static_cast<std::int32_t>(rows_.edges.size() - first));
  }

 private:
  /// The first coupling of the row with coarse column c.
  __attribute__((noinline)) void meet(VertexIndex c) {
    met_[c] = EdgeIndex(rows_.edges.size());
    rows_.edges.push_back({c, met_[c]});
    rows_.bands.resize(rows_.edges.size() * 3 * m_, 0.0F);
  }

  /// to += weight * from, for a band.
  TETROPOLIS_INLINE static void add_band(float* to, const float* from, float weight,
                                         std::size_t m) {
    if (m == 2) {
      for (std::size_t k = 0; k < 2; ++k) to[k] += weight * from[k];
    } else {
      add_scaled(to, from, weight, m);
    }
  }

  /// Couples the row with fine column x by the bands of an edge: (row, k) with (x, k), with
  /// (x, k + 1), and (row, k + 1) with (x, k); the last two may be null.
  TETROPOLIS_INLINE static void add(RowBuilder& b, std::size_t row, std::size_t x,
                                    const float* level, const float* rising, const float* falling,
                                    float weight) {
    const std::size_t m = b.m_;
    // Lower columns have the coupling in their row.
    const auto shares = b.p_.coarse[x];
    for (std::size_t i = shares.size(); i-- > 0;) {
      const VertexIndex c = shares[i].column;
      if (c < row) break;
      const float w = weight * shares[i].weight;
      if (c == row) {
        add_band(b.coarse_.diagonal.data() + row * m, level, w, m);
        if (rising != nullptr) add_band(b.coarse_.vertical.data() + row * m, rising, w, m);
      } else {
        if (b.met_[c] == kNone) b.meet(c);
        float* bands = b.rows_.bands.data() + b.met_[c] * 3 * m;
        add_band(bands, level, w, m);
        if (rising != nullptr) add_band(bands + m, rising, w, m);
        if (falling != nullptr) add_band(bands + 2 * m, falling, w, m);
      }
    }
  }

  /// Adds what fine column v, a share `weight` of which is in the row, is coupled with.
  TETROPOLIS_WIDE static void add_column(RowBuilder& b, std::size_t row, std::size_t v,
                                         float weight) {
    const std::size_t m = b.m_;
    const LevelGraph& graph = b.graph_;
    const auto count = static_cast<std::size_t>(b.fine_.bands);
    for (const EdgeIndex e : graph.starting_at(v)) {
      const float* bands = b.fine_.edge.data() + e * count * m;
      add(b, row, graph.edges[e][1], bands, bands + m, count == 3 ? bands + 2 * m : nullptr,
          weight);
    }
    for (const EdgeIndex e : graph.ending_at(v)) {
      const float* bands = b.fine_.edge.data() + e * count * m;
      add(b, row, graph.edges[e][0], bands, count == 3 ? bands + 2 * m : nullptr, bands + m,
          weight);
    }
    const float* vertical = b.fine_.vertical.data() + v * m;
    add(b, row, v, b.fine_.diagonal.data() + v * m, vertical, vertical, weight);
  }

  const LevelMatrix& fine_;
  const LevelGraph& graph_;
  const Interpolation& p_;
  LevelMatrix& coarse_;
  Rows& rows_;
  std::size_t m_;
  std::vector<EdgeIndex> met_;  ///< Position in rows_.edges of this row's, by upper column.
};

/// Puts the rows one after the other.
void join(const std::vector<Rows>& parts, std::size_t m, CoarseLevel& level) {
  CoarseGraph& graph = level.graph;
  graph.starts.push_back({});
  for (const Rows& rows : parts)
    for (const std::int32_t count : rows.counts)
      graph.starts.push_back(graph.starts.back() + count);
  const std::size_t edges = graph.starts.back();
  graph.edges.resize(edges);
  level.weights.resize(edges);
  level.matrix.edge = PaddedFloats(edges * 3 * m);
  const std::size_t step = level.matrix.uniform ? m : 1;  // All rows but one are alike.
  parallel_chunks(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Rows& rows = parts[i];
      EdgeIndex e = graph.starts[rows.begin];
      std::size_t row = 0, left = 0;
      for (const Rows::Edge& edge : rows.edges) {
        for (; left == 0; ++row) left = static_cast<std::size_t>(rows.counts[row]);
        --left;
        const float* from = rows.bands.data() + edge.met * 3 * m;
        std::memcpy(level.matrix.edge.data() + e * 3 * m, from, 3 * m * sizeof(float));
        float sum = 0;
        for (std::size_t k = 0; k < 3 * m; k += step) sum -= from[k];
        level.weights[e] = std::max(sum, 0.0F);
        graph.edges[e++] = {VertexIndex(rows.begin + row - 1), edge.upper};
      }
    }
  });
  graph.ends =
      ragged_from_pairs<EdgeIndex, std::int32_t>(graph.starts.size() - 1, [&](const auto& use) {
        for (const EdgeIndex e : indices<EdgeIndex>(edges)) use(graph.edges[e][1], e);
      });
}

}  // namespace

void invert_pivots(LevelMatrix& matrix, std::size_t columns) {
  const std::size_t stride = matrix.stride, rows = matrix.rows;
  matrix.inverse_pivots = PaddedFloats(columns * stride);
  const std::size_t m = matrix.band();
  parallel_chunks(columns, 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const float* vertical = matrix.vertical.data() + v * m;
      const float* diagonal = matrix.diagonal.data() + v * m;
      float* pivots = matrix.inverse_pivots.data() + v * stride;
      float previous = 0;  // what elimination takes from the next row's diagonal
      for (std::size_t k = 1; k < (matrix.given_top ? rows - 1 : rows); ++k) {
        const std::size_t i = matrix.in_band(k);
        const float pivot = diagonal[i] - previous;
        pivots[k] = pivot > 0 ? 1 / pivot : 0.0F;
        previous = vertical[i] * vertical[i] * pivots[k];
      }
    }
  });
}

CoarseLevel coarse_level(const LevelMatrix& fine, const LevelGraph& graph, const Interpolation& p) {
  const std::size_t columns = p.fine.size();
  const std::size_t m = fine.band();
  CoarseLevel level;
  level.matrix.rows = fine.rows;
  level.matrix.stride = fine.stride;
  level.matrix.uniform = fine.uniform;
  level.matrix.given_top = fine.given_top;
  level.matrix.bands = 3;
  level.matrix.vertical = PaddedFloats(columns * m);
  level.matrix.diagonal = PaddedFloats(columns * m);
  // Few large chunks, as each has a table of all coarse columns.
  const std::size_t grain = std::max<std::size_t>(64, columns / 64 + 1);
  std::vector<Rows> parts((columns + grain - 1) / grain);
  parallel_chunks(columns, grain, [&](std::size_t begin, std::size_t end) {
    Rows& rows = parts[begin / grain];
    rows.begin = begin;
    rows.edges.reserve((end - begin) * 6);
    rows.bands.reserve((end - begin) * 6 * 3 * m);
    RowBuilder builder(fine, graph, p, level.matrix, rows);
    for (std::size_t c = begin; c < end; ++c) builder.build(c);
  });
  join(parts, m, level);
  invert_pivots(level.matrix, columns);
  return level;
}

}  // namespace tetropolis
