#include "sample_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

namespace tetropolis {

namespace {

constexpr std::size_t kMost = 400'000;

using Node = std::pair<std::int64_t, std::int64_t>;  // j, i

/// Calls visit(j, i, z) for the nodes inside a triangle, seen from above.
template <typename Visit>
void for_each_node(const std::array<Point3, 3>& corners, double spacing, const Visit& visit) {
  const Point3 &a = corners[0], &b = corners[1], &c = corners[2];
  const double twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  if (twice == 0) return;
  const auto range = [&](std::size_t k) {
    const auto [low, high] = std::minmax({a[k], b[k], c[k]});
    return std::pair(static_cast<std::int64_t>(std::ceil(low / spacing - 0.5)),
                     static_cast<std::int64_t>(std::floor(high / spacing - 0.5)));
  };
  const std::pair<std::int64_t, std::int64_t> columns = range(0), rows = range(1);
  for (std::int64_t j = rows.first; j <= rows.second; ++j)
    for (std::int64_t i = columns.first; i <= columns.second; ++i) {
      const double x = (static_cast<double>(i) + 0.5) * spacing;
      const double y = (static_cast<double>(j) + 0.5) * spacing;
      const double s = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / twice;
      const double t = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / twice;
      if (s >= 0 && t >= 0 && s + t <= 1) visit(j, i, a[2] + s * (b[2] - a[2]) + t * (c[2] - a[2]));
    }
}

bool has_people(const FoamPatch& patch) {
  return patch.is_wall && !patch.of_building() && !patch.name.starts_with("water");
}

template <typename Visit>
void for_each_ground_node(const FoamMesh& mesh, double spacing, const Visit& visit) {
  for (const FoamPatch& patch : mesh.patches) {
    if (!has_people(patch)) continue;
    for (std::size_t f = patch.begin; f < patch.end; ++f) {
      const auto corners = mesh.face(f);
      for (std::size_t k = 2; k < corners.size(); ++k)
        for_each_node({mesh.point(corners[0]), mesh.point(corners[k - 1]), mesh.point(corners[k])},
                      spacing, visit);
    }
  }
}

}  // namespace

SamplePoints sample_points(const FoamMesh& mesh, double height, double spacing) {
  const Bounds2& town = mesh.town;
  const auto is_inside = [&](Point2 p) { return town.empty() || town.contains(p); };
  double area = 0;  // of faces around points in the town
  for (const FoamPatch& patch : mesh.patches)
    if (has_people(patch))
      for (std::size_t f = patch.begin; f < patch.end; ++f) {
        const FaceGeometry face = face_geometry(mesh, f);
        if (is_inside({face.centre[0], face.centre[1]})) area += std::abs(face.area[2]);
      }
  while (area / (spacing * spacing) > static_cast<double>(kMost)) spacing *= 2;
  std::map<Node, double> ground;  // on an edge, the first face gives the height
  while (true) {
    for_each_ground_node(mesh, spacing, [&](std::int64_t j, std::int64_t i, double z) {
      const Point2 p{(static_cast<double>(i) + 0.5) * spacing,
                     (static_cast<double>(j) + 0.5) * spacing};
      if (is_inside(p)) ground.emplace(Node(j, i), z);
    });
    if (ground.size() <= kMost) break;
    ground.clear();  // faces across the border of the town are more than their centres told
    spacing *= 2;
  }
  SamplePoints samples{spacing, {}};
  samples.points.reserve(ground.size());
  for (const auto& [node, z] : ground)
    samples.points.push_back({(static_cast<double>(node.second) + 0.5) * spacing,
                              (static_cast<double>(node.first) + 0.5) * spacing, z + height});
  return samples;
}

}  // namespace tetropolis
