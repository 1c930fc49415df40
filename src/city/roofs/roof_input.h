// What the roof of one building is made from. Private to src/city.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/core/ragged_array.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

struct RoofInput {
  Polygon footprint;                       ///< Of the building.
  std::vector<const Polygon*> members;     ///< The footprints it is merged from; never empty.
  RaggedArray<Point3> points;              ///< Per member: its roof points.
  std::vector<std::uint8_t> stays_flat{};  ///< Per member, 1: one flat roof (LoD1.2) whatever the
                                           ///< LoD asked for. Empty: none does.
};

/// An index of RoofInput::members.
using MemberNumber = std::int32_t;
/// A region of a roof: what becomes a part.
using RoofRegion = std::int32_t;

}  // namespace tetropolis
