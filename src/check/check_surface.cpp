#include "tetropolis/check/check_surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "core/infinity.h"
#include "edges.h"
#include "vector3.h"
#include "violations.h"

namespace tetropolis {

namespace {

constexpr const char* kUsedTwice = "edges used twice in one direction";
constexpr const char* kOpen = "open edges";
constexpr const char* kNotFinite = "coordinates that are not finite";

Vector3 area_vector(const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 twice = cross(difference(b, a), difference(c, a));
  return {twice[0] / 2, twice[1] / 2, twice[2] / 2};
}

struct Box {
  Vector3 low, high;
};

Box bounding_box(const SurfaceMesh& surface) {
  Box box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (const auto& p : surface.points)
    for (std::size_t d = 0; d < 3; ++d) {
      box.low[d] = std::min(box.low[d], p[d]);
      box.high[d] = std::max(box.high[d], p[d]);
    }
  return box;
}

/// What is wrong with one face's tags, or nullptr.
const char* tag_violation(const std::array<Vector3, 3>& p, const Vector3& normal, Patch patch,
                          BuildingIndex building, const Box& box) {
  const auto all_at = [&](std::size_t axis, double value) {
    return p[0][axis] == value && p[1][axis] == value && p[2][axis] == value;
  };
  const double steepness = std::hypot(normal[0], normal[1]);
  const bool has_building = patch == Patch::kRoof || patch == Patch::kWall;
  if (has_building != (building >= 0))
    return has_building ? "roof or wall faces without building"
                        : "faces with a building that are neither roof nor wall";
  switch (patch) {
    case Patch::kGround:
      return normal[2] < 0 ? nullptr : "ground faces that do not face down";
    case Patch::kRoof:
      if (!(normal[2] < 0)) return "roof faces that do not face down";
      return p[0][2] == p[1][2] && p[0][2] == p[2][2] ? nullptr : "roof faces that are not level";
    case Patch::kWall:
      return std::abs(normal[2]) <= 1e-9 * steepness ? nullptr : "wall faces that are not vertical";
    case Patch::kTop:
      return normal[2] > 0 ? nullptr : "top faces that do not face up";
    case Patch::kXMin:
      return all_at(0, box.low[0]) && normal[0] < 0 ? nullptr : "faces of xmin off that side";
    case Patch::kXMax:
      return all_at(0, box.high[0]) && normal[0] > 0 ? nullptr : "faces of xmax off that side";
    case Patch::kYMin:
      return all_at(1, box.low[1]) && normal[1] < 0 ? nullptr : "faces of ymin off that side";
    case Patch::kYMax:
      return all_at(1, box.high[1]) && normal[1] > 0 ? nullptr : "faces of ymax off that side";
  }
  return "faces without a patch";
}

/// Two faces along every edge, in opposite directions; and buildings stand apart, so faces of two
/// of them share no edge.
void check_edges(const SurfaceMesh& surface, SurfaceCheck& check) {
  const auto of_building = [&](const EdgeUse& use) {
    return surface.patch[use.face] == Patch::kRoof || surface.patch[use.face] == Patch::kWall;
  };
  const auto look = [&](std::int64_t low, std::span<const EdgeUse> uses,
                        std::vector<Violation>& violations) {
    const auto place = [&] {
      return fmt::format("edge between vertices {} and {}", low, uses[0].high);
    };
    for (std::size_t i = 1; i < uses.size(); ++i) {
      if (uses[i].forward == uses[i - 1].forward) note_violation(violations, kUsedTwice, place);
      const BuildingIndex a = surface.building[uses[i - 1].face],
                          b = surface.building[uses[i].face];
      if (a != b && of_building(uses[i - 1]) && of_building(uses[i]))
        note_violation(violations, "neighbouring roof and wall faces of different buildings",
                       [&] { return fmt::format("buildings {} and {}", a, b); });
    }
    // Forward uses come first.
    if (uses.front().forward == uses.back().forward)
      for (std::size_t i = 0; i < uses.size(); ++i) note_violation(violations, kOpen, place);
  };
  const auto found = look_at_edges(surface.triangles, surface.points.size(), look);
  const auto none = [&](std::string_view what) {
    return std::none_of(found.begin(), found.end(),
                        [&](const Violation& violation) { return violation.what == what; });
  };
  check.manifold = none(kUsedTwice);
  check.closed = none(kOpen);
  add_violations(check.violations, found);
}

std::array<Vector3, 3> corners(const SurfaceMesh& surface, std::size_t f) {
  const auto& t = surface.triangles[f];
  return {surface.points[static_cast<std::size_t>(t[0])],
          surface.points[static_cast<std::size_t>(t[1])],
          surface.points[static_cast<std::size_t>(t[2])]};
}

}  // namespace

SurfaceCheck check_surface(const SurfaceMesh& surface) {
  SurfaceCheck check;
  check.vertices = static_cast<std::int64_t>(surface.points.size());
  check.triangles = static_cast<std::int64_t>(surface.triangles.size());
  if (surface.triangles.empty())
    note_violation(check.violations, "no faces", [] { return "the file"; });
  for (std::size_t v = 0; v < surface.points.size(); ++v)
    if (!is_finite(surface.points[v]))
      note_violation(check.violations, kNotFinite, [&] { return fmt::format("vertex {}", v); });
  const Box box = bounding_box(surface);
  check.highest = box.high[2];
  check.box = {box.low[0], box.low[1], box.high[0], box.high[1]};
  std::map<BuildingIndex, double> roof;
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    const auto p = corners(surface, f);
    const Vector3 normal = area_vector(p[0], p[1], p[2]);
    const auto place = [&] {
      return fmt::format("face {} at ({:.3f}, {:.3f}, {:.3f})", f, p[0][0], p[0][1], p[0][2]);
    };
    const double size = length(normal);
    check.area += size;
    if (!(size > 0)) note_violation(check.violations, "faces without area", place);
    for (std::size_t d = 0; d < 3; ++d)
      check.enclosed_volume += normal[d] * (p[0][d] - box.low[d]) / 3;
    const Patch patch = surface.patch[f];
    ++check.faces_by_patch[static_cast<std::size_t>(patch) - 1];
    if (const char* what = tag_violation(p, normal, patch, surface.building[f], box))
      note_violation(check.violations, what, place);
    if (patch == Patch::kTop)
      for (const Vector3& corner : p) check.lowest_top = std::min(check.lowest_top, corner[2]);
    if (patch == Patch::kRoof &&
        roof.try_emplace(surface.building[f], p[0][2]).first->second != p[0][2])
      note_violation(check.violations, "roofs of one building at different heights", place);
  }
  check_edges(surface, check);
  return check;
}

}  // namespace tetropolis
