// Finds the footprints that contain a position or are near it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/geometry/polygon.h"
#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// A uniform grid whose cells list the footprints with a bounding box (grown by the margin) in
/// them, and for each footprint its edges by horizontal bands, so that large outlines stay cheap to
/// test.
class FootprintIndex {
 public:
  /// Copies the edges; the footprints need not outlive the index. Margin >= 0, metres.
  FootprintIndex(std::span<const Polygon* const> footprints, double margin);

  /// Calls visit(footprint, inside) for every footprint that contains `p` (inside = true, exactly
  /// as contains() decides) or whose boundary is at most the margin away (inside = false),
  /// ascending.
  template <typename Visit>
  void at(Point2 p, const Visit& visit) const {
    if (!box_.contains(p)) return;
    const std::size_t cell = cell_at(p);
    for (std::int64_t k = cell_offsets_[cell]; k < cell_offsets_[cell + 1]; ++k) {
      const std::int32_t footprint = cell_footprints_[static_cast<std::size_t>(k)];
      const Outline& outline = outlines_[static_cast<std::size_t>(footprint)];
      if (!outline.box.contains(p)) continue;
      const std::span<const Edge> edges = band_at(outline, p.y);
      if (inside(edges, p)) {
        visit(footprint, true);
      } else if (near(edges, p)) {
        visit(footprint, false);
      }
    }
  }

  /// Square of the distance from `p` to the boundary of a footprint, if that is at most the margin;
  /// otherwise some number above the square of the margin.
  double squared_distance(std::int32_t footprint, Point2 p) const;

 private:
  struct Edge {
    Point2 a;
    Point2 b;
  };

  /// Bands cut the outline's box into `bands` slices of equal height, from south to north.
  struct Outline {
    Bounds2 box;  ///< Grown by the margin.
    std::int32_t bands = 0;
    std::size_t first_band = 0;  ///< Index into band_offsets_.
  };

  void add_outline(const Polygon& footprint);
  void build_cells();
  double entries_with(double cell) const;
  std::int32_t column(double x) const { return slot(x - box_.xmin, columns_); }
  std::int32_t row(double y) const { return slot(y - box_.ymin, rows_); }

  std::int32_t slot(double offset, std::int32_t count) const {
    return std::clamp(static_cast<std::int32_t>(offset / cell_), 0, count - 1);
  }

  std::size_t cell_at(Point2 p) const {
    return static_cast<std::size_t>(row(p.y)) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column(p.x));
  }

  static std::int32_t band_of(const Outline& outline, double y) {
    const double share = (y - outline.box.ymin) / outline.box.height();
    return std::clamp(static_cast<std::int32_t>(share * outline.bands), 0, outline.bands - 1);
  }

  /// The edges that matter for positions of ordinate y: all within the margin of its band.
  std::span<const Edge> band_at(const Outline& outline, double y) const {
    const std::size_t band = outline.first_band + static_cast<std::size_t>(band_of(outline, y));
    return std::span(edges_).subspan(band_offsets_[band],
                                     band_offsets_[band + 1] - band_offsets_[band]);
  }

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
  std::vector<std::size_t> band_offsets_{0};
  std::vector<Edge> edges_;
  double cell_ = 1;
  std::int32_t columns_ = 0;
  std::int32_t rows_ = 0;
  std::vector<std::int64_t> cell_offsets_;
  std::vector<std::int32_t> cell_footprints_;
};

}  // namespace tetropolis
