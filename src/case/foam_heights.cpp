#include "foam_heights.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <unordered_map>
#include <utility>

#include "core/median.h"
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

std::vector<double> tops_of_prisms(const FoamMesh& mesh, const std::vector<double>& floors) {
  std::vector<std::uint8_t> sides(mesh.cells(), 0);
  for (const auto* cells : {&mesh.owner, &mesh.neighbour})
    for (const std::int32_t cell : *cells) ++sides[static_cast<std::size_t>(cell)];
  const auto is_prism = [&](std::int32_t cell) {
    return sides[static_cast<std::size_t>(cell)] == 5;
  };
  std::unordered_map<std::pair<double, double>, double, PlaceHash> tops;
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    if (!is_prism(mesh.owner[f]) && (f >= mesh.neighbour.size() || !is_prism(mesh.neighbour[f])))
      continue;
    for (const std::int32_t p : mesh.face(f)) {
      const Point3& at = mesh.point(p);
      double& top = tops[{at[0], at[1]}];
      top = std::max(top, at[2] - floors[static_cast<std::size_t>(p)]);
    }
  }
  std::vector<double> found(mesh.points.size(), 0);
  for (std::size_t i = 0; i < found.size(); ++i)
    if (const auto top = tops.find({mesh.points[i][0], mesh.points[i][1]}); top != tops.end())
      found[i] = top->second;
  return found;
}

OpenLand open_land(const FoamMesh& mesh, const std::vector<double>& tops) {
  const bool has_open_land =
      std::any_of(mesh.patches.begin(), mesh.patches.end(),
                  [](const FoamPatch& patch) { return patch.name == kOpenLand; });
  double area = 0, squares = 0;
  std::vector<double> heights;
  for (const FoamPatch& patch : mesh.patches) {
    if (!patch.is_wall || patch.of_building()) continue;
    if (has_open_land && patch.name != kOpenLand) continue;
    for (std::size_t f = patch.begin; f < patch.end; ++f) {
      const double one = std::abs(face_geometry(mesh, f).area[2]);
      area += one;
      squares += one * one;
      for (const std::int32_t p : mesh.face(f))
        heights.push_back(tops[static_cast<std::size_t>(p)]);
    }
  }
  if (!(area > 0)) return {};
  return {std::sqrt(2 * squares / area), median(heights)};
}

std::vector<WallCell> cells_on(const FoamMesh& mesh, std::span<const std::size_t> faces) {
  std::vector<std::vector<Point3>> corners;
  std::vector<std::int32_t> of_cell(mesh.cells(), -1);
  for (const std::size_t f : faces) {
    std::int32_t& own = of_cell[static_cast<std::size_t>(mesh.owner[f])];
    if (own >= 0) continue;
    own = static_cast<std::int32_t>(corners.size());
    corners.emplace_back();
  }
  const auto look = [&](std::int32_t cell, std::size_t f) {
    const std::int32_t own = of_cell[static_cast<std::size_t>(cell)];
    if (own < 0) return;
    for (const std::int32_t p : mesh.face(f))
      corners[static_cast<std::size_t>(own)].push_back(mesh.point(p));
  };
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    look(mesh.owner[f], f);
    if (f < mesh.neighbour.size()) look(mesh.neighbour[f], f);
  }
  std::vector<WallCell> cells;
  cells.reserve(faces.size());
  for (const std::size_t f : faces) {
    const FaceGeometry face = face_geometry(mesh, f);
    const double size = length(face.area);
    const std::int32_t own = of_cell[static_cast<std::size_t>(mesh.owner[f])];
    const auto above = [&](const Point3& at) {  // normals leave the cell
      return size > 0 ? -dot(minus(at, face.centre), face.area) / size : 0;
    };
    WallCell one;
    double sum = 0;
    const std::vector<Point3>& points = corners[static_cast<std::size_t>(own)];
    for (const Point3& at : points) {
      const double height = above(at);
      one.height = std::max(one.height, height);
      sum += height;
    }
    one.centre = sum / static_cast<double>(points.size());
    cells.push_back(one);
  }
  return cells;
}

}  // namespace tetropolis
