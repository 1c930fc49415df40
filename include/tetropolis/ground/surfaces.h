// Water, roads and vegetation: areas of the ground whose edges become edges of the mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Where areas overlap, the kind that comes first here has the ground.
enum class SurfaceKind : std::uint8_t { kWater, kRoad, kVegetation };
inline constexpr std::array<std::string_view, 3> kSurfaceKindNames = {"water", "road",
                                                                      "vegetation"};

/// Also the name of its patch.
constexpr std::string_view name_of(SurfaceKind kind) {
  return kSurfaceKindNames[static_cast<std::size_t>(kind)];
}

struct SurfaceArea {
  SurfaceKind kind = SurfaceKind::kWater;
  Polygon area;  ///< Any polygon. Of mesh_city: CRS coordinates.
};

/// A straight piece of the line between two areas, of a building's outline or of a side of the
/// domain, with what is left and right of it.
struct SurfaceLine {
  static constexpr std::int32_t kOpenGround = -1;
  static constexpr std::int32_t kBeyond = -2;  ///< A building, or what is outside the domain.
  Point2 from, to;
  std::int32_t left = kOpenGround;  ///< Index in Surfaces::kinds, or one of these.
  std::int32_t right = kOpenGround;
};

/// The ground divided into areas. Lines meet at their ends only; all outlines of buildings and all
/// sides of the domain are there, unless there is no area.
struct Surfaces {
  std::vector<SurfaceKind> kinds;  ///< Of each area, which is connected.
  std::vector<SurfaceLine> lines;
  std::array<double, 3> area_given{};   ///< By kind, in the domain and outside buildings, m2,
  std::array<double, 3> area_meshed{};  ///< and what is left of it.
};

}  // namespace tetropolis
