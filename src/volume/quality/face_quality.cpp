#include "tetropolis/volume/quality/face_quality.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/parallel.h"
#include "core/units.h"
#include "tet_cosines.h"

namespace tetropolis {

namespace {

FaceShape worse(const FaceShape& a, const FaceShape& b) {
  return {std::max(a.non_orthogonality_deg, b.non_orthogonality_deg),
          std::max(a.skewness, b.skewness)};
}

FaceQuality combined(const FaceQuality& a, const FaceQuality& b) {
  return {a.faces + b.faces, a.above_70 + b.above_70, worse(a.worst, b.worst)};
}

/// Collects faces. The full measures are taken of those only that may be among the worst or above
/// 70 degrees; the others are told from them without roots.
class FaceCollector {
 public:
  void add(const std::array<Point3, 3>& face, const Point3& c0, const Point3& c1) {
    const Point3 n = cross(minus(face[1], face[0]), minus(face[2], face[0]));
    const Point3 d = minus(c1, c0);
    const double n_d = dot(n, d), d2 = dot(d, d);
    constexpr double third = 1.0 / 3;
    Point3 centre{}, skew{};
    for (std::size_t c = 0; c < 3; ++c) centre[c] = (face[0][c] + face[1][c] + face[2][c]) * third;
    const Point3 to_centre = minus(centre, c0);
    const double share = dot(n, to_centre) / n_d;
    for (std::size_t c = 0; c < 3; ++c) skew[c] = to_centre[c] - share * d[c];
    double extent = 0;  // times the skewness vector's length
    for (const Point3& corner : face)
      extent = std::max(extent, std::abs(dot(skew, minus(corner, centre))));
    const double skew2 = dot(skew, skew);
    const bool ordinary = n_d * n_d > least_cosine2_ * (dot(n, n) * d2) &&
                          (skew2 < skewness_ * extent || skew2 < skewness_ * skewness_ * 0.04 * d2);
    ++quality_.faces;
    if (!ordinary) add_in_full(face_shape(face, c0, c1));
  }
  void add_boundary(const std::array<Point3, 3>& face, const Point3& cell_centre) {
    raise_skewness(boundary_skewness(face, cell_centre));
  }
  const FaceQuality& quality() const { return quality_; }

 private:
  void raise_skewness(double skewness) {
    quality_.worst.skewness = std::max(quality_.worst.skewness, skewness);
    skewness_ = quality_.worst.skewness * (1 - kMargin);
  }
  void add_in_full(const FaceShape& shape) {
    if (shape.non_orthogonality_deg > kMostNonOrthogonal) ++quality_.above_70;
    quality_.worst.non_orthogonality_deg =
        std::max(quality_.worst.non_orthogonality_deg, shape.non_orthogonality_deg);
    const double cosine =
        std::cos(to_radians(std::min(quality_.worst.non_orthogonality_deg, kMostNonOrthogonal)));
    least_cosine2_ = cosine * cosine * (1 + kMargin);
    raise_skewness(shape.skewness);
  }

  static constexpr double kMargin = 1e-9;  // far beyond rounding
  FaceQuality quality_;
  double least_cosine2_ = 2;
  double skewness_ = 0;
};

/// Collects those beyond kMostNonOrthogonal; the others are told from them without roots.
class SteepCollector {
 public:
  void add(const std::array<Point3, 3>& face, const Point3& c0, const Point3& c1) {
    constexpr double kMargin = 1e-9;  // far beyond rounding
    const Point3 n = cross(minus(face[1], face[0]), minus(face[2], face[0]));
    const Point3 d = minus(c1, c0);
    const double n_d = dot(n, d);
    if (n_d * n_d > least_cosine2_ * (1 + kMargin) * (dot(n, n) * dot(d, d))) return;
    const double degrees = face_shape(face, c0, c1).non_orthogonality_deg;
    if (!(degrees > kMostNonOrthogonal)) return;
    ++faces_.count;
    faces_.worst_deg = std::max(faces_.worst_deg, static_cast<float>(degrees));
  }
  void add_boundary(const std::array<Point3, 3>&, const Point3&) {}
  const SteepFaces& faces() const { return faces_; }

