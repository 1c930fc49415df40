#include "column_numbers.h"

#include <cassert>
#include <numeric>
#include <string>
#include <tuple>

#include "tetropolis/core/error.h"
#include "tetropolis/core/parallel.h"

#include "chunked_output.h"

namespace tetropolis {

namespace {

/// What lies across a face of a tet. The values of the sides are their slots in of_triangle.
enum class Across : std::int8_t { kSide12 = 0, kSide13 = 1, kSide23 = 2, kAbove, kNextTet };

/// Corners of a prism are u1, u2, u3 (bottom) and w1, w2, w3 (top): 0 to 5. The order of `corners`
/// leaves the tet if v1, v2, v3 are counter-clockwise.
struct TetFace {
  std::array<int, 3> corners;
  Across across;
};

/// The faces of the three tets drawn in column_mesh.h, but the one to the cell before. Each side of
/// the prism has a low half (a0, b0, b1) and a high half (a0, b1, a1) for its vertices a < b.
constexpr std::array<std::array<TetFace, 3>, 3> kTetFaces = {{
    {{{{0, 1, 5}, Across::kNextTet}, {{0, 5, 2}, Across::kSide13}, {{1, 2, 5}, Across::kSide23}}},
    {{{{0, 4, 5}, Across::kNextTet}, {{0, 1, 4}, Across::kSide12}, {{1, 5, 4}, Across::kSide23}}},
    {{{{4, 5, 3}, Across::kAbove}, {{0, 4, 3}, Across::kSide12}, {{0, 3, 5}, Across::kSide13}}},
}};

/// The tet behind the low and the high half of side 12, 13, 23.
constexpr std::array<std::array<int, 2>, 3> kSideTets = {{{1, 2}, {0, 2}, {0, 1}}};

int slot_of(const EdgeGraph& edges, std::size_t t, EdgeIndex e) {
  const auto& own = edges.of_triangle[t];
  const auto slot = std::find(own.begin(), own.end(), e) - own.begin();
  assert(slot < 3);
  return static_cast<int>(slot);
}

NodeIndex cell_across(const ColumnNumbers& numbers, std::size_t t, std::int32_t k, int i,
                      const TetFace& face) {
  const ColumnMesh& mesh = numbers.mesh;
  if (face.across == Across::kNextTet) return numbers.cell(t, k, i + 1);
  if (face.across == Across::kAbove)
    return k + 1 < mesh.layers ? numbers.cell(t, k + 1, 0) : kNoCell;
  const auto slot = static_cast<std::size_t>(face.across);
  const EdgeIndex e = mesh.edges.of_triangle[t][slot];
  const auto& pair = mesh.edges.triangles[static_cast<std::size_t>(e)];
  const TriangleIndex other = pair[0] == static_cast<TriangleIndex>(t) ? pair[1] : pair[0];
  if (other == kNoTriangle) return kNoCell;
  const auto o = static_cast<std::size_t>(other);
  if (mesh.first_layer[o] > k) return kNoCell;
  const std::size_t half = kSideTets[slot][0] == i ? 0 : 1;
  return numbers.cell(o, k, kSideTets[static_cast<std::size_t>(slot_of(mesh.edges, o, e))][half]);
}

/// Whether the vertices in ascending order run counter-clockwise.
bool ascending_is_ccw(const std::array<VertexIndex, 3>& triangle) {
  const auto lowest = std::min_element(triangle.begin(), triangle.end()) - triangle.begin();
  const auto at = static_cast<std::size_t>(lowest);
  return triangle[(at + 1) % 3] < triangle[(at + 2) % 3];
}

EdgeIndex find_edge(const EdgeGraph& edges, VertexIndex low, VertexIndex high) {
  EdgeIndex e = edges.starts[static_cast<std::size_t>(low)];
  while (edges.vertices[static_cast<std::size_t>(e)][1] != high) ++e;
  assert(e < edges.starts[static_cast<std::size_t>(low) + 1]);
  return e;
}

NodeIndex cell_behind_floor_or_top(const ColumnNumbers& numbers, std::array<VertexIndex, 3> v,
                                   std::int32_t layer) {
  const ColumnMesh& mesh = numbers.mesh;
  v = sorted_vertices(v);
  const auto e = static_cast<std::size_t>(find_edge(mesh.edges, v[0], v[1]));
  const auto [t0, t1] = mesh.edges.triangles[e];
  const bool first = sorted_vertices(mesh.ground.triangles[static_cast<std::size_t>(t0)]) == v;
  const auto t = static_cast<std::size_t>(first ? t0 : t1);
  return layer == mesh.layers ? numbers.cell(t, layer - 1, 2) : numbers.cell(t, layer, 0);
}

}  // namespace

ColumnNumbers number_columns(const ColumnMesh& mesh) {
  ColumnNumbers numbers{mesh, node_offsets(mesh), {}};
  numbers.cells.assign(mesh.triangle_count() + 1, 0);
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    numbers.cells[t + 1] = numbers.cells[t] + 3 * (mesh.layers - mesh.first_layer[t]);
  return numbers;
}

void append_points(const ColumnMesh& mesh, const Placement& placement, std::size_t begin,
                   std::size_t end, std::string& buffer) {
  for (std::size_t v = begin; v < end; ++v)
    for (std::int32_t k = mesh.first_node[v]; k <= mesh.layers; ++k) {
      append_raw(buffer, mesh.ground.vertices[v].x + placement.shift[0]);
      append_raw(buffer, mesh.ground.vertices[v].y + placement.shift[1]);
      append_raw(buffer, mesh.column(v)[k] + placement.shift[2]);
    }
}

FacesAbove faces_above(const ColumnNumbers& numbers, std::size_t t, std::int32_t k, int i) {
  const auto& triangle = numbers.mesh.ground.triangles[t];
  const auto v = sorted_vertices(triangle);
  const bool ccw = ascending_is_ccw(triangle);
  const NodeIndex own = numbers.cell(t, k, i);
  FacesAbove above;
  for (const TetFace& face : kTetFaces[static_cast<std::size_t>(i)]) {
    const NodeIndex neighbour = cell_across(numbers, t, k, i, face);
    if (neighbour < own) continue;  // also kNoCell
    std::array<NodeIndex, 3> nodes{};
    for (std::size_t c = 0; c < 3; ++c) {
      const int corner = face.corners[c];
      nodes[c] = numbers.node({v[static_cast<std::size_t>(corner % 3)], k + corner / 3});
    }
    if (!ccw) std::swap(nodes[1], nodes[2]);
    std::size_t place = above.count++;  // kept in ascending order of neighbours
    for (; place > 0 && above.faces[place - 1].neighbour > neighbour; --place)
      above.faces[place] = above.faces[place - 1];
    above.faces[place] = {own, neighbour, nodes};
  }
  return above;
}

std::vector<Node> boundary_nodes(const ColumnMesh& mesh, const SurfaceMesh& surface) {
  const auto& vertices = mesh.ground.vertices;
  std::vector<VertexIndex> by_position(vertices.size());
  std::iota(by_position.begin(), by_position.end(), 0);
  const auto position = [&](VertexIndex v) {
    const Point2& p = vertices[static_cast<std::size_t>(v)];
    return std::tuple(p.x, p.y, v);
  };
  parallel_sort(by_position.begin(), by_position.end(),
                [&](VertexIndex a, VertexIndex b) { return position(a) < position(b); });

  std::vector<Node> nodes(surface.points.size());
  parallel_chunks(nodes.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& p = surface.points[i];
      const auto found = std::lower_bound(
          by_position.begin(), by_position.end(), std::tuple(p[0], p[1], VertexIndex{0}),
          [&](VertexIndex v, const auto& wanted) { return position(v) < wanted; });
      if (found != by_position.end()) {
        const auto v = static_cast<std::size_t>(*found);
        const double* z = std::lower_bound(mesh.column(v) + mesh.first_node[v],
                                           mesh.column(v) + mesh.layers, p[2]);
        if (vertices[v] == Point2{p[0], p[1]} && *z == p[2]) {
          nodes[i] = {*found, static_cast<std::int32_t>(z - mesh.column(v))};
          continue;
        }
      }
      throw Error(ErrorKind::kGuarantee, "point " + std::to_string(i) +
                                             " of the boundary is not a node of the volume mesh");
    }
  });
  return nodes;
}

NodeIndex cell_behind(const ColumnNumbers& numbers, const std::array<Node, 3>& face) {
  const ColumnMesh& mesh = numbers.mesh;
  const auto [a, b, c] = std::array{face[0].vertex, face[1].vertex, face[2].vertex};
  if (a != b && b != c && c != a)
    return cell_behind_floor_or_top(numbers, {a, b, c}, face[0].layer);
  const VertexIndex low = std::min({a, b, c});
  const VertexIndex high = std::max({a, b, c});
  const std::int32_t k = std::min({face[0].layer, face[1].layer, face[2].layer});
  const EdgeIndex e = find_edge(mesh.edges, low, high);
  const auto [t0, t1] = mesh.edges.triangles[static_cast<std::size_t>(e)];
  const bool first = mesh.first_layer[static_cast<std::size_t>(t0)] <= k;
  assert(first || t1 != kNoTriangle);
  const auto t = static_cast<std::size_t>(first ? t0 : t1);
  // The low half of a side has the higher vertex twice.
  const std::size_t half = (a == high) + (b == high) + (c == high) == 2 ? 0 : 1;
  return numbers.cell(t, k, kSideTets[static_cast<std::size_t>(slot_of(mesh.edges, t, e))][half]);
}

}  // namespace tetropolis
