#include "tetropolis/pipeline/wind_domain.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/pipeline/mesh_city.h"

#include "support/errors.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

constexpr double kRoundings = 1e-3;

double terrain_at(Point2 p) { return 2 + 0.02 * p.x - 0.01 * p.y + 0.5 * std::sin(p.x / 9); }

struct Model {
  CityModel city;
  Raster terrain;
};

void add_building(CityModel& city, const Bounds2& box, double ground, double height) {
  Building& building = city.buildings.emplace_back();
  building.id = "b" + std::to_string(city.buildings.size() - 1);
  building.source_ids = {building.id};
  building.footprint = rectangle(box);
  building.h_ground = ground;
  building.h_roof = ground + height;
}

/// Twelve buildings of 4 to 20 m in three rows, on a slope.
Model small_model() {
  Model model;
  model.city.domain = {0, 0, 150, 120};
  model.city.origin = {85000, 447000};
  const double heights[] = {8, 4, 12.5, 20, 6, 9, 11, 7, 10, 5, 13, 8};
  for (int i = 0; i < 12; ++i) {
    const double x = 20 + 28 * (i % 4), y = 20 + 30 * (i / 4);
    add_building(model.city, {x, y, x + 14 + i % 3, y + 11}, std::round(terrain_at({x, y})),
                 heights[i]);
  }
  model.terrain = {151, 121, 0, 0, 1, {}};
  for (int j = 0; j <= 120; ++j)
    for (int i = 0; i <= 150; ++i)
      model.terrain.values.push_back(terrain_at({double(i), double(j)}));
  return model;
}

WindDomainFacts fit(const WindDomainOptions& options, Model& model) {
  std::vector<Warning> warnings;
  return fit_wind_domain(options, 1, model.city, model.terrain, warnings);
}

/// By looking at each hundredth of a metre.
double shadow(const CityModel& city, Point2 along) {
  std::map<long, double> heights;
  for (const Building& building : city.buildings) {
    double low = 1e9, high = -1e9;
    for (const Point2 p : building.footprint.outer) {
      const double across = p.y * along.x - p.x * along.y;
      low = std::min(low, across);
      high = std::max(high, across);
    }
    for (long k = std::lround(low * 100); k < std::lround(high * 100); ++k)
      heights[k] = std::max(heights[k], building.h_roof - building.h_ground);
  }
  double sum = 0;
  for (const auto& [place, height] : heights) sum += 0.01 * height;
  return sum;
}

/// A building of two parts: a low flat one, and a lean-to roof that rises to the east.
void add_tower(CityModel& city, const Bounds2& box, double ground, double low, double high) {
  add_building(city, box, ground, low);
  Building& building = city.buildings.back();
  const double middle = 0.5 * (box.xmin + box.xmax);
  RoofPart flat, lean_to;
  flat.outline = rectangle({box.xmin, box.ymin, middle, box.ymax});
  flat.roof = {{box.xmin, box.ymin}, ground + low, 0, 0};
  lean_to.outline = rectangle({middle, box.ymin, box.xmax, box.ymax});
  lean_to.roof = {{box.xmax, box.ymin}, ground + high, (high - low) / (box.xmax - middle), 0};
  building.parts = {flat, lean_to};
}

/// By points of the roofs, 0.1 m apart.
double shadow_of_parts(const CityModel& city, Point2 along) {
  std::map<long, double> heights;
  for (const Building& building : city.buildings)
    for (const RoofPart& part : building.parts) {
      const Bounds2 box = bounds(part.outline);
      for (double x = box.xmin; x <= box.xmax + 1e-9; x += 0.1)
        for (double y = box.ymin; y <= box.ymax + 1e-9; y += 0.1) {
          double& height = heights[std::lround((y * along.x - x * along.y) * 4)];
          height = std::max(height, part.roof({x, y}) - building.h_ground);
        }
    }
  double sum = 0;
  for (const auto& [place, height] : heights) sum += 0.25 * height;
  return sum;
}

std::string name_of_side(const Domain& domain, Patch patch) {
  for (const PatchInfo& info : domain.own_patches())
    if (info.patch == patch) return info.name;
  return PatchTable().of(patch).name;
}

