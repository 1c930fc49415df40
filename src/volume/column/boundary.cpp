#include "tetropolis/volume/column/boundary.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "tetropolis/core/error.h"

#include "upper_faces.h"

namespace tetropolis {

namespace {

struct Face {
  std::array<NodeIndex, 3> nodes;
  CellIndex cell;
  BuildingIndex building;
  bool is_first_half = false;  ///< Of a quadrilateral; the next face is the other one.
};

/// Collects faces, one list a patch.
struct FaceLists {
  const PatchTable& patches;
  std::vector<std::vector<Face>> lists = std::vector<std::vector<Face>>(patches.size());
  void add(Patch patch, const Face& face) { lists[patches.position(patch)].push_back(face); }
};

void add_floor_and_top(const ColumnMesh& mesh, const std::vector<CellIndex>& cells,
                       FaceLists& faces) {
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    const auto& v = mesh.ground.triangles[t];
    const Region& region = mesh.ground.region_of(t);
    if (!mesh.has_layers(t))
      faces.add(region.floor,
                {{mesh.floor_over(t, v[0]), mesh.floor_over(t, v[2]), mesh.floor_over(t, v[1])},
                 cells[t],
                 region.building});
    if (mesh.is_covered(t)) continue;
    faces.add(Patch::kTop,
              {{mesh.top(v[0]), mesh.top(v[1]), mesh.top(v[2])}, cells[t + 1] - 1, kNoBuilding});
  }
}

/// Goes through the tags of edges, which are asked for in their order.
class SidesOfDomain {
 public:
  explicit SidesOfDomain(const GroundMesh& mesh) : mesh_(mesh), next_(mesh.tagged_edges.begin()) {}

  Patch at(const std::array<VertexIndex, 2>& edge) {
    const auto vertices = [&] { return std::array{next_->low, next_->high}; };
    while (next_ != mesh_.tagged_edges.end() && vertices() < edge) ++next_;
    if (next_ == mesh_.tagged_edges.end() || vertices() != edge || next_->region != kNoRegion)
      throw Error(ErrorKind::kGuarantee,
                  "ground mesh: the rim edge between vertices " + std::to_string(edge[0]) +
                      " and " + std::to_string(edge[1]) + " is not on a side of the domain");
    return mesh_.sides[static_cast<std::size_t>(next_->segment)];
  }

