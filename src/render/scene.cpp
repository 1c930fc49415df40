#include "scene.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include "core/infinity.h"

namespace tetropolis {

namespace {

/// Of a turned box, a cylinder or a polygon (fit_wind_domain).
bool is_own_side(const std::string& name) {
  return name == "inlet" || name == "outlet" || name == "side" || name.starts_with("side_") ||
         name.starts_with("sector_");
}

/// Faces of no known kind are those of sides by their names, or roofs and walls by their slope.
PatchKind shown_kind(const SurfaceMesh& surface, std::size_t f) {
  const PatchInfo& patch = surface.patch_of(f);
  if (patch.kind != PatchKind::kOther) return patch.kind;
  if (is_own_side(patch.name)) return PatchKind::kSide;
  std::array<Vec3, 3> p;
  for (std::size_t i = 0; i < 3; ++i)
    p[i] = Vec3(surface.points[static_cast<std::size_t>(surface.triangles[f][i])]);
  constexpr double kSteep = 0.3;
  const Vec3 normal = normalised(cross(p[1] - p[0], p[2] - p[0]));
  return std::abs(normal.z) < kSteep ? PatchKind::kWall : PatchKind::kRoof;
}

double mean_elevation(const SurfaceMesh& surface, std::size_t f) {
  double sum = 0;
  for (const std::int32_t v : surface.triangles[f])
    sum += surface.points[static_cast<std::size_t>(v)][2] / 3;
  return sum;
}

/// Elevations of the lowest points of buildings.
std::map<BuildingIndex, double> bases(const SurfaceMesh& surface) {
  std::map<BuildingIndex, double> result;
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    if (!surface.building[f].valid()) continue;
    double& low = result.try_emplace(surface.building[f], kInfinity).first->second;
    for (const std::int32_t v : surface.triangles[f])
      low = std::min(low, surface.points[static_cast<std::size_t>(v)][2]);
  }
  return result;
}

/// Colours that neighbouring numbers tell apart: hues by the golden ratio.
Rgb colour_of(BuildingIndex building) {
  constexpr double kGolden = 0.61803398875;
  const double hue = 6 * std::fmod(static_cast<double>(building.value()) * kGolden, 1.0);
  const auto channel = [&](double at) {
    const double distance = std::abs(std::fmod(hue - at + 9, 6.0) - 3);
    return 0.42 + 0.42 * std::clamp(2 - distance, 0.0, 1.0);
  };
  const auto byte = [&](double at) {
    return static_cast<unsigned>(std::lround(channel(at) * 255));
  };
  return linear(byte(0) << 16U | byte(2) << 8U | byte(4));
}

/// Adds the triangle's normal, upwards and by its area, to those of its corners.
void add_normal(const std::array<std::int32_t, 3>& corners, Scene& scene) {
  const auto p = [&](std::size_t i) { return scene.points[static_cast<std::size_t>(corners[i])]; };
  const Vec3 n = cross(p(1) - p(0), p(2) - p(0));
  for (const std::int32_t v : corners) {
    Vec3& sum = scene.normals[static_cast<std::size_t>(v)];
    sum = sum + (n.z < 0 ? -1.0 : 1.0) * n;
  }
}

/// Takes away points without triangles.
void drop_unused_points(Scene& scene) {
  std::vector<std::int32_t> number(scene.points.size(), -1);
  for (const auto& t : scene.triangles)
    for (const std::int32_t v : t) number[static_cast<std::size_t>(v)] = 0;
  std::int32_t count = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    scene.points[static_cast<std::size_t>(count)] = scene.points[i];
    scene.normals[static_cast<std::size_t>(count)] = scene.normals[i];
    number[i] = count++;
  }
  scene.points.resize(static_cast<std::size_t>(count));
  scene.normals.resize(static_cast<std::size_t>(count));
  for (auto& t : scene.triangles)
    for (std::int32_t& v : t) v = number[static_cast<std::size_t>(v)];
}

class Colours {
 public:
  Colours(const SurfaceMesh& surface, PictureColour colour) : surface_(surface), colour_(colour) {
    if (colour != PictureColour::kHeight) return;
    bases_ = bases(surface);
    for (std::size_t f = 0; f < surface.triangles.size(); ++f)
      if (surface.building[f].valid()) highest_ = std::max(highest_, height(f));
  }

  double highest() const { return highest_; }

  Rgb of(std::size_t f, PatchKind kind) const {
    const Palette palette;
    if (kind == PatchKind::kGround) return of_ground(surface_.patch_of(f).name, palette);
    const BuildingIndex building = surface_.building[f];
    const bool by_class = colour_ == PictureColour::kClass || colour_ == PictureColour::kQuality;
    if (by_class || !building.valid())
      return kind == PatchKind::kRoof ? palette.roof : palette.wall;
    if (colour_ == PictureColour::kHeight)
      return kind == PatchKind::kRoof ? ramp(height(f) / std::max(highest_, 1e-9)) : palette.wall;
    const Rgb roof = colour_of(building);
    return kind == PatchKind::kRoof ? roof : mix(roof, palette.wall, 0.5F);
  }

 private:
  /// Of a face of a building above the lowest point of that.
  double height(std::size_t f) const {
    return mean_elevation(surface_, f) - bases_.at(surface_.building[f]);
  }

  /// By the names of surface layers' patches.
  static Rgb of_ground(const std::string& name, const Palette& palette) {
    if (name == "water") return palette.water;
    if (name == "road") return palette.road;
    return name == "vegetation" ? palette.vegetation : palette.ground;
  }

