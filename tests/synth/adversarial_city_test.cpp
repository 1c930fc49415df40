#include "synth/adversarial_city.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/threads.h"
#include "tetropolis/geometry/polygon.h"

namespace tetropolis {
namespace {

AdversarialCity city_with(std::vector<std::string> defects, std::uint64_t seed,
                          double points_per_m2 = 0.2) {
  return synthetic_adversarial_city({160, seed, points_per_m2, 6, std::move(defects)});
}

void expect_same(const AdversarialCity& a, const AdversarialCity& b) {
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.crs, b.crs);
  EXPECT_EQ(a.as_geojson, b.as_geojson);
  EXPECT_EQ(a.with_z, b.with_z);
  EXPECT_EQ(a.needs_bounds, b.needs_bounds);
  EXPECT_EQ(a.refusable, b.refusable);
  ASSERT_EQ(a.defects.size(), b.defects.size());
  for (std::size_t d = 0; d < a.defects.size(); ++d) {
    EXPECT_EQ(a.defects[d].name, b.defects[d].name);
    EXPECT_EQ(a.defects[d].count, b.defects[d].count) << a.defects[d].name;
  }
  for (double y = 0; y <= a.domain.ymax; y += 7)
    for (double x = 0; x <= a.domain.xmax; x += 7)
      EXPECT_EQ(synthetic_ground(a.terrain, x, y), synthetic_ground(b.terrain, x, y));
  ASSERT_EQ(a.features.size(), b.features.size());
  for (std::size_t f = 0; f < a.features.size(); ++f) {
    EXPECT_EQ(a.features[f].id, b.features[f].id);
    const double ha = a.features[f].height, hb = b.features[f].height;
    EXPECT_TRUE(ha == hb || (std::isnan(ha) && std::isnan(hb))) << f << ": " << ha << ", " << hb;
    EXPECT_EQ(a.features[f].polygons, b.features[f].polygons) << f;
  }
  ASSERT_EQ(a.tiles.size(), b.tiles.size());
  for (std::size_t t = 0; t < a.tiles.size(); ++t) {
    EXPECT_EQ(a.tiles[t].points.x, b.tiles[t].points.x);
    EXPECT_EQ(a.tiles[t].points.y, b.tiles[t].points.y);
    EXPECT_EQ(a.tiles[t].points.z, b.tiles[t].points.z);
    EXPECT_EQ(a.tiles[t].points.classification, b.tiles[t].points.classification);
    EXPECT_EQ(a.tiles[t].flags, b.tiles[t].flags);
  }
}

std::size_t count_points(const AdversarialCity& city,
                         const std::function<bool(const PointTile&, std::size_t)>& which) {
  std::size_t count = 0;
  for (const PointTile& tile : city.tiles)
    for (std::size_t i = 0; i < tile.points.size(); ++i) count += which(tile, i) ? 1U : 0U;
  return count;
}

std::size_t count_all_points(const AdversarialCity& city) {
  return count_points(city, [](const PointTile&, std::size_t) { return true; });
}

std::size_t count_code(const AdversarialCity& city, int code) {
  return count_points(city, [&](const PointTile& tile, std::size_t i) {
    return tile.points.classification[i] == code;
  });
}

std::size_t count_flag(const AdversarialCity& city, int flag) {
  return count_points(city, [&](const PointTile& tile, std::size_t i) {
    return !tile.flags.empty() && (tile.flags[i] & flag) != 0;
  });
}

std::size_t count_rings(const AdversarialCity& city,
                        const std::function<bool(const RawRing&)>& which) {
  std::size_t count = 0;
  for (const RawFeature& feature : city.features)
    for (const RawPolygon& polygon : feature.polygons)
      for (const RawRing& ring : polygon) count += which(ring) ? 1U : 0U;
  return count;
}

/// Of the first vertex less, so that large coordinates lose no digits; NaN for broken vertices.
double twice_area(const RawRing& ring) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i)
    sum += (ring[i].x - ring[0].x) * (ring[i + 1].y - ring[0].y) -
           (ring[i + 1].x - ring[0].x) * (ring[i].y - ring[0].y);
  return sum;
}

bool is_closed(const RawRing& ring) { return ring.size() > 2 && ring.front() == ring.back(); }

double least_edge(const RawRing& ring) {
  double least = 1e9;
  for (std::size_t i = 1; i < ring.size(); ++i)
    least = std::min(least, std::hypot(ring[i].x - ring[i - 1].x, ring[i].y - ring[i - 1].y));
  return least;
}

