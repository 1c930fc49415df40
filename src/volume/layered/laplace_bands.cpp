#include "laplace_bands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/parallel.h"
#include "core/wide.h"

namespace tetropolis {

namespace {

constexpr std::size_t kTrianglesPerBlock = 256;

/// Blocks of consecutive triangles, grouped so that no two blocks of a group share a vertex: the
/// blocks of a group may be assembled at the same time, and every sum is made in a fixed order.
/// Planar meshes numbered along a curve need a handful of groups. Whatever finds no place in 64 of
/// them gets groups of its own.
std::vector<std::vector<std::size_t>> independent_blocks(const GroundMesh& ground) {
  const std::size_t blocks =
      (ground.triangles.size() + kTrianglesPerBlock - 1) / kTrianglesPerBlock;
  std::vector<std::uint64_t> used(ground.vertices.size(), 0);
  std::vector<std::vector<std::size_t>> groups, alone;
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t begin = block * kTrianglesPerBlock;
    const std::size_t end = std::min(begin + kTrianglesPerBlock, ground.triangles.size());
    std::uint64_t taken = 0;
    const auto triangles = indices<TriangleIndex>(begin, end);
    for (const TriangleIndex t : triangles)
      for (const VertexIndex v : ground.triangles[t]) taken |= used[v];
    const auto group = static_cast<std::size_t>(std::countr_one(taken));
    if (group == 64) {
      alone.push_back({block});
      continue;
    }
    for (const TriangleIndex t : triangles)
      for (const VertexIndex v : ground.triangles[t]) used[v] |= std::uint64_t{1} << group;
    if (groups.size() <= group) groups.resize(group + 1);
    groups[group].push_back(block);
  }
  groups.insert(groups.end(), alone.begin(), alone.end());
  return groups;
}

/// Of a triangle with sorted vertices: its area over three times 1 and times the products of the
/// gradients of its three linear basis functions.
struct FlatTriangle {
  double c;
  double g12, g13, g23;
  double g22() const { return -g12 - g23; }
  double g33() const { return -g13 - g23; }
  std::array<VertexIndex, 3> vertices;  ///< Sorted.
};

FlatTriangle flat_triangle(const GroundMesh& ground, const std::array<VertexIndex, 3>& sorted) {
  const Point2 p1 = ground.vertices[sorted[0]];
  const Point2 p2 = ground.vertices[sorted[1]];
  const Point2 p3 = ground.vertices[sorted[2]];
  const double x12 = p2.x - p1.x, y12 = p2.y - p1.y, x13 = p3.x - p1.x, y13 = p3.y - p1.y;
  const double twice_area = x12 * y13 - x13 * y12;
  // gradients (y13, -x13), (-y12, x12) over twice the area; area / 3 is left once.
  const double scale = 1 / (6 * std::abs(twice_area));
  const double g22 = scale * (x13 * x13 + y13 * y13);
  const double g33 = scale * (x12 * x12 + y12 * y12);
  const double g23 = -scale * (x12 * x13 + y12 * y13);
  return {std::abs(twice_area) / 6, -g22 - g23, -g33 - g23, g23, sorted};
}

// A tet with the vertical edge u_m w_m over base nodes at heights z_1, z_2, z_3 has the basis
// gradients (g_i, 0) for i != m and, with s = sum_i g_i z_i and d the vertical edge's length,
// (-s, 1) / d at w_m and (g_m + s / d, -1 / d) at u_m. Its volume is area * d / 3. With T1, T2, T3
// as in layered_mesh.h and t_ij = g_i . s of T_j's base, all of it times area / 3:
//
//   (u1, u2) g12 (d3 + d2) + t12    (w1, w2) -t23    (u1, w2) -t12 + g12 d1 + t23
//   (u1, u3) g13 d3 + t11           (w1, w3) -t33    (u1, w3) -t11 + g13 (d2 + d1) + t33
//   (u2, u3) g23 d3 + t21           (w2, w3) -t32 + g23 d1   (u2, w3) -t21 + g23 d2 + t32
//   (u1, w1) -t13 - (s3.s3 + 1) / d1   (u2, w2) -t22 - (s2.s2 + 1) / d2
//   (u3, w3) -t31 - (s1.s1 + 1) / d3

/// Heights of the three columns of a triangle with sorted vertices, and the layers it has.
struct PrismColumn {
  const double *z1, *z2, *z3;
  std::int32_t first, last;
};

/// Adds the couplings along the side `slot` (v1v2, v1v3, v2v3) of the prisms over one triangle.
TETROPOLIS_WIDE void add_side(const FlatTriangle& f, const PrismColumn& p, int slot,
                              float* __restrict level, float* __restrict rising) {
  const double *z1 = p.z1, *z2 = p.z2, *z3 = p.z3;
  const double g12 = f.g12, g13 = f.g13, g23 = f.g23, g22 = f.g22(), g33 = f.g33();
  if (slot == 0) {
    for (std::int32_t k = p.first; k < p.last; ++k) {
      const double t12 = g12 * (z2[k] - z1[k]) + g13 * (z3[k + 1] - z1[k]);
      const double t23 = g22 * (z2[k + 1] - z1[k]) + g23 * (z3[k + 1] - z1[k]);
      level[k] += static_cast<float>(g12 * (z3[k + 1] - z3[k] + z2[k + 1] - z2[k]) + t12);
      rising[k] += static_cast<float>(-t12 + g12 * (z1[k + 1] - z1[k]) + t23);
    }
    for (std::int32_t k = p.first; k < p.last; ++k)
      level[k + 1] -= static_cast<float>(g22 * (z2[k + 1] - z1[k]) + g23 * (z3[k + 1] - z1[k]));
  } else if (slot == 1) {
    for (std::int32_t k = p.first; k < p.last; ++k) {
      const double t11 = g12 * (z2[k] - z1[k]) + g13 * (z3[k] - z1[k]);
      const double t33 = g23 * (z2[k + 1] - z1[k]) + g33 * (z3[k + 1] - z1[k]);
      level[k] += static_cast<float>(g13 * (z3[k + 1] - z3[k]) + t11);
      rising[k] += static_cast<float>(-t11 + g13 * (z2[k + 1] - z2[k] + z1[k + 1] - z1[k]) + t33);
    }
    for (std::int32_t k = p.first; k < p.last; ++k)
      level[k + 1] -= static_cast<float>(g23 * (z2[k + 1] - z1[k]) + g33 * (z3[k + 1] - z1[k]));
  } else {
    for (std::int32_t k = p.first; k < p.last; ++k) {
      const double t21 = g22 * (z2[k] - z1[k]) + g23 * (z3[k] - z1[k]);
      const double t32 = g23 * (z2[k] - z1[k]) + g33 * (z3[k + 1] - z1[k]);
      level[k] += static_cast<float>(g23 * (z3[k + 1] - z3[k]) + t21);
      rising[k] += static_cast<float>(-t21 + g23 * (z2[k + 1] - z2[k]) + t32);
    }
    for (std::int32_t k = p.first; k < p.last; ++k)
      level[k + 1] += static_cast<float>(g23 * (z1[k + 1] - z1[k] - (z2[k] - z1[k])) -
                                         g33 * (z3[k + 1] - z1[k]));
  }
}

/// Adds the couplings up the three columns of the prisms over one triangle.
TETROPOLIS_WIDE void add_verticals(const FlatTriangle& f, const PrismColumn& p,
                                   float* __restrict v1, float* __restrict v2,
                                   float* __restrict v3) {
  const double *z1 = p.z1, *z2 = p.z2, *z3 = p.z3;
  const double g12 = f.g12, g13 = f.g13, g23 = f.g23, g22 = f.g22(), g33 = f.g33();
  for (std::int32_t k = p.first; k < p.last; ++k) {
    const double a = z2[k] - z1[k], b = z3[k] - z1[k];                // base of T1
    const double up_a = z2[k + 1] - z1[k], up_b = z3[k + 1] - z1[k];  // T3; T2: a and up_b
    const double ss3 = g22 * up_a * up_a + 2 * g23 * up_a * up_b + g33 * up_b * up_b;
    const double ss2 = g22 * a * a + 2 * g23 * a * up_b + g33 * up_b * up_b;
    const double ss1 = g22 * a * a + 2 * g23 * a * b + g33 * b * b;
    const double d1 = z1[k + 1] - z1[k], d2 = up_a - a, d3 = up_b - b;
    v1[k] -= static_cast<float>(g12 * up_a + g13 * up_b + (ss3 + f.c) / d1);
    v2[k] -= static_cast<float>(g22 * a + g23 * up_b + (ss2 + f.c) / d2);
    v3[k] -= static_cast<float>(g23 * a + g33 * b + (ss1 + f.c) / d3);
  }
}

std::vector<FlatTriangle> flat_triangles(const GroundMesh& ground) {
  std::vector<FlatTriangle> flat(ground.triangles.size());
  parallel_chunks(flat.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (const TriangleIndex t : indices<TriangleIndex>(begin, end))
      flat[t] = flat_triangle(ground, sorted_vertices(ground.triangles[t]));
  });
  return flat;
}

