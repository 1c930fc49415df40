#include "body_footprint.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/polygon.h"

#include "city/footprint_index.h"
#include "core/infinity.h"
#include "core/sort_once.h"
#include "geometry/geos.h"
#include "geometry/perimeter.h"

namespace tetropolis {

namespace {

/// On the grid of coordinates, without repeated vertices.
Ring snapped(const Ring& ring) {
  Ring result;
  for (const Point2& p : ring) {
    const Point2 q = snap_coordinate(p);
    if (result.empty() || !(result.back() == q)) result.push_back(q);
  }
  while (result.size() > 1 && result.back() == result.front()) result.pop_back();
  return result;
}

/// The same with flat holes left out; none if the outer ring is flat.
std::optional<Polygon> snapped(const std::vector<Ring>& rings) {
  Polygon polygon;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    Ring ring = snapped(rings[r]);
    if (ring.size() < 3 || signed_area(ring) == 0) {
      if (r == 0) return std::nullopt;
    } else if (r == 0) {
      polygon.outer = std::move(ring);
    } else {
      polygon.holes.push_back(std::move(ring));
    }
  }
  if (polygon.outer.empty()) return std::nullopt;
  return polygon;
}

Ring project(const std::vector<Point3>& ring) {
  Ring result;
  for (const Point3& p : ring) result.push_back({p[0], p[1]});
  return result;
}

/// Vector area by Newell's formula (Sutherland, Sproull, Schumacker, 1974).
Point3 normal(const std::vector<Point3>& ring) {
  Point3 n{};
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const Point3& a = ring[j];
    const Point3& b = ring[i];
    n[0] += (a[1] - b[1]) * (a[2] + b[2]) / 2;
    n[1] += (a[2] - b[2]) * (a[0] + b[0]) / 2;
    n[2] += (a[0] - b[0]) * (a[1] + b[1]) / 2;
  }
  return n;
}

/// Cosine of the angle to the vertical: 1 looks up, -1 down, 0 is a wall.
double uprightness(const Face& face) {
  if (face.rings.empty() || face.rings[0].size() < 3) return 0;
  const Point3 n = normal(face.rings[0]);
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  return length > 0 ? n[2] / length : 0;
}

std::vector<Polygon> project_faces(const std::vector<const Face*>& faces) {
  std::vector<Polygon> polygons;
  for (const Face* face : faces) {
    std::vector<Ring> rings;
    for (const std::vector<Point3>& ring : face->rings) rings.push_back(project(ring));
    if (std::optional<Polygon> polygon = snapped(rings)) polygons.push_back(std::move(*polygon));
  }
  return polygons;
}

constexpr double kFloorCosine = 0.5;  // Steeper than 60 degrees is no floor.
constexpr double kNotWall = 0.01;

std::vector<const Face*> select(std::span<const Face> faces, double low, double high) {
  std::vector<const Face*> chosen;
  for (const Face& face : faces) {
    const double up = uprightness(face);
    if (up >= low && up <= high) chosen.push_back(&face);
  }
  return chosen;
}

/// Those whose semantics say so.
std::vector<const Face*> select(std::span<const Face> faces, bool Face::*meaning) {
  std::vector<const Face*> chosen;
  for (const Face& face : faces)
    if (face.*meaning) chosen.push_back(&face);
  return chosen;
}

/// Where polygons overlap or share edges they become one. Empty where GEOS gives up.
std::vector<Polygon> unite(const std::vector<Polygon>& polygons) {
  std::vector<Polygon> parts;
  for (const Polygon& polygon : polygons) {
    if (geos::is_valid({&polygon, 1})) {
      parts.push_back(polygon);
    } else if (const geos::Result valid = geos::make_valid(polygon)) {
      parts.insert(parts.end(), valid->begin(), valid->end());
    }
  }
  std::vector<Polygon> result;
  const geos::Result whole = geos::unite(parts, 0);
  if (!whole) return result;
  for (const Polygon& polygon : *whole) {
    std::vector<Ring> rings{polygon.outer};
    rings.insert(rings.end(), polygon.holes.begin(), polygon.holes.end());
    if (std::optional<Polygon> part = snapped(rings)) result.push_back(std::move(*part));
  }
  return result;
}

constexpr double kAtBottom = 0.5;  // metres

/// Those that look down, but for soffits in the upper half; and those at the very bottom that look
/// up: a face that is turned the wrong way belongs to the ground all the same.
std::vector<const Face*> ground_faces(const std::vector<Face>& faces) {
  std::vector<const Face*> ground = select(faces, -1, -kFloorCosine);
  double low = kInfinity, high = -low;
  for (const Face& face : faces) {
    const auto [lowest, highest] = elevations(face);
    low = std::min(low, lowest);
    high = std::max(high, highest);
  }
  const double middle = (low + high) / 2;
  std::erase_if(ground, [&](const Face* face) { return elevations(*face).first > middle; });
  for (const Face* face : select(faces, kFloorCosine, 1))
    if (elevations(*face).second <= low + kAtBottom) ground.push_back(face);
  return ground;
}

