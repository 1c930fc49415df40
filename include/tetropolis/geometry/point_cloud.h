// A point cloud in flat arrays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "tetropolis/core/buffer.h"

namespace tetropolis {

/// Four arrays of one length. x and y are metres in the local frame, z is metres of elevation.
struct PointCloud {
  Buffer<double> x;
  Buffer<double> y;
  Buffer<double> z;
  Buffer<std::uint8_t> classification;  ///< ASPRS class code, see PointClass.

  std::size_t size() const { return x.size(); }
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
  kWater = 9,
  kHighNoise = 18,
};

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