  const SurfaceMesh& surface_;
  PictureColour colour_;
  std::map<BuildingIndex, double> bases_;
  double highest_ = 0;
};

}  // namespace

std::string why_not_drawn(const SurfaceMesh& surface) {
  for (const Point3& p : surface.points)
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
      return "has a point whose coordinates are not finite";
  const bool is_empty = std::all_of(surface.patch.begin(), surface.patch.end(), [&](Patch patch) {
    const PatchKind kind = surface.patches.of(patch).kind;
    return kind == PatchKind::kTop || kind == PatchKind::kSide;
  });
  return is_empty ? "has no ground, roof or wall to draw" : "";
}

Rgb ramp(double value) {
  // Dark blue, teal, green, yellow: lightness rises all the way.
  constexpr std::array kStops = {0x3B4C7AU, 0x2F7F93U, 0x57B07AU, 0xB8CF5CU, 0xF6DE64U};
  const double at = std::clamp(value, 0.0, 1.0) * (kStops.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(at), kStops.size() - 2);
  return mix(linear(kStops[i]), linear(kStops[i + 1]),
             static_cast<float>(at - static_cast<double>(i)));
}

Scene city_scene(const SurfaceMesh& surface, PictureColour colour, bool edges) {
  Scene scene;
  scene.points.reserve(surface.points.size());
  for (const Point3& p : surface.points) scene.points.emplace_back(p);
  scene.normals.resize(scene.points.size());
  const Colours colours(surface, colour);
  scene.highest = colours.highest();
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    const PatchKind kind = shown_kind(surface, f);
    if (kind == PatchKind::kTop || kind == PatchKind::kSide) continue;
    scene.add(surface.triangles[f], colours.of(f, kind), edges ? kAllEdges : std::uint8_t{0});
    if (kind == PatchKind::kGround) add_normal(surface.triangles[f], scene);
  }
  for (Vec3& normal : scene.normals) normal = normalised(normal);
  drop_unused_points(scene);
  return scene;
}

void add_slab(Scene& scene, double floor) {
  struct Edge {
    std::int32_t low, high;
    bool operator<(const Edge& other) const {
      return low < other.low || (low == other.low && high < other.high);
    }
    bool operator==(const Edge& other) const { return low == other.low && high == other.high; }
  };
  std::vector<Edge> edges;
  edges.reserve(scene.triangles.size() * 3);
  for (const auto& t : scene.triangles)
    for (std::size_t i = 0; i < 3; ++i)
      edges.push_back({std::min(t[i], t[(i + 1) % 3]), std::max(t[i], t[(i + 1) % 3])});
  std::sort(edges.begin(), edges.end());
  const Palette palette;
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if (end == i + 1) {
      const auto below = [&](std::int32_t v) {
        const Vec3 p = scene.points[static_cast<std::size_t>(v)];
        return scene.add(Vec3{p.x, p.y, floor});
      };
      const std::int32_t c = below(edges[i].low), d = below(edges[i].high);
      scene.add({edges[i].low, edges[i].high, d}, palette.earth);
      scene.add({edges[i].low, d, c}, palette.earth);
    }
    i = end;
  }
}

void move(Scene& scene, Vec3 by) {
  for (Vec3& p : scene.points) p = p + by;
}

Scene clipped(const Scene& scene, Vec3 normal, double offset) {
  Scene kept;
  kept.points = scene.points;
  kept.normals = scene.normals;
  kept.highest = scene.highest;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    const auto& corners = scene.triangles[t];
    std::array<double, 3> d;
    for (std::size_t i = 0; i < 3; ++i)
      d[i] = dot(scene.points[static_cast<std::size_t>(corners[i])], normal) - offset;
    if (d[0] >= 0 && d[1] >= 0 && d[2] >= 0) {
      kept.add(corners, scene.colour[t], scene.edges[t]);
      continue;
    }
    std::vector<std::int32_t> polygon;
    std::vector<bool> drawn;  // from each corner to the next
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      const bool is_drawn = (scene.edges[t] >> i & 1U) != 0;
      if (d[i] >= 0) {
        polygon.push_back(corners[i]);
        drawn.push_back(is_drawn);
      }
      if ((d[i] >= 0) == (d[j] >= 0)) continue;
      const Vec3 a = scene.points[static_cast<std::size_t>(corners[i])];
      const Vec3 b = scene.points[static_cast<std::size_t>(corners[j])];
      const double share = d[i] / (d[i] - d[j]);
      polygon.push_back(kept.add(a + share * (b - a)));
      drawn.push_back(is_drawn && d[i] < 0);
      const Vec3 na = scene.normals[static_cast<std::size_t>(corners[i])];
      const Vec3 nb = scene.normals[static_cast<std::size_t>(corners[j])];
      if (dot(na, nb) > 0) kept.normals.back() = normalised(na + share * (nb - na));
    }
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      const bool is_first = i == 2, is_last = i + 1 == polygon.size();
      const unsigned edges = (is_first && drawn[0] ? 1U : 0U) | (drawn[i - 1] ? 2U : 0U) |
                             (is_last && drawn[i] ? 4U : 0U);
      kept.add({polygon[0], polygon[i - 1], polygon[i]}, scene.colour[t],
               static_cast<std::uint8_t>(edges));
    }
  }
  drop_unused_points(kept);
  return kept;
}

}  // namespace tetropolis
