#include "internal_faces.h"

#include <algorithm>

namespace tetropolis {

namespace {

/// The triangle that shares the vertices a and b with triangle t, or kNoTriangle.
TriangleIndex triangle_across(const ColumnMesh& mesh, TriangleIndex t, VertexIndex a,
                              VertexIndex b) {
  const std::array<VertexIndex, 2> ends{std::min(a, b), std::max(a, b)};
  for (const EdgeIndex e : mesh.edges.of_triangle[t]) {
    if (mesh.edges.vertices[e] != ends) continue;
    const auto& pair = mesh.edges.triangles[e];
    return pair[0] == t ? pair[1] : pair[0];
  }
  return kNoTriangle;
}

}  // namespace

void InternalFaces::look_beyond(TriangleIndex t, std::size_t i) {
  const auto& own = mesh_.ground.triangles[t];
  const std::array<VertexIndex, 2> ends{own[i], own[(i + 1) % 3]};
  Beyond& beyond = beyond_[i];
  const TriangleIndex o = triangle_across(mesh_, t, ends[0], ends[1]);
  beyond.exists = o > t;
  if (!beyond.exists) return;
  const auto& corners = mesh_.ground.triangles[o];
  std::array<std::size_t, 3> end_of_corner{2, 2, 2};  // 2: the corner off the edge
  for (std::size_t e = 0; e < 2; ++e) {
    beyond.from[e] = mesh_.floor_over(o, ends[e]);
    beyond.behind[e].clear();
    end_of_corner[static_cast<std::size_t>(std::find(corners.begin(), corners.end(), ends[e]) -
                                           corners.begin())] = e;
  }
  CellIndex cell = cells_[o];
  Climb<3> front = climb_triangle(mesh_, o);
  for (std::size_t c; (c = front.next()) < 3; front.advance(c), ++cell)
    if (end_of_corner[c] < 2) beyond.behind[end_of_corner[c]].push_back(cell);
}

const std::vector<InternalFace>& InternalFaces::owned_over(TriangleIndex t) {
  if (mesh_.layers.whole) return faces_;
  for (std::size_t i = 0; i < 3; ++i) look_beyond(t, i);
  faces_.clear();
  CellIndex cell = cells_[t];
  Climb<3> front = climb_triangle(mesh_, t);
  for (std::size_t c; (c = front.next()) < 3; ++cell) {
    const NodeIndex low = front.at(c), high = low + 1;
    const bool is_lowest = cell == cells_[t];
    const auto floor = front.at();
    const std::size_t next = (c + 1) % 3, previous = (c + 2) % 3;
    const NodeIndex at_next = front.at(next), at_previous = front.at(previous);
    front.advance(c);
    if (cell + 1 < cells_[t + 1]) faces_.push_back({cell, cell + 1, front.at()});
    const auto begin = faces_.size();
    // The corners run counter-clockwise, so the stack is to the left of c -> next.
    const auto add = [&](const Beyond& beyond, std::size_t end,
                         const std::array<NodeIndex, 3>& nodes) {
      if (beyond.exists && low >= beyond.from[end])
        faces_.push_back(
            {cell, beyond.behind[end][static_cast<std::size_t>(low - beyond.from[end])], nodes});
    };
    add(beyond_[c], 0, {low, at_next, high});
    add(beyond_[previous], 1, {low, high, at_previous});
    if (faces_.size() == begin + 2 && faces_[begin].neighbour > faces_[begin + 1].neighbour)
      std::swap(faces_[begin], faces_[begin + 1]);
    if (is_lowest && mesh_.has_layers(t))
      faces_.push_back({cell,
                        cells_.back() + (mesh_.layers.offsets[t + 1] - 1),
                        {floor[0], floor[2], floor[1]}});
  }
  if (mesh_.is_covered(t)) faces_.push_back({cell - 1, mesh_.upper.over_lid[t], front.at()});
  return faces_;
}

}  // namespace tetropolis
