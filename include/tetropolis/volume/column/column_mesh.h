// The volume mesh as columns over the ground mesh: never a list of tets. Columns end at a lid over
// the roofs, or at the top; what is above the lid has a mesh of its own (upper_mesh.h).
//
// Over every vertex of the ground mesh stands a column of nodes with increasing elevations, as many
// as its surroundings need; over every triangle stands a stack of tets. Starting from the floor
// (the ground, or a roof), a front of one node per corner climbs to the columns' ends: the corner
// whose next segment has the lowest midpoint goes first, and each step leaves one tet behind:
//
//            a'        front (a, b, c), next segment a-a':  tet (a, b, c, a'),
//           /|\        and the front becomes (a', b, c).
//          / | \                                                                            .
//         b--|--c      Each tet has exactly one vertical edge, and its volume is a third of the
//          \ | /       triangle's area times that edge's length: these cells are valid if and only
//            a         if every column increases, whatever the elevations.
//
// The order of two columns' segments depends on these two columns alone, so the triangles on both
// sides of an edge cut the vertical strip over it in the same way: the mesh is conforming. Ties go
// to the higher vertex number; with layers of equal height this is the split of prisms by sorted
// vertex numbers of Naserentin & Logg, step 3.2. Because lower segments go first, fronts follow the
// horizontal wherever floors are not: the tets of neighbouring columns stay well-shaped when the
// columns have different spacings or are shifted against each other on a slope.
//
// A front that starts on the street has to pass through the edge of the roof above. Midpoints do
// that where the edge is horizontal. Where it is not, they are compared by level: a column's
// elevations are mapped to levels piece by piece, linearly between its floors and its top, and
// floors at the two ends of such an edge have nearly the same level (levels.h).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "tetropolis/ground/ground_mesh.h"
#include "tetropolis/volume/column/edge_graph.h"
#include "tetropolis/volume/column/prism_layers.h"
#include "tetropolis/volume/column/upper_mesh.h"

namespace tetropolis {

/// Nodes are numbered column by column and upwards. A column has the nodes that belong to cells
/// only: from the lowest floor of the regions around it to the top, with a node at each floor.
struct ColumnMesh {
  GroundMesh ground;
  EdgeGraph edges;
  VertexRegions regions;         ///< Of `ground`.
  std::vector<NodeIndex> first;  ///< V + 1 offsets: column v has the nodes [first[v], first[v+1]).
  std::vector<double> z;         ///< Per node: elevation in metres; increasing in each column, at
                                 ///< least two a column.
  std::vector<std::int32_t> floors;  ///< Per entry of `regions`: position of the region's floor in
                                     ///< the column, from its first node.
  std::vector<double> floor_levels;  ///< Per entry of `regions`: level of the region's floor.
                                     ///< Empty: all levels are elevations.
  std::vector<double> levels;        ///< Per node: level, increasing in each column; likewise.
  UpperMesh upper;                   ///< What is above the columns' ends,
  PrismLayers layers;                ///< and what is below them over open ground.

  std::size_t vertex_count() const { return ground.vertices.size(); }
  std::size_t triangle_count() const { return ground.triangles.size(); }
  /// Of columns, of the upper part and of layers.
  std::int64_t node_count() const { return first_layer_node().value() + layers.nodes(); }
  NodeIndex first_layer_node() const {
    return NodeIndex(column_nodes() + static_cast<std::int64_t>(upper.nodes()));
  }
  std::int64_t column_nodes() const { return first.back().value(); }
  /// Whether prisms lie below the stack over triangle t.
  bool has_layers(TriangleIndex t) const { return layers.count > 0 && !inside_building(t); }
  /// Whether cells of the upper part lie on the stack over triangle t.
  bool is_covered(TriangleIndex t) const { return !upper.empty() && upper.over_lid[t] != kNoCell; }
  /// The nodes of column v, upwards.
  IndexRange<NodeIndex> nodes(VertexIndex v) const { return {first[v], first[v + 1]}; }
  NodeIndex top(VertexIndex v) const { return first[v + 1] - 1; }
  bool inside_building(TriangleIndex t) const { return ground.inside_building(t); }
  /// The node at the floor of `region` over vertex v. Precondition: the region is around v.
  NodeIndex floor(RegionIndex region, VertexIndex v) const {
    return regions[v].size() == 1 ? first[v] : first[v] + floors_at(v)[place(region, v)];
  }
  /// The node that triangle t's stack starts at over its corner v.
  NodeIndex floor_over(TriangleIndex t, VertexIndex v) const { return floor(ground.region[t], v); }
  /// Per node, what fronts go by: levels, or elevations where these are the same.
  const std::vector<double>& climbing() const { return levels.empty() ? z : levels; }
  /// Levels of the floors in the column of vertex v, in the order of `regions`; empty as they are.
  std::span<const double> floor_levels_at(VertexIndex v) const {
    if (floor_levels.empty()) return {};
    return std::span(floor_levels).subspan(offset(v), regions[v].size());
  }
  std::span<double> floor_levels_at(VertexIndex v) {
    if (floor_levels.empty()) return {};
    return std::span(floor_levels).subspan(offset(v), regions[v].size());
  }
  /// Positions of the floors in the column of vertex v, in the order of `regions`.
  std::span<const std::int32_t> floors_at(VertexIndex v) const {
    return std::span(floors).subspan(offset(v), regions[v].size());
  }
  std::span<std::int32_t> floors_at(VertexIndex v) {
    return std::span(floors).subspan(offset(v), regions[v].size());
  }
  /// Where `region` stands among those around v. Precondition: it is one of them.
  std::size_t place(RegionIndex region, VertexIndex v) const {
    const std::span<const RegionIndex> around = regions[v];
    std::size_t i = 0;
    while (around[i] != region) ++i;
    return i;
  }

