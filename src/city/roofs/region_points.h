// Which points are in which region of a roof, and what it costs when lines move over them. Private
// to src/city.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/core/ragged_array.h"
#include "tetropolis/geometry/types.h"

#include "city/roofs/label_cells.h"
#include "city/roofs/partition.h"
#include "city/roofs/roof_cells.h"

namespace tetropolis {

struct RisingEdge;

/// Costs are sums over points of the squares of their vertical distances over the density: m^4.
/// Beyond a metre they grow linearly (Huber, "Robust estimation of a location parameter", 1964):
/// what is 10 m off is worse than what is 3 m off, but no hundred times as bad as what is one.
class RegionPoints {
 public:
  /// `weights`: square metres that a point stands for; `region_of`: per point, -1 for those that
  /// do not count; `box`: all points are in it; `percentile`: of flat roofs; `cap`: planes are
  /// fitted to points no further off, metres.
  RegionPoints(const std::vector<Point3>& points, std::vector<double> weights,
               std::vector<RoofRegion> region_of, std::vector<RegionRoof> roofs, const Bounds2& box,
               double percentile, double cap);

  const std::vector<RegionRoof>& roofs() const { return roofs_; }
  const RegionRoof& roof(RoofRegion r) const { return roofs_[static_cast<std::size_t>(r)]; }

  /// Of giving the triangle, all of which is in `from`, to `to`. Negative: it fits better there.
  /// Not zero where there are no points, but small against what points would say.
  double cost_of_triangle(Point2 a, Point2 b, Point2 c, RoofRegion from, RoofRegion to) const;
  /// Adds that of triangles from - to - places[k], all of which are in `left` of the line from
  /// there to there, or in `right`, to sums[k]: they are given to the other.
  void add_costs_of_moves(Point2 from, Point2 to, std::span<const Point2> places, RoofRegion left,
                          RoofRegion right, std::span<double> sums) const;
  /// Of one roof for two regions.
  double cost_of_merging(RoofRegion a, RoofRegion b) const;

  /// The roof of a region becomes flat. False: it was.
  bool flatten(RoofRegion r);
  /// All of `gone` is in `keep` from now on.
  void merge(RoofRegion keep, RoofRegion gone);
  /// A new region, a part of `origin`, whose points are found by update().
  void add_region(RoofRegion origin) {
    roofs_.push_back(roof(origin));
    lists_.emplace_back();
    is_fitted_.push_back(0);
  }
  /// Lines have moved within the box.
  void update(const Bounds2& box, const Partition& lines);
  /// Roofs fitted to the points that their regions have now.
  void fit();

  /// The points of a region, as indices of RoofInput::points.values.
  std::vector<std::uint32_t> points_of(RoofRegion r) const;

 private:
  /// Calls visit(point) for those in the box, and some around it.
  template <typename Visit>
  void for_each_near(const Bounds2& box, const Visit& visit) const;
  /// Calls visit(point) for those in the triangle.
  template <typename Visit>
  void for_each_in(const std::array<Point2, 3>& triangle, const Visit& visit) const;
  /// Calls visit(begin, end) for places in the order of the grid: all that are less than `reach`
  /// from the segments, and some around these.
  template <typename Visit>
  void for_each_range(std::span<const RisingEdge> segments, double reach, const Visit& visit) const;
  double cost(const RoofPlane& plane, std::uint32_t point) const;
  double cost(const RoofPlane& plane, const std::vector<std::uint32_t>& points) const;
  /// What planes are chosen by: squares, up to the cap. Points of another plane have no say.
  double loss(const RoofPlane& plane, const std::vector<std::uint32_t>& points) const;
  /// The best roof for points, of those given and such as can be fitted.
  RegionRoof fitted(const std::vector<RegionRoof>& candidates,
                    const std::vector<std::uint32_t>& points) const;
  /// Of the roof of `keep` for the points of `gone`, instead of its own.
  double cost_of_exchange(RoofRegion keep, RoofRegion gone) const;
  /// Blocks keep the height of the one that the points of both fit better.
  RegionRoof merged_roof(RoofRegion a, RoofRegion b,
                         const std::vector<std::uint32_t>& points) const;

  const std::vector<Point3>& points_;
  double percentile_;
  double cap_;
  std::vector<double> weight_;         ///< Per point.
  std::vector<RoofRegion> region_of_;  ///< Per point; -1: none.
  std::vector<RegionRoof> roofs_;
  std::vector<std::vector<std::uint32_t>> lists_;  ///< Per region: its points, and former ones.
  std::vector<std::uint8_t> is_fitted_;  ///< Per region: fitting it again would change nothing.
  Bounds2 box_;
  std::size_t columns_ = 1, rows_ = 1;
  RaggedArray<std::uint32_t> grid_;
  std::vector<double> x_, y_;  ///< Of the points in the order of the grid.
};

/// The points of a building in the regions that its cells chose.
RegionPoints region_points(const RoofInput& input, const RoofCells& cells,
                           const RoofRegions& regions, double percentile, double cap);

}  // namespace tetropolis
