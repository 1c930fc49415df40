#include "tetropolis/volume/boundary.h"

#include <algorithm>
#include <string>

#include "tetropolis/core/error.h"
#include "tetropolis/core/parallel.h"

namespace tetropolis {

namespace {

constexpr std::array<std::string_view, kPatchCount> kNames = {"ground", "roof", "wall", "top",
                                                              "xmin",   "xmax", "ymin", "ymax"};

struct Face {
  std::array<Node, 3> nodes;
  BuildingIndex building;
};

/// Collects faces, one list a patch.
struct FaceLists {
  std::array<std::vector<Face>, kPatchCount> lists;
  void add(Patch patch, const std::array<Node, 3>& nodes, BuildingIndex building) {
    lists[static_cast<std::size_t>(patch) - 1].push_back({nodes, building});
  }
};

void add_floor_and_top(const ColumnMesh& mesh, FaceLists& faces) {
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto& v = mesh.ground.triangles[t];
    const std::int32_t first = mesh.first_layer[t];
    const BuildingIndex building = mesh.ground.region[t];
    faces.add(building == kNoBuilding ? Patch::kGround : Patch::kRoof,
              {Node{v[0], first}, Node{v[2], first}, Node{v[1], first}}, building);
    const std::int32_t top = mesh.layers;
    faces.add(Patch::kTop, {Node{v[0], top}, Node{v[1], top}, Node{v[2], top}}, kNoBuilding);
  }
}

Patch side_of_domain(const ColumnMesh& mesh, const Bounds2& domain, std::size_t e) {
  const Point2 a = mesh.ground.vertices[static_cast<std::size_t>(mesh.edges.vertices[e][0])];
  const Point2 b = mesh.ground.vertices[static_cast<std::size_t>(mesh.edges.vertices[e][1])];
  if (a.x == domain.xmin && b.x == domain.xmin) return Patch::kXMin;
  if (a.x == domain.xmax && b.x == domain.xmax) return Patch::kXMax;
  if (a.y == domain.ymin && b.y == domain.ymin) return Patch::kYMin;
  if (a.y == domain.ymax && b.y == domain.ymax) return Patch::kYMax;
  throw Error(ErrorKind::kGuarantee, "ground mesh: the rim edge between vertices " +
                                         std::to_string(mesh.edges.vertices[e][0]) + " and " +
                                         std::to_string(mesh.edges.vertices[e][1]) +
                                         " is not on a side of the domain");
}

/// Whether the triangle runs along a-b from a to b, that is, lies to the left of it.
bool runs_along(const std::array<VertexIndex, 3>& triangle, VertexIndex a, VertexIndex b) {
  for (std::size_t i = 0; i < 3; ++i)
    if (triangle[i] == a) return triangle[(i + 1) % 3] == b;
  return false;
}

/// Faces of the cells over `triangle` on the vertical sides over edge e, in layers [first, last).
void add_side(const ColumnMesh& mesh, std::size_t e, TriangleIndex triangle, std::int32_t first,
              std::int32_t last, Patch patch, BuildingIndex building, FaceLists& faces) {
  const auto [a, b] = mesh.edges.vertices[e];
  const bool left = runs_along(mesh.ground.triangles[static_cast<std::size_t>(triangle)], a, b);
  for (std::int32_t k = first; k < last; ++k) {
    // The side's diagonal rises from the lower to the higher vertex.
    const Node a0{a, k}, b0{b, k}, a1{a, k + 1}, b1{b, k + 1};
    if (left) {
      faces.add(patch, {a0, b0, b1}, building);
      faces.add(patch, {a0, b1, a1}, building);
    } else {
      faces.add(patch, {a0, b1, b0}, building);
      faces.add(patch, {a0, a1, b1}, building);
    }
  }
}

void add_sides(const ColumnMesh& mesh, const Bounds2& domain, FaceLists& faces) {
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const auto [t0, t1] = mesh.edges.triangles[e];
    const std::int32_t first0 = mesh.first_layer[static_cast<std::size_t>(t0)];
    if (t1 == kNoTriangle) {
      add_side(mesh, e, t0, first0, mesh.layers, side_of_domain(mesh, domain, e), kNoBuilding,
               faces);
      continue;
    }
    const std::int32_t first1 = mesh.first_layer[static_cast<std::size_t>(t1)];
    if (first0 == first1) continue;
    const TriangleIndex air = first0 < first1 ? t0 : t1;
    const TriangleIndex inside = first0 < first1 ? t1 : t0;
    add_side(mesh, e, air, std::min(first0, first1), std::max(first0, first1), Patch::kWall,
             mesh.ground.region[static_cast<std::size_t>(inside)], faces);
  }
}

