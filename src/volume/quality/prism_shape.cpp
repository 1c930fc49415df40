#include "prism_shape.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "geometry/vec3.h"

namespace tetropolis {

namespace {

Point3 plus(const Point3& a, double share, const Point3& b) {
  return {a[0] + share * b[0], a[1] + share * b[1], a[2] + share * b[2]};
}

PrismFace face_of(std::span<const Point3> corners) {
  PrismFace face;
  face.count = corners.size();
  Point3 mean{};
  for (const Point3& p : corners) mean = plus(mean, 1 / static_cast<double>(corners.size()), p);
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point3 &a = corners[i], &b = corners[(i + 1) % corners.size()];
    face.corners[i] = a;
    const Point3 twice = cross(minus(b, a), minus(mean, a));
    const double size = length(twice) / 2;
    face.area = plus(face.area, 0.5, twice);
    sum += size;
    for (const Point3& p : {a, b, mean}) face.centre = plus(face.centre, size / 3, p);
  }
  for (double& c : face.centre) c /= sum;
  face.flatness = length(face.area) / sum;
  return face;
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
  prism.faces[0] = face_of(std::array{low[0], low[2], low[1]});
  prism.faces[1] = face_of(high);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    prism.faces[2 + i] = face_of(std::array{low[i], low[j], high[j], high[i]});
  }
  Point3 guess{};
  for (const PrismFace& face : prism.faces) guess = plus(guess, 0.2, face.centre);
  for (const PrismFace& face : prism.faces) {
    const double volume = dot(face.area, minus(face.centre, guess)) / 3;
    prism.volume += volume;
    prism.centre = plus(plus(prism.centre, 0.75 * volume, face.centre), 0.25 * volume, guess);
  }
  for (double& c : prism.centre) c /= prism.volume;
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

Prism prism_at(const ColumnMesh& mesh, TriangleIndex t, std::int32_t layer) {
  const auto& v = mesh.ground.triangles[t];
  const auto z = [&](VertexIndex u, std::int32_t k) {
    return elevation(mesh, prism_node(mesh, t, u, k));
  };
  std::array<Point3, 3> low{}, high{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Point2 p = mesh.ground.vertices[v[i]];
    low[i] = {p.x, p.y, z(v[i], layer)};
    high[i] = {p.x, p.y, z(v[i], layer + 1)};
  }
  return prism_between(low, high);
}

TriangleIndex triangle_beyond(const ColumnMesh& mesh, TriangleIndex t, std::size_t i) {
  const auto& v = mesh.ground.triangles[t];
  const std::array<VertexIndex, 2> ends{std::min(v[i], v[(i + 1) % 3]),
                                        std::max(v[i], v[(i + 1) % 3])};
  for (const EdgeIndex e : mesh.edges.of_triangle[t])
    if (mesh.edges.vertices[e] == ends)
      return mesh.edges.triangles[e][0] == t ? mesh.edges.triangles[e][1]
                                             : mesh.edges.triangles[e][0];
  return kNoTriangle;
}

}  // namespace tetropolis