/// Of all buildings from each side, by its name.
std::map<std::string, double> distances(const CityModel& city) {
  std::map<std::string, double> least;
  for (const Domain::Side& side : city.domain.sides()) {
    const double dx = side.to.x - side.from.x, dy = side.to.y - side.from.y;
    double& distance = least.try_emplace(name_of_side(city.domain, side.patch), 1e9).first->second;
    for (const Building& building : city.buildings)
      for (const Point2 p : building.footprint.outer)
        distance = std::min(
            distance, (dx * (p.y - side.from.y) - dy * (p.x - side.from.x)) / std::hypot(dx, dy));
  }
  return least;
}

TEST(WindDomain, FrontalAreaIsThatOfAllShadows) {
  std::mt19937 random(testing::test_seed());
  const auto number = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) * 0x1p-32;
  };
  for (int i = 0; i < 40; ++i) {
    CityModel city;
    double heights = 0;
    for (int b = 0; b < 8; ++b) {
      const double x = number(0, 200), y = number(0, 200);
      add_building(city, {x, y, x + number(5, 30), y + number(5, 30)}, 0, number(3, 30));
      heights += city.buildings[BuildingIndex(b)].h_roof;
    }
    const double angle = number(0, 6.3);
    const Point2 along{std::cos(angle), std::sin(angle)};
    const double expected = shadow(city, along), found = frontal_area(city, along);
    EXPECT_GE(found, expected - 0.2 * heights) << "seed " << testing::test_seed();
    EXPECT_LE(found, expected + heights) << "seed " << testing::test_seed();
  }
}

TEST(WindDomain, FrontalAreaIsThatOfTheRoofs) {
  for (const double wind_from : {270.0, 0.0, 180.0, 300.0, 211.0}) {
    CityModel city;
    add_tower(city, {10, 10, 30, 40}, 3, 6, 24);
    add_tower(city, {60, 15, 80, 70}, 1, 10, 14);
    const double angle = wind_from * std::numbers::pi / 180;
    const Point2 along{-std::sin(angle), -std::cos(angle)};
    const double expected = shadow_of_parts(city, along);
    EXPECT_NEAR(frontal_area(city, along), expected, 0.5 * (24 + 14 + 14)) << wind_from;
    for (Building& building : city.buildings) building.parts.clear();
    EXPECT_LT(frontal_area(city, along), 0.9 * expected) << wind_from;
  }
}

TEST(WindDomain, TallestIsWhoseRoofIsHighest) {
  Model model = small_model();  // the tallest block: 20 m on 2 m
  add_tower(model.city, {130, 60, 140, 91}, 4, 8, 30);
  const WindDomainFacts facts = fit({DomainShape::kBox}, model);
  EXPECT_EQ(facts.tallest, "b12");
  EXPECT_NEAR(facts.building_height, 30, 1e-9);
  EXPECT_EQ(model.city.domain_top, 4 + 30 + 5 * 30);
  const std::map<std::string, double> from = distances(model.city);
  EXPECT_NEAR(from.at("xmin"), 5 * 30, kRoundings);
  EXPECT_NEAR(from.at("xmax"), 15 * 30, kRoundings);
}

TEST(WindDomain, BoxKeepsTheDistancesForAnyWind) {
  for (const double wind_from : {270.0, 0.0, 90.0, 180.0, 240.0, 33.0, 359.5}) {
    Model model = small_model();
    const WindDomainFacts facts = fit({DomainShape::kBox, wind_from}, model);
    EXPECT_EQ(facts.building_height, 20);
    EXPECT_EQ(facts.tallest, "b3");
    const bool is_turned = std::fmod(wind_from, 90) != 0;
    EXPECT_EQ(model.city.domain.is_box(), !is_turned) << wind_from;
    const std::map<std::string, double> from = distances(model.city);
    static const std::map<double, std::string> inlets{
        {270, "xmin"}, {0, "ymax"}, {90, "xmax"}, {180, "ymin"}};
    static const std::map<std::string, std::string> opposite{{"xmin", "xmax"},
                                                             {"xmax", "xmin"},
                                                             {"ymin", "ymax"},
                                                             {"ymax", "ymin"},
                                                             {"inlet", "outlet"}};
    EXPECT_EQ(facts.inlet, is_turned ? "inlet" : inlets.at(wind_from));
    EXPECT_NEAR(from.at(facts.inlet), 5 * 20, kRoundings) << wind_from;
    EXPECT_NEAR(from.at(opposite.at(facts.inlet)), 15 * 20, kRoundings) << wind_from;
    for (const auto& [side, distance] : from) EXPECT_GE(distance, 100 - kRoundings) << side;
    // The wind blows in where it comes from.
    const double bearing = wind_from * std::numbers::pi / 180;
    for (const Domain::Side& side : model.city.domain.sides()) {
      if (name_of_side(model.city.domain, side.patch) != facts.inlet) continue;
      const double dx = side.to.x - side.from.x, dy = side.to.y - side.from.y;
      EXPECT_NEAR(dy * std::sin(bearing) - dx * std::cos(bearing), std::hypot(dx, dy), kRoundings);
    }
    EXPECT_NEAR(model.city.domain.area(), facts.length * facts.width, 1);
    EXPECT_EQ(model.city.domain_top, 5 * 20 + 22 + std::round(terrain_at({104, 20})) - 2);
  }
}

