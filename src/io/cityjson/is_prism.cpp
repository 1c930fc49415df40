#include "is_prism.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "tetropolis/city/roof_summary.h"
#include "tetropolis/geometry/polygon.h"

#include "geometry/perimeter.h"

namespace tetropolis {

namespace {

constexpr double kRounding = 0.01;  // metres

/// Whether every edge of a face is one of another face the other way round.
bool is_closed(const std::vector<Face>& faces) {
  std::vector<std::pair<Point3, Point3>> there, back;
  for (const Face& face : faces)
    for (const std::vector<Point3>& ring : face.rings)
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Point3 &p = ring[i], &q = ring[(i + 1) % ring.size()];
        if (p == q) continue;
        there.emplace_back(p, q);
        back.emplace_back(q, p);
      }
  std::sort(there.begin(), there.end());
  std::sort(back.begin(), back.end());
  return there == back;
}

/// Of a closed body near `origin` whose faces look outwards; holes of faces are taken off. Cubic
/// metres.
double volume_of(const std::vector<Face>& faces, const Point3& origin) {
  double six = 0;
  const auto from_origin = [&](const Point3& p) {
    return Point3{p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]};
  };
  for (const Face& face : faces)
    for (const std::vector<Point3>& ring : face.rings)
      for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
        const Point3 a = from_origin(ring[0]), b = from_origin(ring[i]),
                     c = from_origin(ring[i + 1]);
        six += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
      }
  return six / 6;
}

/// Whether that is what footprint and heights make, as far as rounding may change it.
bool has_volume(const std::vector<Face>& faces, const Building& building) {
  double top = building.h_roof, around = perimeter(building.footprint);
  for (const RoofPart& part : building.parts) {
    top = std::max(top, range_of(part).high);
    around += perimeter(part.outline);
  }
  const double change =
      kRounding * (2 * area(building.footprint) + around * (top - building.h_ground));
  const Point2 corner = building.footprint.outer[0];
  const double volume = volume_of(faces, {corner.x, corner.y, building.h_ground});
  return std::abs(volume - volume_of(building)) <= change;
}

/// The corners of a footprint, to be asked which places are at one of them.
class FootprintCorners {
 public:
  explicit FootprintCorners(const Polygon& footprint) {
    for_each_edge(footprint, [&](Point2 a, Point2) { corners_.push_back(a); });
    std::sort(corners_.begin(), corners_.end(), comes_before);
  }
  bool have(double x, double y) const {
    for (const double column : {column_of(x - kRounding), column_of(x + kRounding)}) {
      auto it = std::lower_bound(corners_.begin(), corners_.end(), std::pair{column, y - kRounding},
                                 [](Point2 p, const auto& least) { return key_of(p) < least; });
      for (; it != corners_.end() && column_of(it->x) == column && it->y <= y + kRounding; ++it)
        if (std::abs(it->x - x) <= kRounding) return true;
    }
    return false;
  }

 private:
  /// By columns, of which a search meets two at most: many corners may lie on one line.
  static double column_of(double x) { return std::floor(x / (4 * kRounding)); }
  static std::pair<double, double> key_of(Point2 p) { return {column_of(p.x), p.y}; }
  static bool comes_before(Point2 a, Point2 b) { return key_of(a) < key_of(b); }

  std::vector<Point2> corners_;
};

}  // namespace

bool is_prism(const std::vector<Face>& faces, const Building& building) {
  const FootprintCorners corners(building.footprint);
  const auto is_at = [](const Point3& p, double z) { return std::abs(p[2] - z) <= kRounding; };
  for (const Face& face : faces) {
    const bool may_be_ground = !face.is_roof, may_be_roof = !face.is_ground;
    const auto is_right = [&](const Point3& p) {
      return ((may_be_ground && is_at(p, building.h_ground)) ||
              (may_be_roof && is_at(p, building.h_roof))) &&
             corners.have(p[0], p[1]);
    };
    for (const std::vector<Point3>& ring : face.rings)
      if (!std::all_of(ring.begin(), ring.end(), is_right)) return false;
  }
  return is_closed(faces) && has_volume(faces, building);
}

bool is_roofed(const std::vector<Face>& faces, const Building& building) {
  for (const Face& face : faces) {
    if (!face.is_ground) continue;
    for (const std::vector<Point3>& ring : face.rings)
      for (const Point3& p : ring)
        if (!(std::abs(p[2] - building.h_ground) <= kRounding)) return false;
  }
  return is_closed(faces) && has_volume(faces, building);
}

}  // namespace tetropolis
