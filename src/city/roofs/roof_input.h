// What the roof of one building is made from. Private to src/city.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tetropolis/core/ragged_array.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// What points of a member tell.
enum class RoofSource : std::uint8_t {
  kMeasured,
  kStated,  ///< They stand for roofs that the input states,
  kLevel,   ///< or for its height.
};

struct RoofInput {
  Polygon footprint;                    ///< Of the building.
  std::vector<const Polygon*> members;  ///< The footprints it is merged from; never empty.
  std::vector<double> heights;          ///< Per member: of its roof, elevation.
  RaggedArray<Point3> points;           ///< Per member: its roof points.
  std::vector<RoofSource> sources;      ///< Per member.

  /// Points per square metre of a member, 0.05 at least.
  double density(std::size_t member) const {
    return std::max(0.05, static_cast<double>(points[member].size()) / area(*members[member]));
  }
};

/// An index of RoofInput::members.
using MemberNumber = std::int32_t;
/// A region of a roof: what becomes a part.
using RoofRegion = std::int32_t;

}  // namespace tetropolis
