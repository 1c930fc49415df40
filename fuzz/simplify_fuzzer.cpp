// Polygons from bytes through cleaning and simplification.
#include <algorithm>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/clean.h"
#include "tetropolis/city/simplify/clearance.h"
#include "tetropolis/city/simplify/simplify.h"
#include "tetropolis/core/threads.h"
#include "tetropolis/geometry/polygon.h"

#include "fuzz_input.h"

namespace {

using namespace tetropolis;
using namespace tetropolis::fuzz;

constexpr int kMostPolygons = 6;
constexpr int kMostVertices = 12;
constexpr int kMostHoles = 2;

/// A ring in steps that go from the grid's own to decimetres, somewhere in 200 m x 200 m.
Ring ring_from(ByteReader& bytes, double step) {
  Ring ring;
  const double x0 = bytes.take<std::uint8_t>() * 0.8, y0 = bytes.take<std::uint8_t>() * 0.8;
  const int size = bytes.between(1, kMostVertices);
  for (int i = 0; i < size; ++i) {
    const double x = x0 + step * bytes.take<std::int8_t>();
    ring.push_back({x, y0 + step * bytes.take<std::int8_t>()});
  }
  return ring;
}

struct Case {
  std::vector<Polygon> raw;
  SimplifyOptions options;
  Bounds2 domain{0, 0, 200, 200};
};

Case case_from(ByteReader& bytes) {
  static constexpr double kSteps[] = {0.25, 0.1, 0.5, 0.01, 0.0001, 1};
  static constexpr double kDistances[] = {1, 0.5, 2, 0.1, 5, 20};
  Case made;
  const double step = kSteps[bytes.between(0, 5)];
  made.options.min_distance = kDistances[bytes.between(0, 5)];
  made.options.growths = bytes.between(1, 3);
  made.options.min_area = bytes.between(0, 20);
  if (bytes.between(0, 3) == 3) made.domain = {60, 60, 140, 120};
  for (int k = 0; k < kMostPolygons && !bytes.empty(); ++k) {
    Polygon polygon{ring_from(bytes, step), {}};
    const int holes = std::max(0, bytes.between(-3, kMostHoles));
    for (int h = 0; h < holes; ++h) polygon.holes.push_back(ring_from(bytes, step));
    made.raw.push_back(std::move(polygon));
  }
  return made;
}

/// Guarantees of clean_footprint.
std::vector<Polygon> claim_cleaned(const std::vector<Polygon>& raw) {
  std::vector<Polygon> cleaned;
  for (const Polygon& polygon : raw) {
    CleanedFootprint result = clean_footprint(polygon);
    if (!result.usable()) {
      claim(result.polygon.outer.empty(), "an unusable footprint is empty");
      continue;
    }
    const auto defects = footprint_defects(std::span(&result.polygon, 1), 1);
    claim(defects.empty(), defects.empty() ? "" : "cleaned: " + defects[0].message);
    claim(clean_footprint(result.polygon).usable(), "a cleaned footprint can be cleaned");
    cleaned.push_back(std::move(result.polygon));
  }
  return cleaned;
}

/// Every input is in one output or dropped, in order.
void claim_account(const Simplification& result, std::size_t inputs) {
  std::vector<int> seen(inputs, 0);
  BuildingIndex previous = kNoBuilding;
  claim(result.members.size() == result.footprints.size() &&
            result.flags.size() == result.footprints.size(),
        "members and flags for every footprint");
  for (const auto& members : result.members) {
    claim(!members.empty() && std::is_sorted(members.begin(), members.end()), "members sorted");
    claim(members[0] > previous, "footprints sorted by first member");
    previous = members[0];
    for (const BuildingIndex m : members) ++seen.at(m);
  }
  for (const DroppedFootprint& dropped : result.dropped) {
    claim(!dropped.reason.empty(), "a reason for what is dropped");
    ++seen.at(dropped.index);
  }
  claim(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }),
        "every footprint is accounted for once");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ThreadLimit one_thread(1);
  ByteReader bytes(data, size);
  const Case made = case_from(bytes);
  const std::vector<Polygon> cleaned = claim_cleaned(made.raw);
  const Simplification result = simplify_footprints(cleaned, made.domain, made.options);
  claim_account(result, cleaned.size());
  const auto defects = footprint_defects(result.footprints, 1);
  claim(defects.empty(), defects.empty() ? "" : "simplified: " + defects[0].message);
  claim(
      is_clear(joint_clearance(result.footprints, made.domain).distance, made.options.min_distance),
      "joint clearance");
  for (const Polygon& footprint : result.footprints)
    claim(area(footprint) >= made.options.min_area * (1 - 1e-12), "least area");
  const Simplification again = simplify_footprints(result.footprints, made.domain, made.options);
  claim(again.footprints == result.footprints && again.dropped.empty(),
        "a second call changes nothing");
  return 0;
}