bool is_five_centimetres(double length) { return std::abs(length - 0.05) < 0.003; }

/// From the first hole's vertices to the outer ring; infinity without a hole.
double thinnest_wall(const RawPolygon& polygon) {
  double least = std::numeric_limits<double>::infinity();
  if (polygon.size() < 2) return least;
  const RawRing& outer = polygon[0];
  for (const RawVertex& p : polygon[1])
    for (std::size_t i = 1; i < outer.size(); ++i)
      least = std::min(least, distance_to_segment({p.x, p.y}, {outer[i - 1].x, outer[i - 1].y},
                                                  {outer[i].x, outer[i].y}));
  return least;
}

bool has_vertex(const AdversarialCity& city, const std::function<bool(const RawVertex&)>& which) {
  return count_rings(city, [&](const RawRing& ring) {
           return std::any_of(ring.begin(), ring.end(), which);
         }) > 0;
}

std::size_t count_holes(const AdversarialCity& city) {
  std::size_t count = 0;
  for (const RawFeature& feature : city.features)
    for (const RawPolygon& polygon : feature.polygons) count += polygon.size() - 1;
  return count;
}

double span_of_ground(const AdversarialCity& city) {
  double low = 1e9, high = -1e9;
  for (double y = 0; y <= city.domain.ymax; y += 1)
    for (double x = 0; x <= city.domain.xmax; x += 1) {
      const double z = synthetic_ground(city.terrain, x, y);
      low = std::min(low, z);
      high = std::max(high, z);
    }
  return high - low;
}

/// A fact about a city with the defect that does not hold of a sound one of the same seed.
struct Sign {
  const char* defect;
  std::function<bool(const AdversarialCity& city, const AdversarialCity& sound)> shows;
};

using City = const AdversarialCity&;