 private:
  const GroundMesh& mesh_;
  std::vector<TaggedEdge>::const_iterator next_;
};

/// What the faces over an edge are tagged with, and the nodes they end at over its two vertices.
struct Side {
  Patch patch;
  BuildingIndex building;
  std::array<NodeIndex, 2> end;
};

/// Faces of the cells over triangle t on the vertical side over edge e; none where the triangle's
/// floor is not below the side's end.
void add_side(const ColumnMesh& mesh, CellIndex first_cell, TriangleIndex t, EdgeIndex e,
              const Side& side, FaceLists& faces) {
  const auto& corners = mesh.ground.triangles[t];
  const auto [a, b] = mesh.edges.vertices[e];
  // The edge from corner i to the next one, in the direction that has the triangle on its left.
  std::size_t i = 0;
  while (std::min(corners[i], corners[(i + 1) % 3]) != a ||
         std::max(corners[i], corners[(i + 1) % 3]) != b)
    ++i;
  const std::size_t j = (i + 1) % 3;
  const NodeIndex end_i = side.end[corners[i] == a ? 0 : 1];
  const NodeIndex end_j = side.end[corners[j] == a ? 0 : 1];
  CellIndex cell = first_cell;
  Climb<3> front = climb_triangle(mesh, t);
  while (front.at(i) < end_i || front.at(j) < end_j) {
    const std::size_t c = front.next();
    if (c == i || c == j)
      faces.add(side.patch, {{front.at(i), front.at(j), front.at(c) + 1}, cell, side.building});
    front.advance(c);
    ++cell;
  }
}

void add_sides(const ColumnMesh& mesh, const std::vector<CellIndex>& cells, FaceLists& faces) {
  SidesOfDomain sides(mesh.ground);
  for (const EdgeIndex e : mesh.edges.vertices.indices()) {
    const auto [t0, t1] = mesh.edges.triangles[e];
    const auto [a, b] = mesh.edges.vertices[e];
    if (t1 == kNoTriangle) {
      const std::array top{mesh.top(a), mesh.top(b)};
      add_side(mesh, cells[t0], t0, e, {sides.at({a, b}), kNoBuilding, top}, faces);
      continue;
    }
    if (mesh.ground.region[t0] == mesh.ground.region[t1]) continue;
    // A wall belongs to the building whose floor is the higher one.
    for (const auto& [air, behind] : {std::pair(t0, t1), std::pair(t1, t0)})
      add_side(mesh, cells[air], air, e,
               {Patch::kWall,
                mesh.ground.region_of(behind).building,
                {mesh.floor_over(behind, a), mesh.floor_over(behind, b)}},
               faces);
  }
}

/// Floors and tops of stacks of prisms, and their sides at walls and on the rim.
void add_prisms(const ColumnMesh& mesh, CellIndex first_prism, FaceLists& faces) {
  const auto prism = [&](TriangleIndex t, std::int32_t k) {
    return first_prism + (mesh.layers.offsets[t] + k);
  };
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    const std::int32_t count = prism_count(mesh, t);
    if (count == 0) continue;
    const auto& v = mesh.ground.triangles[t];
    const Region& region = mesh.ground.region_of(t);
    const auto node = [&](std::size_t c, std::int32_t k) { return prism_node(mesh, t, v[c], k); };
    faces.add(region.floor, {{node(0, 0), node(2, 0), node(1, 0)}, prism(t, 0), region.building});
    if (mesh.layers.whole)
      faces.add(
          Patch::kTop,
          {{node(0, count), node(1, count), node(2, count)}, prism(t, count - 1), kNoBuilding});
  }
  SidesOfDomain sides(mesh.ground);
  for (const EdgeIndex e : mesh.edges.vertices.indices()) {
    const auto& ends = mesh.edges.vertices[e];
    const auto [t0, t1] = mesh.edges.triangles[e];
    const bool is_rim = t1 == kNoTriangle;
    const Patch patch = is_rim ? sides.at(ends) : Patch::kWall;
    for (const auto& [air, behind] : {std::pair(t0, t1), std::pair(t1, t0)}) {
      if (air == kNoTriangle) continue;
      std::int32_t count = prism_count(mesh, air);
      BuildingIndex building = kNoBuilding;
      if (!is_rim) {
        // What has no prism behind it.
        if (prism_count(mesh, behind) > 0)
          count = std::min(count, prisms_above(mesh, behind, air, ends[0]));
        building = mesh.ground.region_of(behind).building;
      }
      // With the triangle on the left.
      const auto& corners = mesh.ground.triangles[air];
      const auto at_low = static_cast<std::size_t>(
          std::find(corners.begin(), corners.end(), ends[0]) - corners.begin());
      const bool forward = corners[(at_low + 1) % 3] == ends[1];
      const VertexIndex from = ends[forward ? 0 : 1], to = ends[forward ? 1 : 0];
      for (std::int32_t k = 0; k < count; ++k) {
        const NodeIndex a = prism_node(mesh, air, from, k), b = prism_node(mesh, air, to, k);
        const NodeIndex c = prism_node(mesh, air, to, k + 1);
        const NodeIndex d = prism_node(mesh, air, from, k + 1);
        faces.add(patch, {{a, b, c}, prism(air, k), building, true});
        faces.add(patch, {{a, c, d}, prism(air, k), building});
      }
    }
  }
}