PrismColumn prism_column(const LayeredMesh& mesh, TriangleIndex t, const FlatTriangle& flat) {
  return {mesh.column(flat.vertices[0]), mesh.column(flat.vertices[1]),
          mesh.column(flat.vertices[2]), mesh.first_layer[t], mesh.layers};
}

/// Calls body(first, last) for runs of triangles, those of one call never sharing a vertex with
/// those of another at the same time.
template <typename Body>
void over_independent_triangles(const GroundMesh& ground, const Body& body) {
  for (const auto& group : independent_blocks(ground)) {
    parallel_chunks(group.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t first = group[i] * kTrianglesPerBlock;
        body(first, std::min(first + kTrianglesPerBlock, ground.triangles.size()));
      }
    });
  }
}

/// Position of the edge in its triangle's of_triangle.
int slot_of(const EdgeGraph& edges, TriangleIndex t, EdgeIndex e) {
  const auto& of = edges.of_triangle[t];
  return of[0] == e ? 0 : of[1] == e ? 1 : 2;
}

void assemble_edge(const LayeredMesh& mesh, const std::vector<FlatTriangle>& flat, EdgeIndex e,
                   LevelMatrix& matrix) {
  float* level = matrix.edge.data() + e * 2 * matrix.stride;
  for (const TriangleIndex t : mesh.edges.triangles[e]) {
    if (t == kNoTriangle) continue;
    add_side(flat[t], prism_column(mesh, t, flat[t]), slot_of(mesh.edges, t, e), level,
             level + matrix.stride);
  }
}

