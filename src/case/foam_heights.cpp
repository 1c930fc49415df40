#include "foam_heights.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "geometry/vec3.h"

namespace tetropolis {

namespace {

struct PlaceHash {
  std::size_t operator()(const std::pair<double, double>& place) const {
    const std::hash<double> hash;
    return hash(place.first) * 1000003U ^ hash(place.second);
  }
};

}  // namespace

std::vector<double> floors_below(const std::vector<Point3>& points) {
  std::unordered_map<std::pair<double, double>, double, PlaceHash> lowest;
  for (const Point3& p : points) {
    const auto [entry, is_new] = lowest.try_emplace({p[0], p[1]}, p[2]);
    if (!is_new) entry->second = std::min(entry->second, p[2]);
  }
  std::vector<double> floors(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    floors[i] = lowest.at({points[i][0], points[i][1]});
  return floors;
}

double height_above_floor(const FoamMesh& mesh, const std::vector<double>& floors, std::size_t f,
                          const Point3& at) {
  const auto corners = mesh.face(f);
  const Point3& a = mesh.point(corners[0]);
  std::int32_t far = corners[0];
  double most = 0;
  for (const std::int32_t p : corners) {
    const double d = std::hypot(mesh.point(p)[0] - a[0], mesh.point(p)[1] - a[1]);
    if (d > most) {
      most = d;
      far = p;
    }
  }
  const double from = floors[static_cast<std::size_t>(corners[0])];
  if (most == 0) return at[2] - from;
  const Point3& b = mesh.point(far);
  const double t =
      ((at[0] - a[0]) * (b[0] - a[0]) + (at[1] - a[1]) * (b[1] - a[1])) / (most * most);
  return at[2] - (from + t * (floors[static_cast<std::size_t>(far)] - from));
}

std::vector<double> heights_of_cells(const FoamMesh& mesh, const std::vector<double>& floors) {
  std::vector<double> sum(mesh.cells(), 0);
  std::vector<std::int32_t> count(mesh.cells(), 0);
  for (std::size_t f = 0; f < mesh.faces(); ++f)
    for (const std::int32_t p : mesh.face(f)) {
      const auto i = static_cast<std::size_t>(p);
      const auto add = [&](std::int32_t cell) {
        sum[static_cast<std::size_t>(cell)] += mesh.points[i][2] - floors[i];
        ++count[static_cast<std::size_t>(cell)];
      };
      add(mesh.owner[f]);
      if (f < mesh.neighbour.size()) add(mesh.neighbour[f]);
    }
  for (std::size_t c = 0; c < sum.size(); ++c) sum[c] /= std::max(count[c], 1);
  return sum;
}

std::unordered_map<std::int32_t, double> heights_on(const FoamMesh& mesh,
                                                    std::span<const std::size_t> faces) {
  struct Plane {
    Point3 point{};
    Point3 area{};
    double size = 0;
  };
  std::unordered_map<std::int32_t, Plane> planes;
  std::unordered_map<std::int32_t, double> heights;
  for (const std::size_t f : faces) {
    const FaceGeometry face = face_geometry(mesh, f);
    if (const double size = length(face.area); size > 0)
      planes[mesh.owner[f]] = {face.centre, face.area, size};
  }
  const auto look = [&](std::int32_t cell, std::size_t f) {
    const auto found = planes.find(cell);
    if (found == planes.end()) return;
    double& height = heights[cell];
    const Plane& plane = found->second;
    for (const std::int32_t p : mesh.face(f))  // normals leave the cell
      height = std::max(height, -dot(minus(mesh.point(p), plane.point), plane.area) / plane.size);
  };
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    look(mesh.owner[f], f);
    if (f < mesh.neighbour.size()) look(mesh.neighbour[f], f);
  }
  return heights;
}

}  // namespace tetropolis
