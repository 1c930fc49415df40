// Damage to footprints as a file holds them.
#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/infinity.h"
#include "defects.h"

namespace tetropolis {

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

RawVertex between(const RawVertex& a, const RawVertex& b, double share) {
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.z};
}

/// A vertex beside the middle of an edge: `off` times the edge's length to its left.
RawVertex beside(const RawVertex& a, const RawVertex& b, double share, double off) {
  RawVertex p = between(a, b, share);
  p.x -= off * (b.y - a.y);
  p.y += off * (b.x - a.x);
  return p;
}

/// An edge of a closed ring: the index of its first vertex.
std::size_t some_edge(const RawRing& ring, SeededRandom& random) {
  return random.bits() % (ring.size() - 1);
}

RawRing scaled_copy(const RawRing& ring, double scale, double dx, double dy) {
  RawRing copy;
  for (const RawVertex& p : ring)
    copy.push_back({ring[0].x + scale * (p.x - ring[0].x) + dx,
                    ring[0].y + scale * (p.y - ring[0].y) + dy, p.z});
  return copy;
}

void unclosed(RawPolygon& polygon, SeededRandom& random) {
  RawRing& ring = polygon.front();
  ring.pop_back();
  // Or almost closed.
  if (random.chance(0.3))
    ring.push_back({ring[0].x + random.uniform(-0.01, 0.01), ring[0].y + 1e-4, ring[0].z});
}

void clockwise(RawPolygon& polygon, SeededRandom& random) {
  for (RawRing& ring : polygon)
    if (&ring == &polygon.front() || random.chance(0.7)) std::reverse(ring.begin(), ring.end());
}

void duplicate_vertices(RawPolygon& polygon, SeededRandom& random) {
  for (RawRing& ring : polygon) {
    RawRing more;
    for (const RawVertex& p : ring)
      more.insert(more.end(), random.chance(0.5) ? 1 + random.bits() % 4 : 1, p);
    ring = more;
  }
}

void near_duplicates(RawPolygon& polygon, SeededRandom& random) {
  RawRing& ring = polygon.front();
  constexpr double kOffsets[] = {1e-12, 1e-9, 1e-7, 1e-6, 1e-4, 1e-3, 5e-3};
  RawRing more{ring.front()};
  for (std::size_t i = 1; i < ring.size(); ++i) {
    if (random.chance(0.5)) {
      const double off = kOffsets[random.bits() % std::size(kOffsets)];
      more.push_back({ring[i].x + off * random.bell(), ring[i].y + off * random.bell(), ring[i].z});
    }
    more.push_back(ring[i]);
  }
  ring = more;
}

void spike(RawPolygon& polygon, SeededRandom& random) {
  RawRing& ring = polygon.front();
  const std::size_t i = some_edge(ring, random);
  const double share = random.chance(0.3) ? 0 : random.uniform(0.2, 0.8);
  const RawVertex foot = between(ring[i], ring[i + 1], share);
  // Out of the house or into it, a whisker or farther than the neighbours.
  const double off = (random.chance(0.7) ? -1 : 1) * random.uniform(0.05, 1.5);
  const RawVertex tip = beside(ring[i], ring[i + 1], share, off);
  ring.insert(ring.begin() + static_cast<std::ptrdiff_t>(i) + 1, {foot, tip, foot});
}

void bow_tie(RawPolygon& polygon, SeededRandom& random) {
  RawRing& ring = polygon.front();
  if (ring.size() < 5) return;
  const std::size_t i = 1 + random.bits() % (ring.size() - 3);
  std::swap(ring[i], ring[i + 1]);
}

void hole_outside(RawPolygon& polygon, SeededRandom& random) {
  const double far = random.chance(0.5) ? random.uniform(15, 40) : random.uniform(2, 10);
  polygon.push_back(scaled_copy(polygon.front(), 0.4, far, random.uniform(-5, 5)));
}

void hole_equal(RawPolygon& polygon, SeededRandom& random) {
  RawRing hole = polygon.front();
  if (random.chance(0.7)) std::reverse(hole.begin(), hole.end());
  polygon.push_back(hole);
}

/// A triangular yard whose tip is on the wall, or in a corner.
void hole_touching(RawPolygon& polygon, SeededRandom& random) {
  const RawRing& ring = polygon.front();
  const std::size_t i = some_edge(ring, random);
  const double share = random.chance(0.3) ? 0 : 0.5;
  const RawVertex tip = between(ring[i], ring[i + 1], share);
  const RawVertex left = beside(ring[i], ring[i + 1], 0.35, 0.25);
  const RawVertex right = beside(ring[i], ring[i + 1], 0.65, 0.25);
  polygon.push_back({tip, left, right, tip});
}

/// A yard that has a piece of the wall for its own.
void hole_sharing_edge(RawPolygon& polygon, SeededRandom& random) {
  const RawRing& ring = polygon.front();
  const std::size_t i = some_edge(ring, random);
  const bool whole = random.chance(0.3);
  const RawVertex a = between(ring[i], ring[i + 1], whole ? 0 : 0.25);
  const RawVertex b = between(ring[i], ring[i + 1], whole ? 1 : 0.75);
  polygon.push_back(
      {a, beside(ring[i], ring[i + 1], 0.3, 0.3), beside(ring[i], ring[i + 1], 0.7, 0.3), b, a});
}

