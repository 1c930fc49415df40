#include "is_prism.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "tetropolis/geometry/polygon.h"

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

/// The corners of a footprint, to be asked which places are at one of them.
class Corners {
 public:
  explicit Corners(const Polygon& footprint) {
    for_each_edge(footprint, [&](Point2 a, Point2) { corners_.push_back(a); });
    std::sort(corners_.begin(), corners_.end(), [](Point2 a, Point2 b) { return a.x < b.x; });
  }
  bool have(double x, double y) const {
    auto it = std::lower_bound(corners_.begin(), corners_.end(), x - kRounding,
                               [](Point2 p, double least) { return p.x < least; });
    for (; it != corners_.end() && it->x <= x + kRounding; ++it)
      if (std::abs(it->y - y) <= kRounding) return true;
    return false;
  }

 private:
  std::vector<Point2> corners_;
};

}  // namespace

bool is_prism(const std::vector<Face>& faces, const Building& building) {
  const Corners corners(building.footprint);
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
  return is_closed(faces);
}

}  // namespace tetropolis
