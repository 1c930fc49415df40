#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tetropolis/check/check_mesh.h"

#include "violations.h"

namespace tetropolis {

namespace {

/// Even-odd rule over all rings.
bool inside(const Polygon& polygon, double x, double y) {
  bool odd = false;
  const auto cross = [&](const Ring& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point2 a = ring[i], b = ring[(i + 1) % ring.size()];
      if ((a.y <= y) != (b.y <= y) && x < a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y)) odd = !odd;
    }
  };
  cross(polygon.outer);
  for (const Ring& hole : polygon.holes) cross(hole);
  return odd;
}

/// Footprints by the squares of a coarse grid that their boxes meet.
class FootprintGrid {
 public:
  explicit FootprintGrid(const CityModel& city) : city_(city) {
    const Bounds2& d = city.domain;
    columns_ = std::max<std::size_t>(1, static_cast<std::size_t>(d.width() / kSquare) + 1);
    rows_ = std::max<std::size_t>(1, static_cast<std::size_t>(d.height() / kSquare) + 1);
    squares_.resize(columns_ * rows_);
    for (std::size_t b = 0; b < city.buildings.size(); ++b) {
      const Ring& ring = city.buildings[b].footprint.outer;
      const auto [west, east] = std::minmax_element(ring.begin(), ring.end(),
                                                    [](Point2 p, Point2 q) { return p.x < q.x; });
      const auto [south, north] = std::minmax_element(ring.begin(), ring.end(),
                                                      [](Point2 p, Point2 q) { return p.y < q.y; });
      for (std::size_t j = row(south->y); j <= row(north->y); ++j)
        for (std::size_t i = column(west->x); i <= column(east->x); ++i)
          squares_[j * columns_ + i].push_back(static_cast<BuildingIndex>(b));
    }
  }

  BuildingIndex at(double x, double y) const {
    for (const BuildingIndex b : squares_[row(y) * columns_ + column(x)])
      if (inside(city_.buildings[static_cast<std::size_t>(b)].footprint, x, y)) return b;
    return kNoBuilding;
  }

 private:
  static constexpr double kSquare = 20;

  std::size_t column(double x) const { return index(x - city_.domain.xmin, columns_); }
  std::size_t row(double y) const { return index(y - city_.domain.ymin, rows_); }
  static std::size_t index(double offset, std::size_t count) {
    const double i = offset / kSquare;
    if (!(i > 0)) return 0;
    return i < static_cast<double>(count) ? static_cast<std::size_t>(i) : count - 1;
  }

  const CityModel& city_;
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  std::vector<std::vector<BuildingIndex>> squares_;
};

}  // namespace

std::vector<Violation> check_regions_of_cells(const TetMesh& mesh, std::array<double, 3> shift,
                                              const CityModel& city) {
  if (mesh.region.size() != mesh.cells.size())
    return {{"no region for every cell", 1,
             fmt::format("{} regions, {} cells", mesh.region.size(), mesh.cells.size())}};
  const FootprintGrid footprints(city);
  const auto look = [&](std::size_t begin, std::size_t end, std::vector<Violation>& violations) {
    for (std::size_t c = begin; c < end; ++c) {
      double x = shift[0], y = shift[1];
      for (const std::int64_t v : mesh.cells[c]) {
        x += mesh.points[static_cast<std::size_t>(v)][0] / 4;
        y += mesh.points[static_cast<std::size_t>(v)][1] / 4;
      }
      if (!std::isfinite(x) || !std::isfinite(y)) {
        note_violation(violations, "cells whose coordinates are not finite",
                       [&] { return fmt::format("cell {}", c); });
        continue;
      }
      const BuildingIndex expected = footprints.at(x, y);
      if (mesh.region[c] != expected)
        note_violation(violations, "cells with the wrong region", [&] {
          return fmt::format("cell {} says {}, it stands over {}", c, mesh.region[c], expected);
        });
    }
  };
  return sum_of_violations(mesh.region.size(), look);
}

}  // namespace tetropolis
