// The hot loops of the solver: everything runs up contiguous columns, several rows at a time.
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "core/wide.h"
#include "laplace_level.h"
#include "laplace_rows.h"

namespace tetropolis {

namespace {

/// Rows [k0, k0 + count * size of Rows) of A x in column v, into y (the column's own). Row 0, a
/// top that is given or unlike other rows, and what is above it hold nonsense afterwards.
template <bool kUniform, int kBands, typename Rows, int kCount>
TETROPOLIS_INLINE void product_rows(const LevelMatrix& a, const LevelGraph& graph, const float* x,
                                    std::size_t v, std::size_t k0, float* y) {
  constexpr std::size_t size = sizeof(Rows) / sizeof(float);
  const std::size_t stride = a.stride;
  const std::size_t band = a.band();
  Rows sum[kCount];
  Rows value, factor;
  const float* const xv = x + v * stride + k0;
  const std::size_t k_band = kUniform ? 0 : k0;
  const float* const vertical = a.vertical.data() + v * band + k_band;
  const float* const diagonal = a.diagonal.data() + v * band + k_band;
  // Coefficients are broadcast or loaded, `shift` rows below those of the sums.
  const auto add = [&](Rows & into, const float* coefficients, int i, int shift, const float* from)
      __attribute__((always_inline)) {
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(size) * i;
    load(value, from + at);
    if constexpr (kUniform) {
      into += *coefficients * value;
    } else {
      load(factor, coefficients + at + shift);
      into += factor * value;
    }
  };
  for (int i = 0; i < kCount; ++i) {
    sum[i] = Rows{};
    add(sum[i], diagonal, i, 0, xv);
    add(sum[i], vertical, i, 0, xv + 1);
    add(sum[i], vertical, i, -1, xv - 1);
  }
  for (const EdgeIndex e : graph.starting_at(v)) {
    const float* level = a.edge.data() + e * kBands * band + k_band;
    const float* xb = x + graph.edges[e][1] * stride + k0;
    for (int i = 0; i < kCount; ++i) {
      add(sum[i], level, i, 0, xb);
      add(sum[i], level + band, i, 0, xb + 1);
      if constexpr (kBands == 3) add(sum[i], level + 2 * band, i, -1, xb - 1);
    }
  }
  for (const EdgeIndex e : graph.ending_at(v)) {
    const float* level = a.edge.data() + e * kBands * band + k_band;
    const float* xa = x + graph.edges[e][0] * stride + k0;
    for (int i = 0; i < kCount; ++i) {
      add(sum[i], level, i, 0, xa);
      add(sum[i], level + band, i, -1, xa - 1);
      if constexpr (kBands == 3) add(sum[i], level + 2 * band, i, 0, xa + 1);
    }
  }
  for (int i = 0; i < kCount; ++i)
    std::memcpy(y + k0 + size * static_cast<std::size_t>(i), &sum[i], sizeof(Rows));
}

/// The top row of A x in column v, of a uniform matrix.
template <int kBands>
TETROPOLIS_INLINE float product_at_top(const LevelMatrix& a, const LevelGraph& graph,
                                       const float* x, std::size_t v) {
  const std::size_t band = a.band(), top = a.rows - 1;
  const float* const own = x + v * a.stride + top;
  float sum = a.diagonal[v * band + 1] * own[0] + a.vertical[v * band] * own[-1];
  for (const EdgeIndex e : graph.starting_at(v)) {
    const float* bands = a.edge.data() + e * kBands * band;
    const float* other = x + graph.edges[e][1] * a.stride + top;
    sum += bands[1] * other[0];
    if constexpr (kBands == 3) sum += bands[2 * band] * other[-1];
  }
  for (const EdgeIndex e : graph.ending_at(v)) {
    const float* bands = a.edge.data() + e * kBands * band;
    const float* other = x + graph.edges[e][0] * a.stride + top;
    sum += bands[1] * other[0] + bands[band] * other[-1];
  }
  return sum;
}

/// Column v of A x.
template <bool kUniform, int kBands>
TETROPOLIS_INLINE void product(const LevelMatrix& a, const LevelGraph& graph, const float* x,
                               std::size_t v, float* y) {
  std::size_t k = 0;
  for (; k + 24 <= a.stride; k += 24)
    product_rows<kUniform, kBands, Rows8, 3>(a, graph, x, v, k, y);
  if (k + 16 <= a.stride) {
    product_rows<kUniform, kBands, Rows8, 2>(a, graph, x, v, k, y);
    k += 16;
  }
  if (k + 8 <= a.stride) {
    product_rows<kUniform, kBands, Rows8, 1>(a, graph, x, v, k, y);
    k += 8;
  }
  if (k < a.stride) product_rows<kUniform, kBands, Rows4, 1>(a, graph, x, v, k, y);
  y[0] = 0;
  if (a.given_top || kUniform)
    for (k = a.rows - 1; k < a.stride; ++k) y[k] = 0;
  if (kUniform && !a.given_top) y[a.rows - 1] = product_at_top<kBands>(a, graph, x, v);
}

/// Calls kernel(product of a column), compiled for the kind of matrix.
template <typename Kernel>
TETROPOLIS_INLINE void with_product(const LevelMatrix& a, const Kernel& kernel) {
  if (a.uniform && a.bands == 2) {
    kernel([](auto&&... rest) __attribute__((always_inline)) { product<true, 2>(rest...); });
  } else if (a.uniform) {
    kernel([](auto&&... rest) __attribute__((always_inline)) { product<true, 3>(rest...); });
  } else if (a.bands == 2) {
    kernel([](auto&&... rest) __attribute__((always_inline)) { product<false, 2>(rest...); });
  } else {
    kernel([](auto&&... rest) __attribute__((always_inline)) { product<false, 3>(rest...); });
  }
}

/// Sums over the rows of columns: within one in single precision, of all in double.
struct Accumulator {
  Rows4 column{};
  double total[4] = {0, 0, 0, 0};

