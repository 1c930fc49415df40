#include "tetropolis/check/check_surface.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/geometry/domain.h"

#include "core/infinity.h"
#include "edges.h"
#include "vector3.h"
#include "violations.h"

namespace tetropolis {

namespace {

constexpr const char* kUsedTwice = "edges used twice in one direction";
constexpr const char* kOpen = "open edges";

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

/// Whether a point lies on a side of the domain.
bool is_on(const Domain& domain, std::size_t side, const Vector3& p) {
  const double most_off = domain.is_box() ? 0 : 1e-6;  // points of a slanting side are rounded
  return std::abs(domain.distance_to_side(side, {p[0], p[1]})) <= most_off;
}

/// Whether a face with this normal lies on the side of the domain that the patch is, facing out.
bool is_on_side(const std::array<Vector3, 3>& p, const Vector3& normal, Patch patch,
                const Domain& domain) {
  const std::vector<Domain::Side> sides = domain.sides();
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const auto& [from, to, own] = sides[i];
    if (own == patch && normal[0] * (to.y - from.y) - normal[1] * (to.x - from.x) > 0 &&
        std::all_of(p.begin(), p.end(), [&](const Vector3& q) { return is_on(domain, i, q); }))
      return true;
  }
  return false;
}

/// What is wrong with one face's tags; nothing if it is empty.
std::string tag_violation(const std::array<Vector3, 3>& p, const Vector3& normal,
                          const PatchInfo& patch, BuildingIndex building, const Domain& domain) {
  const double steepness = std::hypot(normal[0], normal[1]);
  const std::vector<PatchInfo>& own = domain.own_patches();
  const bool is_own_side = std::any_of(
      own.begin(), own.end(), [&](const PatchInfo& side) { return side.patch == patch.patch; });
  const PatchKind kind = is_own_side ? PatchKind::kSide : patch.kind;
  if (kind == PatchKind::kOther) return {};
  if (patch.of_building() != (building >= 0))
    return patch.of_building() ? "roof or wall faces without building"
                               : "faces with a building that are neither roof nor wall";
  const auto unless = [&](bool holds, fmt::format_string<const std::string&> what) {
    return holds ? std::string() : fmt::format(what, patch.name);
  };
  switch (kind) {
    case PatchKind::kGround:
    case PatchKind::kRoof:
      return unless(normal[2] < 0, "{} faces that do not face down");
    case PatchKind::kWall:
      return unless(std::abs(normal[2]) <= 1e-9 * steepness, "{} faces that are not vertical");
    case PatchKind::kTop:
      return unless(normal[2] > 0, "{} faces that do not face up");
    case PatchKind::kSide:
      return unless(is_on_side(p, normal, patch.patch, domain), "faces of {} off that side");
    case PatchKind::kOther:
      break;
  }
  return {};
}

enum class Rim { kNone, kOnSides };

/// Two faces along every edge, in opposite directions, but for a rim on the sides of the domain;
/// and buildings stand apart, so faces of two of them share no edge.
void check_edges(const SurfaceMesh& surface, Rim rim, const Domain& domain, SurfaceCheck& check) {
  const std::size_t sides = domain.sides().size();
  const auto is_on_rim = [&](std::int64_t low, const EdgeUse& use) {
    if (rim == Rim::kNone) return false;
    const auto& a = surface.points[static_cast<std::size_t>(low)];
    const auto& b = surface.points[static_cast<std::size_t>(use.high)];
    for (std::size_t i = 0; i < sides; ++i)
      if (is_on(domain, i, a) && is_on(domain, i, b)) return true;
    return false;
  };
  const auto of_building = [&](const EdgeUse& use) {
    return surface.patch_of(use.face).of_building();
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
    if (uses.front().forward == uses.back().forward && !is_on_rim(low, uses.front()))
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

/// Whether triangles f and f + 1 are, to a ten-thousandth of a degree.
bool is_plane(const SurfaceMesh& surface, std::size_t f) {
  const auto p = corners(surface, f), q = corners(surface, f + 1);
  const Vector3 n = area_vector(p[0], p[1], p[2]), m = area_vector(q[0], q[1], q[2]);
  const double sum = length(n) + length(m);
  const Vector3 both{n[0] + m[0], n[1] + m[1], n[2] + m[2]};
  return length(both) >= (1 - 1e-12) * sum;
}

SurfaceCheck check(const SurfaceMesh& surface, Rim rim, const Domain* given = nullptr) {
  SurfaceCheck check;
  check.vertices = static_cast<std::int64_t>(surface.points.size());
  check.quads = static_cast<std::int64_t>(surface.quads.size());
  check.triangles = static_cast<std::int64_t>(surface.triangles.size()) - 2 * check.quads;
  if (surface.triangles.empty())
    note_violation(check.violations, "no faces", [] { return "the file"; });
  for (std::size_t v = 0; v < surface.points.size(); ++v)
    if (!is_finite(surface.points[v]))
      note_violation(check.violations, kCoordinatesNotFinite,
                     [&] { return fmt::format("vertex {}", v); });
  const Box box = bounding_box(surface);
  check.highest = box.high[2];
  check.box = {box.low[0], box.low[1], box.high[0], box.high[1]};
  const Domain domain = given ? *given : Domain(check.box);
  for (const PatchInfo& info : surface.patches) check.faces_by_patch.push_back({info.name, 0});
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
    const PatchInfo& patch = surface.patch_of(f);
    const bool is_half = std::binary_search(surface.quads.begin(), surface.quads.end(),
                                            static_cast<std::int32_t>(f));
    if (!is_half) ++check.faces_by_patch[surface.patches.position(patch.patch)].faces;
    if (const std::string what = tag_violation(p, normal, patch, surface.building[f], domain);
        !what.empty())
      note_violation(check.violations, what.c_str(), place);
    if (patch.kind == PatchKind::kTop)
      for (const Vector3& corner : p) check.lowest_top = std::min(check.lowest_top, corner[2]);
  }
  for (const std::int32_t f : surface.quads)
    if (!is_plane(surface, static_cast<std::size_t>(f)))
      note_violation(check.violations, "quadrilaterals that are not plane",
                     [&] { return fmt::format("face {}", f); });
  check_edges(surface, rim, domain, check);
  return check;
}

}  // namespace

SurfaceCheck check_surface(const SurfaceMesh& surface, const Domain* domain) {
  return check(surface, Rim::kNone, domain);
}

SurfaceCheck check_city_surface(const SurfaceMesh& surface, const Domain* domain) {
  SurfaceMesh turned = surface;
  for (auto& triangle : turned.triangles) std::swap(triangle[1], triangle[2]);
  SurfaceCheck result = check(turned, Rim::kOnSides, domain);
  result.closed = false;
  result.enclosed_volume = 0;
  const auto up = [](Violation& violation) {
    const std::size_t down = violation.what.find("face down");
    if (down != std::string::npos) violation.what.replace(down, 9, "face up");
  };
  std::for_each(result.violations.begin(), result.violations.end(), up);
  return result;
}

}  // namespace tetropolis