TEST(WindDomain, BoxIsWidenedUntilLittleIsBlocked) {
  Model model = small_model();
  model.city.buildings[BuildingIndex(3)].h_roof -= 10;
  add_building(model.city, {130, 20, 140, 91}, 4, 15);  // a slab across the wind
  const double frontal = frontal_area(model.city, {1, 0});
  EXPECT_EQ(frontal, 71 * 15);
  const WindDomainFacts facts = fit({DomainShape::kBox}, model);
  EXPECT_EQ(facts.tallest, "b12");
  EXPECT_NEAR(facts.guideline_width, 71 + 150, 1e-9);
  EXPECT_NEAR(facts.guideline_height, 90, 1e-9);
  EXPECT_NEAR(facts.guideline_blockage, frontal / (221 * 90), 1e-12);
  EXPECT_GT(facts.guideline_blockage, 0.03);
  EXPECT_NEAR(facts.blockage, 0.03, 1e-9);
  EXPECT_NEAR(facts.width, frontal / (0.03 * 90), 1e-9);
  // In the middle.
  const std::map<std::string, double> from = distances(model.city);
  EXPECT_NEAR(from.at("ymin"), from.at("ymax"), kRoundings);
  // A single block needs no widening.
  Model one = small_model();
  one.city.buildings.erase(one.city.buildings.begin(), one.city.buildings.end() - 1);
  const WindDomainFacts narrow = fit({DomainShape::kBox}, one);
  EXPECT_EQ(narrow.width, narrow.guideline_width);
  EXPECT_LT(narrow.blockage, 0.03);
}

TEST(WindDomain, CylinderHasASectorForEachWind) {
  for (const int sectors : {4, 36, 7, 72}) {
    Model model = small_model();
    const Bounds2 box{20, 20, 120, 91};
    const WindDomainFacts facts = fit({DomainShape::kCylinder, 270, sectors}, model);
    EXPECT_NEAR(facts.guideline_radius, 0.5 * std::hypot(box.width(), box.height()) + 300, 1e-9);
    EXPECT_GE(facts.radius, facts.guideline_radius);
    const Point2 centre{70, 55.5};
    const Domain& domain = model.city.domain;
    EXPECT_EQ(domain.own_patches().size(), static_cast<std::size_t>(sectors));
    double perimeter = 0;
    for (const Domain::Side& side : domain.sides()) {
      EXPECT_NEAR(std::hypot(side.from.x - centre.x, side.from.y - centre.y), facts.radius,
                  kRoundings);
      perimeter += std::hypot(side.to.x - side.from.x, side.to.y - side.from.y);
      const Point2 middle{0.5 * (side.from.x + side.to.x) - centre.x,
                          0.5 * (side.from.y + side.to.y) - centre.y};
      const double bearing = std::atan2(middle.x, middle.y) * 180 / std::numbers::pi;
      const double named = std::stod(name_of_side(domain, side.patch).substr(7));
      const double off = std::remainder(bearing - named, 360);
      EXPECT_LE(std::abs(off), 180.0 / sectors + 0.5);
    }
    EXPECT_NEAR(perimeter, 2 * std::numbers::pi * facts.radius, 0.005 * perimeter);
  }
}