const Sign kSigns[] = {
    {"slope_45", [](City c, City) { return span_of_ground(c) > c.domain.xmax * 0.9; }},
    {"quarry_wall", [](City c, City s) { return span_of_ground(c) > span_of_ground(s) + 12; }},
    {"canals",
     [](City c, City s) { return count_code(c, kWater) > 0 && count_code(s, kWater) == 0; }},
    {"below_sea", [](City c, City) { return synthetic_ground(c.terrain, 9, 9) < 0; }},
    {"high_mountains", [](City c, City) { return synthetic_ground(c.terrain, 9, 9) > 2499; }},
    {"circle_4000",
     [](City c, City) {
       return count_rings(c, [](const RawRing& r) { return r.size() == 4001; }) > 0;
     }},
    {"shed_2cm",
     [](City c, City) {
       return count_rings(c, [](const RawRing& r) { return least_edge(r) < 0.0225; }) > 0;
     }},
    {"wall_5cm",
     [](City c, City) {
       return count_rings(c, [](const RawRing& r) { return is_five_centimetres(least_edge(r)); }) >
                  0 ||
              std::any_of(c.features.begin(), c.features.end(), [](const RawFeature& f) {
                return std::any_of(f.polygons.begin(), f.polygons.end(), [](const RawPolygon& p) {
                  return is_five_centimetres(thinnest_wall(p));
                });
              });
     }},
    {"building_twice", [](City c, City s) { return c.features.size() > s.features.size(); }},
    {"tower_300",
     [](City c, City) {
       return std::any_of(c.features.begin(), c.features.end(),
                          [](const RawFeature& f) { return f.height >= 200; });
     }},
    {"larger_than_domain",
     [](City c, City) {
       return count_rings(c, [&](const RawRing& r) {
                return std::abs(twice_area(r)) > 2 * c.domain.width() * c.domain.height();
              }) == 1;
     }},
    {"offset_centimetres",
     [](City c, City s) { return c.origin.x - s.origin.x > 0 && c.origin.x - s.origin.x < 0.1; }},
    {"far_north", [](City c, City) { return c.origin.y > 7e6; }},
    {"small_numbers", [](City c, City) { return c.origin.x < 0 && c.origin.x > -1000; }},
    {"multipolygon",
     [](City c, City) {
       return std::any_of(c.features.begin(), c.features.end(),
                          [](const RawFeature& f) { return f.polygons.size() > 1; });
     }},
    {"hole_outside", [](City c, City s) { return count_holes(c) > count_holes(s); }},
    {"hole_equal", [](City c, City s) { return count_holes(c) > count_holes(s); }},
    {"hole_touching", [](City c, City s) { return count_holes(c) > count_holes(s); }},
    {"hole_sharing_edge", [](City c, City s) { return count_holes(c) > count_holes(s); }},
    {"duplicate_vertices",
     [](City c, City s) {
       const auto doubled = [](const RawRing& r) { return least_edge(r) == 0; };
       return count_rings(c, doubled) > 0 && count_rings(s, doubled) == 0;
     }},
    {"near_duplicate_vertices",
     [](City c, City s) {
       const auto close = [](const RawRing& r) { return least_edge(r) < 0.02; };
       return count_rings(c, close) > 0 && count_rings(s, close) == 0;
     }},
    {"clockwise",
     [](City c, City s) {
       const auto negative = [](const RawRing& r) { return twice_area(r) < 0; };
       return count_rings(c, negative) != count_rings(s, negative);
     }},
    {"unclosed",
     [](City c, City s) {
       const auto open = [](const RawRing& r) { return !is_closed(r); };
       return count_rings(c, open) > 0 && count_rings(s, open) == 0;
     }},
    {"huge_coordinate",
     [](City c, City) {
       return has_vertex(c,
                         [](RawVertex p) { return std::max(std::abs(p.x), std::abs(p.y)) >= 1e9; });
     }},
    {"nan_coordinate",
     [](City c, City) {
       return has_vertex(c, [](RawVertex p) { return !std::isfinite(p.x) || !std::isfinite(p.y); });
     }},
    {"two_vertices",
     [](City c, City) {
       return count_rings(c, [](const RawRing& r) {
                return r.size() == 2 || (r.size() == 3 && r[0] == r[2]);
              }) > 0;
     }},
    {"null_shape",
     [](City c, City) {
       return std::any_of(c.features.begin(), c.features.end(),
                          [](const RawFeature& f) { return f.polygons.empty(); });
     }},
    {"z_values", [](City c, City s) { return c.with_z && !s.with_z; }},
    {"points_twice", [](City c, City s) { return count_all_points(c) == 2 * count_all_points(s); }},
    {"birds_classed",
     [](City c, City s) { return count_code(c, kHighNoise) > count_code(s, kHighNoise); }},
    {"pits_classed",
     [](City c, City s) { return count_code(c, kLowNoise) > count_code(s, kLowNoise); }},
    {"birds_unclassed", [](City c, City s) { return count_all_points(c) > count_all_points(s); }},
    {"pits_unclassed", [](City c, City s) { return count_all_points(c) > count_all_points(s); }},
    {"void_25m", [](City c, City s) { return count_all_points(c) < count_all_points(s) - 20; }},
    {"half_without_ground",
     [](City c, City s) { return 3 * count_code(c, kGround) < 2 * count_code(s, kGround); }},
    {"class_above_31",
     [](City c, City) {
       return count_points(c, [](const PointTile& t, std::size_t i) {
                return t.points.classification[i] > 31;
              }) > 50;
     }},
    {"tiles_overlap",
     [](City c, City s) {
       return c.tiles.size() > 1 && count_all_points(c) > count_all_points(s);
     }},
    {"tiles_gap",
     [](City c, City s) {
       return c.tiles.size() > 1 && count_all_points(c) < count_all_points(s);
     }},
    {"withheld_points", [](City c, City) { return count_flag(c, kWithheldPoint) > 50; }},
    {"synthetic_points", [](City c, City) { return count_flag(c, kSyntheticPoint) > 50; }},
    {"overlap_points", [](City c, City) { return count_flag(c, kOverlapPoint) > 50; }},
    {"no_classes", [](City c, City) { return count_code(c, kGround) == 0; }},
    {"only_ground", [](City c, City) { return count_code(c, kBuildingClass) == 0; }},
    {"only_buildings", [](City c, City) { return count_code(c, kGround) == 0; }},
};

