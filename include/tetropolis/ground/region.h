// What the triangles of the ground mesh stand for.
#pragma once

#include <cstdint>

#include "tetropolis/geometry/patch.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

enum class RegionKind : std::uint8_t { kOpenGround, kBuildingPart };

/// A set of triangles with one floor: what the air over them stands on.
struct Region {
  RegionKind kind = RegionKind::kOpenGround;
  BuildingIndex building = kNoBuilding;  ///< Whose part it is.
  std::int32_t part = 0;                 ///< Number of the part within its building.
  Patch floor = Patch::kGround;          ///< Patch of the floor's faces.

  bool is_building() const { return kind == RegionKind::kBuildingPart; }
  friend bool operator==(const Region&, const Region&) = default;
};

}  // namespace tetropolis
