// The roofs of a city model at places in the plan.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "tetropolis/city/city_model.h"

namespace tetropolis {

/// Parts of buildings; a building without parts is one part with a level roof. Refers to the model.
/// All of its methods take building numbers that the model has.
class RoofPlanes {
 public:
  explicit RoofPlanes(const CityModel& city);

  /// Of all buildings together, counted through: parts are numbered from first(b) on.
  std::size_t size() const { return pieces_.size(); }
  std::size_t first(BuildingIndex b) const { return pieces_of(b).first; }
  std::size_t parts(BuildingIndex b) const { return pieces_of(b).second - pieces_of(b).first; }

  /// The part that a place is over, which may be on a line to within a millimetre: the nearest.
  std::optional<std::size_t> part_at(BuildingIndex b, Point2 p) const;

  const Polygon& outline(BuildingIndex b, std::size_t part) const;

  /// Elevation of a part's plane, metres.
  double height(BuildingIndex b, std::size_t part, Point2 p) const;

  /// What elevations may be off it for rounding alone: 1e-9 m and what the rounding of x and y in
  /// the reference system makes on a slope.
  double tolerance(BuildingIndex b, std::size_t part) const;

  /// Lowest and highest plane of the parts that contain a place or touch it to a tenth of a
  /// millimetre; low > high if none does.
  std::pair<double, double> range_at(BuildingIndex b, Point2 p) const;

 private:
  struct Piece {
    const Polygon* outline = nullptr;
    const RoofPlane* plane = nullptr;  ///< None: level.
    double level = 0;
    Bounds2 box;
  };
  std::pair<std::size_t, std::size_t> pieces_of(BuildingIndex b) const {
    return {first_[static_cast<std::size_t>(b)], first_[static_cast<std::size_t>(b) + 1]};
  }
  const Piece& piece(BuildingIndex b, std::size_t part) const {
    return pieces_[pieces_of(b).first + part];
  }

  std::vector<Piece> pieces_;  ///< Building by building.
  std::vector<std::size_t> first_;
  double rounding_ = 0;  ///< Of x and y, metres.
};

}  // namespace tetropolis