  TETROPOLIS_INLINE void add(const float* x, const float* y, std::size_t stride) {
    column = Rows4{};
    Rows4 a, b;
    for (std::size_t k = 0; k < stride; k += 4) {
      load(a, x + k);
      load(b, y + k);
      column += a * b;
    }
    for (int i = 0; i < 4; ++i) total[i] += static_cast<double>(column[i]);
  }
  TETROPOLIS_INLINE double sum() const { return total[0] + total[1] + total[2] + total[3]; }
};

/// Columns that are solved together: each waits for its own last row.
constexpr std::size_t kTogether = 4;

/// In place: y = T^-1 y in columns v to v + kColumns, by the Thomas algorithm.
template <std::size_t kColumns>
TETROPOLIS_INLINE void solve_together(const LevelMatrix& a, std::size_t v, float* y) {
  const std::size_t stride = a.stride, step = a.uniform ? 0 : 1, next = a.band();
  const float* const pivot = a.inverse_pivots.data() + v * stride;
  const float* const vertical = a.vertical.data() + v * next;
  float previous[kColumns] = {};
  for (std::size_t k = 1; k < a.rows; ++k) {
    for (std::size_t c = 0; c < kColumns; ++c) {
      const float factor = vertical[c * next + (k - 1) * step] * pivot[c * stride + k - 1];
      previous[c] = y[c * stride + k] - factor * previous[c];
      y[c * stride + k] = previous[c];
    }
  }
  for (std::size_t c = 0; c < kColumns; ++c) previous[c] = 0;
  for (std::size_t k = a.rows; k-- > 1;) {
    for (std::size_t c = 0; c < kColumns; ++c) {
      const float p = pivot[c * stride + k];
      previous[c] = y[c * stride + k] * p - vertical[c * next + k * step] * p * previous[c];
      y[c * stride + k] = previous[c];
    }
  }
  for (std::size_t c = 0; c < kColumns; ++c) y[c * stride] = 0;
}

/// Calls body(v, columns), `columns` a constant, for runs of columns to be solved together.
template <typename Body>
TETROPOLIS_INLINE void in_runs(ColumnRange range, const Body& body) {
  std::size_t v = range.begin;
  for (; v + kTogether <= range.end; v += kTogether)
    body(v, std::integral_constant<std::size_t, kTogether>{});
  for (; v < range.end; ++v) body(v, std::integral_constant<std::size_t, 1>{});
}

}  // namespace

TETROPOLIS_WIDE double multiply(const LevelMatrix& a, const LevelGraph& graph, const float* x,
                                float* y, ColumnRange range) {
  Accumulator dot;
  with_product(
      a, [&](const auto& column_of) __attribute__((always_inline)) {
        for (std::size_t v = range.begin; v < range.end; ++v) {
          column_of(a, graph, x, v, y + v * a.stride);
          dot.add(x + v * a.stride, y + v * a.stride, a.stride);
        }
      });
  return dot.sum();
}

TETROPOLIS_WIDE void residual(const LevelMatrix& a, const LevelGraph& graph, const float* b,
                              const float* x, float* y, ColumnRange range) {
  with_product(
      a, [&](const auto& column_of) __attribute__((always_inline)) {
        for (std::size_t v = range.begin; v < range.end; ++v) {
          float* yv = y + v * a.stride;
          const float* bv = b + v * a.stride;
          column_of(a, graph, x, v, yv);
          for (std::size_t k = 0; k < a.stride; ++k) yv[k] = bv[k] - yv[k];
        }
      });
}

TETROPOLIS_WIDE void solve_columns(const LevelMatrix& a, float w, const float* b, float* x,
                                   ColumnRange range) {
  in_runs(
      range, [&](std::size_t v, auto columns) __attribute__((always_inline)) {
        float* const xv = x + v * a.stride;
        const float* const bv = b + v * a.stride;
        for (std::size_t i = 0; i < columns * a.stride; ++i) xv[i] = w * bv[i];
        solve_together<columns>(a, v, xv);
      });
}

TETROPOLIS_WIDE double sweep(const LevelMatrix& a, const LevelGraph& graph, float w, const float* b,
                             const float* x, float* y, ColumnRange range) {
  Accumulator dot;
  with_product(
      a, [&](const auto& column_of) __attribute__((always_inline)) {
        in_runs(
            range, [&](std::size_t v, auto columns) __attribute__((always_inline)) {
              const std::size_t size = columns * a.stride;
              float* const yv = y + v * a.stride;
              const float* const bv = b + v * a.stride;
              const float* const xv = x + v * a.stride;
              const float* const pivot = a.inverse_pivots.data() + v * a.stride;
              for (std::size_t c = 0; c < columns; ++c)
                column_of(a, graph, x, v + c, yv + c * a.stride);
              for (std::size_t i = 0; i < size; ++i) yv[i] = w * (bv[i] - yv[i]);
              solve_together<columns>(a, v, yv);
              // Interpolation has put something into nodes with given values as well.
              for (std::size_t i = 0; i < size; ++i) yv[i] += pivot[i] != 0 ? xv[i] : 0.0F;
              for (std::size_t c = 0; c < columns; ++c)
                dot.add(bv + c * a.stride, yv + c * a.stride, a.stride);
            });
      });
  return dot.sum();
}

TETROPOLIS_WIDE void restrict_columns(const Interpolation& p, std::size_t stride, const float* fine,
                                      float* coarse, ColumnRange range) {
  for (std::size_t c = range.begin; c < range.end; ++c) {
    float* const to = coarse + c * stride;
    std::memset(to, 0, stride * sizeof(float));
    for (const auto& entry : p.fine[c])
      add_scaled(to, fine + entry.column * stride, entry.weight, stride);
  }
}

TETROPOLIS_WIDE void add_interpolated(const Interpolation& p, std::size_t stride,
                                      const float* coarse, float* fine, ColumnRange range) {
  for (std::size_t v = range.begin; v < range.end; ++v)
    for (const auto& entry : p.coarse[v])
      add_scaled(fine + v * stride, coarse + entry.column * stride, entry.weight, stride);
}

}  // namespace tetropolis
