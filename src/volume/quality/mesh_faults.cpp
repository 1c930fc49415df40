#include "mesh_faults.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/sort_once.h"
#include "core/units.h"
#include "shapes_over.h"

namespace tetropolis {

namespace {

template <typename Work>
void for_each(std::size_t size, const Work& work) {
  parallel_chunks(size, grain_of_chunks(size), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) work(i);
  });
}

/// The cosines of the bounds' angles.
struct CosineBounds {
  double of_least, of_greatest;
};

const std::array<CosineBounds, kAskedBounds.size()>& cosine_bounds() {
  static const auto bounds = [] {
    std::array<CosineBounds, kAskedBounds.size()> cosines{};
    for (std::size_t i = 0; i < cosines.size(); ++i)
      cosines[i] = {std::cos(to_radians(kAskedBounds[i].least)),
                    std::cos(to_radians(kAskedBounds[i].greatest))};
    return cosines;
  }();
  return bounds;
}

}  // namespace

MeshFaults::Stack MeshFaults::look_at(const ColumnMesh& mesh, std::size_t t) {
  const auto& bounds = cosine_bounds();
  const double thin = bounds[static_cast<std::size_t>(Asked::kOfMost)].of_least;
  Stack stack;
  for_each_shape_over(mesh, t, [&](const auto&, const auto&, const TetCosines& shape) {
    ++stack.cells;
    stack.thin += shape.greatest > thin ? 1 : 0;
    for (std::size_t i = 0; i < bounds.size(); ++i)
      stack.outside[i] +=
          shape.greatest > bounds[i].of_least || shape.least < bounds[i].of_greatest ? 1 : 0;
  });
  stack.steep = steep_faces_over(mesh, t);
  return stack;
}

MeshFaults::MeshFaults(const ColumnMesh& mesh)
    : stacks_(mesh.triangle_count()), beside_(mesh.edges.size()) {
  for_each(stacks_.size(), [&](std::size_t t) { stacks_[t] = look_at(mesh, t); });
  for_each(beside_.size(), [&](std::size_t e) { beside_[e] = steep_faces_beside(mesh, e); });
}

void MeshFaults::look_again(const ColumnMesh& mesh, std::span<const VertexIndex> columns) {
  const std::vector<TriangleIndex> triangles = triangles_around(mesh.edges, columns);
  std::vector<EdgeIndex> edges;
  for (const TriangleIndex t : triangles) {
    const auto& own = mesh.edges.of_triangle[static_cast<std::size_t>(t)];
    edges.insert(edges.end(), own.begin(), own.end());
  }
  sort_once(edges);
  for_each(triangles.size(), [&](std::size_t i) {
    const auto t = static_cast<std::size_t>(triangles[i]);
    stacks_[t] = look_at(mesh, t);
  });
  for_each(edges.size(), [&](std::size_t i) {
    const auto e = static_cast<std::size_t>(edges[i]);
    beside_[e] = steep_faces_beside(mesh, e);
  });
}

FaultCounts MeshFaults::counts() const {
  FaultCounts counts;
  const auto add = [&](const SteepFaces& faces) {
    counts.steep_faces += faces.count;
    counts.worst_face_deg = std::max(counts.worst_face_deg, static_cast<double>(faces.worst_deg));
  };
  for (const Stack& stack : stacks_) {
    counts.cells += stack.cells;
    counts.thin += stack.thin;
    for (std::size_t i = 0; i < kAskedBounds.size(); ++i) {
      counts.outside[i] += stack.outside[i];
      counts.triangles[i] += stack.outside[i] > 0 ? 1 : 0;
    }
    add(stack.steep);
  }
  for (const SteepFaces& faces : beside_) add(faces);
  return counts;
}

std::vector<std::uint8_t> MeshFaults::steep_triangles(const ColumnMesh& mesh) const {
  std::vector<std::uint8_t> steep(stacks_.size());
  for (std::size_t t = 0; t < steep.size(); ++t) steep[t] = stacks_[t].steep.count > 0 ? 1 : 0;
  for (std::size_t e = 0; e < beside_.size(); ++e)
    if (beside_[e].count > 0)
      for (const TriangleIndex t : mesh.edges.triangles[e])
        if (t != kNoTriangle) steep[static_cast<std::size_t>(t)] = 1;
  return steep;
}

std::vector<std::uint8_t> MeshFaults::bad_triangles(const ColumnMesh& mesh, Asked asked) const {
  std::vector<std::uint8_t> bad = steep_triangles(mesh);
  for (std::size_t t = 0; t < bad.size(); ++t)
    if (stacks_[t].outside[static_cast<std::size_t>(asked)] > 0) bad[t] = 1;
  return bad;
}

}  // namespace tetropolis