TEST(WindDomain, CylinderIsWidenedForEveryWind) {
  // A long row of buildings: seen from the side it blocks most.
  Model model = small_model();
  for (std::size_t i = 0; i < 40; ++i) {
    Building more = model.city.buildings[BuildingIndex(0)];
    for (Point2& p : more.footprint.outer) p.y += 30.0 * static_cast<double>(i);
    more.id = "more" + std::to_string(i);
    model.city.buildings.push_back(more);
  }
  const WindDomainFacts facts = fit({DomainShape::kCylinder, 270, 36}, model);
  EXPECT_GT(facts.radius, facts.guideline_radius);
  double most = 0;
  for (int k = 0; k < 36; ++k) {
    const double angle = k * std::numbers::pi / 18;
    const double share = frontal_area(model.city, {std::sin(angle), std::cos(angle)}) /
                         (2 * facts.radius * facts.guideline_height);
    most = std::max(most, share);
  }
  EXPECT_NEAR(most, 0.03, 1e-4);
  EXPECT_NEAR(facts.blockage, 0.03, 1e-9);
}

TEST(WindDomain, TerrainThatIsKnownStays) {
  // Of a raster that ends 100 m east of the data.
  Raster known{276, 601, -300, -240, 2, {}};
  for (std::int32_t j = 0; j < known.ny; ++j)
    for (std::int32_t i = 0; i < known.nx; ++i)
      known.values.push_back(terrain_at({known.x0 + 2.0 * i, known.y0 + 2.0 * j}));
  for (const bool is_known : {true, false}) {
    Model model = small_model();
    std::vector<Warning> warnings;
    fit_wind_domain({DomainShape::kBox, 270, 36}, 1, model.city, model.terrain, warnings,
                    is_known ? &known : nullptr);
    const Raster& terrain = model.terrain;
    double most = 0, steepest = 0, far = 0;
    for (std::int32_t j = 0; j < terrain.ny; ++j)
      for (std::int32_t i = 0; i < terrain.nx; ++i) {
        const Point2 p{terrain.x0 + i * terrain.step, terrain.y0 + j * terrain.step};
        const double off = std::abs(terrain.at(i, j) - terrain_at(p));
        if (known.bounds().contains(p)) most = std::max(most, off);
        if (!known.bounds().contains(p)) far = std::max(far, p.x);
        if (i > 0) steepest = std::max(steepest, std::abs(terrain.at(i, j) - terrain.at(i - 1, j)));
      }
    EXPECT_GT(far, known.bounds().xmax + 50);
    EXPECT_LT(steepest, 0.5);  // no step where it ends
    if (is_known)
      EXPECT_LT(most, 0.01);
    else
      EXPECT_GT(most, 1);
  }
}

TEST(WindDomain, PolygonKeepsTheBuildingsInIt) {
  Model model = small_model();
  WindDomainOptions options{DomainShape::kGiven};
  const auto give = [&](const Ring& ring) { options.given = {polygon_domain({ring, {}})}; };
  give({{85000, 447000}, {85400, 447000}, {85400, 447010}, {85000, 447070}});
  std::vector<Warning> warnings;
  fit_wind_domain(options, 1, model.city, model.terrain, warnings);
  EXPECT_EQ(model.city.buildings.size(), 5U);
  std::map<std::string, int> reasons;
  for (const Dropped& dropped : model.city.dropped) ++reasons[dropped.reason];
  EXPECT_EQ(reasons, (std::map<std::string, int>{{"crosses the domain boundary", 3},
                                                 {"outside the domain", 4}}));
  EXPECT_TRUE(warnings.front().message.starts_with("7 features are left out, the first, "))
      << warnings.front().message;
  for (const Building& building : model.city.buildings)
    for (const Point2 p : building.footprint.outer) {
      EXPECT_TRUE(contains({{{0, 0}, {400, 0}, {400, 10}, {0, 70}}, {}}, p));
    }
  EXPECT_EQ(model.city.domain.sides()[2].patch, static_cast<Patch>(11));
  EXPECT_EQ(name_of_side(model.city.domain, static_cast<Patch>(11)), "side_3");
  EXPECT_THROW(give({{85000, 447000}, {85100, 447100}, {85100, 447000}, {85000, 447100}}), Error);
  give({{85000, 447000}, {85100, 447000}, {85100, 447070}, {85000, 447070}});
  Model cut = small_model();
  fit_wind_domain(options, 1, cut.city, cut.terrain, warnings);
  EXPECT_EQ(cut.city.buildings.size(), 6U);
  EXPECT_EQ(warnings.back().code, "domain_blockage");
}