 private:
  std::size_t offset(VertexIndex v) const { return static_cast<std::size_t>(regions.offsets[v]); }
};

/// Cells of the upper part in a block of cell_offsets(), and points in one of point_rows().
inline constexpr std::size_t kUpperBlock = UpperMesh::kBlock;

/// Ends of columns and nodes of the upper part.
inline NodeIndex upper_node(const ColumnMesh& mesh, UpperPlace p) {
  const std::size_t columns = mesh.vertex_count();
  if (p < columns) return mesh.top(VertexIndex(p.value()));
  return NodeIndex(mesh.column_nodes()) + (std::size_t{p} - columns);
}
inline VertexIndex upper_vertex(const ColumnMesh& mesh, UpperPlace p) {
  const std::size_t columns = mesh.vertex_count();
  return p < columns ? VertexIndex(p.value()) : mesh.upper.vertex[p - columns];
}

/// The cells over triangle t are [offsets[t], offsets[t + 1]), upwards. After those of all
/// triangles come those of the upper part, in blocks: T + 1 offsets, and one more for each block.
/// So there are offsets.size() - 1 rows of cells, one per triangle or block.
std::vector<CellIndex> cell_offsets(const ColumnMesh& mesh);

/// Rows of nodes: one per ground vertex, then one per block of the upper part, and one per vertex
/// of the layers.
inline std::size_t point_rows(const ColumnMesh& mesh) {
  return mesh.vertex_count() + (mesh.upper.nodes() + kUpperBlock - 1) / kUpperBlock +
         mesh.layers.vertices.size();
}

/// The node of vertex v below (0 .. count - 1) or on top of (count) layer k. Precondition: v is one
/// of the layers'.
inline NodeIndex layer_node(const ColumnMesh& mesh, VertexIndex v, std::int32_t k) {
  const PrismLayers& layers = mesh.layers;
  if (k == layers.count) return mesh.first[v];
  return mesh.first_layer_node() + (std::int64_t{layers.position[v]} * layers.count + k);
}

/// Prisms over triangle t.
inline std::int32_t prism_count(const ColumnMesh& mesh, TriangleIndex t) {
  const auto& offsets = mesh.layers.offsets;
  return offsets.empty() ? 0 : static_cast<std::int32_t>(offsets[t + 1] - offsets[t]);
}

/// The node of triangle t's corner v below (0 .. prism_count - 1) or on top of prism k of its
/// stack.
inline NodeIndex prism_node(const ColumnMesh& mesh, TriangleIndex t, VertexIndex v,
                            std::int32_t k) {
  const std::int32_t layers = mesh.has_layers(t) ? mesh.layers.count : 0;
  return k < layers ? layer_node(mesh, v, k) : mesh.floor_over(t, v) + std::int64_t{k - layers};
}

/// By how many prisms the stack over triangle t begins above that over `other`, beside it, which
/// both have vertex v.
inline std::int32_t prisms_above(const ColumnMesh& mesh, TriangleIndex t, TriangleIndex other,
                                 VertexIndex v) {
  const auto begin = [&](TriangleIndex own) {
    const std::int64_t floor = mesh.floor_over(own, v) - mesh.first[v];
    return static_cast<std::int32_t>(floor) - (mesh.has_layers(own) ? mesh.layers.count : 0);
  };
  return begin(t) - begin(other);
}

/// The triangle that prism i of layers.cells() stands over.
inline TriangleIndex triangle_below(const ColumnMesh& mesh, std::int64_t i) {
  const auto& offsets = mesh.layers.offsets;
  return TriangleIndex(std::upper_bound(offsets.begin(), offsets.end(), i) - offsets.begin() - 1);
}

/// Prism i of layers.cells(): its corners below, as the triangle has them, and those above. Its
/// number among cells is that of all tets plus i.
inline std::array<NodeIndex, 6> wedge(const ColumnMesh& mesh, std::int64_t i) {
  const TriangleIndex t = triangle_below(mesh, i);
  const auto layer = static_cast<std::int32_t>(i - mesh.layers.offsets[t]);
  const auto& v = mesh.ground.triangles[t];
  std::array<NodeIndex, 6> nodes{};
  for (std::size_t c = 0; c < 3; ++c) {
    nodes[c] = prism_node(mesh, t, v[c], layer);
    nodes[3 + c] = prism_node(mesh, t, v[c], layer + 1);
  }
  return nodes;
}

/// Elevation of a node.
inline double elevation(const ColumnMesh& mesh, NodeIndex n) {
  if (n < mesh.column_nodes()) return mesh.z[n];
  const std::int64_t below = n - mesh.first_layer_node();
  if (below >= 0) return mesh.layers.z[static_cast<std::size_t>(below)];
  return mesh.upper.z[static_cast<std::size_t>(n.value() - mesh.column_nodes())];
}

/// What fronts order a column's segments by, here the one from node n up: twice the level of its
/// midpoint. `level`: levels of the column.
inline double climbing_key(const double* level, NodeIndex n) {
  return level[n.value()] + level[n.value() + 1];
}

/// Whether a segment over vertex v with the key `a` goes before one over w with the key `b`.
constexpr bool climbs_first(double a, VertexIndex v, double b, VertexIndex w) {
  return a < b || (a == b && v > w);
}

/// A front of N columns that climbs in the order drawn above.
template <std::size_t N>
class Climb {
 public:
  /// Column i goes from node from[i] to the column's top.
  Climb(const ColumnMesh& mesh, const std::array<VertexIndex, N>& vertices,
        const std::array<NodeIndex, N>& from)
      : vertex_(vertices), at_(from) {
    level_.fill(mesh.climbing().data());
    for (std::size_t i = 0; i < N; ++i) last_[i] = mesh.top(vertex_[i]);
    for (std::size_t i = 0; i < N; ++i) set_key(i);
  }
  /// Columns of no mesh: the levels of column i are level[i][0 .. last[i]].
  Climb(const std::array<const double*, N>& level, const std::array<VertexIndex, N>& vertices,
        const std::array<NodeIndex, N>& from, const std::array<NodeIndex, N>& last)
      : level_(level), vertex_(vertices), at_(from), last_(last) {
    for (std::size_t i = 0; i < N; ++i) set_key(i);
  }
  /// The position (0 .. N - 1) of the column that goes next; N when all are at their last node.
  std::size_t next() const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < N; ++i)
      if (climbs_first(key_[i], vertex_[i], key_[best], vertex_[best])) best = i;
    return key_[best] < kDone ? best : N;
  }
  void advance(std::size_t i) {
    ++at_[i];
    set_key(i);
  }
  /// The front: node numbers of the mesh, or positions in the columns if they are of none.
  const std::array<NodeIndex, N>& at() const { return at_; }
  NodeIndex at(std::size_t i) const { return at_[i]; }

 private:
  static constexpr double kDone = std::numeric_limits<double>::infinity();
  void set_key(std::size_t i) {
    key_[i] = at_[i] < last_[i] ? climbing_key(level_[i], at_[i]) : kDone;
  }

  std::array<const double*, N> level_{};
  std::array<VertexIndex, N> vertex_;
  std::array<NodeIndex, N> at_;
  std::array<NodeIndex, N> last_{};
  std::array<double, N> key_{};
};