/// The middle one of three layers of height `d`.
struct UniformPrism {
  std::array<double, 3> z;
  explicit UniformPrism(double d) : z{0, d, 2 * d} {}
  PrismColumn columns() const { return {z.data(), z.data(), z.data(), 0, 2}; }
};

void assemble_uniform_edge(const EdgeGraph& edges, const std::vector<FlatTriangle>& flat,
                           const UniformPrism& prism, EdgeIndex e, LevelMatrix& matrix) {
  std::array<float, 3> level{}, rising{};
  for (const TriangleIndex t : edges.triangles[e])
    if (t != kNoTriangle)
      add_side(flat[t], prism.columns(), slot_of(edges, t, e), level.data(), rising.data());
  float* const bands = matrix.edge.data() + 2 * e * matrix.band();
  bands[0] = level[1];
  bands[1] = level[2];
  bands[matrix.band()] = rising[1];
}

/// The edge's cotangent weight in the plan, less the share of the height that is trimmed.
float plan_weight(const LayeredMesh& mesh, const std::vector<FlatTriangle>& flat, EdgeIndex e) {
  double sum = 0;
  for (const TriangleIndex t : mesh.edges.triangles[e]) {
    if (t == kNoTriangle) continue;
    const int slot = slot_of(mesh.edges, t, e);
    const double share = 1 - static_cast<double>(mesh.first_layer[t]) / mesh.layers;
    sum -= share * (slot == 0 ? flat[t].g12 : slot == 1 ? flat[t].g13 : flat[t].g23);
  }
  return static_cast<float>(std::max(sum, 0.0));
}

/// Rows of one column for complete_diagonal: the sums of couplings, and A u by differences.
struct RowSums {
  float* __restrict couplings;
  float* __restrict product;
};

TETROPOLIS_WIDE void add_band(const RowSums& sums, const float* band, bool uniform,
                              const float* own, const float* other, std::size_t rows) {
  if (uniform) {
    for (std::size_t k = 0; k < rows; ++k) {
      sums.couplings[k] += *band;
      sums.product[k] += *band * (other[k] - own[k]);
    }
  } else {
    for (std::size_t k = 0; k < rows; ++k) {
      sums.couplings[k] += band[k];
      sums.product[k] += band[k] * (other[k] - own[k]);
    }
  }
}

}  // namespace

bool is_uniform(const LayeredMesh& mesh) {
  constexpr double kEven = 1e-9;
  const double* first = mesh.column(VertexIndex(0));
  const double spacing = (first[mesh.layers] - first[0]) / mesh.layers;
  for (std::int32_t k = 0; k < mesh.layers; ++k)
    if (std::abs(first[k + 1] - first[k] - spacing) > kEven * spacing) return false;
  return parallel_reduce_ordered(
      mesh.vertex_count(), 4096, true,
      [&](std::size_t begin, std::size_t end) {
        for (const VertexIndex v : indices<VertexIndex>(begin, end))
          if (mesh.first_node[v] != 0 || mesh.roof_layer[v] != kNoRoof ||
              !std::equal(first, first + mesh.stride(), mesh.column(v)))
            return false;
        return true;
      },
      [](bool a, bool b) { return a && b; });
}

