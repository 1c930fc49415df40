#include "upper_faces.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/infinity.h"
#include "core/parallel.h"

namespace tetropolis {

namespace {

/// The faces of a cell, their normals outwards.
constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{
    {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};

using Cell = std::array<NodeIndex, 4>;
using Nodes = std::array<NodeIndex, 3>;

constexpr std::size_t kPlacesPerChunk = 16384;

Nodes nodes_of(const Cell& cell, std::size_t face) {
  const auto& corner = kFaces[face];
  return {cell[corner[0]], cell[corner[1]], cell[corner[2]]};
}

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

UpperNodes::UpperNodes(const ColumnMesh& mesh) : mesh_(mesh) {
  const auto nodes = static_cast<std::size_t>(mesh.column_nodes());
  VertexIndex v(0);
  for (std::size_t n = 0; n < nodes; n += kBlock) {
    while (mesh.first[v + 1] <= NodeIndex(n)) ++v;
    first_of_block_.push_back(v);
  }
}

std::size_t inner_face_chunks(const ColumnMesh& mesh) {
  const std::size_t places = mesh.vertex_count() + mesh.upper.points.size();
  return (places + kPlacesPerChunk - 1) / kPlacesPerChunk;
}

void visit_inner_faces(
    const ColumnMesh& mesh,
    const std::function<void(std::size_t, std::span<const UpperFaces::Inner>)>& visit) {
  const auto& cells = mesh.upper.cells;
  const CellIndex first = CellIndex(cell_offsets(mesh)[mesh.triangle_count()]);
  const UpperNodes at(mesh);
  // A face is looked for at its highest node: three of a cell at that of the cell, and the one
  // without it at the second.
  const auto two_highest = [](const Cell& cell) {
    NodeIndex highest = std::max(cell[0], cell[1]), second = std::min(cell[0], cell[1]);
    for (const NodeIndex n : {cell[2], cell[3]}) {
      if (n > highest)
        second = std::exchange(highest, n);
      else if (n > second)
        second = n;
    }
    return std::array{highest, second};
  };
  std::vector<std::uint32_t> begin(at.places() + 1, 0);
  for (const Cell& cell : cells)
    for (const NodeIndex n : two_highest(cell)) ++begin[at.place(n)];
  std::inclusive_scan(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> cells_at(2 * cells.size());
  for (std::size_t c = cells.size(); c-- > 0;)
    for (const NodeIndex n : two_highest(cells[c]))
      cells_at[--begin[at.place(n)]] = static_cast<std::uint32_t>(c);

  struct Half {
    std::array<NodeIndex, 2> others;  // than the highest node, in ascending order
    std::uint32_t cell;
    std::uint32_t face;
  };
  parallel_chunks(at.places(), kPlacesPerChunk, [&](std::size_t place, std::size_t end) {
    const std::size_t chunk = place / kPlacesPerChunk;
    std::vector<Half> halves;
    std::vector<UpperFaces::Inner> faces;
    for (; place < end; ++place) {
      halves.clear();
      for (std::uint32_t i = begin[place]; i < begin[place + 1]; ++i) {
        const Cell& cell = cells[cells_at[i]];
        const auto [highest, second] = two_highest(cell);
        const NodeIndex here = at.place(highest) == place ? highest : second;
        for (std::uint32_t f = 0; f < 4; ++f) {
          const Nodes n = nodes_of(cell, f);
          const bool has_highest = n[0] == highest || n[1] == highest || n[2] == highest;
          if (has_highest != (here == highest)) continue;
          const auto [a, b] = n[0] == here   ? std::minmax(n[1], n[2])
                              : n[1] == here ? std::minmax(n[0], n[2])
                                             : std::minmax(n[0], n[1]);
          halves.push_back({{a, b}, cells_at[i], f});
        }
      }
      std::sort(halves.begin(), halves.end(), [](const Half& a, const Half& b) {
        return std::tie(a.others, a.cell) < std::tie(b.others, b.cell);
      });
      for (std::size_t i = 0; i + 1 < halves.size(); ++i) {
        const Half &half = halves[i], &next = halves[i + 1];
        if (half.others != next.others) continue;
        UpperFaces::Inner face;
        face.cell = first + half.cell;
        face.nodes = nodes_of(cells[half.cell], half.face);
        face.neighbour = first + next.cell;
        faces.push_back(face);
        ++i;
      }
    }
    visit(chunk, faces);
  });
}

void visit_outer_faces(const ColumnMesh& mesh,
                       const std::function<void(const UpperFace&, bool)>& visit) {
  const auto& cells = mesh.upper.cells;
  const CellIndex first = CellIndex(cell_offsets(mesh)[mesh.triangle_count()]);
  const UpperNodes at(mesh);
  std::vector<std::uint8_t> is_at_rim(mesh.vertex_count(), 0);
  for (const EdgeIndex e : mesh.edges.vertices.indices())
    if (mesh.edges.triangles[e][1] == kNoTriangle)
      for (const VertexIndex v : mesh.edges.vertices[e]) is_at_rim[v] = 1;
  double top = -kInfinity;
  for (const Point3& p : mesh.upper.points) top = std::max(top, p[2]);
  for (const VertexIndex v : mesh.ground.vertices.indices())
    top = std::max(top, mesh.z[mesh.top(v)]);
  const auto is_at_top = [&](NodeIndex n) {
    return (n < mesh.column_nodes() ? mesh.z[n] : at[n][2]) == top;
  };
  // Over the rim there are faces between cells, too.
  struct AtRim {
    Nodes sorted;
    UpperFace face;
  };
  std::vector<AtRim> rim;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    std::array<bool, 4> tops{}, rims{};
    for (std::size_t i = 0; i < 4; ++i) {
      tops[i] = is_at_top(cells[c][i]);
      rims[i] = is_at_rim[at.vertex(cells[c][i])] != 0;
    }
    for (std::size_t f = 0; f < 4; ++f) {
      const auto& corner = kFaces[f];
      const auto all = [&](const std::array<bool, 4>& is) {
        return is[corner[0]] && is[corner[1]] && is[corner[2]];
      };
      const UpperFace face{first + c, nodes_of(cells[c], f)};
      if (all(tops))
        visit(face, true);
      else if (all(rims))
        rim.push_back({sorted(face.nodes), face});
    }
  }
  std::sort(rim.begin(), rim.end(), [](const AtRim& a, const AtRim& b) {
    return std::tie(a.sorted, a.face.cell) < std::tie(b.sorted, b.face.cell);
  });
  for (std::size_t i = 0; i < rim.size(); ++i) {
    if (i + 1 < rim.size() && rim[i + 1].sorted == rim[i].sorted)
      ++i;
    else if (area_in_plan(mesh, at, rim[i].face.nodes) == 0)  // else it is on the lid
      visit(rim[i].face, false);
  }
}

UpperFaces upper_faces(const ColumnMesh& mesh, bool with_inner) {
  UpperFaces faces;
  if (with_inner) {
    std::vector<std::vector<UpperFaces::Inner>> parts(inner_face_chunks(mesh));
    visit_inner_faces(mesh, [&](std::size_t chunk, std::span<const UpperFaces::Inner> inner) {
      parts[chunk].assign(inner.begin(), inner.end());
    });
    faces.inner.reserve(2 * mesh.upper.cells.size());
    for (std::vector<UpperFaces::Inner>& part : parts) {
      faces.inner.insert(faces.inner.end(), part.begin(), part.end());
      part = {};
    }
    parallel_sort(faces.inner.begin(), faces.inner.end(), [](const auto& a, const auto& b) {
      return std::tie(a.cell, a.neighbour) < std::tie(b.cell, b.neighbour);
    });
  }
  visit_outer_faces(mesh, [&](const UpperFace& face, bool is_top) {
    (is_top ? faces.top : faces.sides).push_back(face);
  });
  const auto by_cell = [](const UpperFace& a, const UpperFace& b) {
    return std::tie(a.cell, a.nodes) < std::tie(b.cell, b.nodes);
  };
  std::sort(faces.top.begin(), faces.top.end(), by_cell);
  std::sort(faces.sides.begin(), faces.sides.end(), by_cell);
  return faces;
}

}  // namespace tetropolis
