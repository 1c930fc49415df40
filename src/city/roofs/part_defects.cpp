#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/city/roofs.h"
#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/geometry/polygon.h"

#include "city/grid_geometry.h"
#include "city/roofs/plane_fit.h"
#include "core/sort_once.h"

namespace tetropolis {

namespace {

using Vertex = std::pair<double, double>;  // steps
using Side = std::pair<Vertex, Vertex>;

Vertex vertex(Point2 p) { return {p.x, p.y}; }
Point2 point(const Vertex& v) { return {v.first, v.second}; }

class Examination {
 public:
  Examination(const Building& building, double clearance, double min_area)
      : building_(building), clearance_(clearance), min_area_(min_area) {}

  std::vector<std::string> run() {
    examine_parts();
    if (defects_.empty()) examine_tiling();
    if (defects_.empty()) examine_clearance();
    if (defects_.empty()) examine_angles();
    return std::move(defects_);
  }

 private:
  template <typename... Args>
  void report(fmt::format_string<Args...> text, Args&&... args) {
    defects_.push_back(fmt::format("building {}: ", building_.id) +
                       fmt::format(text, std::forward<Args>(args)...));
  }

  void examine_parts() {
    for (std::size_t k = 0; k < building_.parts.size(); ++k) {
      const RoofPart& part = building_.parts[k];
      for (const FootprintDefect& defect : footprint_defects(std::span(&part.outline, 1)))
        report("part {}: {}", k, defect.message);
      constexpr double kRounding = 1e-9;
      if (area(part.outline) < min_area_ - kRounding)
        report("part {}: {:.3f} m2 is less than {} m2", k, area(part.outline), min_area_);
      if (slope_of(part.roof) > kMaxRoofSlope + 1e-3)
        report("part {}: its roof is steeper than 70 degrees", k);
    }
  }

  /// Every side of a part is one of another part's, the other way round, or one of the footprint.
  void examine_tiling() {
    for (const RoofPart& part : building_.parts)
      for_each_edge(part.outline, [&](Point2 a, Point2 b) { add(a, b, 1); });
    std::map<Side, int> inner = sides_;
    for_each_edge(building_.footprint, [&](Point2 a, Point2 b) {
      const Side side{vertex(grid::to_steps(a)), vertex(grid::to_steps(b))};
      if (const auto found = inner.find(side); found == inner.end())
        report("no part has the footprint's side from ({}, {}) to ({}, {})", a.x, a.y, b.x, b.y);
      else
        inner.erase(found);
      outline_.push_back(side);
    });
    for (const auto& [side, count] : inner) {
      const auto other = inner.find({side.second, side.first});
      if (count != 1 || other == inner.end() || other->second != 1)
        report("the side from ({}, {}) to ({}, {}) belongs to no two parts",
               side.first.first / grid::kSteps, side.first.second / grid::kSteps,
               side.second.first / grid::kSteps, side.second.second / grid::kSteps);
      else if (side.first < side.second)
        inner_.push_back(side);
    }
    double sum = 0;
    for (const RoofPart& part : building_.parts) sum += area(part.outline);
    const double whole = area(building_.footprint);
    if (std::abs(sum - whole) > 1e-9 * whole)
      report("its parts have {} m2 in all, its footprint {} m2", sum, whole);
  }

  void add(Point2 a, Point2 b, int count) {
    sides_[{vertex(grid::to_steps(a)), vertex(grid::to_steps(b))}] += count;
  }

  void examine_clearance() {
    std::vector<Side> all = outline_;
    all.insert(all.end(), inner_.begin(), inner_.end());
    std::vector<Vertex> vertices;
    for (const Side& side : all) {
      vertices.push_back(side.first);
      vertices.push_back(side.second);
    }
    sort_once(vertices);
    const double reach = clearance_ * grid::kSteps;
    for (const Side& side : all) {
      const double west = std::min(side.first.first, side.second.first) - reach;
      const double east = std::max(side.first.first, side.second.first) + reach;
      for (auto v = std::lower_bound(vertices.begin(), vertices.end(), Vertex{west, -1e300});
           v != vertices.end() && v->first <= east; ++v) {
        if (*v == side.first || *v == side.second) continue;
        const double d =
            grid::point_segment_distance(point(*v), point(side.first), point(side.second));
        if (!is_clear(d / grid::kSteps, clearance_))
          report("{:.4f} m between vertex ({}, {}) and an edge at ({}, {})", d / grid::kSteps,
                 v->first / grid::kSteps, v->second / grid::kSteps, side.first.first / grid::kSteps,
                 side.first.second / grid::kSteps);
      }
    }
  }

  void examine_angles() {
    struct Spoke {
      double angle;
      bool is_outline;
    };
    std::map<Vertex, std::vector<Spoke>> spokes;
    const auto enter = [&](const Side& side, bool is_outline) {
      const auto direction = [](const Vertex& a, const Vertex& b) {
        return std::atan2(b.second - a.second, b.first - a.first);
      };
      spokes[side.first].push_back({direction(side.first, side.second), is_outline});
      spokes[side.second].push_back({direction(side.second, side.first), is_outline});
    };
    for (const Side& side : outline_) enter(side, true);
    for (const Side& side : inner_) enter(side, false);
    constexpr double kLeast = 15 * std::numbers::pi / 180;
    for (auto& [at, list] : spokes) {
      std::sort(list.begin(), list.end(),
                [](const Spoke& a, const Spoke& b) { return a.angle < b.angle; });
      for (std::size_t k = 0; k < list.size(); ++k) {
        const Spoke& a = list[k];
        const Spoke& b = list[(k + 1) % list.size()];
        double angle = b.angle - a.angle;
        if (k + 1 == list.size()) angle += 2 * std::numbers::pi;
        if (angle < kLeast && !(a.is_outline && b.is_outline))
          report("lines meet at {:.1f} degrees at ({}, {})", angle * 180 / std::numbers::pi,
                 at.first / grid::kSteps, at.second / grid::kSteps);
      }
    }
  }

  const Building& building_;
  double clearance_;
  double min_area_;
  std::map<Side, int> sides_;
  std::vector<Side> outline_, inner_;
  std::vector<std::string> defects_;
};

}  // namespace

std::vector<std::string> part_defects(std::span<const Building> buildings, double clearance,
                                      double min_area, std::size_t limit) {
  std::vector<std::string> result;
  for (const Building& building : buildings) {
    if (building.parts.empty()) continue;
    for (std::string& defect : Examination(building, clearance, min_area).run())
      if (result.size() < limit) result.push_back(std::move(defect));
  }
  return result;
}

}  // namespace tetropolis
