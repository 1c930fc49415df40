// Footprints on which a random search has seen the library fail; one test each.
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/city/clean.h"
#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/city/simplify/simplify.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/run/run.h"

#include "city/clip.h"
#include "defect_city.h"
#include "support/test_data.h"

namespace tetropolis::testing {
namespace {

Polygon clean(const Polygon& raw) {
  const CleanedFootprint result = clean_footprint(raw);
  EXPECT_EQ(result.reason, "");
  for (const FootprintDefect& defect : footprint_defects(std::vector{result.polygon}))
    ADD_FAILURE() << defect.message;
  EXPECT_EQ(clean_footprint(result.polygon).polygon.outer, result.polygon.outer);
  EXPECT_EQ(clean_footprint(result.polygon).polygon.holes, result.polygon.holes);
  return result.polygon;
}

// The second round leaves a hole of no width along the western wall, which bridges only move on.
TEST(FoundBySearch, ARingDrawnTwiceWithSlightlyDifferentVertices) {
  const Polygon raw{{{9.88806, 19.69683},
                     {12.53136, 19.69683},
                     {12.52836, 22.89232},
                     {12.53136, 24.98591},
                     {9.88806, 24.98591},
                     {9.89816, 24.20506},
                     {10.19816, 25.20506},
                     {9.88806, 19.69683},
                     {12.53136, 19.69683},
                     {12.52836, 22.89232},
                     {12.53136, 24.98591},
                     {9.88816, 24.20506},
                     {9.88806, 24.98591}},
                    {}};
  EXPECT_NEAR(area(clean(raw)), 14, 0.5);
}

// Ten teeth with slots of a centimetre between them; two vertices of one slot are interchanged and
// there is a spike between them, so that the outline crosses itself all along the slot.
TEST(FoundBySearch, ACombWithSlotsOfACentimetreOneOfThemTangled) {
  constexpr double kPitch = 1.17516, kTooth = 1.16516;
  Polygon comb{{{97.43125, -0.5033}, {97.43125 + 10 * kPitch, -0.5033}}, {}};
  for (int i = 9; i >= 0; --i) {
    const double x = 97.43125 + kPitch * i;
    if (i == 6)
      comb.outer.insert(comb.outer.end(),
                        {{x + kTooth, 8.2183}, {x + kTooth + 0.01, 9.2183}, {x + kTooth, 1.4967}});
    else
      comb.outer.insert(comb.outer.end(), {{x + kTooth, 1.4967}, {x + kTooth, 8.2183}});
    comb.outer.push_back({x, 8.2183});
    if (i > 0) comb.outer.push_back({x, 1.4967});
  }
  const Polygon cleaned = clean(comb);
  EXPECT_NEAR(area(cleaned), 98, 1);
  const Simplification simple =
      simplify_footprints(std::vector{cleaned}, Bounds2{80, -20, 130, 30}, {});
  ASSERT_EQ(simple.footprints.size(), 1U);
  EXPECT_NEAR(area(simple.footprints[0]), 10 * 1.175 * 8.72, 4);
}

// Slivers: their union has nothing that is as wide as the grid, and merging took the first of no
// parts.
TEST(FoundBySearch, ACloseGroupOfSliversOnly) {
  const std::vector<Polygon> slivers{
      {{{18.0842, 19.6762}, {25.2418, 19.6762}, {25.2418, 19.6768}}, {}},
      {{{17.7842, 19.7762}, {25.2418, 19.7762}, {25.2418, 19.7768}}, {}}};
  const Simplification simple = simplify_footprints(slivers, Bounds2{0, 0, 26.2422, 26.2422}, {});
  EXPECT_TRUE(simple.footprints.empty());
  EXPECT_EQ(simple.dropped.size(), 2U);
}

// Two houses that hang together by a garden wall of 20 cm: cutting it left one, and nothing of the
// other but its name in the list of members.
TEST(FoundBySearch, NoBuildingVanishesWithTheWallThatJoinsItToAnother) {
  const Polygon wall{rectangle(15, 15, 63, 50).outer, {rectangle(15.2, 15.2, 62.8, 49.8).outer}};
  const std::vector<Polygon> houses{rectangle(10, 10, 20, 20), rectangle(60, 12, 66, 22)};
  const std::vector<Polygon> input{houses[0], houses[1], clean(wall)};
  const Simplification simple = simplify_footprints(input, Bounds2{0, 0, 100, 100}, {});
  ASSERT_EQ(simple.footprints.size(), 2U);
  for (std::size_t i = 0; i < houses.size(); ++i) {
    const Point2 middle = interior_point(houses[i]);
    int times = 0;
    for (std::size_t k = 0; k < simple.footprints.size(); ++k) {
      const auto& members = simple.members[k];
      const bool member =
          std::find(members.begin(), members.end(), BuildingIndex(i)) != members.end();
      EXPECT_EQ(contains(simple.footprints[k], middle), member) << "house " << i;
      times += member ? 1 : 0;
    }
    EXPECT_EQ(times, 1) << "house " << i;
  }
  EXPECT_GE(joint_clearance(simple.footprints).distance, 1);
  const Simplification again = simplify_footprints(simple.footprints, Bounds2{0, 0, 100, 100}, {});
  EXPECT_EQ(again.stats.symmetric_difference, 0);
}

// Where the slivers came from: needles of which the domain's boundary leaves the tip.
TEST(FoundBySearch, ATipCutOffByTheDomainIsClean) {
  const Polygon needle{{{18, 10}, {48, 10}, {48, 10.005}}, {}};
  const std::vector<Polygon> tips = clip_to_domain(needle, Bounds2{1, 1, 25.2, 25.2}, 0);
  ASSERT_EQ(tips.size(), 1U);
  EXPECT_EQ(clean_footprint(tips[0]).polygon.outer, tips[0].outer);
  const std::vector<Polygon> kept =
      clip_to_domain(rectangle(10, 10, 40, 20), Bounds2{1, 1, 25.2, 25.2}, 0);
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].outer.size(), 4U);
  EXPECT_NEAR(area(kept[0]), 15.2 * 10, 1e-9);
}

// A part of the difference of two outlines that is too thin to be halved across was halved across
// for ever.
TEST(FoundBySearch, TheLargestDistanceIsFoundInSliversToo) {
  const TemporaryFolder folder;
  Config synth;
  synth.kind = SynthKind::kAdversarial;
  synth.seed = 61;
  synth.size = 251;
  synth.relief = 4.8;
  synth.point_density = 1.85;
  synth.out = (folder / "input").string();
  run_synth(synth);
  Config config;
  config.footprints = {(folder / "input/footprints.geojson").string()};
  config.points = {synth.out};
  config.out = (folder / "out").string();
  const Report report = run_city(config);
  EXPECT_GT(report.city->max_distance, 0.5);
  EXPECT_LT(report.city->max_distance, 2);
}

}  // namespace
}  // namespace tetropolis::testing
