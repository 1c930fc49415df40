#include "roof_solid.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "tetropolis/geometry/polygon.h"

#include "geometry/vec2.h"

namespace tetropolis {

namespace {

bool comes_before(Point2 a, Point2 b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); }

/// What the parts are at their corners.
class Corners {
 public:
  explicit Corners(const std::vector<RoofPart>& parts) {
    for (std::size_t part = 0; part < parts.size(); ++part) {
      for_each_ring(parts[part].outline, [&](const Ring& ring) {
        for (const Point2& p : ring) corners_.push_back({p, parts[part].roof(p), part});
      });
    }
    std::sort(corners_.begin(), corners_.end(), [](const Corner& a, const Corner& b) {
      return std::tie(a.at.x, a.at.y, a.z, a.part) < std::tie(b.at.x, b.at.y, b.z, b.part);
    });
    for (auto first = corners_.begin(); first != corners_.end();) {
      auto last = first + 1;
      while (last != corners_.end() && last->at == first->at &&
             last->z - (last - 1)->z < kLeastStep)
        ++last;
      const double z = snap_height(first->z + ((last - 1)->z - first->z) / 2);
      for (; first != last; ++first) first->z = z;
    }
  }

  /// Precondition: a corner of that part.
  double elevation(Point2 at, std::size_t part) const {
    auto it = first_at(at);
    while (it->part != part) ++it;
    return it->z;
  }

  /// Appends what is strictly between, ascending if low < high, else descending.
  void append_between(Point2 at, double from, double to, std::vector<Point3>& ring) const {
    const std::size_t size = ring.size();
    for (auto it = first_at(at); it != corners_.end() && it->at == at; ++it)
      if (it->z > std::min(from, to) && it->z < std::max(from, to) &&
          (ring.size() == size || it->z > ring.back()[2]))
        ring.push_back({at.x, at.y, it->z});
    if (from > to) std::reverse(ring.begin() + static_cast<std::ptrdiff_t>(size), ring.end());
  }

 private:
  static constexpr double kLeastStep = 1e-3;  // metres
  struct Corner {
    Point2 at;
    double z = 0;
    std::size_t part = 0;
  };

  std::vector<Corner>::const_iterator first_at(Point2 at) const {
    return std::lower_bound(corners_.begin(), corners_.end(), at,
                            [](const Corner& a, Point2 p) { return comes_before(a.at, p); });
  }

  std::vector<Corner> corners_;  ///< By place, then elevation.
};

/// Which part is to the left of which edge.
class Sides {
 public:
  explicit Sides(const std::vector<RoofPart>& parts) {
    for (std::size_t part = 0; part < parts.size(); ++part) {
      for_each_ring(parts[part].outline, [&](const Ring& ring) {
        for (std::size_t i = 0; i < ring.size(); ++i)
          edges_.push_back({ring[i], ring[(i + 1) % ring.size()], part});
      });
    }
    std::sort(edges_.begin(), edges_.end(), is_less);
  }

  std::optional<std::size_t> left_of(Point2 a, Point2 b) const {
    const Edge wanted{a, b, 0};
    const auto it = std::lower_bound(edges_.begin(), edges_.end(), wanted, is_less);
    if (it == edges_.end() || !(it->a == a && it->b == b)) return std::nullopt;
    return it->part;
  }

 private:
  struct Edge {
    Point2 a, b;
    std::size_t part = 0;
  };
  static bool is_less(const Edge& s, const Edge& t) {
    return std::tie(s.a.x, s.a.y, s.b.x, s.b.y, s.part) <
           std::tie(t.a.x, t.a.y, t.b.x, t.b.y, t.part);
  }

  std::vector<Edge> edges_;
};

class SolidBuilder {
 public:
  explicit SolidBuilder(const Building& building)
      : building_(building), corners_(building.parts), sides_(building.parts) {}

  std::vector<SolidFace> build() {
    add_ground();
    for (std::size_t part = 0; part < building_.parts.size(); ++part) add_roof(part);
    for (std::size_t part = 0; part < building_.parts.size(); ++part) {
      const Polygon& outline = building_.parts[part].outline;
      add_walls(part, outline.outer);
      for (const Ring& hole : outline.holes) add_walls(part, hole);
    }
    return std::move(faces_);
  }

 private:
  /// The end of a wall: lower and upper end of a vertical edge, or one point.
  struct End {
    Point2 at;
    double low = 0, high = 0;
  };

