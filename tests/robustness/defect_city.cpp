#include "defect_city.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/run/run.h"

#include "support/guarantees.h"

namespace tetropolis::testing {

namespace fs = std::filesystem;

DefectCity defect_city() {
  DefectCity city;
  Polygon north = rectangle(20, 75, 50, 100);
  north.holes = {{{30, 83}, {30, 92}, {40, 92}, {40, 83}}};
  city.houses = {
      {"west", rectangle(15, 20, 35, 40), 9},
      {"east", {{{110, 20}, {140, 20}, {140, 35}, {125, 35}, {125, 50}, {110, 50}}, {}}, 15},
      {"north", north, 18},
      {"tower", rectangle(110, 75, 125, 90), 40},
      {"shed", rectangle(60, 20, 66, 25), 3},
      {"patient", rectangle(60, 50, 84, 66), 12},
  };
  city.ground = [](double x, double y) { return 20 + 0.02 * x + 0.01 * y; };
  return city;
}

namespace {

std::string ring_wkt(const Ring& ring, bool closed) {
  std::string text = "(";
  for (std::size_t i = 0; i < ring.size() + (closed ? 1 : 0); ++i) {
    const Point2 p = ring[i % ring.size()];
    text += fmt::format("{}{} {}", i == 0 ? "" : ",", p.x, p.y);
  }
  return text + ")";
}

std::string polygon_wkt(const Polygon& polygon, bool closed) {
  std::string text = "POLYGON(" + ring_wkt(polygon.outer, closed);
  for (const Ring& hole : polygon.holes) text += "," + ring_wkt(hole, closed);
  return text + ")";
}

}  // namespace

std::string open_wkt(const Polygon& polygon) { return polygon_wkt(polygon, false); }
std::string wkt(const Polygon& polygon) { return polygon_wkt(polygon, true); }

std::vector<Feature> sound_features(const DefectCity& city) {
  std::vector<Feature> features;
  for (const House& house : city.houses) features.push_back({house.id, wkt(house.footprint)});
  return features;
}

std::vector<Feature> with_patient(const DefectCity& city, const std::string& patient) {
  std::vector<Feature> features = sound_features(city);
  for (Feature& feature : features)
    if (feature.id == "patient") feature.wkt = patient;
  return features;
}

PointCloud scan(const DefectCity& city) {
  PointCloud cloud;
  const auto add = [&](double x, double y, double z, int code) {
    cloud.push_back(x, y, z, static_cast<std::uint8_t>(code));
  };
  // Off the walls, which are at whole metres.
  const Bounds2& box = city.domain;
  for (double y = box.ymin + 0.3; y <= box.ymax; y += 1)
    for (double x = box.xmin + 0.3; x <= box.xmax; x += 1) {
      double roof = -std::numeric_limits<double>::infinity();
      for (const House& house : city.houses) {
        if (!contains(house.footprint, {x, y})) continue;
        const Point2 corner = house.footprint.outer.front();
        roof = std::max(roof, city.ground(corner.x, corner.y) + house.height);
      }
      if (std::isfinite(roof))
        add(x, y, roof, 6);
      else if (const int code = city.ground_class(x, y); code != 0)
        add(x, y, city.ground(x, y), code);
    }
  for (const Point3& p : city.strays) add(p[0], p[1], p[2], kGround);
  return cloud;
}

std::string moved_wkt(const std::string& wkt, Point2 by) {
  std::string result;
  int column = 0;  // of the number within its point
  for (std::size_t i = 0; i < wkt.size();) {
    std::size_t end = i;
    while (end < wkt.size() && wkt[end] != '(' && wkt[end] != ')' && wkt[end] != ',' &&
           wkt[end] != ' ')
      ++end;
    if (end == i) {
      if (wkt[i] != ' ') column = 0;
      result += wkt[i++];
      continue;
    }
    double value = 0;
    const auto [stop, code] = std::from_chars(wkt.data() + i, wkt.data() + end, value);
    const bool number = code == std::errc() && stop == wkt.data() + end;
    if (number && std::isfinite(value) && column < 2)
      result += fmt::format("{}", value + (column == 0 ? by.x : by.y));
    else
      result += wkt.substr(i, end - i);
    if (number) ++column;
    i = end;
  }
  return result;
}

void write_features(const fs::path& path, const std::vector<Feature>& features, Point2 origin) {
  std::ofstream file(path);
  file << "id,WKT\n";
  for (const Feature& feature : features)
    file << feature.id << ",\"" << moved_wkt(feature.wkt, origin) << "\"\n";
}

const Building* Outcome::building_of(const std::string& source_id) const {
  for (const Building& building : city.buildings)
    for (const std::string& id : building.source_ids)
      if (id == source_id) return &building;
  return nullptr;
}

std::string Outcome::reason_of(const std::string& source_id) const {
  for (const Dropped& dropped : city.dropped)
    if (dropped.source_id == source_id) return dropped.reason;
  return {};
}

bool Outcome::has_warning(const std::string& code) const {
  return std::any_of(report.warnings.begin(), report.warnings.end(),
                     [&](const Warning& warning) { return warning.code == code; });
}

Config small_config(const DefectCity& city, const fs::path& folder) {
  Config config;
  config.footprints = {(folder / "footprints.csv").string()};
  config.points = {(folder / "points.las").string()};
  config.out = (folder / "out").string();
  config.id_attribute = "id";
  config.bounds = {city.domain.xmin + city.origin.x, city.domain.ymin + city.origin.y,
                   city.domain.xmax + city.origin.x, city.domain.ymax + city.origin.y};
  config.mesh_size = 15;
  config.measured_ground = MeasuredGround::kKeep;  // the scan knows sound buildings only
  config.domain_height = 40;
  return config;
}

void write_input(const DefectCity& city, const std::vector<Feature>& features,
                 const fs::path& folder) {
  if (!fs::exists(folder / "points.las")) {
    WritePointsOptions options;
    options.crs = "EPSG:3006";
    write_points(folder / "points.las", scan(city), city.origin, options);
  }
  write_features(folder / "footprints.csv", features, city.origin);
}

Outcome build(const Config& config, const std::vector<std::string>& ids) {
  Outcome outcome;
  try {
    outcome.report = run_build(config);
  } catch (const Error& error) {
    outcome.error = error.what();
    outcome.exit_code = static_cast<int>(error.kind());
    EXPECT_EQ(outcome.error.find_first_of("\r\n"), std::string::npos) << outcome.error;
    EXPECT_FALSE(fs::exists(config.out)) << outcome.error;
    return outcome;
  }
  outcome.raw = read_city(fs::path(config.out) / "city_raw.city.json");
  outcome.city = read_city(fs::path(config.out) / "city.city.json");
  expect_sound(config, outcome, ids);
  return outcome;
}

void expect_sound(const Config& config, const Outcome& outcome,
                  const std::vector<std::string>& ids) {
  expect_guarantees(config.out);
  EXPECT_EQ(outcome.report.volume_mesh->inverted, 0);
  EXPECT_GT(outcome.report.volume_mesh->cells, 0);
  EXPECT_TRUE(outcome.report.surface_mesh->closed && outcome.report.surface_mesh->manifold);
  if (!outcome.city.buildings.empty()) {
    EXPECT_GE(outcome.report.city->min_clearance, config.min_building_distance);
  }
  for (const Building& building : outcome.city.buildings)
    EXPECT_GE(building.h_roof, building.h_ground + config.min_building_height) << building.id;
  std::multiset<std::string> accounted;
  for (const Building& building : outcome.city.buildings)
    accounted.insert(building.source_ids.begin(), building.source_ids.end());
  for (const Dropped& dropped : outcome.city.dropped) {
    accounted.insert(dropped.source_id);
    EXPECT_FALSE(dropped.reason.empty()) << dropped.source_id;
  }
  EXPECT_EQ(accounted, std::multiset<std::string>(ids.begin(), ids.end()));
}

namespace {

double one_way_distance(const Polygon& a, const Polygon& b) {
  double greatest = 0;
  for_each_edge(
      a, [&](Point2 p, Point2) { greatest = std::max(greatest, distance_to_boundary(b, p)); });
  return greatest;
}

}  // namespace

double outline_distance(const Polygon& a, const Polygon& b) {
  if (a.holes.size() != b.holes.size()) return std::numeric_limits<double>::infinity();
  return std::max(one_way_distance(a, b), one_way_distance(b, a));
}

}  // namespace tetropolis::testing
