// Finds the footprints that contain a position or are near it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/core/ragged_array.h"
#include "tetropolis/core/row_major.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// A uniform grid whose cells list the footprints with a bounding box (grown by the margin) in
/// them, and for each footprint its edges by horizontal bands. Whether a position is inside is told
/// by the edges of its band alone: a few of however many, unless most run far from south to north.
/// Whether one that is not is near takes the bands within the margin. Memory: at most
/// kEntriesPerEdge times the edges.
class FootprintIndex {
 public:
  /// How many bands an edge is in at most, on average over an outline.
  static constexpr std::size_t kEntriesPerEdge = 4;

  /// Copies the edges; the footprints need not outlive the index. Margin >= 0, metres.
  FootprintIndex(std::span<const Polygon* const> footprints, double margin);

  /// Calls visit(footprint, inside) for every footprint that contains `p` (inside = true, exactly
  /// as contains() decides) or whose boundary is at most the margin away (inside = false),
  /// ascending.
  template <typename Visit>
  void at(Point2 p, const Visit& visit) const {
    if (!box_.contains(p)) return;
    const std::size_t cell = cell_at(p);
    if (!is_used_[cell]) return;
    for (const BuildingIndex footprint : cells_[cell]) {
      const Outline& outline = outlines_[footprint];
      if (!outline.box.contains(p)) continue;
      if (inside(bands_at(outline, p.y, p.y), p)) {
        visit(footprint, true);
      } else if (near(near_bands(outline, p.y), p)) {
        visit(footprint, false);
      }
    }
  }

  /// Square of the distance from `p` to the boundary of a footprint, if that is at most the margin;
  /// otherwise some number above the square of the margin.
  double squared_distance(BuildingIndex footprint, Point2 p) const;

  /// How many edges tell whether a position of ordinate y is inside a footprint.
  std::size_t edges_at(BuildingIndex footprint, double y) const {
    return bands_at(outlines_[footprint], y, y).size();
  }

  /// How many edges there are in all bands.
  std::size_t entries() const { return bands_.values.size(); }

 private:
  struct Edge {
    Point2 a;
    Point2 b;
  };

  /// Bands cut the outline's box into `bands` slices of equal height, from south to north. Each
  /// has the edges that meet it.
  struct Outline {
    Bounds2 box;  ///< Grown by the margin and a hair.
    std::int32_t bands = 0;
    std::size_t first_band = 0;  ///< Row of bands_.
  };

  void add_outline(const Polygon& footprint);
  static std::size_t count_entries(const Outline& outline, std::span<const Edge> edges);
  void build_cells();
  double entries_with(double cell) const;
  std::int32_t column(double x) const { return slot(x - box_.xmin, columns_); }
  std::int32_t row(double y) const { return slot(y - box_.ymin, rows_); }

  std::int32_t slot(double offset, std::int32_t count) const {
    return std::clamp(static_cast<std::int32_t>(offset * per_metre_), 0, count - 1);
  }

  std::size_t cell_at(Point2 p) const { return row_major(column(p.x), row(p.y), columns_); }

  static std::int32_t band_of(const Outline& outline, double y) {
    const double share = (y - outline.box.ymin) / outline.box.height();
    return std::clamp(static_cast<std::int32_t>(share * outline.bands), 0, outline.bands - 1);
  }

  /// The edges of the bands from `low` to `high`; those that are in several come as often.
  std::span<const Edge> bands_at(const Outline& outline, double low, double high) const {
    const auto row = [&](double y) {
      return outline.first_band + static_cast<std::size_t>(band_of(outline, y));
    };
    return bands_.rows(row(low), row(high) + 1);
  }

  /// The edges that may be within the margin of positions of ordinate y. Rounding in band_of is
  /// monotone in y, so an edge in no band from y - reach to y + reach is further away.
  std::span<const Edge> near_bands(const Outline& outline, double y) const {
    return bands_at(outline, y - reach(), y + reach());
  }

  /// A hair more than the margin, because positions exactly at the margin count.
  double reach() const { return margin_ + 1e-6; }

  static bool inside(std::span<const Edge> edges, Point2 p) {
    bool result = false;
    for (const Edge& edge : edges) result ^= crosses_ray(edge.a, edge.b, p);
    return result;
  }

  bool near(std::span<const Edge> edges, Point2 p) const {
    return std::any_of(edges.begin(), edges.end(), [&](const Edge& edge) {
      return squared_distance_to_segment(p, edge.a, edge.b) <= margin_ * margin_;
    });
  }

  double margin_;
  Bounds2 box_;
  std::vector<Outline> outlines_;
  RaggedArray<Edge> bands_;  ///< The edges of all bands of all outlines.
  double per_metre_ = 1;     ///< Cells; a power of two, so that it divides as the cells' size does.
  std::int32_t columns_ = 0;
  std::int32_t rows_ = 0;
  RaggedArray<BuildingIndex> cells_;  ///< Footprints, row by row of the grid.
  std::vector<bool> is_used_;         ///< Per cell. Most points lie in cells without footprints.
};

}  // namespace tetropolis