/// The front at the floor of triangle t, in the order of its corners.
inline Climb<3> climb_triangle(const ColumnMesh& mesh, TriangleIndex t) {
  const auto& v = mesh.ground.triangles[t];
  return {mesh, v, {mesh.floor_over(t, v[0]), mesh.floor_over(t, v[1]), mesh.floor_over(t, v[2])}};
}

/// Calls visit(nodes) for the tets over triangle t, upwards; none if there are only prisms. The
/// first three nodes are over the triangle's corners in their order, the fourth is the upper end of
/// the vertical edge: (p1 - p0) x (p2 - p0) . (p3 - p0) > 0.
template <typename Visit>
void for_each_tet_over(const ColumnMesh& mesh, TriangleIndex t, const Visit& visit) {
  if (mesh.layers.whole) return;
  Climb<3> front = climb_triangle(mesh, t);
  for (std::size_t i; (i = front.next()) < 3; front.advance(i)) {
    const auto& at = front.at();
    visit(std::array<NodeIndex, 4>{at[0], at[1], at[2], at[i] + 1});
  }
}

/// The same for the tets of a row of cell_offsets().
template <typename Visit>
void for_each_tet_of(const ColumnMesh& mesh, std::size_t row, const Visit& visit) {
  if (row < mesh.triangle_count()) return for_each_tet_over(mesh, TriangleIndex(row), visit);
  const std::size_t begin = (row - mesh.triangle_count()) * kUpperBlock;
  const std::size_t end = std::min(begin + kUpperBlock, mesh.upper.cells());
  mesh.upper.for_each_cell(begin, end, [&](const UpperMesh::Cell& cell) {
    const auto node = [&](std::size_t i) { return upper_node(mesh, cell[i]); };
    visit(std::array<NodeIndex, 4>{node(0), node(1), node(2), node(3)});
  });
}

