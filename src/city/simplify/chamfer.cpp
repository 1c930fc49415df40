#include "chamfer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "tetropolis/geometry/polygon.h"

#include "city/grid_geometry.h"
#include "outline_change.h"

namespace tetropolis {

namespace {

using grid::distance;

/// What rounding two points to the grid may take from their distance, and some.
constexpr double kCutRounding = 1.5;

/// Whether the angle between a and b, seen from the tip, has a larger cosine.
bool is_sharper(Point2 a, Point2 tip, Point2 b, double cosine) {
  return grid::dot(tip, a, b) > cosine * distance(tip, a) * distance(tip, b);
}

class CornerChamfer {
 public:
  CornerChamfer(Outline& outline, const ChamferOptions& options)
      : o_(outline),
        options_(options),
        cosine_(std::cos(options.least_angle)),
        judge_(outline, options.epsilon, options.keep_inside) {}

  std::int64_t run() {
    std::int64_t chamfered = 0;
    for (const OutlineVertex v : o_.vertices())  // as they are now
      if (o_.alive(v) && is_sharp(o_.at(o_.before(v)), o_.at(v), o_.at(o_.after(v))) && chamfer(v))
        ++chamfered;
    return chamfered;
  }

 private:
  bool is_sharp(Point2 a, Point2 tip, Point2 b) const { return is_sharper(a, tip, b, cosine_); }

  int sharp_corners(const OutlineChange& c, const ShortPath& path) const {
    int count = 0;
    for (int i = 0; i < path.count; ++i) {
      const Point2 a = i == 0 ? o_.at(o_.before(c.first)) : path.at(i - 1);
      const Point2 b = i + 1 == path.count ? o_.at(o_.after(c.last)) : path.at(i + 1);
      if (is_sharp(a, path.at(i), b)) ++count;
    }
    return count;
  }

  /// The walls of a sharp corner.
  struct Walls {
    double la, lb;     ///< Lengths: to the vertex before, and to the one after.
    double sine;       ///< Of the angle between them.
    double ring_area;  ///< Of the ring, as it was when it was first asked for.
    /// Whether twice_area of a triangle at the corner is more than half of the ring's.
    bool is_most(double twice_area) const { return twice_area > ring_area; }
  };

  double ring_area(OutlineVertex v) {
    ring_areas_.resize(o_.first.size(), -1);
    double& area = ring_areas_[o_.ring_of(v)];
    if (area < 0) area = std::abs(signed_area(ring_through(o_, v)));
    return area;
  }

  bool chamfer(OutlineVertex v) {
    const OutlineChange all = vertex_change(o_, v, ChangeKind::kMove);
    const Point2 tip = o_.at(v), a = o_.at(all.first), b = o_.at(all.last);
    const double la = distance(tip, a), lb = distance(tip, b);
    const Walls walls{la, lb, grid::twice_area(tip, a, b) / (la * lb), ring_area(v)};
    if (!(walls.sine > 0)) return false;
    // The width at the same distance from the tip along both walls is 2 sin(angle / 2) of it.
    const double half_sine =
        std::sqrt((1 - std::sqrt(std::max(0.0, 1 - walls.sine * walls.sine))) / 2);
    const double rest = options_.epsilon + kCutRounding;
    const double reach = rest / (2 * half_sine);
    if (cut_off(v, walls, reach)) return true;
    // What would be left at its foot may be in the way of others: then all of it goes, or none.
    const bool is_needle = la - reach < 2 * rest && lb - reach < 2 * rest;
    if (is_needle && !walls.is_most(la * lb * walls.sine) &&
        replace_if_better(all, old_path(o_, all), new_path(o_, all)))
      return true;
    if (widen(v, walls)) return true;
    for (double longer = reach; longer < std::max(la, lb);) {
      longer *= 1.25;
      if ((longer * longer - reach * reach) * walls.sine > 2 * options_.most_beyond) break;
      if (cut_off(v, walls, longer)) return true;
    }
    return false;
  }

