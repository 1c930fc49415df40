// One grid of the multigrid solver: a matrix on columns, as bands. Private to the solver.
//
// A level couples node (a, k) of an edge a < b with (b, k), with (b, k + 1) and, on coarse levels,
// (a, k + 1) with (b, k). In the first solve all layers are alike, and two numbers stand for a
// whole band.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <span>
#include <vector>

#include "tetropolis/volume/column/edge_graph.h"

#include "core/page_advice.h"

namespace tetropolis {

/// Floats with room before and after, so that vector loads shifted by one row stay inside; zero at
/// first. Large ones get their memory from whichever thread touches it first, in huge pages where
/// the system has them: with small ones a sixth of a solve is spent on page faults.
class PaddedFloats {
 public:
  PaddedFloats() = default;
  explicit PaddedFloats(std::size_t size)
      : values_(static_cast<float*>(std::calloc(size + 2 * kPad, sizeof(float)))), size_(size) {
    if (!values_) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
    if (size >= kLarge) advise_pages(values_.get(), data() + size, MADV_HUGEPAGE);
#endif
  }
  float* data() { return values_.get() + kPad; }
  const float* data() const { return values_.get() + kPad; }
  std::size_t size() const { return size_; }
  float& operator[](std::size_t i) { return data()[i]; }
  float operator[](std::size_t i) const { return data()[i]; }

 private:
  struct Free {
    void operator()(float* values) const { std::free(values); }
  };
  static constexpr std::size_t kPad = 16, kLarge = 1 << 20;
  std::unique_ptr<float[], Free> values_;
  std::size_t size_ = 0;
};

/// Rows of a column are padded to a multiple of four.
constexpr std::size_t padded_rows(std::size_t rows) { return (rows + 3) / 4 * 4; }

/// The matrix of a level. With m = band():
///   edge[(bands * e + 0) * m + k]   couples (a, k) with (b, k),      e = edge a < b
///   edge[(bands * e + 1) * m + k]   couples (a, k) with (b, k + 1)
///   edge[(bands * e + 2) * m + k]   couples (a, k + 1) with (b, k),  if bands == 3
///   vertical[m * v + k]             couples (v, k) with (v, k + 1)
///   diagonal[m * v + k]
/// Values are given in row 0 and, if `given_top`, in row K; what the bands say of these rows is
/// ignored. Other nodes with given values have rows and columns of zeros. Uniform matrices have no
/// others; their bands are of two numbers: for all rows but the top, and for that.
/// inverse_pivots[stride * v + k] are those of the columns' tridiagonal matrices, 0 where the value
/// is given: solving up a column then leaves these nodes at zero.
struct LevelMatrix {
  std::size_t rows = 0;    ///< K + 1.
  std::size_t stride = 0;  ///< padded_rows(rows).
  bool uniform = false;
  bool given_top = false;
  int bands = 2;
  PaddedFloats edge, vertical, diagonal, inverse_pivots;

  std::size_t band() const { return uniform ? 2 : stride; }
  /// Where a band has row k.
  std::size_t in_band(std::size_t k) const { return uniform ? (k + 1 == rows ? 1 : 0) : k; }
};

/// The graph of a level, numbered as EdgeGraph, which belongs to somebody else.
struct LevelGraph {
  std::size_t columns = 0;
  std::span<const std::array<VertexIndex, 2>> edges;
  std::span<const EdgeIndex> starts;
  std::span<const std::int32_t> end_offsets;
  std::span<const EdgeIndex> ends;

  LevelGraph(std::span<const std::array<VertexIndex, 2>> vertices_of_edges,
             std::span<const EdgeIndex> starts_of_rows,
             const RaggedArray<EdgeIndex, std::int32_t>& edges_that_end)
      : columns(edges_that_end.size()),
        edges(vertices_of_edges),
        starts(starts_of_rows),
        end_offsets(edges_that_end.offsets),
        ends(edges_that_end.values) {}
  explicit LevelGraph(const EdgeGraph& graph)
      : LevelGraph(graph.vertices, graph.starts, graph.ends) {}

  IndexRange<EdgeIndex> starting_at(std::size_t v) const { return {starts[v], starts[v + 1]}; }
  std::span<const EdgeIndex> ending_at(std::size_t v) const {
    return {ends.data() + end_offsets[v], ends.data() + end_offsets[v + 1]};
  }
};

/// A coarse level's own graph.
struct CoarseGraph {
  std::vector<std::array<VertexIndex, 2>> edges;
  std::vector<EdgeIndex> starts;
  RaggedArray<EdgeIndex, std::int32_t> ends;

  LevelGraph view() const { return {edges, starts, ends}; }
};

/// How strongly the edges of a graph couple its columns in the plan; at least 0.
using EdgeWeights = std::vector<float>;

/// Weights (coarse column, weight) of the columns of a finer level, and the same transposed.
struct Interpolation {
  struct Entry {
    VertexIndex column;
    float weight;
  };
  RaggedArray<Entry, std::int32_t> coarse;  ///< Per fine column: coarse columns, ascending.
  RaggedArray<Entry, std::int32_t> fine;    ///< Per coarse column: fine columns, ascending.
};

struct ColumnRange {
  std::size_t begin, end;
};

// Kernels over the columns of `range`; vectors have the level's stride and are zero where padded or
// given, except that interpolation may leave anything at nodes with given values.

/// y = A x; returns x . y.
double multiply(const LevelMatrix& a, const LevelGraph& graph, const float* x, float* y,
                ColumnRange range);

/// y = b - A x.
void residual(const LevelMatrix& a, const LevelGraph& graph, const float* b, const float* x,
              float* y, ColumnRange range);

/// x = w T^-1 b, T the tridiagonal part of A.
void solve_columns(const LevelMatrix& a, float w, const float* b, float* x, ColumnRange range);

/// y = x + w T^-1 (b - A x); returns b . y.
double sweep(const LevelMatrix& a, const LevelGraph& graph, float w, const float* b, const float* x,
             float* y, ColumnRange range);

/// coarse = P^T fine, for coarse columns.
void restrict_columns(const Interpolation& p, std::size_t stride, const float* fine, float* coarse,
                      ColumnRange range);

/// fine += P coarse, for fine columns.
void add_interpolated(const Interpolation& p, std::size_t stride, const float* coarse, float* fine,
                      ColumnRange range);

}  // namespace tetropolis
