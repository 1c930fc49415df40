// Points that a caller has in memory, such as NumPy arrays.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "tetropolis/io/las/las.h"

namespace tetropolis {

/// Arrays of n points that outlive their use.
struct PointArrays {
  std::span<const std::array<double, 3>> xyz;      ///< n; CRS coordinates, z in metres.
  std::span<const std::uint8_t> classification{};  ///< n ASPRS classes, or none: never classified.
  std::span<const std::uint8_t> withheld{};        ///< n of 0 or 1, or none: no point is.
  std::string source = "points";                   ///< What messages call them.
  std::string crs = {};                            ///< As normalise_crs takes it; "" if unknown.
};

/// What read_points makes of a file with these points, by the same options. Points with a
/// coordinate that is not finite are left out ("points_not_finite").
///
/// Errors: kUsage for arrays of other sizes than xyz's, or a bad crs; kInput if points kept lie
/// farther from the origin than a PointCoordinate reaches.
PointsInput take_points(const PointArrays& points, const ReadPointsOptions& options = {});

}  // namespace tetropolis
