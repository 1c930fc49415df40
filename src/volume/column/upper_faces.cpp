#include "upper_faces.h"

#include <algorithm>
#include <tuple>

#include "core/infinity.h"
#include "core/parallel.h"
#include "core/parallel_sort.h"
#include "upper_fans.h"

namespace tetropolis {

namespace {

using Cell = UpperMesh::Cell;

constexpr std::size_t kFansPerChunk = 4096;

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

std::size_t inner_face_chunks(const ColumnMesh& mesh) {
  return (mesh.upper.fans.size() + kFansPerChunk - 1) / kFansPerChunk;
}

void visit_inner_faces(const ColumnMesh& mesh,
                       const std::function<void(std::size_t, const InnerFace&)>& visit) {
  const UpperMesh& upper = mesh.upper;
  if (upper.empty()) return;
  const CellsByTop tops(mesh);
  parallel_chunks(upper.fans.size() - 1, kFansPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      visit_faces_of(upper, tops, f,
                     [&](const InnerFace& face) { visit(begin / kFansPerChunk, face); });
  });
}

double top_of(const ColumnMesh& mesh) {
  double top = -kInfinity;
  for (const VertexIndex v : mesh.ground.vertices.indices())
    top = std::max(top, mesh.z[mesh.top(v)]);
  for (const double z : mesh.upper.z) top = std::max(top, z);
  return top;
}

void visit_outer_faces(const ColumnMesh& mesh,
                       const std::function<void(std::size_t, const UpperMesh::Cell&,
                                                const std::array<UpperPlace, 3>&, bool)>& visit) {
  const UpperMesh& upper = mesh.upper;
  const auto z = [&](UpperPlace p) { return elevation(mesh, upper_node(mesh, p)); };
  const double top = top_of(mesh);
  for (std::size_t f = 0; f + 1 < upper.fans.size(); ++f) {
    const UpperFan &fan = upper.fans[f], &next = upper.fans[f + 1];
    for (std::size_t c = fan.cell; c < next.cell; ++c) {
      const Cell cell = upper.cell(f, c);
      const UpperTriangle places = fan_face(cell, FanFace::kTop);
      if (z(places[2]) == top && z(places[0]) == top && z(places[1]) == top)
        visit(c, cell, places, true);
    }
    if (!fan.up.valid() || upper.others[fan.other] == upper.others[next.other - 1]) continue;
    // Columns at the rim do not end.
    const Cell first = upper.cell(f, fan.cell), last = upper.cell(f, next.cell - 1);
    visit(fan.cell, first, fan_face(first, FanFace::kBefore), false);
    visit(next.cell - 1, last, fan_face(last, FanFace::kAfter), false);
  }
}

std::vector<UpperFace> upper_faces(const ColumnMesh& mesh) {
  std::vector<std::vector<UpperFace>> parts(inner_face_chunks(mesh));
  visit_inner_faces(mesh, [&](std::size_t chunk, const InnerFace& face) {
    const auto cell = [&](std::size_t i) { return static_cast<std::uint32_t>(face.cells[i]); };
    parts[chunk].push_back({cell(0), cell(1), face.places});
  });
  std::vector<UpperFace> faces;
  faces.reserve(2 * mesh.upper.cells());
  for (std::vector<UpperFace>& part : parts) {
    faces.insert(faces.end(), part.begin(), part.end());
    part = {};
  }
  parallel_sort(faces.begin(), faces.end(), [](const UpperFace& a, const UpperFace& b) {
    return std::tie(a.cell, a.neighbour) < std::tie(b.cell, b.neighbour);
  });
  return faces;
}

}  // namespace tetropolis