  void add_ground() {
    SolidFace face;
    for_each_ring(building_.footprint, [&](const Ring& ring) {
      std::vector<Point3> down{{ring[0].x, ring[0].y, building_.h_ground}};
      for (std::size_t i = ring.size() - 1; i > 0; --i)
        down.push_back({ring[i].x, ring[i].y, building_.h_ground});
      face.rings.push_back(std::move(down));
    });
    faces_.push_back(std::move(face));
  }

  void add_roof(std::size_t part) {
    SolidFace face;
    face.kind = SolidFaceKind::kRoof;
    face.part = part;
    std::size_t position = 0;
    for_each_ring(building_.parts[part].outline, [&](const Ring& ring) {
      std::vector<Point3>& up = face.rings.emplace_back();
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Point2 a = ring[i], b = ring[(i + 1) % ring.size()];
        up.push_back({a.x, a.y, corners_.elevation(a, part)});
        ++position;
        const std::optional<std::size_t> other = sides_.left_of(b, a);
        if (!other) continue;
        if (const std::optional<Point3> crossing = crossing_of(a, b, part, *other)) {
          up.push_back(*crossing);
          face.crossings.push_back(position++);
        }
      }
    });
    faces_.push_back(std::move(face));
  }

  /// How much higher one part is than the other.
  double step_at(Point2 p, std::size_t part, std::size_t other) const {
    return corners_.elevation(p, part) - corners_.elevation(p, other);
  }

  /// The same for both sides of the line.
  std::optional<Point3> crossing_of(Point2 a, Point2 b, std::size_t part, std::size_t other) const {
    constexpr double kFromEnds = 2e-3;  // metres: files of others may have whole millimetres
    if (comes_before(b, a)) {
      std::swap(a, b);
      std::swap(part, other);
    }
    const double at_a = step_at(a, part, other), at_b = step_at(b, part, other);
    if (!((at_a < 0 && at_b > 0) || (at_a > 0 && at_b < 0))) return std::nullopt;
    const double least = std::min(0.5, kFromEnds / distance(a, b));
    const double t = std::clamp(at_a / (at_a - at_b), least, 1 - least);
    const Point2 p = snap_coordinate({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
    const auto between = [&](std::size_t side) {
      const double from = corners_.elevation(a, side);
      return from + t * (corners_.elevation(b, side) - from);
    };
    return Point3{p.x, p.y, snap_height((between(part) + between(other)) / 2)};
  }

  void add_walls(std::size_t part, const Ring& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point2 a = ring[i], b = ring[(i + 1) % ring.size()];
      const double high_a = corners_.elevation(a, part), high_b = corners_.elevation(b, part);
      const std::optional<std::size_t> other = sides_.left_of(b, a);
      if (!other) {
        add_wall(SolidFaceKind::kOuterWall, part, {a, building_.h_ground, high_a},
                 {b, building_.h_ground, high_b});
        continue;
      }
      // Where the other is higher, the wall is the other's.
      End from{a, corners_.elevation(a, *other), high_a},
          to{b, corners_.elevation(b, *other), high_b};
      if (const std::optional<Point3> crossing = crossing_of(a, b, part, *other)) {
        const auto& [x, y, z] = *crossing;
        (from.high < from.low ? from : to) = {{x, y}, z, z};
      }
      if (from.high >= from.low && to.high >= to.low && (from.high > from.low || to.high > to.low))
        add_wall(SolidFaceKind::kStep, part, from, to);
    }
  }

  void add_wall(SolidFaceKind kind, std::size_t part, const End& from, const End& to) {
    SolidFace face;
    face.kind = kind;
    face.part = part;
    std::vector<Point3>& ring = face.rings.emplace_back();
    ring.push_back({from.at.x, from.at.y, from.low});
    ring.push_back({to.at.x, to.at.y, to.low});
    corners_.append_between(to.at, to.low, to.high, ring);
    if (to.high > to.low) ring.push_back({to.at.x, to.at.y, to.high});
    if (from.high > from.low) ring.push_back({from.at.x, from.at.y, from.high});
    corners_.append_between(from.at, from.high, from.low, ring);
    faces_.push_back(std::move(face));
  }

  const Building& building_;
  Corners corners_;
  Sides sides_;
  std::vector<SolidFace> faces_;
};

}  // namespace

std::vector<SolidFace> roof_solid(const Building& building) {
  return SolidBuilder(building).build();
}

}  // namespace tetropolis
