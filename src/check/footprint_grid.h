// The footprints of a city model by place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/city/city_model.h"

#include "geometry/grid_index.h"

namespace tetropolis {

/// Footprints by the squares of a grid that their boxes meet, and the edges of each by bands from
/// south to north, so that outlines of many vertices stay cheap to ask. Its size is bounded by the
/// numbers of buildings and edges.
class FootprintGrid {
 public:
  explicit FootprintGrid(const CityModel& city);

  /// The first building in whose footprint the point lies (even-odd rule over all rings), or
  /// kNoBuilding.
  BuildingIndex at(double x, double y) const;

  /// Every building whose footprint's box contains the point is among these; ascending.
  std::span<const std::uint32_t> near(double x, double y) const {
    return index_.rows[index_.grid.at(x, y)];
  }

  /// What it takes: squares, and footprints filed under them.
  std::size_t squares() const { return index_.grid.size(); }
  std::size_t entries() const { return index_.rows.values.size(); }
  /// Edges filed under bands.
  std::size_t edge_entries() const { return edges_of_.values.size(); }

 private:
  struct Edge {
    Point2 a;
    Point2 b;
  };
  /// Slices of equal height of a footprint's box; none for one without edges.
  struct Bands {
    double south = 0;
    double north = 0;
    std::size_t count = 0;
    std::size_t first = 0;  ///< Row of edges_of_.
    /// Grows with y, which lies between south and north.
    std::size_t at(double y) const;
  };

  void add_bands(std::size_t first_edge);
  void file_edges();
  bool is_inside(const Bands& bands, double x, double y) const;

  GridIndex index_;
  std::vector<Edge> edges_;  ///< Of all rings, footprint by footprint.
  std::vector<Bands> bands_;
  std::vector<std::uint32_t> owners_;    ///< Footprint of each edge.
  RaggedArray<std::uint32_t> edges_of_;  ///< Of each band.
};

}  // namespace tetropolis
