#include "check_ground.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"
#include "core/parallel.h"
#include "core/ragged_builder.h"
#include "core/sort_once.h"
#include "core/units.h"
#include "ground/validate.h"
#include "roof_planes.h"
#include "violations.h"

namespace tetropolis {

namespace {

/// Of the arithmetic here, for what is measured from exact coordinates.
constexpr double kAngleRoundingDeg = 1e-9;
constexpr double kLengthRounding = 1e-11;  // of the length
/// Triangles this little below the minimum angle may be there and may be counted or not.
constexpr double kAngleSlackDeg = 1e-6;
/// More than rounding in the reference system turns edges of centimetres by.
constexpr double kPlanSlackDeg = 1e-4;

double distance(Point2 p, Point2 q) { return std::hypot(p.x - q.x, p.y - q.y); }

class GroundChecker {
 public:
  GroundChecker(const SurfaceMesh& surface, std::array<double, 3> shift, const CityModel& city)
      : surface_(surface), shift_(shift), city_(city), planes_(city) {
    double greatest = 0;
    for (std::size_t v = 0; v < surface.points.size(); ++v) {
      const Point2 p = at(static_cast<std::int32_t>(v));
      for (const double x : {p.x + city.origin.x, p.y + city.origin.y})
        if (std::isfinite(x)) greatest = std::max(greatest, std::abs(x));
    }
    rounding_ = std::nextafter(greatest, kInfinity) - greatest;
    file_faces();
  }

  void measure_angles(double min_angle_deg, GroundCheck& check) const {
    const auto measure = [&](std::size_t begin, std::size_t end) {
      GroundCheck part;
      for (std::size_t f = begin; f < end; ++f)
        if (surface_.patch_of(f).kind == PatchKind::kGround ||
            surface_.patch_of(f).kind == PatchKind::kRoof)
          add_triangle(f, min_angle_deg, part);
      return part;
    };
    check = parallel_reduce_ordered(
        surface_.triangles.size(), 16384, GroundCheck{}, measure,
        [](GroundCheck sum, const GroundCheck& part) {
          sum.triangles += part.triangles;
          sum.least_angle_deg = std::min(sum.least_angle_deg, part.least_angle_deg);
          sum.below += part.below;
          for (std::size_t i = 0; i < 2; ++i) {
            sum.least_angle_bounds_deg[i] =
                std::min(sum.least_angle_bounds_deg[i], part.least_angle_bounds_deg[i]);
            sum.below_bounds[i] += part.below_bounds[i];
          }
          return sum;
        });
  }

  /// Ground and roofs each by themselves: they have no vertices in common.
  void check_small_angles(double min_angle_deg, std::vector<Violation>& violations) const {
    std::vector<Point2> points(surface_.points.size());
    for (std::size_t v = 0; v < points.size(); ++v) points[v] = at(static_cast<std::int32_t>(v));
    for (const PatchKind kind : {PatchKind::kGround, PatchKind::kRoof}) {
      std::map<Patch, std::vector<std::uint32_t>>
          faces;  // edges of roads and waters are input, too
      std::vector<std::array<VertexIndex, 3>> triangles;
      for (std::size_t f = 0; f < surface_.triangles.size(); ++f) {
        const auto& t = surface_.triangles[f];
        const auto finite = [&](std::int32_t v) {
          return std::isfinite(at(v).x) && std::isfinite(at(v).y);
        };
        if (surface_.patch_of(f).kind != kind || !std::all_of(t.begin(), t.end(), finite)) continue;
        faces[surface_.patch[f]].push_back(static_cast<std::uint32_t>(f));
        triangles.push_back({VertexIndex(t[0]), VertexIndex(t[1]), VertexIndex(t[2])});
      }
      std::vector<std::array<VertexIndex, 2>> segments;
      for (const auto& [patch, own] : faces)
        for (const auto& [v, w] : outline(own))
          segments.push_back({VertexIndex(std::min(v, w)), VertexIndex(std::max(v, w))});
      sort_once(segments);
      for (const std::string& found :
           check_angles(points, triangles, segments, min_angle_deg - kPlanSlackDeg))
        note_violation(violations, "angles below the minimum where no input corner is sharper",
                       [&] { return found; });
    }
  }

