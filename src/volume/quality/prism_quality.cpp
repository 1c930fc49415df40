#include "tetropolis/volume/quality/prism_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "tetropolis/volume/quality/face_quality.h"

#include "core/infinity.h"
#include "core/parallel.h"
#include "core/units.h"
#include "prism_shape.h"
#include "tet_cosines.h"

namespace tetropolis {

namespace {

constexpr std::size_t kStacksPerChunk = 1024;

double least_height(const Prism& prism) {
  double least = kInfinity;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& side = prism.faces[2 + i].corners;
    least = std::min(least, side[3][2] - side[0][2]);
  }
  return least;
}

/// As in primitiveMeshTools::cellClosedness.
double aspect_ratio(const Prism& prism) {
  Point3 sum{};
  for (const PrismFace& face : prism.faces)
    for (std::size_t c = 0; c < 3; ++c) sum[c] += std::abs(face.area[c]);
  const auto [least, most] = std::minmax({sum[0], sum[1], sum[2]});
  const double of_surface = (sum[0] + sum[1] + sum[2]) / (6 * std::pow(prism.volume, 2.0 / 3));
  return std::max(most / least, of_surface);
}

struct Sums {
  PrismQuality quality;
  double cosines = 0, least_cosine = 1;

  void add(const Prism& prism) {
    ++quality.cells;
    quality.volume += prism.volume;
    quality.least_height = std::min(quality.least_height, least_height(prism));
    quality.max_aspect_ratio = std::max(quality.max_aspect_ratio, aspect_ratio(prism));
    for (const PrismFace& face : prism.faces)
      quality.least_flatness = std::min(quality.least_flatness, face.flatness);
  }
  /// Between the cells with these centres; the face's area leaves the first.
  void add_inner(const PrismFace& face, const Point3& from, const Point3& to) {
    static const double cosine_of_70 = std::cos(to_radians(kMostNonOrthogonal));
    const double cosine = cosine_across(face, from, to);
    ++quality.faces;
    quality.above_70 += cosine < cosine_of_70 ? 1 : 0;
    cosines += cosine;
    least_cosine = std::min(least_cosine, cosine);
    quality.max_skewness = std::max(quality.max_skewness, skewness_across(face, from, to));
  }
  void add_outer(const PrismFace& face, const Point3& from) {
    quality.max_skewness = std::max(quality.max_skewness, skewness_at_boundary(face, from));
  }
};

Sums added(Sums a, const Sums& b) {
  PrismQuality& sum = a.quality;
  const PrismQuality& more = b.quality;
  sum.cells += more.cells;
  sum.volume += more.volume;
  sum.least_height = std::min(sum.least_height, more.least_height);
  sum.faces += more.faces;
  sum.above_70 += more.above_70;
  sum.max_skewness = std::max(sum.max_skewness, more.max_skewness);
  sum.max_aspect_ratio = std::max(sum.max_aspect_ratio, more.max_aspect_ratio);
  sum.least_flatness = std::min(sum.least_flatness, more.least_flatness);
  a.cosines += b.cosines;
  a.least_cosine = std::min(a.least_cosine, b.least_cosine);
  return a;
}

/// The centre of the lowest tet over triangle t.
Point3 lowest_tet(const ColumnMesh& mesh, TriangleIndex t) {
  const Climb<3> front = climb_triangle(mesh, t);
  const std::size_t c = front.next();
  std::array<Point3, 4> p{};
  for (std::size_t i = 0; i < 3; ++i)
    p[i] = position(mesh, mesh.ground.triangles[t][i], front.at(i));
  p[3] = position(mesh, mesh.ground.triangles[t][c], front.at(c) + 1);
  return centre_of(p);
}

void add_over(const ColumnMesh& mesh, TriangleIndex t, Sums& sums) {
  const PrismSurroundings around(mesh, t);
  const PrismStack& stack = around.stack();
  if (stack.count() == 0) return;
  Prism prism = stack.prism(0);
  sums.add_outer(prism.faces[0], prism.centre);
  for (std::int32_t k = 0; k < stack.count(); ++k) {
    sums.add(prism);
    for (std::size_t i = 0; i < 3; ++i) {
      if (!around.has_beyond(i, k))
        sums.add_outer(prism.faces[2 + i], prism.centre);
      else if (around.triangle_beyond(i) > t)
        sums.add_inner(prism.faces[2 + i], prism.centre, around.centre_beyond(i, k));
    }
    if (k + 1 == stack.count()) {
      if (mesh.layers.whole)
        sums.add_outer(prism.faces[1], prism.centre);
      else
        sums.add_inner(prism.faces[1], prism.centre, lowest_tet(mesh, t));
      break;
    }
    const Prism above = stack.prism(k + 1);
    sums.add_inner(prism.faces[1], prism.centre, above.centre);
    prism = above;
  }
}

double share_as_asked(const ColumnMesh& mesh, double first) {
  const PrismLayers& layers = mesh.layers;
  const auto is_as_asked = [&](VertexIndex v) {
    const std::size_t at =
        static_cast<std::size_t>(layers.position[v]) * static_cast<std::size_t>(layers.count);
    const double top = layers.count > 1 ? layers.z[at + 1] : mesh.z[mesh.first[v]];
    return std::abs(top - layers.z[at] - first) <= 1e-3;
  };
  double all = 0, as_asked = 0;
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    if (!mesh.has_layers(t)) continue;
    const auto& v = mesh.ground.triangles[t];
    const Point2 a = mesh.ground.vertices[v[0]], b = mesh.ground.vertices[v[1]];
    const Point2 c = mesh.ground.vertices[v[2]];
    const double area = ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
    all += area;
    for (const VertexIndex u : v) as_asked += is_as_asked(u) ? area / 3 : 0;
  }
  return all > 0 ? as_asked / all : 0;
}

}  // namespace

PrismQuality measure_prisms(const ColumnMesh& mesh, double first) {
  const PrismLayers& layers = mesh.layers;
  if (layers.cells() == 0) return {};
  Sums none;
  none.quality.least_height = kInfinity;
  const Sums sums = parallel_reduce_ordered(
      mesh.triangle_count(), kStacksPerChunk, none,
      [&](std::size_t begin, std::size_t end) {
        Sums part = none;
        for (const TriangleIndex t : indices<TriangleIndex>(begin, end)) add_over(mesh, t, part);
        return part;
      },
      added);
  PrismQuality quality = sums.quality;
  quality.max_non_orthogonality_deg = angle_deg(sums.least_cosine);
  quality.mean_non_orthogonality_deg = angle_deg(sums.cosines / static_cast<double>(quality.faces));
  quality.share_as_asked = share_as_asked(mesh, first);
  return quality;
}

}  // namespace tetropolis
