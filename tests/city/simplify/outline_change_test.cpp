#include "city/simplify/outline_change.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "city/grid_geometry.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

constexpr double kEpsilon = 10'000;  // steps

/// A star of long thin spikes, and triangles in and between them and elsewhere.
std::vector<Polygon> star_among_triangles(std::mt19937& random) {
  const auto from = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<Polygon> polygons(1);
  constexpr int kSpikes = 30;
  for (int k = 0; k < 2 * kSpikes; ++k) {
    const double angle = (k + from(0, 0.5)) * std::numbers::pi / kSpikes;
    const double radius = k % 2 == 0 ? from(1e6, 3e6) : from(5e4, 1e5);
    polygons[0].outer.push_back(
        grid::rounded({radius * std::cos(angle), radius * std::sin(angle)}));
  }
  for (int k = 0; k < 200; ++k) {
    const double angle = from(0, 2 * std::numbers::pi), radius = from(1e5, 3e6);
    const Point2 p{radius * std::cos(angle), radius * std::sin(angle)};
    Ring ring;
    for (const double turn : {0.0, 2.0, 4.0})
      ring.push_back(grid::rounded({p.x + 300 * std::cos(turn), p.y + 300 * std::sin(turn)}));
    polygons.push_back({ring, {}});
  }
  return polygons;
}

/// Whether dropping v makes the new edge touch another, or sweeps over a vertex: by looking at all.
bool is_harmful(const Outline& o, OutlineVertex v) {
  const OutlineVertex u = o.before(v), w = o.after(v);
  const Ring swept{o.at(u), o.at(v), o.at(w)};
  for (const OutlineVertex e : o.vertices()) {
    if (e != u && e != v && e != w && grid::is_inside(swept, o.at(e))) return true;
    const bool is_beside = e == u || e == v || e == w || o.after(e) == u;
    if (!is_beside && grid::segments_touch(o.at(u), o.at(w), o.at(e), o.at(o.after(e))))
      return true;
  }
  return false;
}

TEST(OutlineChange, DropsAreRefusedWhereTheyTouchOrSweepOverSomethingHoweverLongTheSpike) {
  SCOPED_TRACE(testing::test_seed());
  std::mt19937 random(testing::test_seed());
  int harmful = 0, harmless = 0;
  for (int round = 0; round < 20; ++round) {
    const std::vector<Polygon> polygons = star_among_triangles(random);
    std::vector<const Polygon*> pointers;
    for (const Polygon& polygon : polygons) pointers.push_back(&polygon);
    const Outline outline = outline_for(pointers, kEpsilon);
    ChangeJudge judge(outline, kEpsilon, Bounds2{-1e9, -1e9, 1e9, 1e9});
    for (const OutlineVertex v : indices<OutlineVertex>(polygons[0].outer.size())) {
      const bool expected = is_harmful(outline, v);
      (expected ? harmful : harmless) += 1;
      EXPECT_EQ(judge.gain(vertex_change(outline, v, ChangeKind::kDrop), -1e9).has_value(),
                !expected)
          << "vertex " << v.value() << " in round " << round;
    }
  }
  EXPECT_GT(harmful, 100);
  EXPECT_GT(harmless, 100);
}

}  // namespace
}  // namespace tetropolis
