// Buildings of several roofs at random.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tetropolis/city/city_model.h"

namespace tetropolis::testing {

/// Parts laid like bricks, so that three meet at most at one place: every other course is set off
/// by half a brick of 6 m x 5 m. One is a courtyard, one has a tower on it. Roofs are flat, planes
/// at random (which cross along common lines) or that of the part before.
inline Building brick_building(std::mt19937& random, std::size_t columns, std::size_t courses,
                               Point2 corner, double turn) {
  std::uniform_real_distribution<double> unit(0, 1);
  const auto share = [&] { return unit(random); };
  // The places of the bond: line j is below course j; i counts half bricks.
  std::vector<std::vector<Point2>> places(courses + 1);
  for (std::size_t j = 0; j <= courses; ++j)
    for (std::size_t i = 0; i <= 2 * columns; ++i) {
      const double x = 3 * static_cast<double>(i) + 0.8 * (share() - 0.5);
      const double y = 5 * static_cast<double>(j) + 0.8 * (share() - 0.5);
      places[j].push_back(
          snap_coordinate(Point2{corner.x + x * std::cos(turn) - y * std::sin(turn),
                                 corner.y + x * std::sin(turn) + y * std::cos(turn)}));
    }
  Building building;
  building.id = "b1";
  building.source_ids = {"s1"};
  const auto roof_at = [&](Point2 p) {
    RoofPlane roof{p, 8 + 6 * share(), 0, 0};
    const double kind = share();
    if (kind < 0.25 && !building.parts.empty()) return building.parts.back().roof;
    if (kind < 0.75) {
      roof.slope_x = 1.6 * share() - 0.8;
      roof.slope_y = 1.6 * share() - 0.8;
    }
    return snap_plane(roof);
  };
  const auto add = [&](Polygon outline) {
    RoofPart part;
    part.roof = roof_at(outline.outer[0]);
    part.outline = std::move(outline);
    part.source_id = "s" + std::to_string(1 + building.parts.size() % 3);
    part.lod = part.roof.is_flat() ? Lod::k1_3 : Lod::k2_2;
    part.n_points = static_cast<std::int64_t>(random() % 1000);
    part.rmse = part.n_points > 0 ? share() : std::nan("");
    building.parts.push_back(std::move(part));
  };
  for (std::size_t j = 0; j < courses; ++j)
    for (std::size_t i = 0; i < 2 * columns;) {
      const std::size_t end = std::min(2 * columns, i + (i == 0 && j % 2 == 1 ? 1 : 2));
      Polygon outline;
      for (std::size_t k = i; k <= end; ++k) outline.outer.push_back(places[j][k]);
      for (std::size_t k = end + 1; k-- > i;) outline.outer.push_back(places[j + 1][k]);
      const bool is_courtyard = j == 1 && i == 1, has_tower = j == 2 && i == 2;
      i = end;
      if (is_courtyard) {
        std::reverse(outline.outer.begin() + 1, outline.outer.end());
        building.footprint.holes.push_back(std::move(outline.outer));
        continue;
      }
      if (has_tower) {
        Point2 middle{0, 0};
        for (const Point2& p : outline.outer) {
          middle.x += p.x / static_cast<double>(outline.outer.size());
          middle.y += p.y / static_cast<double>(outline.outer.size());
        }
        const Ring tower{snap_coordinate(Point2{middle.x - 1, middle.y - 1}),
                         snap_coordinate(Point2{middle.x + 1, middle.y - 1}),
                         snap_coordinate(Point2{middle.x + 1, middle.y + 1}),
                         snap_coordinate(Point2{middle.x - 1, middle.y + 1})};
        outline.holes.push_back({tower[0], tower[3], tower[2], tower[1]});
        add(std::move(outline));
        add({tower, {}});
        continue;
      }
      add(std::move(outline));
    }
  Ring& outer = building.footprint.outer;
  for (std::size_t i = 0; i < 2 * columns; ++i) outer.push_back(places[0][i]);
  for (std::size_t j = 0; j < courses; ++j) outer.push_back(places[j][2 * columns]);
  for (std::size_t i = 2 * columns; i > 0; --i) outer.push_back(places[courses][i]);
  for (std::size_t j = courses; j > 0; --j) outer.push_back(places[j][0]);
  double low = 1e9;
  for (const RoofPart& part : building.parts)
    for (const Point2& p : part.outline.outer) low = std::min(low, part.roof(p));
  building.h_ground = snap_height(low - 2.5 - share());
  building.h_roof = snap_height(building.h_ground + 3 + 10 * share());
  building.n_roof_points = 1000;
  return building;
}

}  // namespace tetropolis::testing