/// Whether walls stand all around these grounds, and nowhere else: what a roof has beyond them are
/// eaves, however wide. `faces`: of the building; `grounds`: disjoint, not above `level`.
bool is_walled(const std::vector<Polygon>& grounds, double level, const std::vector<Face>& faces) {
  constexpr double kNear = 0.05;                           // metres
  constexpr double kLeastAround = 0.9, kMostApart = 0.05;  // of the perimeter
  constexpr double kAtFoot = 0.4;  // of a wall's height; diagonals of triangles are half way up
  double whole = 0, around = 0, apart = 0;
  std::vector<const Polygon*> pointers;
  for (const Polygon& ground : grounds) {
    pointers.push_back(&ground);
    whole += perimeter(ground);
  }
  const FootprintIndex index(pointers, kNear);
  for (const Face& face : faces) {
    if (!is_wall(face)) continue;
    const auto [low, high] = elevations(face);
    const double foot = std::min(low + kAtFoot * (high - low), level + kAtBottom);
    const std::vector<Point3>& ring = face.rings[0];
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point3 &a = ring[i], &b = ring[(i + 1) % ring.size()];
      if ((a[2] + b[2]) / 2 > foot) continue;
      const Point2 middle{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
      bool is_near = false;
      index.at(middle, [&](BuildingIndex ground, bool) {
        is_near = is_near || index.squared_distance(ground, middle) <= kNear * kNear;
      });
      (is_near ? around : apart) += std::hypot(b[0] - a[0], b[1] - a[1]);
    }
  }
  return around >= kLeastAround * whole && apart <= kMostApart * whole;
}

/// The faces whose shadow is the footprint.
std::vector<Polygon> ground_polygons(const std::vector<Face>& faces) {
  constexpr double kMostOfRoof = 0.6;  // the rest are eaves
  std::vector<Polygon> polygons = project_faces(select(faces, &Face::is_ground));
  if (!polygons.empty()) return polygons;
  const std::vector<const Face*> ground = ground_faces(faces);
  polygons = project_faces(ground);
  std::vector<Polygon> above = project_faces(select(faces, kNotWall, 1));
  const std::vector<Polygon> grounds = unite(polygons);
  double level = -kInfinity;
  for (const Face* face : ground) level = std::max(level, elevations(*face).second);
  // Where none looks down, what is lowest may be a roof.
  const bool looks_down = !select(faces, -1, -kFloorCosine).empty();
  const bool is_whole =
      !grounds.empty() &&
      ((looks_down && total_area(grounds) >= kMostOfRoof * total_area(unite(above))) ||
       is_walled(grounds, level, faces));
  // Where part of the ground is missing, what is above it tells.
  if (!is_whole) {
    if (!looks_down) polygons.clear();
    polygons.insert(polygons.end(), above.begin(), above.end());
  }
  if (polygons.empty()) polygons = project_faces(select(faces, -1, -kNotWall));
  return polygons;
}

/// Area in the plan of what of a planar ring is not above `level`.
double area_up_to(const std::vector<Point3>& ring, double level) {
  Ring below;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point3& a = ring[i];
    const Point3& b = ring[(i + 1) % ring.size()];
    if (a[2] <= level) below.push_back({a[0], a[1]});
    if ((a[2] <= level) == (b[2] <= level)) continue;
    const double t = (level - a[2]) / (b[2] - a[2]);
    below.push_back({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])});
  }
  return below.size() < 3 ? 0 : std::abs(signed_area(below));
}

double area_up_to(const std::vector<const Face*>& faces, double level) {
  double sum = 0;
  for (const Face* face : faces)
    for (std::size_t r = 0; r < face->rings.size(); ++r)
      sum += (r == 0 ? 1 : -1) * area_up_to(face->rings[r], level);
  return sum;
}

/// The lowest level up to which the roofs have an area of `wanted`, to a micrometre.
double level_of(const std::vector<const Face*>& roofs, double wanted) {
  std::vector<double> levels;
  for (const Face* face : roofs)
    for (const std::vector<Point3>& ring : face->rings)
      for (const Point3& p : ring) levels.push_back(p[2]);
  sort_once(levels);
  const auto reached = [&](double level) { return area_up_to(roofs, level) >= wanted; };
  const auto at = std::partition_point(levels.begin(), levels.end(),
                                       [&](double level) { return !reached(level); });
  if (at == levels.end()) return levels.back();  // by rounding
  // Flat roofs at that level, or a slope on the way to it.
  double high = std::nextafter(*at, -kInfinity);
  if (at == levels.begin() || !reached(high)) return *at;
  double low = *(at - 1);
  constexpr double kExact = 1e-6;  // metres
  for (double middle = (low + high) / 2; high - low > kExact && middle > low && middle < high;
       middle = (low + high) / 2)
    (reached(middle) ? high : low) = middle;
  return high;
}