  /// Cuts off, or fills, as far as `reach` from the tip along both walls.
  bool cut_off(OutlineVertex v, const Walls& walls, double reach) {
    OutlineChange c = vertex_change(o_, v, ChangeKind::kMove);
    const Point2 tip = o_.at(v), a = o_.at(c.first), b = o_.at(c.last);
    const double la = walls.la, lb = walls.lb;
    // What would be left of a wall is not to be a short edge: then all of the wall goes.
    const double rest = options_.epsilon + kCutRounding;
    bool all_of_a = la - reach < rest, all_of_b = lb - reach < rest;
    if (all_of_a) reach = std::max(reach, la);
    if (all_of_b) reach = std::max(reach, lb);
    all_of_a = all_of_a || la - reach < rest;
    all_of_b = all_of_b || lb - reach < rest;
    if (walls.is_most(reach * reach * walls.sine)) return false;
    const auto add = [&](Point2 end, double length, double share) {
      const double t = share * reach / length;
      c.add(grid::rounded({tip.x + t * (end.x - tip.x), tip.y + t * (end.y - tip.y)}));
    };
    // Where one wall goes, what follows it has a direction of its own: the end may have to turn.
    for (const double share : {1.0, 0.97, 0.94, 0.9}) {
      c.fresh_count = 0;
      if (!all_of_a) add(a, la, share);
      if (!all_of_b) add(b, lb, share);
      if (replace_if_better(c, old_path(o_, c), new_path(o_, c))) return true;
      if (all_of_a == all_of_b) break;
    }
    return false;
  }

  /// Gives the tip the width that an end has to have: to both sides or to one, there or nearer to
  /// its foot, whichever first leaves room for what is around.
  bool widen(OutlineVertex v, const Walls& walls) {
    OutlineChange c = vertex_change(o_, v, ChangeKind::kMove);
    const Point2 tip = o_.at(v), a = o_.at(c.first), b = o_.at(c.last);
    const double la = walls.la, lb = walls.lb;
    // The sum of the directions of the walls, and across it, towards a.
    double dx = (a.x - tip.x) / la + (b.x - tip.x) / lb;
    double dy = (a.y - tip.y) / la + (b.y - tip.y) / lb;
    const double norm = std::hypot(dx, dy);
    dx /= norm, dy /= norm;
    const double turn = grid::orientation(tip, a, b) > 0 ? 1 : -1;
    const double least_width = options_.epsilon + kCutRounding;
    const double twice_area = std::abs(grid::twice_area(tip, a, b));
    for (const double shorter : {0.0, 0.5, 0.8}) {
      if (walls.is_most(shorter * shorter * twice_area)) break;
      // To one side the end is not square to both walls: what is a little wider is wide enough.
      for (const auto& [side, share] :
           {std::pair{0.5, 1.0}, std::pair{1.0, 1.0}, std::pair{0.0, 1.0}, std::pair{1.0, 1.03},
            std::pair{0.0, 1.03}}) {
        const double width = share * least_width;
        const double x = tip.x + shorter * std::min(la, lb) * dx;
        const double y = tip.y + shorter * std::min(la, lb) * dy;
        c.fresh_count = 0;
        for (const double across : {side * width, (side - 1) * width})
          c.add(grid::rounded({x + turn * across * dy, y - turn * across * dx}));
        if (replace_if_better(c, old_path(o_, c), new_path(o_, c))) return true;
      }
    }
    return false;
  }

  bool replace_if_better(const OutlineChange& c, const ShortPath& before, const ShortPath& after) {
    if (sharp_corners(c, after) >= sharp_corners(c, before) || !judge_.gain(c)) return false;
    replace_vertices(o_, c);
    return true;
  }

  Outline& o_;
  const ChamferOptions& options_;
  std::vector<double> ring_areas_;  ///< Below 0 where unknown.
  double cosine_;
  ChangeJudge judge_;
};

}  // namespace

bool has_sharp_corner(const Polygon& polygon, double least_angle) {
  const double cosine = std::cos(least_angle);
  const auto in_ring = [&](const Ring& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i)
      if (is_sharper(ring[(i + ring.size() - 1) % ring.size()], ring[i],
                     ring[(i + 1) % ring.size()], cosine))
        return true;
    return false;
  };
  return in_ring(polygon.outer) || std::any_of(polygon.holes.begin(), polygon.holes.end(), in_ring);
}

std::int64_t chamfer_corners(Outline& outline, const ChamferOptions& options) {
  return CornerChamfer(outline, options).run();
}

}  // namespace tetropolis