TEST(WindDomain, AnotherCityGetsTheSame) {
  for (const WindDomainOptions& options :
       {WindDomainOptions{DomainShape::kBox}, WindDomainOptions{DomainShape::kBox, 240},
        WindDomainOptions{DomainShape::kCylinder}}) {
    Model first = small_model();
    fit(options, first);
    Model second = small_model();
    add_building(second.city, {130, 20, 133, 91}, 4, 40);
    second.city.origin = {84990, 447010};
    WindDomainOptions given{DomainShape::kGiven};
    given.given = {first.city.domain.moved(first.city.origin), first.city.domain_top};
    fit(given, second);
    const auto before = first.city.domain.sides(), after = second.city.domain.sides();
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_EQ(snap_coordinate(Point2{before[i].from.x + 10, before[i].from.y - 10}),
                after[i].from);
      EXPECT_EQ(name_of_side(first.city.domain, before[i].patch),
                name_of_side(second.city.domain, after[i].patch));
    }
    EXPECT_EQ(first.city.domain_top, second.city.domain_top);
    EXPECT_LT(second.city.domain_top, guideline_top(second.city));
  }
}

TEST(WindDomain, PolygonIsBlockedForTheWindThatBlows) {
  for (const double wind_from : {270.0, 0.0, 225.0}) {
    Model model = small_model();
    add_building(model.city, {130, 20, 133, 91}, 4, 18);  // a slab across a wind from the west
    WindDomainOptions options{DomainShape::kGiven, wind_from};
    options.given = {
        polygon_domain({{{84900, 446900}, {85300, 446900}, {85300, 447200}, {84900, 447200}}, {}})};
    const WindDomainFacts facts = fit(options, model);
    const double angle = wind_from * std::numbers::pi / 180;
    const double length = std::abs(400 * std::sin(angle)) + std::abs(300 * std::cos(angle));
    const double width = std::abs(300 * std::sin(angle)) + std::abs(400 * std::cos(angle));
    EXPECT_NEAR(facts.length, length, 1e-6) << wind_from;
    EXPECT_NEAR(facts.width, width, 1e-6) << wind_from;
    const Point2 along{-std::sin(angle), -std::cos(angle)};
    EXPECT_NEAR(facts.blockage, frontal_area(model.city, along) / (width * 6 * 20),
                0.02 * facts.blockage)
        << wind_from;
  }
}

TEST(WindDomain, WithoutBuildings) {
  Model model = small_model();
  model.city.buildings.clear();
  EXPECT_THROW(fit({DomainShape::kBox}, model), Error);
  const Raster before = model.terrain;
  EXPECT_EQ(fit({}, model).length, 0);
  EXPECT_EQ(model.terrain.values, before.values);
}

TEST(WindDomain, TerrainIsKeptAmongTheBuildingsAndLevelAtTheSides) {
  for (const WindDomainOptions& options :
       {WindDomainOptions{DomainShape::kBox}, WindDomainOptions{DomainShape::kBox, 240},
        WindDomainOptions{DomainShape::kCylinder}}) {
    Model model = small_model();
    round_to_single(model.terrain);
    const Raster data = model.terrain;
    const WindDomainFacts facts = fit(options, model);
    const Raster& terrain = model.terrain;
    const Domain& domain = model.city.domain;
    EXPECT_TRUE(terrain.bounds().covers(domain.bounds()));
    double sum = 0, count = 0;
    for (int j = 0; j < data.ny; ++j)
      for (int i = 0; i < data.nx; ++i)
        if (i == 0 || j == 0 || i == data.nx - 1 || j == data.ny - 1) {
          sum += data.at(i, j);
          ++count;
        }
    EXPECT_NEAR(facts.rim_height, sum / count, 1e-9);
    for (const Building& building : model.city.buildings)
      for (const Point2 p : building.footprint.outer)
        EXPECT_EQ(sample(terrain, p), sample(data, p));
    for (const Domain::Side& side : domain.sides())
      for (double t = 0; t <= 1; t += 0.05) {
        const Point2 p{side.from.x + t * (side.to.x - side.from.x),
                       side.from.y + t * (side.to.y - side.from.y)};
        EXPECT_NEAR(sample(terrain, p), facts.rim_height, 0.05) << p.x << ' ' << p.y;
      }
    double steepest = 0;  // no cliff anywhere
    for (int j = 1; j < terrain.ny; ++j)
      for (int i = 1; i < terrain.nx; ++i)
        steepest = std::max({steepest, std::abs(terrain.at(i, j) - terrain.at(i - 1, j)),
                             std::abs(terrain.at(i, j) - terrain.at(i, j - 1))});
    EXPECT_LT(steepest, 0.2);
    EXPECT_NEAR(facts.area_outside_data, 1 - 150 * 120 / domain.area(), 1e-6);
  }
}