void huge_coordinate(RawPolygon& polygon, SeededRandom& random) {
  RawRing& ring = polygon[random.bits() % polygon.size()];
  RawVertex& p = ring[random.bits() % ring.size()];
  constexpr double kHuge[] = {1e300, -1e300, 1e20, 1e12, 1e9};
  (random.chance(0.5) ? p.x : p.y) = kHuge[random.bits() % std::size(kHuge)];
}

void nan_coordinate(RawPolygon& polygon, SeededRandom& random) {
  RawRing& ring = polygon[random.bits() % polygon.size()];
  RawVertex& p = ring[random.bits() % ring.size()];
  (random.chance(0.5) ? p.x : p.y) = random.chance(0.7) ? kNan : kInfinity;
}

struct OutlineDefect {
  std::string_view name;
  void (*damage)(RawPolygon&, SeededRandom&);
};
constexpr OutlineDefect kOutlineDefects[] = {{"unclosed", unclosed},
                                             {"clockwise", clockwise},
                                             {"duplicate_vertices", duplicate_vertices},
                                             {"near_duplicate_vertices", near_duplicates},
                                             {"zero_width_spike", spike},
                                             {"bow_tie", bow_tie},
                                             {"hole_outside", hole_outside},
                                             {"hole_equal", hole_equal},
                                             {"hole_touching", hole_touching},
                                             {"hole_sharing_edge", hole_sharing_edge},
                                             {"huge_coordinate", huge_coordinate},
                                             {"nan_coordinate", nan_coordinate}};

bool whole(const RawFeature& feature) {
  return !feature.polygons.empty() && feature.polygons[0].front().size() >= 4;
}

/// Features without an outline to speak of, at random places of the list.
std::int64_t add_odd_features(std::string_view name, AdversarialCity& city, SeededRandom& random) {
  const auto count = static_cast<std::int64_t>(1 + random.bits() % 3);
  for (std::int64_t k = 0; k < count; ++k) {
    RawFeature odd;
    odd.id = fmt::format("{}-{}", name == "null_shape" ? "null" : "line", k + 1);
    if (name == "two_vertices") {
      const double x = random.uniform(20, city.domain.xmax - 20);
      const double y = random.uniform(20, city.domain.ymax - 20);
      RawRing line{{x, y, 0}, {x + 5, y + 3, 0}};
      if (random.chance(0.5)) line.push_back(line.front());
      odd.polygons = {{line}};
    }
    const std::size_t at = random.bits() % (city.features.size() + 1);
    city.features.insert(city.features.begin() + static_cast<std::ptrdiff_t>(at), odd);
  }
  return count;
}

std::int64_t add_heights(AdversarialCity& city, SeededRandom& random) {
  city.with_z = true;
  std::int64_t count = 0;
  const bool nothing = random.chance(0.3);
  for (RawFeature& feature : city.features)
    for (RawPolygon& polygon : feature.polygons)
      for (RawRing& ring : polygon)
        for (RawVertex& p : ring) {
          p.z = nothing ? -9999 : random.uniform(-10, 90);
          ++count;
        }
  return count;
}

/// A parcel around everything, which the laser knows nothing of.
std::int64_t add_parcel(AdversarialCity& city, SeededRandom& random) {
  const double low = -random.uniform(0.5, 60);
  const double high = city.domain.xmax + random.uniform(0.5, 60);
  RawFeature parcel;
  parcel.id = "parcel";
  parcel.polygons = {
      {{{low, low, 0}, {high, low, 0}, {high, high, 0}, {low, high, 0}, {low, low, 0}}}};
  city.features.push_back(std::move(parcel));
  return 1;
}

/// Buildings far apart under one number.
std::int64_t join_features(AdversarialCity& city, SeededRandom& random) {
  std::int64_t count = 0;
  for (int k = 0; k < 3 && city.features.size() > 6; ++k) {
    const std::size_t from = random.bits() % city.features.size();
    RawFeature moved = city.features[from];
    city.features.erase(city.features.begin() + static_cast<std::ptrdiff_t>(from));
    RawFeature& to = city.features[random.bits() % city.features.size()];
    to.polygons.insert(to.polygons.end(), moved.polygons.begin(), moved.polygons.end());
    ++count;
  }
  return count;
}

}  // namespace

std::int64_t damage_outlines(std::string_view name, AdversarialCity& city, SeededRandom& random) {
  if (city.features.empty()) return 0;
  if (name == "null_shape" || name == "two_vertices") return add_odd_features(name, city, random);
  if (name == "z_values") return add_heights(city, random);
  if (name == "larger_than_domain") return add_parcel(city, random);
  if (name == "multipolygon") return join_features(city, random);
  for (const OutlineDefect& defect : kOutlineDefects) {
    if (defect.name != name) continue;
    std::int64_t count = 0;
    // A few, or a good part of all.
    const std::size_t most = random.chance(0.3) ? city.features.size() / 2 + 1 : 4;
    const auto wanted = static_cast<std::int64_t>(1 + random.bits() % most);
    for (int tries = 0; tries < 200 && count < wanted; ++tries) {
      RawFeature& feature = city.features[random.bits() % city.features.size()];
      if (!whole(feature)) continue;
      defect.damage(feature.polygons[0], random);
      ++count;
    }
    return count;
  }
  return 0;
}

}  // namespace tetropolis