 private:
  double least_cosine2_ = std::pow(std::cos(to_radians(kMostNonOrthogonal)), 2);
  SteepFaces faces_;
};

/// Faces between the cells over triangle t, and those at their two ends.
template <typename Faces>
void add_faces_over(const ColumnMesh& mesh, std::size_t t, Faces& faces) {
  const auto& v = mesh.ground.triangles[t];
  Climb<3> front = climb_triangle(mesh, t);
  std::array<Point3, 3> face;
  for (std::size_t i = 0; i < 3; ++i) face[i] = position(mesh, v[i], front.at(i));
  Point3 below{};
  for (bool first = true; true; first = false) {
    const std::size_t c = front.next();
    if (c == 3) {
      if (!first) faces.add_boundary(face, below);
      return;
    }
    const Point3 apex = position(mesh, v[c], front.at(c) + 1);
    const Point3 centre = centre_of({face[0], face[1], face[2], apex});
    if (first)
      faces.add_boundary(face, centre);
    else
      faces.add(face, below, centre);
    below = centre;
    face[c] = apex;
    front.advance(c);
  }
}

/// Faces over edge a-b of triangle t on the boundary: those below the nodes `end` of its columns.
template <typename Faces>
void add_faces_on_boundary(const ColumnMesh& mesh, std::size_t t, VertexIndex a, VertexIndex b,
                           const std::array<NodeIndex, 2>& end, Faces& faces) {
  std::array<VertexIndex, 3> v{a, b, 0};
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

/// Faces over edge e, between the cells on its two sides and, where there are none on one side, on
/// the boundary.
template <typename Faces>
void add_faces_beside(const ColumnMesh& mesh, std::size_t e, Faces& faces) {
  const auto [t0, t1] = mesh.edges.triangles[e];
  const auto [a, b] = mesh.edges.vertices[e];
  if (t1 == kNoTriangle) {
    add_faces_on_boundary(mesh, static_cast<std::size_t>(t0), a, b, {mesh.top(a), mesh.top(b)},
                          faces);
    return;
  }
  const std::array<std::size_t, 2> sides{static_cast<std::size_t>(t0),
                                         static_cast<std::size_t>(t1)};
  std::array<VertexIndex, 4> v{a, b, 0, 0};
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
  for (const std::size_t t : sides) add_faces_on_boundary(mesh, t, a, b, {from[0], from[1]}, faces);
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

FaceQuality measure_faces(const ColumnMesh& mesh) {
  const auto over = [&](std::size_t begin, std::size_t end) {
    FaceCollector faces;
    for (std::size_t t = begin; t < end; ++t) add_faces_over(mesh, t, faces);
    return faces.quality();
  };
  const auto beside = [&](std::size_t begin, std::size_t end) {
    FaceCollector faces;
    for (std::size_t e = begin; e < end; ++e) add_faces_beside(mesh, e, faces);
    return faces.quality();
  };
  const std::size_t triangles = mesh.triangle_count(), edges = mesh.edges.size();
  return combined(
      parallel_reduce_ordered(triangles, grain_of_chunks(triangles), FaceQuality{}, over, combined),
      parallel_reduce_ordered(edges, grain_of_chunks(edges), FaceQuality{}, beside, combined));
}

SteepFaces steep_faces_over(const ColumnMesh& mesh, std::size_t t) {
  SteepCollector steep;
  add_faces_over(mesh, t, steep);
  return steep.faces();
}

SteepFaces steep_faces_beside(const ColumnMesh& mesh, std::size_t e) {
  if (mesh.edges.triangles[e][1] == kNoTriangle) return {};
  SteepCollector steep;
  add_faces_beside(mesh, e, steep);
  return steep.faces();
}

}  // namespace tetropolis