/// `boxes`: of the footprints, of which there is one at least.
std::size_t nearest(const std::vector<Polygon>& footprints, const std::vector<Bounds2>& boxes,
                    Point2 p) {
  std::size_t found = 0;
  double least = kInfinity;
  for (std::size_t k = 0; k < footprints.size(); ++k) {
    if (!boxes[k].grown(least).contains(p)) continue;
    const double away = distance_to_boundary(footprints[k], p);
    if (away < least) {
      least = away;
      found = k;
    }
  }
  return found;
}

/// In the plan: inside of the face, or, of a wall, between its ends.
Point2 middle_of(const Face& face) {
  const Ring ring = project(face.rings[0]);
  if (!is_wall(face) && ring.size() >= 3 && signed_area(ring) != 0) {
    Polygon polygon{ring, {}};
    for (std::size_t r = 1; r < face.rings.size(); ++r)
      polygon.holes.push_back(project(face.rings[r]));
    return interior_point(polygon);
  }
  Point2 middle{0, 0};
  for (const Point2& p : ring) {
    middle.x += p.x / static_cast<double>(ring.size());
    middle.y += p.y / static_cast<double>(ring.size());
  }
  return middle;
}

}  // namespace

std::pair<double, double> elevations(const Face& face) {
  std::pair range{kInfinity, -kInfinity};
  for (const std::vector<Point3>& ring : face.rings)
    for (const Point3& p : ring)
      range = {std::min(range.first, p[2]), std::max(range.second, p[2])};
  return range;
}

bool is_wall(const Face& face) {
  constexpr double kLeastArea = 1e-3, kLeastHeight = 0.1, kGreatestHeight = 1100;
  if (face.rings.empty() || face.rings[0].size() < 3) return false;
  const Point3 n = normal(face.rings[0]);
  const double area = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (!(area > kLeastArea && std::abs(n[2]) < kNotWall * area)) return false;
  const auto [low, high] = elevations(face);
  const double height = high - low;
  return height >= kLeastHeight && height <= kGreatestHeight;
}

void orient(Polygon& polygon) {
  const auto turn = [](Ring& ring) { std::reverse(ring.begin() + 1, ring.end()); };
  if (signed_area(polygon.outer) < 0) turn(polygon.outer);
  for (Ring& hole : polygon.holes)
    if (signed_area(hole) > 0) turn(hole);
}

std::optional<double> roof_height_of(std::span<const Face> faces, double area_of_footprint) {
  constexpr double kMostOfFootprint = 0.8;
  const auto covers = [&](double area) {
    return area > 0 && area >= kMostOfFootprint * area_of_footprint;
  };
  std::vector<const Face*> roofs = select(faces, &Face::is_roof);
  std::erase_if(roofs, [](const Face* face) { return uprightness(*face) < kNotWall; });
  if (const double all = area_up_to(roofs, kInfinity); covers(all))
    return level_of(roofs, 0.9 * all);
  // Where some faces only are named, or none, those that look up are the roofs. Floors and storeys
  // below one another are among them, so that only what is above a level is known.
  roofs = select(faces, kNotWall, 1);
  std::erase_if(roofs, [](const Face* face) { return face->is_ground; });
  const double all = area_up_to(roofs, kInfinity);
  if (!covers(all)) return std::nullopt;
  const double level = level_of(roofs, all - 0.1 * std::min(all, area_of_footprint));
  // Of a body that is turned inside out the ground looks up, and the roof down.
  std::vector<const Face*> above = select(faces, -1, -kNotWall);
  std::erase_if(above, [&](const Face* face) { return elevations(*face).first <= level; });
  if (2 * area_up_to(above, kInfinity) >= area_of_footprint) return std::nullopt;
  return level;
}

std::vector<std::vector<Face>> share_out(const std::vector<Face>& faces,
                                         const std::vector<Polygon>& footprints) {
  std::vector<const Polygon*> pointers;
  std::vector<Bounds2> boxes;
  for (const Polygon& footprint : footprints) {
    pointers.push_back(&footprint);
    boxes.push_back(bounds(footprint));
  }
  constexpr double kNear = 0.05;  // metres: walls stand on the boundary
  const FootprintIndex index(pointers, kNear);
  std::vector<std::vector<Face>> parts(footprints.size());
  for (const Face& face : faces) {
    if (face.rings.empty() || face.rings[0].empty()) continue;
    const Point2 middle = middle_of(face);
    std::optional<std::size_t> part;
    index.at(middle, [&](BuildingIndex footprint, bool inside) {
      if (inside || !part) part = footprint;
    });
    if (!part) part = nearest(footprints, boxes, middle);
    parts[*part].push_back(face);
  }
  return parts;
}

FootprintResult footprint_of(const std::vector<Face>& faces) {
  FootprintResult result;
  std::vector<Polygon> polygons = ground_polygons(faces);
  if (polygons.empty()) {
    result.reason = "no face that could be a footprint";
    return result;
  }
  // One face needs no union: its vertices and their order stay.
  result.polygons = polygons.size() == 1 ? std::move(polygons) : unite(polygons);
  if (result.polygons.empty()) result.reason = "a footprint without area";
  for (Polygon& polygon : result.polygons) orient(polygon);
  return result;
}

}  // namespace tetropolis
