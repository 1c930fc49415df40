// The hot loops of the solver: everything runs up contiguous columns, several rows at a time.
#include <cstddef>
#include <cstring>

#include "core/wide.h"
#include "laplace_level.h"

namespace tetropolis {

namespace {

using Rows8 = float __attribute__((vector_size(32)));
using Rows4 = float __attribute__((vector_size(16)));

template <typename Rows>
TETROPOLIS_INLINE void load(Rows& rows, const float* from) {
  std::memcpy(&rows, from, sizeof(Rows));
}

/// Rows [k0, k0 + count * size of Rows) of A x in column v, into y (the column's own). Row 0 and
/// a given top hold nonsense afterwards.
template <bool kUniform, int kBands, typename Rows, int kCount>
TETROPOLIS_INLINE void product_rows(const LevelMatrix& a, const LevelGraph& graph, const float* x,
                                    std::size_t v, std::size_t k0, float* y) {
  constexpr std::size_t size = sizeof(Rows) / sizeof(float);
  const std::size_t stride = a.stride;
  const std::size_t band = kUniform ? 1 : stride;
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
  if (a.given_top)
    for (k = a.rows - 1; k < a.stride; ++k) y[k] = 0;
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

/// In place: y = T^-1 y, by the Thomas algorithm.
TETROPOLIS_INLINE void solve_column(const LevelMatrix& a, std::size_t v, float* y) {
  const float* pivot = a.inverse_pivots.data() + v * a.stride;
  const float* vertical = a.vertical.data() + (a.uniform ? v : v * a.stride);
  const std::size_t step = a.uniform ? 0 : 1;
  float previous = 0;
  for (std::size_t k = 1; k < a.rows; ++k) {
    previous = y[k] - vertical[(k - 1) * step] * pivot[k - 1] * previous;
    y[k] = previous;
  }
  previous = 0;
  for (std::size_t k = a.rows; k-- > 1;) {
    previous = y[k] * pivot[k] - vertical[k * step] * pivot[k] * previous;
    y[k] = previous;
  }
  y[0] = 0;
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
  for (std::size_t v = range.begin; v < range.end; ++v) {
    float* xv = x + v * a.stride;
    const float* bv = b + v * a.stride;
    for (std::size_t k = 0; k < a.stride; ++k) xv[k] = w * bv[k];
    solve_column(a, v, xv);
  }
}

TETROPOLIS_WIDE double sweep(const LevelMatrix& a, const LevelGraph& graph, float w, const float* b,
                             const float* x, float* y, ColumnRange range) {
  Accumulator dot;
  with_product(
      a, [&](const auto& column_of) __attribute__((always_inline)) {
        for (std::size_t v = range.begin; v < range.end; ++v) {
          float* yv = y + v * a.stride;
          const float* bv = b + v * a.stride;
          const float* xv = x + v * a.stride;
          const float* pivot = a.inverse_pivots.data() + v * a.stride;
          column_of(a, graph, x, v, yv);
          for (std::size_t k = 0; k < a.stride; ++k) yv[k] = w * (bv[k] - yv[k]);
          solve_column(a, v, yv);
          // Interpolation has put something into nodes with given values as well.
          for (std::size_t k = 0; k < a.stride; ++k) yv[k] += pivot[k] != 0 ? xv[k] : 0.0F;
          dot.add(bv, yv, a.stride);
        }
      });
  return dot.sum();
}

TETROPOLIS_WIDE void restrict_columns(const Interpolation& p, std::size_t stride, const float* fine,
                                      float* coarse, ColumnRange range) {
  for (std::size_t c = range.begin; c < range.end; ++c) {
    float* __restrict to = coarse + c * stride;
    for (std::size_t k = 0; k < stride; ++k) to[k] = 0;
    for (const auto& entry : p.fine[c]) {
      const float* from = fine + entry.column * stride;
      for (std::size_t k = 0; k < stride; ++k) to[k] += entry.weight * from[k];
    }
  }
}

TETROPOLIS_WIDE void add_interpolated(const Interpolation& p, std::size_t stride,
                                      const float* coarse, float* fine, ColumnRange range) {
  for (std::size_t v = range.begin; v < range.end; ++v) {
    float* __restrict to = fine + v * stride;
    for (const auto& entry : p.coarse[v]) {
      const float* from = coarse + entry.column * stride;
      for (std::size_t k = 0; k < stride; ++k) to[k] += entry.weight * from[k];
    }
  }
}

}  // namespace tetropolis