Stiffness assemble_stiffness(const LayeredMesh& mesh, bool uniform) {
  Stiffness result;
  LevelMatrix& matrix = result.matrix;
  matrix.rows = mesh.stride();
  matrix.stride = padded_rows(mesh.stride());
  matrix.uniform = uniform;
  matrix.bands = 2;
  const std::size_t m = matrix.band();
  matrix.edge = PaddedFloats(mesh.edges.size() * 2 * m);
  matrix.vertical = PaddedFloats(mesh.vertex_count() * m);
  result.weights.resize(mesh.edges.size());
  const std::vector<FlatTriangle> flat = flat_triangles(mesh.ground);
  const UniformPrism prism(
      (mesh.column(VertexIndex(0))[mesh.layers] - mesh.column(VertexIndex(0))[0]) / mesh.layers);
  parallel_chunks(mesh.edges.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (const EdgeIndex e : indices<EdgeIndex>(begin, end)) {
      if (uniform) {
        assemble_uniform_edge(mesh.edges, flat, prism, e, matrix);
      } else {
        assemble_edge(mesh, flat, e, matrix);
      }
      result.weights[e] = plan_weight(mesh, flat, e);
    }
  });
  over_independent_triangles(mesh.ground, [&](std::size_t first, std::size_t last) {
    for (const TriangleIndex t : indices<TriangleIndex>(first, last)) {
      std::array<float*, 3> up;
      for (std::size_t i = 0; i < 3; ++i) up[i] = matrix.vertical.data() + flat[t].vertices[i] * m;
      if (!uniform) {
        add_verticals(flat[t], prism_column(mesh, t, flat[t]), up[0], up[1], up[2]);
        continue;
      }
      std::array<std::array<float, 2>, 3> layers{};
      add_verticals(flat[t], prism.columns(), layers[0].data(), layers[1].data(), layers[2].data());
      for (std::size_t i = 0; i < 3; ++i) *up[i] += layers[i][1];
    }
  });
  return result;
}

PaddedFloats complete_diagonal(const LayeredMesh& mesh, const std::vector<float>& u,
                               LevelMatrix& matrix) {
  const std::size_t n = mesh.stride(), stride = matrix.stride;
  const std::size_t m = matrix.band();
  matrix.diagonal = PaddedFloats(mesh.vertex_count() * m);
  PaddedFloats r(mesh.vertex_count() * stride);
  parallel_chunks(mesh.vertex_count(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<float> couplings(n), product(n);
    for (const VertexIndex v : indices<VertexIndex>(begin, end)) {
      std::fill(couplings.begin(), couplings.end(), 0.0F);
      std::fill(product.begin(), product.end(), 0.0F);
      const float* own = u.data() + v * n;
      // Rows k with rows k + shift of the other column, by band[k] or, downwards, band[k - 1].
      const auto add = [&](const float* band, const float* other, int shift) {
        const std::size_t from = shift < 0 ? 1 : 0, top = n - 1;
        add_band({couplings.data() + from, product.data() + from}, band, matrix.uniform, own + from,
                 shift > 0 ? other + 1 : other, top);
        if (shift == 0)
          add_band({couplings.data() + top, product.data() + top}, band + matrix.in_band(top), true,
                   own + top, other + top, 1);
      };
      const float* vertical = matrix.vertical.data() + v * m;
      add(vertical, own, 1);
      add(vertical, own, -1);
      for (const EdgeIndex e : mesh.edges.starting_at(v)) {
        const float* other = u.data() + mesh.edges.vertices[e][1] * n;
        add(matrix.edge.data() + 2 * e * m, other, 0);
        add(matrix.edge.data() + (2 * e + 1) * m, other, 1);
      }
      for (const EdgeIndex e : mesh.edges.ends[v]) {
        const float* other = u.data() + mesh.edges.vertices[e][0] * n;
        add(matrix.edge.data() + 2 * e * m, other, 0);
        add(matrix.edge.data() + (2 * e + 1) * m, other, -1);
      }
      float* diagonal = matrix.diagonal.data() + v * m;
      if (matrix.uniform) {
        diagonal[0] = -couplings[1];
        diagonal[1] = -couplings[n - 1];
      } else {
        for (std::size_t k = 0; k < n; ++k) diagonal[k] = -couplings[k];
      }
      for (std::size_t k = 0; k < n; ++k) r[v * stride + k] = -product[k];
    }
  });
  return r;
}

}  // namespace tetropolis
