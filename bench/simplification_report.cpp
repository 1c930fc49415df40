// Simplifies footprints and writes how far the result is from the input, with outlines of the
// places worth looking at, as JSON for scripts/simplification-report.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/clean.h"
#include "tetropolis/city/simplify/simplify.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/vector/vector.h"

namespace tetropolis {
namespace {

using Json = nlohmann::json;

struct Input {
  std::vector<Polygon> footprints;
  std::size_t read = 0;
  Bounds2 domain;
};

/// "random:N": overlapping rectangles on 2.5 km, as in bench/simplify_bench.cpp.
std::vector<Polygon> random_rectangles(int count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> side(1, 20), place(2, 2478);
  std::vector<Polygon> result;
  for (int i = 0; i < count; ++i) {
    const double x = place(random), y = place(random), w = side(random), h = side(random);
    result.push_back({{{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}}, {}});
  }
  return result;
}

std::vector<Polygon> read_local(const std::string& path, const std::string& crs) {
  ReadFootprintsOptions options;
  options.target_crs = crs;
  FootprintsInput input = read_footprints(path, options);
  const Point2 origin{std::floor(input.bounds.xmin), std::floor(input.bounds.ymin)};
  std::vector<Polygon> result;
  for (Footprint& feature : input.features) {
    for (Point2& p : feature.polygon.outer) p = {p.x - origin.x, p.y - origin.y};
    for (Ring& hole : feature.polygon.holes)
      for (Point2& p : hole) p = {p.x - origin.x, p.y - origin.y};
    result.push_back(std::move(feature.polygon));
  }
  return result;
}

Input read_input(const std::string& source, const std::string& crs) {
  const std::vector<Polygon> raw = source.starts_with("random:")
                                       ? random_rectangles(std::stoi(source.substr(7)))
                                       : read_local(source, crs);
  Input input;
  input.read = raw.size();
  bool any = false;
  for (const Polygon& polygon : raw) {
    CleanedFootprint cleaned = clean_footprint(polygon);
    if (!cleaned.usable()) continue;
    const Bounds2 box = bounds(cleaned.polygon);
    input.domain =
        any ? Bounds2{std::min(input.domain.xmin, box.xmin), std::min(input.domain.ymin, box.ymin),
                      std::max(input.domain.xmax, box.xmax), std::max(input.domain.ymax, box.ymax)}
            : box;
    any = true;
    input.footprints.push_back(std::move(cleaned.polygon));
  }
  input.domain = input.domain.grown(100);
  return input;
}

Json rings_json(const Polygon& polygon) {
  Json rings = Json::array();
  for_each_ring(polygon, [&](const Ring& ring) {
    Json points = Json::array();
    for (const Point2 p : ring) points.push_back({p.x, p.y});
    rings.push_back(std::move(points));
  });
  return rings;
}

/// Every input and output whose box meets `window`.
Json place_json(const std::string& why, Point2 at, const Bounds2& window, const Input& input,
                const Simplification& result, std::size_t k) {
  Json before = Json::array(), after = Json::array();
  for (const Polygon& polygon : input.footprints)
    if (bounds(polygon).intersects(window)) before.push_back(rings_json(polygon));
  for (const Polygon& polygon : result.footprints)
    if (bounds(polygon).intersects(window)) after.push_back(rings_json(polygon));
  return {{"why", why},
          {"at", {at.x, at.y}},
          {"window", {window.xmin, window.ymin, window.xmax, window.ymax}},
          {"area_changed", result.changes[k].symmetric_difference},
          {"distance", result.changes[k].hausdorff_distance},
          {"members", result.members[k].size()},
          {"before", before},
          {"after", after}};
}

Bounds2 window_around(Point2 p, double half) { return Bounds2{p.x, p.y, p.x, p.y}.grown(half); }

/// The footprints with the largest changes by `value`, largest first.
template <typename Value>
std::vector<std::size_t> largest(const Simplification& result, std::size_t count,
                                 const Value& value) {
  std::vector<std::size_t> order(result.footprints.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return value(a) > value(b); });
  order.resize(std::min(order.size(), count));
  return order;
}

Json places_json(const Input& input, const Simplification& result, std::size_t worst) {
  Json places = Json::array();
  const auto whole = [&](std::size_t k) {
    const Bounds2 box = bounds(result.footprints[k]);
    return window_around({(box.xmin + box.xmax) / 2, (box.ymin + box.ymax) / 2},
                         std::min(0.55 * std::max(box.width(), box.height()) + 3, 150.0));
  };
  for (std::size_t k = 0; k < result.footprints.size(); ++k)
    if ((result.flags[k] & kConvexHull) != 0)
      places.push_back(place_json("hull", result.changes[k].at, whole(k), input, result, k));
  const auto distance = [&](std::size_t k) { return result.changes[k].hausdorff_distance; };
  for (const std::size_t k : largest(result, worst, distance))
    places.push_back(place_json("distance", result.changes[k].at,
                                window_around(result.changes[k].at, 15 + 2 * distance(k)), input,
                                result, k));
  const auto changed = [&](std::size_t k) { return result.changes[k].symmetric_difference; };
  for (const std::size_t k : largest(result, worst, changed))
    places.push_back(place_json("area", result.changes[k].at, whole(k), input, result, k));
  const auto share = [&](std::size_t k) {
    return result.changes[k].symmetric_difference / area(result.footprints[k]);
  };
  for (const std::size_t k : largest(result, worst, share))
    places.push_back(place_json("share", result.changes[k].at, whole(k), input, result, k));
  // In the middle of those that were changed at all, by share of the area.
  std::vector<std::size_t> order = largest(result, result.footprints.size(), share);
  std::erase_if(order, [&](std::size_t k) { return !(changed(k) > 0); });
  if (!order.empty()) {
    const std::size_t k = order[order.size() / 2];
    places.push_back(place_json("typical", result.changes[k].at,
                                window_around(result.changes[k].at, 40), input, result, k));
  }
  return places;
}

Json stats_json(const Input& input, const Simplification& result) {
  const SimplifyStats& s = result.stats;
  std::vector<double> distances;
  for (const FootprintChange& change : result.changes)
    distances.push_back(change.hausdorff_distance);
  std::sort(distances.begin(), distances.end());
  const double p99 = distances.empty() ? 0 : distances[distances.size() * 99 / 100];
  return {{"read", input.read},
          {"cleaned", input.footprints.size()},
          {"buildings", result.footprints.size()},
          {"dropped", result.dropped.size()},
          {"area", s.area_before},
          {"area_changed_share", s.area_before > 0 ? s.symmetric_difference / s.area_before : 0},
          {"area_dropped_share", s.area_before > 0 ? s.area_dropped / s.area_before : 0},
          {"max_distance", s.max_hausdorff_distance},
          {"p99_distance", p99},
          {"hulls", s.hulls},
          {"local_hulls", s.local_hulls},
          {"hull_repairs", s.hull_repairs},
          {"merged_by_hull", s.merged_by_hull + s.merged_by_hulls},
          {"merged_by_bridge", s.merged_by_bridge},
          {"rounds", s.rounds},
          {"min_clearance", s.min_clearance}};
}

int run(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: simplification_report SOURCE CLEARANCE OUT.json [CRS] [WORST]\n");
    return 2;
  }
  const Input input = read_input(argv[1], argc > 4 ? argv[4] : "");
  const auto worst = static_cast<std::size_t>(argc > 5 ? std::stoi(argv[5]) : 3);
  SimplifyOptions options;
  options.min_distance = std::stod(argv[2]);
  const auto start = std::chrono::steady_clock::now();
  const Simplification result = simplify_footprints(input.footprints, input.domain, options);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  Json json = {{"stats", stats_json(input, result)},
               {"seconds", took.count()},
               {"places", places_json(input, result, worst)}};
  std::ofstream(argv[3]) << json.dump() << '\n';
  return 0;
}

}  // namespace
}  // namespace tetropolis

int main(int argc, char** argv) {
  try {
    return tetropolis::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "simplification_report: %s\n", error.what());
    return 1;
  }
}