TEST(WindDomain, MeshHasItsSidesAsPatches) {
  for (const WindDomainOptions& options :
       {WindDomainOptions{DomainShape::kBox, 240}, WindDomainOptions{DomainShape::kCylinder}}) {
    Model model = small_model();
    const WindDomainFacts facts = fit(options, model);
    MeshCityOptions meshing;
    meshing.mesh_size = 8;
    meshing.grading.far_size = 40;
    meshing.own_top = true;
    const CityMesh mesh = mesh_city(model.city, model.terrain, meshing);
    EXPECT_EQ(mesh.volume_facts.top, model.city.domain_top);
    std::map<std::string, std::int64_t> faces;
    for (const PatchCount& patch : mesh.surface_facts.faces_by_patch)
      faces[patch.name] = patch.faces;
    for (const PatchInfo& info : model.city.domain.own_patches()) EXPECT_GT(faces[info.name], 0);
    for (const char* name : {"xmin", "xmax", "ymin", "ymax"}) EXPECT_EQ(faces[name], 0) << name;
    EXPECT_TRUE(mesh.surface_facts.closed && mesh.surface_facts.manifold);
    EXPECT_GT(mesh.volume_facts.dihedral_min, 8);
    double mean = 0, area_sum = 0;  // the volume is area times height, less buildings
    for (const TriangleIndex t : mesh.volume.ground.triangles.indices()) {
      const auto& v = mesh.volume.ground.triangles[t];
      const Point2 a = mesh.volume.ground.vertices[v[0]], b = mesh.volume.ground.vertices[v[1]],
                   c = mesh.volume.ground.vertices[v[2]];
      const double part = 0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
      area_sum += part;
      for (const VertexIndex w : v)
        mean += part / 3 * mesh.volume.z[mesh.volume.floor_over(t, w).value()];
    }
    EXPECT_NEAR(area_sum, model.city.domain.area(), 1e-6 * area_sum);
    EXPECT_NEAR(mesh.volume_facts.volume, area_sum * model.city.domain_top - mean,
                1e-6 * mesh.volume_facts.volume);
    EXPECT_GT(facts.length, 300);
  }
}

TEST(WindDomain, IsInTheCityModelsFile) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path path = folder / "a.city.json";
  for (const WindDomainOptions& options :
       {WindDomainOptions{DomainShape::kBox}, WindDomainOptions{DomainShape::kBox, 240},
        WindDomainOptions{DomainShape::kCylinder, 270, 7}}) {
    Model model = small_model();
    fit(options, model);
    write_city(path, model.city);
    const CityModel read = read_city(path);
    EXPECT_EQ(read.domain, model.city.domain);
    EXPECT_EQ(read.domain_top, model.city.domain_top);
  }
  // Corners the wrong way round are no domain.
  std::string text;
  std::getline(std::ifstream(path), text, '\0');
  const std::size_t begin = text.find("\"domainSides\":[");
  ASSERT_NE(begin, std::string::npos);
  std::ofstream(path)
      << text.substr(0, begin) << "\"domainSides\":["
      << R"({"from":[0,0],"patch":9,"name":"a"},{"from":[0,9],"patch":9,"name":"a"},)"
      << R"({"from":[9,0],"patch":9,"name":"a"}],"domainTop":50)"
      << text.substr(text.find(",\"dropped\"", begin));
  const std::string message = testing::error_of([&] { read_city(path); });
  EXPECT_NE(message.find("counter-clockwise"), std::string::npos) << message;
}

}  // namespace
}  // namespace tetropolis
