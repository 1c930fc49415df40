#include "prism_shape.h"

#include <algorithm>
#include <cmath>

#include "core/is_among.h"
#include "geometry/vec3.h"

namespace tetropolis {

namespace {

using Corners = std::array<Point3, 3>;

Point3 plus(const Point3& a, double share, const Point3& b) {
  return {a[0] + share * b[0], a[1] + share * b[1], a[2] + share * b[2]};
}

struct AreaAndCentre {
  Point3 area, centre;
};

AreaAndCentre of_triangle(const Point3& a, const Point3& b, const Point3& c) {
  const Point3 twice = cross(minus(b, a), minus(c, a));
  return {plus({}, 0.5, twice), plus({}, 1.0 / 3, plus(plus(a, 1, b), 1, c))};
}

/// Over the side from corner i to the next: upright.
AreaAndCentre of_side(const Corners& low, const Corners& high, std::size_t i) {
  const Point3 &a = low[i], &b = low[(i + 1) % 3];
  const double above_a = high[i][2], above_b = high[(i + 1) % 3][2];
  const double at_a = above_a - a[2], at_b = above_b - b[2], sum = at_a + at_b;
  const double dx = b[0] - a[0], dy = b[1] - a[1];
  const double share_b = (at_a + 2 * at_b) / (3 * sum);  // of its centre
  const double z = (at_b * (a[2] + b[2] + above_b) + at_a * (a[2] + above_b + above_a)) / (3 * sum);
  return {{dy * sum / 2, -dx * sum / 2, 0}, {a[0] + share_b * dx, a[1] + share_b * dy, z}};
}

/// Of its lower face, its upper one, and its sides.
std::array<AreaAndCentre, 5> faces_of(const Corners& low, const Corners& high) {
  return {of_triangle(low[0], low[2], low[1]), of_triangle(high[0], high[1], high[2]),
          of_side(low, high, 0), of_side(low, high, 1), of_side(low, high, 2)};
}

struct VolumeAndCentre {
  double volume;
  Point3 centre;
};

VolumeAndCentre inside(const std::array<AreaAndCentre, 5>& faces) {
  Point3 guess{}, centre{};
  for (const AreaAndCentre& face : faces) guess = plus(guess, 0.2, face.centre);
  double sum = 0;
  for (const AreaAndCentre& face : faces) {
    const double volume = dot(face.area, minus(face.centre, guess)) / 3;
    sum += volume;
    centre = plus(plus(centre, 0.75 * volume, face.centre), 0.25 * volume, guess);
  }
  return {sum, plus({}, 1 / sum, centre)};
}

/// Of a line that passes by the face's centre at `skew`.
double skewness(const PrismFace& face, const Point3& skew, double least_extent) {
  const double off = length(skew);
  if (!(off > 0)) return 0;
  double extent = least_extent;
  for (std::size_t i = 0; i < face.count; ++i)
    extent = std::max(extent, std::abs(dot(skew, minus(face.corners[i], face.centre))) / off);
  return off / extent;
}

}  // namespace

Prism prism_between(const std::array<Point3, 3>& low, const std::array<Point3, 3>& high) {
  Prism prism;
  const std::array<AreaAndCentre, 5> faces = faces_of(low, high);
  for (std::size_t f = 0; f < 5; ++f) {
    prism.faces[f].area = faces[f].area;
    prism.faces[f].centre = faces[f].centre;
    prism.faces[f].count = f < 2 ? 3 : 4;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const double at_i = high[i][2] - low[i][2], at_j = high[j][2] - low[j][2];
    prism.faces[0].corners[i] = low[(3 - i) % 3];
    prism.faces[1].corners[i] = high[i];
    prism.faces[2 + i].corners = {low[i], low[j], high[j], high[i]};
    prism.faces[2 + i].flatness =
        2 * std::abs(at_i + at_j) / (std::abs(at_i) + std::abs(at_j) + std::abs(at_i + at_j));
  }
  const auto [volume, centre] = inside(faces);
  prism.volume = volume;
  prism.centre = centre;
  return prism;
}

double cosine_across(const PrismFace& face, const Point3& from, const Point3& to) {
  const Point3 line = minus(to, from);
  return dot(face.area, line) / (length(face.area) * length(line));
}

double skewness_across(const PrismFace& face, const Point3& from, const Point3& to) {
  const Point3 line = minus(to, from), to_face = minus(face.centre, from);
  const double share = dot(face.area, to_face) / dot(face.area, line);
  return skewness(face, plus(to_face, -share, line), 0.2 * length(line));
}

double skewness_at_boundary(const PrismFace& face, const Point3& from) {
  const Point3 to_face = minus(face.centre, from);
  const double share = dot(face.area, to_face) / dot(face.area, face.area);
  return skewness(face, plus(to_face, -share, face.area),
                  0.4 * std::abs(share) * length(face.area));
}

PrismStack::PrismStack(const ColumnMesh& mesh, TriangleIndex t)
    : mesh_(&mesh),
      count_(prism_count(mesh, t)),
      layers_(mesh.has_layers(t) ? mesh.layers.count : 0) {
  for (std::size_t i = 0; i < 3; ++i) {
    const VertexIndex v = mesh.ground.triangles[t][i];
    at_[i] = mesh.ground.vertices[v];
    if (layers_ > 0) layer_node_[i] = layer_node(mesh, v, 0);
    floor_[i] = mesh.floor_over(t, v);
  }
}

std::array<Point3, 3> PrismStack::corners(std::int32_t level) const {
  std::array<Point3, 3> corners{};
  for (std::size_t i = 0; i < 3; ++i) {
    const NodeIndex node = level < layers_ ? layer_node_[i] + std::int64_t{level}
                                           : floor_[i] + std::int64_t{level - layers_};
    corners[i] = {at_[i].x, at_[i].y, elevation(*mesh_, node)};
  }
  return corners;
}

Point3 PrismStack::centre(std::int32_t layer) const {
  return inside(faces_of(corners(layer), corners(layer + 1))).centre;
}

PrismSurroundings::PrismSurroundings(const ColumnMesh& mesh, TriangleIndex t) : stack_(mesh, t) {
  const auto& v = mesh.ground.triangles[t];
  for (const EdgeIndex e : mesh.edges.of_triangle[t]) {
    const auto& [one, two] = mesh.edges.triangles[e];
    const TriangleIndex other = one == t ? two : one;
    if (other == kNoTriangle || prism_count(mesh, other) == 0) continue;
    const std::array<VertexIndex, 2>& ends = mesh.edges.vertices[e];
    std::size_t i = 0;
    while (is_among(v[(i + 2) % 3], ends)) ++i;
    beyond_[i] = {other, prisms_above(mesh, t, other, v[i]), PrismStack(mesh, other)};
  }
}

}  // namespace tetropolis
