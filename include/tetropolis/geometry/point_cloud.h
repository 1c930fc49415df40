// A point cloud in flat arrays.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "tetropolis/core/buffer.h"

namespace tetropolis {

/// A coordinate of a point as a whole number of tenths of a millimetre: what airborne LiDAR tells
/// (whole millimetres or centimetres) without a loss in half the memory of a double. Reads as the
/// double nearest to it.
class PointCoordinate {
 public:
  static constexpr double kPerMetre = 1e4;
  static constexpr double kMost = 214'748;  ///< Metres either side of 0 that there is room for.

  PointCoordinate() = default;
  /// The nearest, the lowest or the highest there is. Precondition: a number.
  PointCoordinate(double metres)  // NOLINT(google-explicit-constructor)
      : tenths_(nearest(std::clamp(metres, -kMost, kMost) * kPerMetre)) {}
  operator double() const { return tenths_ / kPerMetre; }  // NOLINT(google-explicit-constructor)

  /// What fmt prints; from release 10 on it converts nothing by itself.
  friend double format_as(PointCoordinate coordinate) { return coordinate; }

  /// For loops over many. Precondition: at most kMost * kPerMetre either side of 0.
  static PointCoordinate of_tenth_millimetres(double tenths) {
    PointCoordinate result;
    result.tenths_ = nearest(tenths);
    return result;
  }

 private:
  static std::int32_t nearest(double tenths) {
    return static_cast<std::int32_t>(tenths + std::copysign(0.5, tenths));
  }

  std::int32_t tenths_;
};

/// Four arrays of one length. x and y are metres in the local frame, z is metres of elevation.
struct PointCloud {
  Buffer<PointCoordinate> x;
  Buffer<PointCoordinate> y;
  Buffer<PointCoordinate> z;
  Buffer<std::uint8_t> classification;  ///< ASPRS class code, see PointClass.

  std::size_t size() const { return x.size(); }
  void push_back(PointCoordinate px, PointCoordinate py, PointCoordinate pz, std::uint8_t code) {
    x.push_back(px);
    y.push_back(py);
    z.push_back(pz);
    classification.push_back(code);
  }
};

/// The points number begin to end - 1 of a cloud.
struct PointRange {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// The ASPRS standard classes that the pipeline looks at (LAS 1.4 R15, table 17).
enum PointClass : std::uint8_t {
  kNeverClassified = 0,
  kUnclassified = 1,
  kGround = 2,
  kLowVegetation = 3,
  kMediumVegetation = 4,
  kHighVegetation = 5,
  kBuildingClass = 6,
  kLowNoise = 7,
  kModelKeyPoint = 8,  ///< Up to LAS 1.3.
  kWater = 9,
  kRail = 10,
  kRoad = 11,
  kWireGuard = 13,
  kBridgeDeck = 17,
  kHighNoise = 18,
  kIgnoredGround = 20,
  kBathymetricPoint = 40,
  kNoBottomFound = 45,
};

/// Whether points of this class tell the terrain: ground and water.
inline bool is_ground(std::uint8_t code) { return code == kGround || code == kWater; }

/// Where no point has class 6: neither ground, water, vegetation, noise, wires, their towers and
/// connectors (13 to 16) nor the deck of a bridge; nor what ASPRS keeps apart of ground and water:
/// key points of the terrain (8), rails and roads (10, 11), ground ignored near break lines (20)
/// and the classes of bathymetry (40 to 45).
inline bool may_be_roof(std::uint8_t code) {
  const auto is_between = [&](std::uint8_t low, std::uint8_t high) {
    return code >= low && code <= high;
  };
  return !is_ground(code) && !is_between(kLowVegetation, kHighVegetation) && code != kLowNoise &&
         code != kHighNoise && !is_between(kWireGuard, kBridgeDeck) && code != kModelKeyPoint &&
         code != kRail && code != kRoad && code != kIgnoredGround &&
         !is_between(kBathymetricPoint, kNoBottomFound);
}

/// Which of all class codes are among `codes`.
using ClassTable = std::array<bool, 256>;
inline ClassTable class_table(std::span<const std::uint8_t> codes) {
  ClassTable table{};
  for (const std::uint8_t code : codes) table[code] = true;
  return table;
}

/// The flags of a LAS point (LAS 1.4 R15, table 16; in the order of its bits).
enum PointFlag : std::uint8_t {
  kSyntheticPoint = 1,
  kKeyPoint = 2,
  kWithheldPoint = 4,
  kOverlapPoint = 8,  ///< Point formats 6 and above only.
};

}  // namespace tetropolis
