#include "laplace_bands.h"

#include <array>
#include <bit>
#include <cassert>
#include <cstdint>

#include "tetropolis/core/parallel.h"

namespace tetropolis {

namespace {

constexpr std::size_t kTrianglesPerBlock = 256;

/// Blocks of consecutive triangles, grouped so that no two blocks of a group share a vertex: the
/// blocks of a group may be assembled at the same time, and every sum is made in a fixed order.
std::vector<std::vector<std::size_t>> independent_blocks(const GroundMesh& ground) {
  const std::size_t blocks =
      (ground.triangles.size() + kTrianglesPerBlock - 1) / kTrianglesPerBlock;
  std::vector<std::uint64_t> used(ground.vertices.size(), 0);
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t begin = block * kTrianglesPerBlock;
    const std::size_t end = std::min(begin + kTrianglesPerBlock, ground.triangles.size());
    std::uint64_t taken = 0;
    for (std::size_t t = begin; t < end; ++t)
      for (const VertexIndex v : ground.triangles[t]) taken |= used[static_cast<std::size_t>(v)];
    // 64 groups are far more than a planar mesh needs; the last one would then be run serially.
    const auto group = static_cast<std::size_t>(std::countr_one(taken));
    assert(group < 64);
    for (std::size_t t = begin; t < end; ++t)
      for (const VertexIndex v : ground.triangles[t])
        used[static_cast<std::size_t>(v)] |= std::uint64_t{1} << group;
    if (groups.size() <= group) groups.resize(group + 1);
    groups[group].push_back(block);
  }
  return groups;
}

struct Vector2 {
  double x, y;
};
double dot(Vector2 a, Vector2 b) { return a.x * b.x + a.y * b.y; }

/// A triangle with sorted vertices: its area over three and the gradients of its three linear basis
/// functions.
struct FlatTriangle {
  double third_of_area;
  Vector2 g1, g2, g3;
};

FlatTriangle flat_triangle(Point2 p1, Point2 p2, Point2 p3) {
  const double twice_area = (p2.x - p1.x) * (p3.y - p1.y) - (p3.x - p1.x) * (p2.y - p1.y);
  const Vector2 g2{(p3.y - p1.y) / twice_area, (p1.x - p3.x) / twice_area};
  const Vector2 g3{(p1.y - p2.y) / twice_area, (p2.x - p1.x) / twice_area};
  return {std::abs(twice_area) / 6, {-g2.x - g3.x, -g2.y - g3.y}, g2, g3};
}

/// Where the prisms of one triangle add to: bands of its three edges and three columns.
struct PrismBands {
  float *h12, *d12, *h13, *d13, *h23, *d23;
  float *v1, *v2, *v3;
};

/// Adds the stiffness of the prisms over one triangle in layers [first, last).
///
/// A tet with the vertical edge u_m w_m over base nodes at heights z_1, z_2, z_3 has the basis
/// gradients (g_i, 0) for i != m and, with s = sum_i g_i z_i and d the vertical edge's length,
/// (-s, 1) / d at w_m and (g_m + s / d, -1 / d) at u_m. Its volume is area * d / 3.
void add_prisms(const FlatTriangle& f, const double* z1, const double* z2, const double* z3,
                std::int32_t first, std::int32_t last, const PrismBands& out) {
  const double c = f.third_of_area;
  const double g12 = dot(f.g1, f.g2), g13 = dot(f.g1, f.g3), g23 = dot(f.g2, f.g3);
  for (std::int32_t k = first; k < last; ++k) {
    const double d1 = z1[k + 1] - z1[k], d2 = z2[k + 1] - z2[k], d3 = z3[k + 1] - z3[k];
    const auto slope = [&](double a, double b) {
      return Vector2{f.g2.x * a + f.g3.x * b, f.g2.y * a + f.g3.y * b};
    };
    const Vector2 s1 = slope(z2[k] - z1[k], z3[k] - z1[k]);          // T1: base u1 u2 u3
    const Vector2 s2 = slope(z2[k] - z1[k], z3[k + 1] - z1[k]);      // T2: base u1 u2 w3
    const Vector2 s3 = slope(z2[k + 1] - z1[k], z3[k + 1] - z1[k]);  // T3: base u1 w2 w3
    const double t11 = dot(f.g1, s1), t12 = dot(f.g2, s1), t13 = dot(f.g3, s1);
    const double t21 = dot(f.g1, s2), t22 = dot(f.g2, s2), t23 = dot(f.g3, s2);
    const double t31 = dot(f.g1, s3), t32 = dot(f.g2, s3), t33 = dot(f.g3, s3);
    out.h12[k] += static_cast<float>(c * (g12 * d3 + g12 * d2 + t21));
    out.h13[k] += static_cast<float>(c * (g13 * d3 + t11));
    out.h23[k] += static_cast<float>(c * (g23 * d3 + t12));
    out.d12[k] += static_cast<float>(c * (-t21 + g12 * d1 + t32));
    out.d13[k] += static_cast<float>(c * (-t11 + g13 * d2 + g13 * d1 + t33));
    out.d23[k] += static_cast<float>(c * (-t12 + g23 * d2 + t23));
    out.h12[k + 1] += static_cast<float>(c * -t32);
    out.h13[k + 1] += static_cast<float>(c * -t33);
    out.h23[k + 1] += static_cast<float>(c * (-t23 + g23 * d1));
    out.v1[k] -= static_cast<float>(c * (t31 + (dot(s3, s3) + 1) / d1));
    out.v2[k] -= static_cast<float>(c * (t22 + (dot(s2, s2) + 1) / d2));
    out.v3[k] -= static_cast<float>(c * (t13 + (dot(s1, s1) + 1) / d3));
  }
}

void add_triangle(const LayeredMesh& mesh, std::size_t t, StiffnessBands& bands) {
  const std::size_t n = mesh.stride();
  const auto v = sorted_vertices(mesh.ground.triangles[t]);
  const std::array<std::size_t, 3> column{static_cast<std::size_t>(v[0]),
                                          static_cast<std::size_t>(v[1]),
                                          static_cast<std::size_t>(v[2])};
  const auto& edge = mesh.edges.of_triangle[t];
  const auto band = [&](int side) {
    return bands.edge.data() +
           static_cast<std::size_t>(edge[static_cast<std::size_t>(side)]) * 2 * n;
  };
  const PrismBands out{band(0),
                       band(0) + n,
                       band(1),
                       band(1) + n,
                       band(2),
                       band(2) + n,
                       bands.vertical.data() + column[0] * n,
                       bands.vertical.data() + column[1] * n,
                       bands.vertical.data() + column[2] * n};
  const FlatTriangle flat =
      flat_triangle(mesh.ground.vertices[column[0]], mesh.ground.vertices[column[1]],
                    mesh.ground.vertices[column[2]]);
  add_prisms(flat, mesh.column(column[0]), mesh.column(column[1]), mesh.column(column[2]),
             mesh.first_layer[t], mesh.layers, out);
}

/// Constants are in the kernel of the Laplacian, so a row sums to zero.
void fill_diagonal(const LayeredMesh& mesh, std::size_t v, StiffnessBands& bands) {
  const std::size_t n = mesh.stride();
  float* diagonal = bands.diagonal.data() + v * n;
  const float* vertical = bands.vertical.data() + v * n;
  for (std::size_t k = 0; k < n; ++k) diagonal[k] = -vertical[k];
  for (std::size_t k = 1; k < n; ++k) diagonal[k] -= vertical[k - 1];
  for (EdgeIndex e = mesh.edges.starts[v]; e < mesh.edges.starts[v + 1]; ++e) {
    const float* level = bands.edge.data() + static_cast<std::size_t>(e) * 2 * n;
    for (std::size_t k = 0; k < n; ++k) diagonal[k] -= level[k] + level[n + k];
  }
  for (std::int32_t i = mesh.edges.end_offsets[v]; i < mesh.edges.end_offsets[v + 1]; ++i) {
    const auto e = static_cast<std::size_t>(mesh.edges.ends[static_cast<std::size_t>(i)]);
    const float* level = bands.edge.data() + e * 2 * n;
    diagonal[0] -= level[0];
    for (std::size_t k = 1; k < n; ++k) diagonal[k] -= level[k] + level[n + k - 1];
  }
  for (std::int32_t k = 0; k < mesh.first_node[v]; ++k) diagonal[k] = 1;
}

}  // namespace

StiffnessBands assemble_stiffness(const LayeredMesh& mesh) {
  const std::size_t n = mesh.stride();
  StiffnessBands bands;
  bands.edge.assign(mesh.edges.size() * 2 * n, 0.0F);
  bands.vertical.assign(mesh.vertex_count() * n, 0.0F);
  bands.diagonal.resize(mesh.vertex_count() * n);
  for (const auto& group : independent_blocks(mesh.ground)) {
    parallel_chunks(group.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t first = group[i] * kTrianglesPerBlock;
        const std::size_t last = std::min(first + kTrianglesPerBlock, mesh.triangle_count());
        for (std::size_t t = first; t < last; ++t) add_triangle(mesh, t, bands);
      }
    });
  }
  parallel_chunks(mesh.vertex_count(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) fill_diagonal(mesh, v, bands);
  });
  return bands;
}

}  // namespace tetropolis
