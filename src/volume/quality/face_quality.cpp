#include "tetropolis/volume/quality/face_quality.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "faces_of.h"
#include "tet_cosines.h"
#include "volume/column/upper_faces.h"

namespace tetropolis {

namespace {

void raise_to(double& greatest, double value) { greatest = std::max(greatest, value); }

class Collector {
 public:
  void add(const std::array<Point3, 3>& face, const Point3& c0, const Point3& c1) {
    const FaceShape shape = face_shape(face, c0, c1);
    ++quality_.faces;
    if (shape.non_orthogonality_deg > kMostNonOrthogonal) ++quality_.above_70;
    raise_to(quality_.worst.non_orthogonality_deg, shape.non_orthogonality_deg);
    raise_to(quality_.worst.skewness, shape.skewness);
  }
  void add_boundary(const std::array<Point3, 3>& face, const Point3& cell_centre) {
    raise_to(quality_.worst.skewness, boundary_skewness(face, cell_centre));
  }
  const FaceQuality& quality() const { return quality_; }

 private:
  FaceQuality quality_;
};

/// Faces over edge a-b of triangle t on the boundary: those below the nodes `end` of its columns.
void add_faces_on_boundary(const ColumnMesh& mesh, TriangleIndex t, VertexIndex a, VertexIndex b,
                           const std::array<NodeIndex, 2>& end, Collector& faces) {
  std::array<VertexIndex, 3> v{a, b, {}};
  for (const VertexIndex corner : mesh.ground.triangles[t])
    if (corner != a && corner != b) v[2] = corner;
  Climb<3> front(mesh, v, {mesh.floor_over(t, a), mesh.floor_over(t, b), mesh.floor_over(t, v[2])});
  std::array<Point3, 3> p;
  for (std::size_t i = 0; i < 3; ++i) p[i] = position(mesh, v[i], front.at(i));
  while (front.at(0) < end[0] || front.at(1) < end[1]) {
    const std::size_t c = front.next();
    const Point3 apex = position(mesh, v[c], front.at(c) + 1);
    if (c < 2) faces.add_boundary({p[0], p[1], apex}, centre_of({p[0], p[1], apex, p[2]}));
    p[c] = apex;
    front.advance(c);
  }
}

}  // namespace

FaceShape face_shape(const std::array<Point3, 3>& face, const Point3& c0, const Point3& c1) {
  const Point3 n = cross(minus(face[1], face[0]), minus(face[2], face[0]));
  const Point3 d = minus(c1, c0);
  const double n_d = dot(n, d), length = std::sqrt(dot(d, d));
  FaceShape shape;
  shape.non_orthogonality_deg = angle_deg(std::abs(n_d) / (std::sqrt(dot(n, n)) * length));
  Point3 centre{}, skew{};
  for (std::size_t c = 0; c < 3; ++c) centre[c] = (face[0][c] + face[1][c] + face[2][c]) / 3;
  const Point3 to_centre = minus(centre, c0);
  const double share = dot(n, to_centre) / n_d;
  for (std::size_t c = 0; c < 3; ++c) skew[c] = to_centre[c] - share * d[c];
  const double distance = std::sqrt(dot(skew, skew));
  double extent = 0.2 * length;
  if (distance > 0)
    for (const Point3& corner : face)
      extent = std::max(extent, std::abs(dot(skew, minus(corner, centre))) / distance);
  shape.skewness = distance / extent;
  return shape;
}

double boundary_skewness(const std::array<Point3, 3>& face, const Point3& cell_centre) {
  const Point3 n = cross(minus(face[1], face[0]), minus(face[2], face[0]));
  Point3 centre{}, skew{};
  for (std::size_t c = 0; c < 3; ++c) centre[c] = (face[0][c] + face[1][c] + face[2][c]) / 3;
  const Point3 to_centre = minus(centre, cell_centre);
  const double share = dot(n, to_centre) / dot(n, n);
  for (std::size_t c = 0; c < 3; ++c) skew[c] = to_centre[c] - share * n[c];
  const double distance = std::sqrt(dot(skew, skew));
  double extent = 0.4 * std::abs(share) * std::sqrt(dot(n, n));
  if (distance > 0)
    for (const Point3& corner : face)
      extent = std::max(extent, std::abs(dot(skew, minus(corner, centre))) / distance);
  return distance / extent;
}

FaceQuality faces_over(const ColumnMesh& mesh, TriangleIndex t) {
  Collector faces;
  const auto& v = mesh.ground.triangles[t];
  Climb<3> front = climb_triangle(mesh, t);
  std::array<Point3, 3> face;
  for (std::size_t i = 0; i < 3; ++i) face[i] = position(mesh, v[i], front.at(i));
  Point3 below{};
  bool is_lowest = true;
  for (std::size_t c; (c = front.next()) < 3; front.advance(c)) {
    const Point3 apex = position(mesh, v[c], front.at(c) + 1);
    const Point3 centre = centre_of({face[0], face[1], face[2], apex});
    if (!std::exchange(is_lowest, false)) faces.add(face, below, centre);
    below = centre;
    face[c] = apex;
  }
  return faces.quality();
}

double skewness_at_ends(const ColumnMesh& mesh, TriangleIndex t) {
  const auto& v = mesh.ground.triangles[t];
  const auto face_at = [&](const auto& node_at) {
    std::array<Point3, 3> face;
    for (std::size_t i = 0; i < 3; ++i) face[i] = position(mesh, v[i], node_at(i));
    return face;
  };
  double skewness = 0;
  if (!mesh.has_layers(t)) {
    const Climb<3> front = climb_triangle(mesh, t);
    const std::size_t c = front.next();
    const std::array<Point3, 3> floor = face_at([&](std::size_t i) { return front.at(i); });
    const Point3 apex = position(mesh, v[c], front.at(c) + 1);
    raise_to(skewness, boundary_skewness(floor, centre_of({floor[0], floor[1], floor[2], apex})));
  }
  if (!mesh.is_covered(t))
    raise_to(skewness, boundary_skewness(face_at([&](std::size_t i) { return mesh.top(v[i]); }),
                                         centre_of(uppermost_cell(mesh, t))));
  return skewness;
}

FaceQuality faces_beside(const ColumnMesh& mesh, EdgeIndex e) {
  Collector faces;
  const std::array<TriangleIndex, 2>& sides = mesh.edges.triangles[e];
  const auto [a, b] = mesh.edges.vertices[e];
  if (sides[1] == kNoTriangle) {
    add_faces_on_boundary(mesh, sides[0], a, b, {mesh.top(a), mesh.top(b)}, faces);
    return faces.quality();
  }
  std::array<VertexIndex, 4> v{a, b, {}, {}};
  std::array<NodeIndex, 4> from{};
  for (std::size_t s = 0; s < 2; ++s)
    for (const VertexIndex corner : mesh.ground.triangles[sides[s]])
      if (corner != a && corner != b) {
        v[2 + s] = corner;
        from[2 + s] = mesh.floor_over(sides[s], corner);
      }
  // Under a roof there are cells on one side only: the front climbs that side up to the roof first,
  // where the columns of the edge begin.
  for (std::size_t i = 0; i < 2; ++i)
    from[i] = std::max(mesh.floor_over(sides[0], v[i]), mesh.floor_over(sides[1], v[i]));
  for (const TriangleIndex t : sides)
    add_faces_on_boundary(mesh, t, a, b, {from[0], from[1]}, faces);
  Climb<4> front(mesh, v, from);
  std::array<Point3, 4> p;
  for (std::size_t i = 0; i < 4; ++i) p[i] = position(mesh, v[i], front.at(i));
  for (std::size_t c; (c = front.next()) < 4; front.advance(c)) {
    const Point3 apex = position(mesh, v[c], front.at(c) + 1);
    if (c < 2)
      faces.add({p[0], p[1], apex}, centre_of({p[0], p[1], apex, p[2]}),
                centre_of({p[0], p[1], apex, p[3]}));
    p[c] = apex;
  }
  return faces.quality();
}

}  // namespace tetropolis