void add_upper(const ColumnMesh& mesh, FaceLists& faces) {
  const CellIndex first = cell_offsets(mesh)[mesh.triangle_count()];
  // By edge, as the sides are asked for.
  std::vector<std::pair<std::array<VertexIndex, 2>, Face>> sides;
  visit_outer_faces(mesh, [&](std::size_t cell, const UpperMesh::Cell&,
                              const std::array<UpperPlace, 3>& places, bool is_top) {
    const Face face{upper_nodes(mesh, places), first + cell, kNoBuilding};
    if (is_top) return faces.add(Patch::kTop, face);
    const auto [low, high] =
        std::minmax({upper_vertex(mesh, places[0]), upper_vertex(mesh, places[1]),
                     upper_vertex(mesh, places[2])});
    sides.push_back({{low, high}, face});
  });
  std::stable_sort(sides.begin(), sides.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  SidesOfDomain side_at(mesh.ground);
  for (const auto& [edge, face] : sides) faces.add(side_at.at(edge), face);
}

/// Numbers the boundary's nodes in column order.
SurfaceMesh number_faces(const ColumnMesh& mesh, FaceLists faces) {
  constexpr std::int32_t unused = -1;
  std::vector<std::int32_t> number(static_cast<std::size_t>(mesh.node_count()), unused);
  std::size_t count = 0;
  for (const auto& list : faces.lists) {
    count += list.size();
    for (const Face& face : list)
      for (const NodeIndex node : face.nodes) number[node] = 0;
  }
  SurfaceMesh surface;
  surface.patches = faces.patches;
  for (std::size_t row = 0; row < point_rows(mesh); ++row)
    for_each_point_of(mesh, row, [&](NodeIndex node, const Point3& p) {
      auto& own = number[node];
      if (own == unused) return;
      own = static_cast<std::int32_t>(surface.points.size());
      surface.points.push_back(p);
      surface.node.push_back(node);
    });
  surface.triangles.reserve(count);
  surface.patch.reserve(count);
  surface.building.reserve(count);
  surface.cell.reserve(count);
  const auto numbered = [&](NodeIndex node) { return number[node]; };
  for (std::size_t i = 0; i < faces.lists.size(); ++i) {
    for (const Face& face : faces.lists[i]) {
      if (face.is_first_half)
        surface.quads.push_back(static_cast<std::int32_t>(surface.triangles.size()));
      surface.triangles.push_back(
          {numbered(face.nodes[0]), numbered(face.nodes[1]), numbered(face.nodes[2])});
      surface.patch.push_back(faces.patches[i].patch);
      surface.building.push_back(face.building);
      surface.cell.push_back(face.cell);
    }
    faces.lists[i] = {};
  }
  return surface;
}

}  // namespace

SurfaceMesh extract_boundary(const ColumnMesh& mesh) {
  const std::vector<CellIndex> cells = cell_offsets(mesh);
  FaceLists faces{mesh.ground.patches};
  if (!mesh.layers.whole) {
    add_floor_and_top(mesh, cells, faces);
    add_sides(mesh, cells, faces);
  }
  if (!mesh.upper.empty()) add_upper(mesh, faces);
  if (mesh.layers.cells() > 0) add_prisms(mesh, cells.back(), faces);
  return number_faces(mesh, std::move(faces));
}

std::size_t SurfaceFaces::quads_before(std::size_t i) const {
  // Of quad q the number as a face, face_of(q), increases.
  std::size_t low = 0, high = surface_.quads.size();
  while (low < high) {
    const std::size_t q = (low + high) / 2;
    if (face_of(q) < i)
      low = q + 1;
    else
      high = q;
  }
  return low;
}

FaceCorners SurfaceFaces::corners(std::size_t i) const {
  const std::size_t f = triangle(i);
  const auto& [a, b, c] = surface_.triangles[f];
  if (!is_quad(i)) return {{a, b, c}, 3};
  return {{a, b, c, surface_.triangles[f + 1][2]}, 4};
}