  void check_outlines(std::vector<Violation>& violations) const {
    const RaggedArray<std::uint32_t> roofs = file_under_rows(
        surface_.triangles.size(), planes_.size(), [&](std::size_t f, const auto& use) {
          if (part_of_[f] != kNoPart) use(part_of_[f]);
        });
    const auto look = [&](std::size_t begin, std::size_t end, std::vector<Violation>& found) {
      for (std::size_t b = begin; b < end; ++b) {
        const Building& building = city_.buildings[b];
        const auto index = static_cast<BuildingIndex>(b);
        for (std::size_t part = 0; part < planes_.parts(index); ++part) {
          const std::string name = building.parts.empty()
                                       ? "building " + building.id
                                       : fmt::format("part {} of building {}", part, building.id);
          check_outline(planes_.outline(index, part), name, roofs[planes_.first(index) + part],
                        found);
        }
      }
    };
    add_violations(violations, sum_of_violations(city_.buildings.size(), look));
  }

 private:
  using MeshEdge = std::pair<std::int32_t, std::int32_t>;
  static constexpr std::size_t kNoPart = static_cast<std::size_t>(-1);

  /// Looks which part each roof face is over.
  void file_faces() {
    part_of_.assign(surface_.triangles.size(), kNoPart);
    parallel_chunks(part_of_.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) {
        const BuildingIndex b = surface_.building[f];
        if (surface_.patch_of(f).kind == PatchKind::kRoof && b < city_.buildings.size())
          part_of_[f] = part_under(f, b);
      }
    });
  }

  std::size_t part_under(std::size_t f, BuildingIndex b) const {
    const auto& t = surface_.triangles[f];
    const Point2 p = at(t[0]), q = at(t[1]), r = at(t[2]);
    const std::optional<std::size_t> part =
        planes_.part_at(b, {(p.x + q.x + r.x) / 3, (p.y + q.y + r.y) / 3});
    return part ? planes_.first(b) + *part : kNoPart;
  }

  /// In the local frame of the city model.
  Point2 at(std::int32_t v) const {
    const auto& p = surface_.points[static_cast<std::size_t>(v)];
    return {p[0] + shift_[0], p[1] + shift_[1]};
  }

  void add_triangle(std::size_t f, double min_angle_deg, GroundCheck& check) const {
    const auto& t = surface_.triangles[f];
    double least = kInfinity, shortest = least;
    for (std::size_t i = 0; i < 3; ++i) {
      const Point2 p = at(t[i]), q = at(t[(i + 1) % 3]), r = at(t[(i + 2) % 3]);
      const double ux = q.x - p.x, uy = q.y - p.y, vx = r.x - p.x, vy = r.y - p.y;
      least = std::min(least, std::atan2(std::abs(ux * vy - uy * vx), ux * vx + uy * vy));
      shortest = std::min(shortest, distance(p, q));
    }
    // A vertex is off by less than `rounding_`, so an edge turns by less than twice that over its
    // length.
    const double angle_deg = to_degrees(least);
    const double error_deg = to_degrees(4 * rounding_ / shortest) + kAngleRoundingDeg;
    ++check.triangles;
    check.least_angle_deg = std::min(check.least_angle_deg, angle_deg);
    check.least_angle_bounds_deg[0] =
        std::min(check.least_angle_bounds_deg[0], angle_deg - error_deg);
    check.least_angle_bounds_deg[1] =
        std::min(check.least_angle_bounds_deg[1], angle_deg + error_deg);
    if (angle_deg < min_angle_deg - kAngleSlackDeg) ++check.below;
    if (angle_deg + error_deg < min_angle_deg - kAngleSlackDeg) ++check.below_bounds[0];
    if (angle_deg - error_deg < min_angle_deg) ++check.below_bounds[1];
  }

