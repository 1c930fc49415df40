// The footprints of a city model by place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "tetropolis/city/city_model.h"

#include "filed_squares.h"

namespace tetropolis {

/// Even-odd rule over all rings.
bool inside(const Polygon& polygon, double x, double y);

/// Footprints by the squares of a grid that their boxes meet. Its size is bounded by the number of
/// buildings. The model must outlive it.
class FootprintGrid {
 public:
  explicit FootprintGrid(const CityModel& city);

  /// The first building in whose footprint the point lies, or kNoBuilding.
  BuildingIndex at(double x, double y) const;

  /// Every building whose footprint's box contains the point is among these; ascending.
  std::span<const std::uint32_t> near(double x, double y) const {
    return filed_.rows[filed_.squares.at(x, y)];
  }

  /// What it takes: squares, and footprints filed under them.
  std::size_t squares() const { return filed_.squares.size(); }
  std::size_t entries() const { return filed_.rows.items.size(); }

 private:
  const CityModel& city_;
  FiledSquares filed_;
};

}  // namespace tetropolis