SurfaceMesh select_patches(const SurfaceMesh& surface, std::span<const Patch> patches) {
  constexpr std::int32_t unused = -1;
  std::vector<std::int32_t> number(surface.points.size(), unused);
  SurfaceMesh result;
  result.patches = surface.patches;
  auto quad = surface.quads.begin();
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    const bool is_first_half = quad != surface.quads.end() && static_cast<std::size_t>(*quad) == f;
    if (is_first_half) ++quad;
    if (std::find(patches.begin(), patches.end(), surface.patch[f]) == patches.end()) continue;
    auto triangle = surface.triangles[f];
    for (auto& v : triangle) {
      auto& renumbered = number[static_cast<std::size_t>(v)];
      if (renumbered == unused) {
        renumbered = static_cast<std::int32_t>(result.points.size());
        result.points.push_back(surface.points[static_cast<std::size_t>(v)]);
        if (!surface.node.empty()) result.node.push_back(surface.node[static_cast<std::size_t>(v)]);
      }
      v = renumbered;
    }
    if (is_first_half) result.quads.push_back(static_cast<std::int32_t>(result.triangles.size()));
    result.triangles.push_back(triangle);
    result.patch.push_back(surface.patch[f]);
    result.building.push_back(surface.building[f]);
    if (!surface.cell.empty()) result.cell.push_back(surface.cell[f]);
  }
  return result;
}

SurfaceMesh city_surface(const SurfaceMesh& boundary) {
  SurfaceMesh surface = select_patches(boundary, boundary.patches.solid());
  for (auto& triangle : surface.triangles) std::swap(triangle[1], triangle[2]);
  surface.quads.clear();
  return surface;
}

void sort_by_patch(SurfaceMesh& surface) {
  std::vector<std::uint8_t> half(surface.triangles.size(), 0);  // of a quadrilateral: 1, 2
  for (const std::int32_t q : surface.quads) {
    const auto f = static_cast<std::size_t>(q);
    half[f] = 1;
    half[f + 1] = 2;
  }
  const auto key = [&](std::size_t f) { return std::pair(surface.patch[f], half[f] > 0); };
  std::vector<std::size_t> order(surface.triangles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  const auto sort = [&](auto& values) {
    if (values.empty()) return;
    auto sorted = values;
    for (std::size_t f = 0; f < order.size(); ++f) sorted[f] = values[order[f]];
    values = std::move(sorted);
  };
  sort(surface.triangles);
  sort(surface.patch);
  sort(surface.building);
  sort(surface.cell);
  sort(half);
  surface.quads.clear();
  for (std::size_t f = 0; f < half.size(); ++f)
    if (half[f] == 1) surface.quads.push_back(static_cast<std::int32_t>(f));
}

std::vector<PatchCount> count_by_patch(const SurfaceMesh& surface) {
  std::vector<PatchCount> counts;
  for (const PatchInfo& info : surface.patches) counts.push_back({info.name, 0});
  for (const Patch patch : surface.patch) ++counts[surface.patches.position(patch)].faces;
  for (const std::int32_t f : surface.quads)
    --counts[surface.patches.position(surface.patch[static_cast<std::size_t>(f)])].faces;
  return counts;
}

SurfaceTopology check_topology(const SurfaceMesh& surface) {
  // Half-edges by their lower vertex; each as twice the upper one, plus 1 if it runs there.
  std::vector<std::size_t> end(surface.points.size(), 0);
  const auto for_each_half_edge = [&](const auto& visit) {
    for (const auto& triangle : surface.triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::int32_t a = triangle[i], b = triangle[(i + 1) % 3];
        visit(end[static_cast<std::size_t>(std::min(a, b))],
              2 * static_cast<std::uint32_t>(std::max(a, b)) + (a < b ? 1U : 0U));
      }
  };
  for_each_half_edge([](std::size_t& count, std::uint32_t) { ++count; });
  std::exclusive_scan(end.begin(), end.end(), end.begin(), std::size_t{0});
  std::vector<std::uint32_t> halves(3 * surface.triangles.size());
  for_each_half_edge([&](std::size_t& next, std::uint32_t half) { halves[next++] = half; });
  SurfaceTopology result;
  std::size_t i = 0;
  for (const std::size_t last : end) {
    std::sort(halves.begin() + static_cast<std::ptrdiff_t>(i),
              halves.begin() + static_cast<std::ptrdiff_t>(last));
    for (std::size_t j = i; i < last; i = j) {
      while (j < last && halves[j] / 2 == halves[i] / 2) ++j;
      if (j - i == 1)
        ++result.open_edges;
      else if (j - i > 2)
        ++result.non_manifold_edges;
      else if (halves[i] == halves[i + 1])
        ++result.misoriented_edges;
    }
  }
  return result;
}

}  // namespace tetropolis