/// Numbers the boundary's nodes in column order.
SurfaceMesh number_faces(const ColumnMesh& mesh, const FaceLists& faces) {
  const std::size_t n = mesh.stride();
  constexpr std::int32_t unused = -1;
  std::vector<std::int32_t> number(mesh.vertex_count() * n, unused);
  const auto slot = [&](const Node& node) {
    return static_cast<std::size_t>(node.vertex) * n + static_cast<std::size_t>(node.layer);
  };
  std::size_t count = 0;
  for (const auto& list : faces.lists) {
    count += list.size();
    for (const Face& face : list)
      for (const Node& node : face.nodes) number[slot(node)] = 0;
  }
  SurfaceMesh surface;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] == unused) continue;
    number[i] = static_cast<std::int32_t>(surface.points.size());
    const Point2 p = mesh.ground.vertices[i / n];
    surface.points.push_back({p.x, p.y, mesh.z[i]});
  }
  surface.triangles.reserve(count);
  surface.patch.reserve(count);
  surface.building.reserve(count);
  for (std::size_t i = 0; i < faces.lists.size(); ++i) {
    for (const Face& face : faces.lists[i]) {
      surface.triangles.push_back(
          {number[slot(face.nodes[0])], number[slot(face.nodes[1])], number[slot(face.nodes[2])]});
      surface.patch.push_back(static_cast<Patch>(i + 1));
      surface.building.push_back(face.building);
    }
  }
  return surface;
}

}  // namespace

std::string_view patch_name(Patch patch) { return kNames[static_cast<std::size_t>(patch) - 1]; }

SurfaceMesh extract_boundary(const ColumnMesh& mesh, const Bounds2& domain) {
  FaceLists faces;
  add_floor_and_top(mesh, faces);
  add_sides(mesh, domain, faces);
  return number_faces(mesh, faces);
}

SurfaceMesh select_patches(const SurfaceMesh& surface, std::span<const Patch> patches) {
  constexpr std::int32_t unused = -1;
  std::vector<std::int32_t> number(surface.points.size(), unused);
  SurfaceMesh result;
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    if (std::find(patches.begin(), patches.end(), surface.patch[f]) == patches.end()) continue;
    auto triangle = surface.triangles[f];
    for (auto& v : triangle) {
      auto& renumbered = number[static_cast<std::size_t>(v)];
      if (renumbered == unused) {
        renumbered = static_cast<std::int32_t>(result.points.size());
        result.points.push_back(surface.points[static_cast<std::size_t>(v)]);
      }
      v = renumbered;
    }
    result.triangles.push_back(triangle);
    result.patch.push_back(surface.patch[f]);
    result.building.push_back(surface.building[f]);
  }
  return result;
}

std::array<std::int64_t, kPatchCount> count_by_patch(const SurfaceMesh& surface) {
  std::array<std::int64_t, kPatchCount> counts{};
  for (const Patch patch : surface.patch) ++counts[static_cast<std::size_t>(patch) - 1];
  return counts;
}

SurfaceTopology check_topology(const SurfaceMesh& surface) {
  struct HalfEdge {
    std::int32_t low, high;
    bool forward;
  };
  std::vector<HalfEdge> halves;
  halves.reserve(surface.triangles.size() * 3);
  for (const auto& triangle : surface.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t a = triangle[i], b = triangle[(i + 1) % 3];
      halves.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  parallel_sort(halves.begin(), halves.end(), [](const HalfEdge& a, const HalfEdge& b) {
    if (a.low != b.low) return a.low < b.low;
    if (a.high != b.high) return a.high < b.high;
    return a.forward < b.forward;
  });
  SurfaceTopology result;
  for (std::size_t i = 0, j = 0; i < halves.size(); i = j) {
    while (j < halves.size() && halves[j].low == halves[i].low && halves[j].high == halves[i].high)
      ++j;
    if (j - i == 1)
      ++result.open_edges;
    else if (j - i > 2)
      ++result.non_manifold_edges;
    else if (halves[i].forward == halves[i + 1].forward)
      ++result.misoriented_edges;
  }
  return result;
}

}  // namespace tetropolis
