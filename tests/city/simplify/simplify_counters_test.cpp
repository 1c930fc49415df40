// What simplification counts: for every counter an input on which its value is known, and the area
// that is to come of it.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/city/simplify/simplify.h"
#include "tetropolis/geometry/polygon.h"

#include "city/footprint_checks.h"

namespace tetropolis {
namespace {

using testing::box;
using testing::clockwise_box;
using testing::kSliver;
using testing::simplified;

using Counter = std::function<std::int64_t(const SimplifyStats&)>;

Counter fills_of_reach(std::size_t k) {
  return [k](const SimplifyStats& stats) { return stats.merged_by_gap_fill.at(k); };
}

struct CounterCase {
  const char* name;
  Counter counter;
  std::int64_t value;
  std::vector<Polygon> input;
  double area;              ///< Of the outputs, square metres.
  double tolerance = 1e-6;  ///< Of the area.
  std::size_t footprints = 1;
  double min_distance = 1;
  int growths = 3;
  std::optional<Bounds2> domain{};  ///< With room around if there is none.
};

void PrintTo(const CounterCase& row, std::ostream* out) { *out << row.name; }

class SimplifyCounters : public ::testing::TestWithParam<CounterCase> {};

TEST_P(SimplifyCounters, CountWhatWasDone) {
  const CounterCase& row = GetParam();
  SimplifyOptions options;
  options.min_distance = row.min_distance;
  options.growths = row.growths;
  const std::vector<Polygon> input = testing::cleaned(row.input);
  ASSERT_EQ(input.size(), row.input.size());
  const Simplification result = row.domain ? simplify_footprints(input, *row.domain, options)
                                           : simplified(row.input, options);
  if (row.domain) testing::expect_sound(result, input.size(), *row.domain, options);
  EXPECT_EQ(row.counter(result.stats), row.value);
  ASSERT_EQ(result.stats.merged_by_gap_fill.size(), static_cast<std::size_t>(options.growths) + 1);
  EXPECT_EQ(result.footprints.size(), row.footprints);
  double sum = 0;
  for (const Polygon& polygon : result.footprints) sum += area(polygon);
  EXPECT_NEAR(sum, row.area, row.tolerance);
}

/// Two squares of 10 m, 0.0707 m apart along x and along y: 0.09998 m between their corners.
const std::vector<Polygon> kCorners{box(0, 0, 10, 10), box(10.0707, 10.0707, 10, 10)};

/// What a sliver, whose tip goes flat on the grid, joins to something 2.5 m away: see
/// merge_polygons_test.cpp.

/// 20 m by 13 m with a slot of 0.5 m and 3 m, from whose mouth two walls lead apart at a right
/// angle.
const Polygon kFunnel{{{0, 0},
                       {20, 0},
                       {20, 13},
                       {13.25, 13},
                       {10.25, 10},
                       {10.25, 7},
                       {9.75, 7},
                       {9.75, 10},
                       {6.75, 13},
                       {0, 13}},
                      {}};
constexpr double kFunnelArea = 260 - 0.5 * 3 - (0.5 + 6.5) / 2 * 3;

/// A house of 28 m2 whose corner, a right angle, points into the funnel.
Polygon house_in_funnel(double y) {
  return {{{10, y}, {12, y + 2}, {12, y + 8}, {8, y + 8}, {8, y + 2}}, {}};
}

/// A square on its corner, 6 m across, and a domain that leaves it a strip 6 steps less than 2 m
/// wide, at two metres from its boundary.
const Polygon kDiamond{{{16, 13}, {19, 16}, {16, 19}, {13, 16}}, {}};
constexpr Bounds2 kStrip{13, 0, 19, 40};

INSTANTIATE_TEST_SUITE_P(
    Simplify, SimplifyCounters,
    ::testing::Values(
        CounterCase{.name = "merged_by_union",
                    .counter = &SimplifyStats::merged_by_union,
                    .value = 1,
                    .input = {box(0, 0, 10, 10), box(5, 5, 10, 10)},
                    .area = 175},
        // Groups of one are joined by nothing.
        CounterCase{.name = "merged_by_union_of_one",
                    .counter = &SimplifyStats::merged_by_union,
                    .value = 0,
                    .input = {box(0, 0, 10, 10), box(15, 0, 10, 10)},
                    .area = 200,
                    .footprints = 2},
        CounterCase{.name = "merged_by_gap_fill_1",
                    .counter = fills_of_reach(1),
                    .value = 1,
                    .input = {box(0, 0, 10, 10), box(10.5, 0, 10, 10)},
                    .area = 205},
        // At the first reach both gap fills are smaller than a square centimetre.
        CounterCase{.name = "merged_by_gap_fill_2",
                    .counter = fills_of_reach(2),
                    .value = 1,
                    .input = kCorners,
                    .area = 200 + 0.2002 * 0.2002 - 2 * 0.0707 * 0.0707,
                    .tolerance = 2e-5,
                    .min_distance = 0.1},
        // A square of 0.11 m, less what of it is in the corners; its own corners are repaired.
        CounterCase{.name = "merged_by_bridge",
                    .counter = &SimplifyStats::merged_by_bridge,
                    .value = 1,
                    .input = kCorners,
                    .area = 200 + 0.11 * 0.11 - 2 * std::pow((0.11 - 0.0707) / 2, 2),
                    .tolerance = 0.02,
                    .min_distance = 0.1,
                    .growths = 1},
        CounterCase{.name = "merged_by_hulls",
                    .counter = &SimplifyStats::merged_by_hulls,
                    .value = 1,
                    .input = {{{{0, 0}, {200, 0}, {200, 8}, {220, 8}, {220, 10}, {0, 10}}, {}},
                              kSliver,
                              box(202.5, 0, 10, 6)},
                    .area = 2120 + 30,
                    .tolerance = 0.2},
        CounterCase{.name = "merged_by_hull",
                    .counter = &SimplifyStats::merged_by_hull,
                    .value = 1,
                    .input = {box(0, 0, 200, 10), kSliver, box(202.5, 0, 10, 10)},
                    .area = 2125},
        // 1.4 m from all walls of the funnel, but less than one from where it is a metre wide,
        // which is as far as the slot is filled.
        CounterCase{.name = "merged_late",
                    .counter = &SimplifyStats::merged_late,
                    .value = 1,
                    .input = {kFunnel, house_in_funnel(11.4)},
                    .area = kFunnelArea + 28 + 3.3,
                    .tolerance = 0.5},
        // Two squares that meet in a corner; between their walls, 1.1 m from either, the corner of
        // a third, which is 0.85 m from the gap fill that joins them.
        CounterCase{.name = "merged_late_by_gap_fill",
                    .counter = &SimplifyStats::merged_late,
                    .value = 1,
                    .input = {box(0, 0, 10, 10), box(10, 10, 10, 10), box(-1.1, 11.1, 10, 10)},
                    .area = 300 + 2.6,
                    .tolerance = 0.5},
        CounterCase{.name = "merged_late_none",
                    .counter = &SimplifyStats::merged_late,
                    .value = 0,
                    .input = {kFunnel, house_in_funnel(11.6)},
                    .area = kFunnelArea + 28 + 1.9,
                    .tolerance = 0.1,
                    .footprints = 2},
        // A corner cut off by 0.4 m comes back.
        CounterCase{.name = "edges_merged",
                    .counter = &SimplifyStats::edges_merged,
                    .value = 1,
                    .input = {{{{0, 0}, {10, 0}, {10, 9.6}, {9.6, 10}, {0, 10}}, {}}},
                    .area = 100},
        // A step of 0.3 m is made slanted, as much to one side as to the other.
        CounterCase{.name = "edges_slid",
                    .counter = &SimplifyStats::edges_slid,
                    .value = 1,
                    .input = {{{{0, 0}, {60, 0}, {60, 10}, {30, 10}, {30, 10.3}, {0, 10.3}}, {}}},
                    .area = 609,
                    .tolerance = 0.01},
        // A bump of 0.4 m by 0.4 m goes: of its three vertices the last is on a straight wall then.
        CounterCase{
            .name = "vertices_dropped",
            .counter = &SimplifyStats::vertices_dropped,
            .value = 2,
            .input = {{{{0, 0}, {20, 0}, {20, 10}, {10.4, 10}, {10.2, 10.4}, {10, 10}, {0, 10}},
                       {}}},
            .area = 200},
        // Vertices on straight walls, which a union leaves, are tidied away: no repair.
        CounterCase{.name = "vertices_dropped_by_tidying",
                    .counter = &SimplifyStats::vertices_dropped,
                    .value = 0,
                    .input = {box(0, 0, 10, 10), box(10, 0, 10, 10)},
                    .area = 200},
        // The tip of a notch, 0.98 m from the opposite wall, goes up to a metre and two steps.
        CounterCase{.name = "vertices_moved",
                    .counter = &SimplifyStats::vertices_moved,
                    .value = 1,
                    .input = {{{{0, 0}, {20, 0}, {20, 10}, {10, 0.98}, {0, 10}}, {}}},
                    .area = 200 - 20 * (10 - 1.0002) / 2},
        CounterCase{.name = "holes_filled",
                    .counter = &SimplifyStats::holes_filled,
                    .value = 1,
                    .input = {{box(0, 0, 20, 20).outer, {clockwise_box(5, 5, 0.8, 0.8)}}},
                    .area = 400},
        // A corner 0.6 m from a wall on the other side of a yard. What is filled has two corners on
        // that wall, 1.001 m from the corner's walls: sqrt(1.001^2 - 0.6^2) above it, and below it
        // where the distance to the slanted wall, |(-11 * 0.6 + 4.4 t) / 11.847|, is that.
        CounterCase{.name = "gaps_filled",
                    .counter = &SimplifyStats::gaps_filled,
                    .value = 1,
                    .input = {{{{0, 0},
                                {20, 0},
                                {20, 20},
                                {16, 20},
                                {10.6, 16},
                                {15, 5},
                                {10, 5},
                                {10, 20},
                                {0, 20}},
                               {}}},
                    .area = 356 + (1.1952 * 1.001 + 1.0025 * 0.6 + 0.8013 * 0.6) / 2,
                    .tolerance = 1e-3},
        // A garden wall of 5 cm and 15 m.
        CounterCase{.name = "arms_cut",
                    .counter = &SimplifyStats::arms_cut,
                    .value = 1,
                    .input = {{{{0, 0}, {10, 0}, {10, 9.95}, {25, 9.95}, {25, 10}, {0, 10}}, {}}},
                    .area = 100,
                    .tolerance = 0.2},
        // A notch whose tip is 0.6 m from the opposite wall, between two rooms: what is added is
        // less than a box of 1.1 m.
        CounterCase{.name = "necks_widened",
                    .counter = &SimplifyStats::necks_widened,
                    .value = 1,
                    .input = {{{{0, 0}, {40, 0}, {40, 20}, {22, 20}, {20, 0.6}, {0, 6.6}}, {}}},
                    .area = 452.6 + 0.6,
                    .tolerance = 0.6},
        // In a strip too narrow for anything, two corners are too close to the wall across in each
        // of the six rounds of hulls. It is the pairs that count: here both are of one place.
        CounterCase{.name = "local_hulls",
                    .counter = &SimplifyStats::local_hulls,
                    .value = 2 * 6,
                    .input = {kDiamond},
                    .area = 0,
                    .footprints = 0,
                    .min_distance = 2,
                    .domain = kStrip},
        // Then it becomes its hull, which counts although it vanishes.
        CounterCase{.name = "hull_repairs",
                    .counter = &SimplifyStats::hull_repairs,
                    .value = 1,
                    .input = {kDiamond},
                    .area = 0,
                    .footprints = 0,
                    .min_distance = 2,
                    .domain = kStrip}),
    [](const ::testing::TestParamInfo<CounterCase>& row) { return std::string(row.param.name); });

TEST(Simplify, CountersOfFootprintsThatAreFineAreZero) {
  const SimplifyStats stats = simplified({box(0, 0, 10, 10), box(11.001, 0, 10, 10)}).stats;
  EXPECT_EQ(stats.groups, 2);
  EXPECT_EQ(stats.rounds, 1);
  const std::vector<Counter> counters{&SimplifyStats::hulls,
                                      &SimplifyStats::clipped,
                                      &SimplifyStats::merged_by_union,
                                      fills_of_reach(1),
                                      fills_of_reach(2),
                                      fills_of_reach(3),
                                      &SimplifyStats::merged_by_bridge,
                                      &SimplifyStats::merged_by_hulls,
                                      &SimplifyStats::merged_by_hull,
                                      &SimplifyStats::merged_late,
                                      &SimplifyStats::vertices_dropped,
                                      &SimplifyStats::edges_merged,
                                      &SimplifyStats::edges_slid,
                                      &SimplifyStats::vertices_moved,
                                      &SimplifyStats::holes_filled,
                                      &SimplifyStats::gaps_filled,
                                      &SimplifyStats::arms_cut,
                                      &SimplifyStats::necks_widened,
                                      &SimplifyStats::corners_chamfered,
                                      &SimplifyStats::local_hulls,
                                      &SimplifyStats::hull_repairs};
  for (std::size_t k = 0; k < counters.size(); ++k) EXPECT_EQ(counters[k](stats), 0) << k;
}

}  // namespace
}  // namespace tetropolis