TEST(SyntheticAdversarial, EveryDefectShowsAndAloneIsListed) {
  std::set<std::string> with_sign;
  for (const Sign& sign : kSigns) with_sign.insert(sign.defect);
  for (const std::uint64_t seed : {2, 3, 11}) {
    // Sound but for one thing that the signs of the others do not look at.
    const AdversarialCity sound = city_with({"offset_centimetres"}, seed);
    AdversarialCity reference = sound;
    reference.origin = SyntheticCity{}.origin;
    for (const Sign& sign : kSigns)
      EXPECT_FALSE(sign.shows(reference, reference)) << sign.defect << ", seed " << seed;
    for (const DefectKind& kind : defect_kinds()) {
      const AdversarialCity city = city_with({kind.name}, seed);
      ASSERT_EQ(city.defects.size(), 1U) << kind.name << ", seed " << seed;
      EXPECT_EQ(city.defects[0].name, kind.name);
      EXPECT_GT(city.defects[0].count, 0) << kind.name;
      EXPECT_EQ(city.refusable, kind.refusable);
      for (const Sign& sign : kSigns) {
        const bool holds = sign.defect != std::string(kind.name) || sign.shows(city, reference);
        EXPECT_TRUE(holds) << kind.name << ", seed " << seed;
      }
      if (std::string(kind.group) == "building" && !with_sign.contains(kind.name)) {
        std::size_t changed = city.features.size() != reference.features.size() ? 1 : 0;
        for (std::size_t f = 0; changed == 0 && f < city.features.size(); ++f)
          changed += city.features[f].polygons != reference.features[f].polygons ? 1U : 0U;
        EXPECT_GT(changed, 0U) << kind.name << ", seed " << seed;
      }
    }
  }
}

TEST(SyntheticAdversarial, TheSameSeedGivesTheSameCityForAnyNumberOfThreads) {
  for (const std::uint64_t seed : {1, 5, 9}) {
    const AdversarialCity city = city_with({}, seed);
    {
      const ThreadLimit one(1);
      expect_same(city, city_with({}, seed));
    }
    const AdversarialCity other = city_with({}, seed + 1);
    EXPECT_NE(city.tiles[0].points.z, other.tiles[0].points.z);
  }
}

TEST(SyntheticAdversarial, MixesReachEveryDefectAndEveryCityHasBuildings) {
  std::map<std::string, int> seen;
  int as_geojson = 0;
  constexpr int kSeeds = 500;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const AdversarialCity city = city_with({}, static_cast<std::uint64_t>(seed), 0.02);
    EXPECT_GE(city.defects.size(), 1U);
    for (const Defect& defect : city.defects) ++seen[defect.name];
    as_geojson += city.as_geojson ? 1 : 0;
    EXPECT_GE(city.features.size(), 3U) << "seed " << seed;
    std::set<std::string> ids;
    for (const RawFeature& feature : city.features) ids.insert(feature.id);
    EXPECT_EQ(ids.size(), city.features.size()) << "seed " << seed;
    for (const PointTile& tile : city.tiles) EXPECT_GT(tile.points.size(), 0U) << "seed " << seed;
  }
  for (const DefectKind& kind : defect_kinds()) EXPECT_GT(seen[kind.name], 3) << kind.name;
  EXPECT_GT(as_geojson, kSeeds / 3);
  EXPECT_LT(as_geojson, 2 * kSeeds / 3);
}

TEST(SyntheticAdversarial, UndamagedRingsTurnAsTheFormatWantsIt) {
  int formats = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const AdversarialCity city = city_with({"offset_centimetres"}, seed, 0.02);
    formats |= city.as_geojson ? 1 : 2;
    for (const RawFeature& feature : city.features)
      for (const RawPolygon& polygon : feature.polygons)
        for (const RawRing& ring : polygon) {
          const bool outer = &ring == &polygon.front();
          EXPECT_EQ(twice_area(ring) > 0, outer == city.as_geojson) << seed << " " << feature.id;
          EXPECT_TRUE(is_closed(ring));
        }
  }
  EXPECT_EQ(formats, 3);
}

TEST(SyntheticAdversarial, RefusesWhatItCannotDo) {
  const auto kind_of = [](const AdversarialCityOptions& options) {
    try {
      synthetic_adversarial_city(options);
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::kGuarantee;
  };
  EXPECT_EQ(kind_of({99, 1, 1, 6, {}}), ErrorKind::kUsage);
  EXPECT_EQ(kind_of({200, 1, 0, 6, {}}), ErrorKind::kUsage);
  EXPECT_EQ(kind_of({200, 1, 1, -1, {}}), ErrorKind::kUsage);
  EXPECT_EQ(kind_of({200, 1, 1, 6, {"bow_tie", "unicorn"}}), ErrorKind::kUsage);
}

}  // namespace
}  // namespace tetropolis