  /// The edges with a face on one side only, or faces of two parts.
  std::vector<MeshEdge> outline(std::span<const std::uint32_t> faces) const {
    std::vector<std::pair<MeshEdge, std::size_t>> edges;
    for (const std::uint32_t f : faces)
      for (std::size_t i = 0; i < 3; ++i)
        edges.emplace_back(
            std::minmax({surface_.triangles[f][i], surface_.triangles[f][(i + 1) % 3]}),
            part_of_[f]);
    std::sort(edges.begin(), edges.end());
    std::vector<MeshEdge> kept;
    for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
      while (j < edges.size() && edges[j].first == edges[i].first) ++j;
      if (j - i == 1 || edges[i].second != edges[j - 1].second) kept.push_back(edges[i].first);
    }
    return kept;
  }

  void check_outline(const Polygon& polygon, const std::string& name,
                     std::span<const std::uint32_t> faces,
                     std::vector<Violation>& violations) const {
    if (faces.empty()) {
      note_violation(violations, "buildings without roof faces", [&] { return name; });
      return;
    }
    const std::vector<MeshEdge> edges = outline(faces);
    double length = 0;
    std::vector<Point2> vertices;
    for (const auto& [v, w] : edges) {
      length += distance(at(v), at(w));
      for (const Point2 p : {at(v), at(w)})
        if (std::isfinite(p.x) && std::isfinite(p.y)) vertices.push_back(p);
    }
    std::sort(vertices.begin(), vertices.end(), [](Point2 p, Point2 q) { return p.x < q.x; });
    double perimeter = 0;
    for_each_ring(polygon, [&](const Ring& ring) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        perimeter += distance(ring[i], ring[(i + 1) % ring.size()]);
        if (is_among(vertices, ring[i])) continue;
        note_violation(violations, "footprint vertices off the roof's outline", [&] {
          return fmt::format("{} at ({:.4f}, {:.4f})", name, ring[i].x, ring[i].y);
        });
      }
    });
    // Both ends of an edge of the outline may be off.
    const double tolerance = 2 * rounding_ * static_cast<double>(edges.size()) +
                             kLengthRounding * std::min(length, perimeter);
    if (!(std::abs(length - perimeter) <= tolerance))
      note_violation(violations, "roof outlines that leave the footprint's edges", [&] {
        return fmt::format("{}: outline of {:.6f} m, footprint of {:.6f} m", name, length,
                           perimeter);
      });
  }

  /// `vertices` by x.
  bool is_among(const std::vector<Point2>& vertices, Point2 p) const {
    auto at = std::lower_bound(vertices.begin(), vertices.end(), p.x - rounding_,
                               [](Point2 vertex, double x) { return vertex.x < x; });
    for (; at != vertices.end() && at->x <= p.x + rounding_; ++at)
      if (std::abs(at->y - p.y) <= rounding_) return true;
    return false;
  }

  const SurfaceMesh& surface_;
  std::array<double, 3> shift_;
  const CityModel& city_;
  RoofPlanes planes_;
  std::vector<std::size_t> part_of_;  ///< Per face of a roof its part, counted through.
  /// Distance of the doubles at the largest coordinate in the reference system: vertices are off by
  /// at most half of it in x and in y.
  double rounding_;
};

}  // namespace

GroundCheck check_ground(const SurfaceMesh& surface, std::array<double, 3> shift,
                         const CityModel& city, double min_angle_deg) {
  GroundCheck check;
  const GroundChecker checker(surface, shift, city);
  checker.measure_angles(min_angle_deg, check);
  if (check.below_bounds[0] > 0) checker.check_small_angles(min_angle_deg, check.violations);
  checker.check_outlines(check.violations);
  return check;
}

}  // namespace tetropolis