/// The building below the cells of a row of cell_offsets(); kNoBuilding in the upper part.
inline BuildingIndex building_below(const ColumnMesh& mesh, std::size_t row) {
  return row < mesh.triangle_count() ? mesh.ground.region_of(TriangleIndex(row)).building
                                     : kNoBuilding;
}

/// Calls visit(node, position) for the nodes of a row of point_rows().
template <typename Visit>
void for_each_point_of(const ColumnMesh& mesh, std::size_t row, const Visit& visit) {
  if (row < mesh.vertex_count()) {
    const VertexIndex v(row);
    const Point2 p = mesh.ground.vertices[v];
    for (const NodeIndex n : mesh.nodes(v)) visit(n, Point3{p.x, p.y, mesh.z[n]});
    return;
  }
  const UpperMesh& upper = mesh.upper;
  const std::size_t begin = (row - mesh.vertex_count()) * kUpperBlock;
  const std::size_t end = std::min(begin + kUpperBlock, upper.nodes());
  if (begin >= upper.nodes()) {
    const PrismLayers& layers = mesh.layers;
    const VertexIndex v = layers.vertices[row + layers.vertices.size() - point_rows(mesh)];
    const Point2 p = mesh.ground.vertices[v];
    const double* const z = layers.z.data() + (layer_node(mesh, v, 0) - mesh.first_layer_node());
    for (std::int32_t k = 0; k < layers.count; ++k)
      visit(layer_node(mesh, v, k), Point3{p.x, p.y, z[k]});
    return;
  }
  for (std::size_t i = begin; i < end; ++i) {
    const Point2 p = mesh.ground.vertices[upper.vertex[i]];
    visit(NodeIndex(mesh.column_nodes()) + i, Point3{p.x, p.y, upper.z[i]});
  }
}

/// The building below prism i of layers.cells(), or kNoBuilding.
inline BuildingIndex building_of_prism(const ColumnMesh& mesh, std::int64_t i) {
  return mesh.ground.region_of(triangle_below(mesh, i)).building;
}

/// Position of a node over ground vertex v.
inline std::array<double, 3> position(const ColumnMesh& mesh, VertexIndex v, NodeIndex node) {
  const Point2 p = mesh.ground.vertices[v];
  return {p.x, p.y, mesh.z[node]};
}

/// What makes the mesh valid up to the lid (guarantees 4 and 5): every column has at least two
/// nodes and increases, with its layers below and the vertical edges above, and fronts pass through
/// the edges of roofs. Cells above the lid are measured, too (upper_mesh.h). Throws
/// Error(kGuarantee) naming the ground vertex otherwise. Returns the shortest vertical edge in
/// metres. Precondition: `edges` are those of `ground`.
double require_valid(const ColumnMesh& mesh);

}  // namespace tetropolis
