#include "tetropolis/io/cityjson/city_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/ground/triangulation.h"

#include "cityjson_geometry.h"
#include "io/file/input_file.h"
#include "io/file/json_place.h"
#include "model_document.h"

namespace tetropolis {

namespace {

/// Twice the area of the ring as a vector at right angles to it (Newell).
Point3 area_vector(std::span<const Point3> ring) {
  Point3 n{0, 0, 0};
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point3& p = ring[i];
    const Point3& q = ring[(i + 1) % ring.size()];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t d = (c + 1) % 3, e = (c + 2) % 3;
      n[c] += (p[d] - q[d]) * (p[e] + q[e]);
    }
  }
  return n;
}

/// Triangles of one face.
class FaceTriangles {
 public:
  explicit FaceTriangles(const Face& face) : face_(face), normal_(area_vector(face.rings[0])) {
    const auto larger = [&](std::size_t a, std::size_t b) {
      return std::abs(normal_[a]) < std::abs(normal_[b]);
    };
    const std::array<std::size_t, 3> axes{0, 1, 2};
    dropped_ = *std::max_element(axes.begin(), axes.end(), larger);
  }

  bool has_area() const { return normal_[dropped_] != 0; }
  bool is_steep() const {
    constexpr double kSteep = 0.3;
    return std::abs(normal_[2]) < kSteep * std::hypot(normal_[0], normal_[1], normal_[2]);
  }

  /// Calls take(corners).
  template <typename Take>
  void for_each(const Take& take) const {
    const std::vector<Point3>& outer = face_.rings[0];
    if (face_.rings.size() == 1 && is_convex(outer)) {
      for (std::size_t i = 2; i < outer.size(); ++i)
        take(std::array{outer[0], outer[i - 1], outer[i]});
      return;
    }
    PlanarGraph graph;
    Polygon polygon;
    std::vector<Point3> corners;
    for (const std::vector<Point3>& ring : face_.rings) {
      Ring flat;
      const auto first = std::ssize(graph.points);
      for (std::size_t i = 0; i < ring.size(); ++i) {
        flat.push_back(flattened(ring[i]));
        graph.segments.push_back(
            {VertexIndex(first + static_cast<std::ptrdiff_t>(i)),
             VertexIndex(first + static_cast<std::ptrdiff_t>((i + 1) % ring.size()))});
        graph.points.push_back(flat.back());
        corners.push_back(ring[i]);
      }
      if (polygon.outer.empty())
        polygon.outer = std::move(flat);
      else
        polygon.holes.push_back(std::move(flat));
    }
    const Triangulation flat = constrained_delaunay(graph);
    std::vector<Point3> points;
    for (const Point2 p : flat.points) points.push_back(on_plane(p));
    for (std::size_t i = 0; i < corners.size(); ++i) points[flat.input_vertex[i]] = corners[i];
    for (const auto& t : flat.triangles) {
      const Point2 a = flat.points[t[0]], b = flat.points[t[1]], c = flat.points[t[2]];
      if (contains(polygon, {(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3}))
        take(std::array{points[t[0]], points[t[1]], points[t[2]]});
    }
  }

 private:
  Point2 flattened(const Point3& p) const { return {p[(dropped_ + 1) % 3], p[(dropped_ + 2) % 3]}; }

  Point3 on_plane(Point2 p) const {
    const std::size_t a = (dropped_ + 1) % 3, b = (dropped_ + 2) % 3;
    const Point3& q = face_.rings[0][0];
    Point3 result{};
    result[a] = p.x;
    result[b] = p.y;
    result[dropped_] =
        q[dropped_] - (normal_[a] * (p.x - q[a]) + normal_[b] * (p.y - q[b])) / normal_[dropped_];
    return result;
  }

  /// Turns one way only and has no more corners than a ring that does that once around.
  bool is_convex(const std::vector<Point3>& ring) const {
    if (ring.size() == 3) return true;
    if (ring.size() != 4) return false;
    const double sign = normal_[dropped_];
    for (std::size_t i = 0; i < 4; ++i) {
      const Point2 a = flattened(ring[i]), b = flattened(ring[(i + 1) % 4]),
                   c = flattened(ring[(i + 2) % 4]);
      if (((b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x)) * sign < 0) return false;
    }
    return true;
  }

  const Face& face_;
  Point3 normal_;
  std::size_t dropped_ = 2;  ///< The axis that the face is looked at along.
};

bool has_no_corners(const std::vector<Point3>& ring) { return ring.size() < 3; }

struct Collected {
  std::vector<std::array<Point3, 3>> triangles;
  std::vector<Patch> patch;
  std::vector<BuildingIndex> building;

  void add(Face face, bool is_terrain, BuildingIndex of) {
    if (face.is_ground || face.rings.empty() || has_no_corners(face.rings[0])) return;
    std::erase_if(face.rings, has_no_corners);
    const FaceTriangles parts(face);
    if (!parts.has_area()) return;
    const bool is_roof = face.is_roof || !parts.is_steep();
    parts.for_each([&](const std::array<Point3, 3>& corners) {
      triangles.push_back(corners);
      patch.push_back(is_terrain ? Patch::kGround : is_roof ? Patch::kRoof : Patch::kWall);
      building.push_back(is_terrain ? kNoBuilding : of);
    });
  }
};

SurfaceMesh indexed(const Collected& all) {
  SurfaceMesh surface;
  std::vector<std::size_t> corners(all.triangles.size() * 3);
  std::iota(corners.begin(), corners.end(), std::size_t{0});
  const auto point = [&](std::size_t c) -> const Point3& { return all.triangles[c / 3][c % 3]; };
  std::sort(corners.begin(), corners.end(),
            [&](std::size_t a, std::size_t b) { return point(a) < point(b); });
  surface.triangles.resize(all.triangles.size());
  for (const std::size_t c : corners) {
    if (surface.points.empty() || surface.points.back() != point(c))
      surface.points.push_back(point(c));
    surface.triangles[c / 3][c % 3] = static_cast<std::int32_t>(surface.points.size()) - 1;
  }
  surface.patch = all.patch;
  surface.building = all.building;
  return surface;
}

}  // namespace

CitySurface read_city_surface(const std::filesystem::path& path) {
  const ModelDocument document = read_document(path);
  const Place root(path, document.root);
  if (!root.has("type") || root.at("type").text() != "CityJSON")
    fail_input(path, "is not CityJSON; give a .city.json");
  const CityFrame frame = read_vertices(root);
  const Place objects = root.at("CityObjects");
  if (!objects.value().is_object()) objects.fail("is not an object");
  Collected all;
  std::int32_t number = 0;
  for (const auto& item : objects.value().items()) {
    const Place object = objects.at(item.key());
    const std::string& type = object.at("type").text();
    const bool is_terrain = type == "TINRelief";
    if (!is_terrain && type != "Building" && type != "BuildingPart") continue;
    try {
      for (Face& face : read_faces(object, frame).faces)
        all.add(std::move(face), is_terrain, BuildingIndex(number));
    } catch (const Error& error) {
      const std::string what = error.what();
      if (what.starts_with(path.string())) throw;
      object.fail("has a face that cannot be drawn: " + what);  // of the triangulation
    }
    ++number;
  }
  return {indexed(all), frame.origin};
}

}  // namespace tetropolis
