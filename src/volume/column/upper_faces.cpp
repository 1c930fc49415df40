#include "upper_faces.h"

#include <numeric>
#include <tuple>
#include <utility>

namespace tetropolis {

namespace {

/// The faces of a cell, their normals outwards.
constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{
    {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};

using Nodes = std::array<NodeIndex, 3>;

Nodes sorted(Nodes nodes) {
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

/// Twice the area in plan of a face, > 0 if it is seen from above. Exactly 0 on sides of the
/// domain, where two nodes are over one vertex.
double area_in_plan(const ColumnMesh& mesh, const UpperNodes& at, const Nodes& nodes) {
  std::array<Point2, 3> p;
  for (std::size_t i = 0; i < 3; ++i) p[i] = mesh.ground.vertices[at.vertex(nodes[i])];
  return (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
}

}  // namespace

std::array<Point3, 4> uppermost_cell(const ColumnMesh& mesh, TriangleIndex t) {
  const auto& v = mesh.ground.triangles[t];
  const auto last_key = [&](std::size_t i) {
    return climbing_key(mesh.climbing().data(), mesh.top(v[i]) - 1);
  };
  std::size_t last = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (!climbs_first(last_key(i), v[i], last_key(last), v[last])) last = i;
  std::array<Point3, 4> p{};
  for (std::size_t i = 0; i < 3; ++i) p[i] = position(mesh, v[i], mesh.top(v[i]));
  p[3] = p[last];
  p[last][2] = mesh.z[mesh.top(v[last]) - 1];
  return p;
}

void visit_upper_faces(const ColumnMesh& mesh,
                       const std::function<void(const UpperFaces::Inner&)>& inner,
                       const std::function<void(const UpperFace&, bool is_top)>& outer) {
  const auto& cells = mesh.upper.cells;
  const CellIndex first = CellIndex(cell_offsets(mesh)[mesh.triangle_count()]);
  const auto nodes_of = [&](std::size_t face) {
    const auto& cell = cells[face / 4];
    const auto& corner = kFaces[face % 4];
    return Nodes{cell[corner[0]], cell[corner[1]], cell[corner[2]]};
  };
  // Faces by their highest node; those without a node of the upper part by themselves.
  const auto place = [&](std::size_t face) {
    const Nodes nodes = nodes_of(face);
    const std::int64_t highest = std::max({nodes[0], nodes[1], nodes[2]}).value();
    return static_cast<std::size_t>(std::max<std::int64_t>(highest - mesh.column_nodes() + 1, 0));
  };
  std::vector<std::size_t> end(mesh.upper.points.size() + 1, 0);
  for (std::size_t f = 0; f < 4 * cells.size(); ++f) ++end[place(f)];
  std::exclusive_scan(end.begin(), end.end(), end.begin(), std::size_t{0});
  std::vector<std::size_t> by_place(4 * cells.size());
  for (std::size_t f = 0; f < by_place.size(); ++f) by_place[end[place(f)]++] = f;

  const UpperNodes at(mesh);
  std::vector<std::pair<Nodes, std::size_t>> here;
  std::size_t begin = 0;
  for (const std::size_t last : end) {
    here.clear();
    for (; begin < last; ++begin)
      here.emplace_back(sorted(nodes_of(by_place[begin])), by_place[begin]);
    std::sort(here.begin(), here.end());
    for (std::size_t i = 0; i < here.size(); ++i) {
      const std::size_t f = here[i].second;
      const UpperFace face{first + f / 4, nodes_of(f)};
      if (i + 1 < here.size() && here[i + 1].first == here[i].first) {
        inner({face, first + here[++i].second / 4});
        continue;
      }
      const double area = area_in_plan(mesh, at, face.nodes);
      if (area >= 0) outer(face, area > 0);
    }
  }
}

UpperFaces upper_faces(const ColumnMesh& mesh, bool with_inner) {
  UpperFaces faces;
  if (with_inner) faces.inner.reserve(2 * mesh.upper.cells.size());
  visit_upper_faces(
      mesh,
      [&](const UpperFaces::Inner& face) {
        if (with_inner) faces.inner.push_back(face);
      },
      [&](const UpperFace& face, bool is_top) {
        (is_top ? faces.top : faces.sides).push_back(face);
      });
  const auto by_cell = [](const UpperFace& a, const UpperFace& b) {
    return std::tie(a.cell, a.nodes) < std::tie(b.cell, b.nodes);
  };
  std::sort(faces.inner.begin(), faces.inner.end(), [](const auto& a, const auto& b) {
    return std::tie(a.cell, a.neighbour) < std::tie(b.cell, b.neighbour);
  });
  std::sort(faces.top.begin(), faces.top.end(), by_cell);
  std::sort(faces.sides.begin(), faces.sides.end(), by_cell);
  return faces;
}

}  // namespace tetropolis
