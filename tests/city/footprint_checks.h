// Shapes for the tests of footprints, and the checks that every result has to pass.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/clean.h"
#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/city/simplify/simplify.h"
#include "tetropolis/geometry/polygon.h"

namespace tetropolis::testing {

inline Polygon box(double x, double y, double width, double height) {
  return {{{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}}, {}};
}

inline Ring clockwise_box(double x, double y, double width, double height) {
  return {{x, y}, {x, y + height}, {x + width, y + height}, {x + width, y}};
}

inline const Polygon kSliver{{{0, 5}, {202, 5.0006}, {0, 5.0011}}, {}};

inline Polygon turned(Polygon polygon, double angle, Point2 about = {}) {
  const auto turn = [&](Point2& p) {
    const double x = p.x - about.x, y = p.y - about.y;
    p = {about.x + std::cos(angle) * x - std::sin(angle) * y,
         about.y + std::sin(angle) * x + std::cos(angle) * y};
  };
  for (Point2& p : polygon.outer) turn(p);
  for (Ring& hole : polygon.holes)
    for (Point2& p : hole) turn(p);
  return polygon;
}

inline Polygon circle(Point2 centre, double radius, int vertices) {
  Polygon polygon;
  for (int i = 0; i < vertices; ++i) {
    const double a = 2 * std::numbers::pi * i / vertices;
    polygon.outer.push_back({centre.x + radius * std::cos(a), centre.y + radius * std::sin(a)});
  }
  return polygon;
}

/// A star-shaped polygon with edges and angles of all sizes.
inline Polygon random_star(std::mt19937& random, Point2 centre, double radius, int vertices) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> angles(static_cast<std::size_t>(vertices));
  for (double& a : angles) a = 2 * std::numbers::pi * unit(random);
  std::sort(angles.begin(), angles.end());
  Polygon polygon;
  for (const double a : angles) {
    const double r = radius * (0.1 + 0.9 * unit(random));
    polygon.outer.push_back({centre.x + r * std::cos(a), centre.y + r * std::sin(a)});
  }
  return polygon;
}

/// The definition, pair by pair.
inline double brute_force_clearance(std::span<const Polygon> polygons) {
  std::vector<const Ring*> rings;
  for (const Polygon& polygon : polygons) {
    rings.push_back(&polygon.outer);
    for (const Ring& hole : polygon.holes) rings.push_back(&hole);
  }
  double least = std::numeric_limits<double>::infinity();
  for (const Ring* r : rings)
    for (std::size_t v = 0; v < r->size(); ++v)
      for (const Ring* s : rings)
        for (std::size_t e = 0; e < s->size(); ++e) {
          const std::size_t f = (e + 1) % s->size();
          if (r == s && (e == v || f == v)) continue;
          least = std::min(least, distance_to_segment((*r)[v], (*s)[e], (*s)[f]));
        }
  return least;
}

inline std::vector<Polygon> cleaned(const std::vector<Polygon>& raw) {
  std::vector<Polygon> result;
  for (const Polygon& polygon : raw) {
    CleanedFootprint footprint = clean_footprint(polygon);
    if (footprint.usable()) result.push_back(std::move(footprint.polygon));
  }
  return result;
}

inline Bounds2 domain_around(const std::vector<Polygon>& polygons, double margin = 20) {
  Bounds2 domain = Bounds2::nothing();
  for (const Polygon& polygon : polygons) domain.extend(bounds(polygon));
  if (domain.empty()) domain = {0, 0, 1, 1};
  return {std::floor(domain.xmin - margin), std::floor(domain.ymin - margin),
          std::ceil(domain.xmax + margin), std::ceil(domain.ymax + margin)};
}

/// Guarantees 1 and 2 and everything else simplify_footprints promises of one result.
inline void expect_sound(const Simplification& result, std::size_t inputs, const Bounds2& domain,
                         const SimplifyOptions& options) {
  ASSERT_EQ(result.members.size(), result.footprints.size());
  ASSERT_EQ(result.flags.size(), result.footprints.size());
  std::vector<int> seen(inputs, 0);
  for (std::size_t k = 0; k < result.members.size(); ++k) {
    const auto& members = result.members[k];
    ASSERT_FALSE(members.empty());
    EXPECT_TRUE(std::is_sorted(members.begin(), members.end()));
    EXPECT_EQ(members.size() > 1, (result.flags[k] & kMerged) != 0);
    if (k > 0) {
      EXPECT_LT(result.members[k - 1][0], members[0]);
    }
    for (const BuildingIndex i : members) ++seen.at(static_cast<std::size_t>(i));
  }
  for (const DroppedFootprint& dropped : result.dropped) {
    ++seen.at(static_cast<std::size_t>(dropped.index));
    EXPECT_FALSE(dropped.reason.empty());
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(inputs));
  for (const FootprintDefect& defect : footprint_defects(result.footprints))
    ADD_FAILURE() << defect.message;
  EXPECT_TRUE(is_clear(joint_clearance(result.footprints, domain).distance, options.min_distance));
  for (const Polygon& polygon : result.footprints) EXPECT_GE(area(polygon), options.min_area);
}

/// Simplifies cleaned `raw`, checks the result and that simplifying it again changes nothing.
inline Simplification simplified(const std::vector<Polygon>& raw,
                                 const SimplifyOptions& options = {}) {
  const std::vector<Polygon> input = cleaned(raw);
  const Bounds2 domain = domain_around(input);
  Simplification result = simplify_footprints(input, domain, options);
  expect_sound(result, input.size(), domain, options);
  const Simplification again = simplify_footprints(result.footprints, domain, options);
  EXPECT_EQ(again.footprints, result.footprints) << "a second simplification changed something";
  return result;
}

}  // namespace tetropolis::testing
