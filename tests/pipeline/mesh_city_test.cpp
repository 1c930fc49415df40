// What mesh_city refuses before it meshes.
#include "tetropolis/pipeline/mesh_city.h"

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/pipeline/build_city.h"

#include "support/errors.h"
#include "support/small_city.h"

namespace tetropolis {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

testing::SmallCity level_city() {
  return testing::small_city([](double, double) { return 3.0; });
}

using EditOptions = std::function<void(MeshCityOptions&)>;

TEST(MeshCity, RefusesOptionsOutOfRange) {
  const testing::SmallCity small = level_city();
  const CityModel city = testing::city_model(small);
  const auto region = [](double size) {
    return EditOptions([size](MeshCityOptions& options) {
      options.grading.regions = {{rectangle({1010, 2010, 1020, 2020}), size}};
    });
  };
  const std::vector<std::pair<std::string, EditOptions>> edits = {
      {"mesh_size -1: must be positive", [](auto& options) { options.mesh_size = -1; }},
      {"mesh_size 1000000000: must be", [](auto& options) { options.mesh_size = 1e9; }},
      {"mesh_size nan", [](auto& options) { options.mesh_size = kNaN; }},
      {"refine: size 0", region(0)},
      {"refine: size -2", region(-2)},
      {"refine: size nan", region(kNaN)},
      {"size_growth 1", [](auto& options) { options.grading = {.far_size = 20, .growth = 1}; }},
      {"far_size 5", [](auto& options) { options.grading.far_size = 5; }},
      {"min_building_distance 0", [](auto& options) { options.surface_clearance = 0; }},
      {"target_cells -5: must be 0 or more", [](auto& options) { options.target_cells = -5; }},
      {"min_angle 40: must be 0 to 33", [](auto& options) { options.min_angle_deg = 40; }},
      {"domain_height 0: must be above 0", [](auto& options) { options.domain_height = 0; }},
      {"domain_height nan", [](auto& options) { options.domain_height = kNaN; }},
      {"domain_height inf",
       [](auto& options) { options.domain_height = std::numeric_limits<double>::infinity(); }},
      {"layer_height -1", [](auto& options) { options.layer_height = -1; }},
      {"boundary_layers -3", [](auto& options) { options.boundary_layers.count = -3; }},
      {"first_layer -1",
       [](auto& options) {
         options.boundary_layers = {3, -1, 1.2};
       }},
      {"layer_growth 0.5",
       [](auto& options) {
         options.boundary_layers = {3, 0.5, 0.5};
       }},
      {"min_wall_height -1", [](auto& options) { options.min_wall_height = -1; }},
      {"cut_slope nan", [](auto& options) { options.cut_slope_deg = kNaN; }},
      {"cut_slope 91", [](auto& options) { options.cut_slope_deg = 91; }},
      {"min_gap_share 1", [](auto& options) { options.min_gap_share = 1; }},
      {"solver_tolerance 0", [](auto& options) { options.solver_tolerance = 0; }},
      {"solver_iterations 0", [](auto& options) { options.solver_iterations = 0; }},
      {"max_memory nan", [](auto& options) { options.max_bytes = kNaN; }},
      {"max_memory -1", [](auto& options) { options.max_bytes = -1; }}};
  for (const auto& [words, edit] : edits) {
    MeshCityOptions options;
    edit(options);
    const std::string message = testing::error_of(
        [&, &options = options] { mesh_city(city, small.dtm, options); }, ErrorKind::kUsage);
    EXPECT_TRUE(message.starts_with(words)) << words << " | " << message;
  }
}

/// What stays as it is, in metres, counts: the second run has the mesh size of the refusal.
TEST(MeshCity, TheMeshSizeThatARefusalNamesFits) {
  testing::SmallCity small = level_city();
  small.domain = {0, 0, 500, 500};
  small.dtm = testing::raster_of(small.domain, [](double, double) { return 3.0; });
  const CityModel city = testing::city_model(small);
  const SizeRegion region{rectangle({1200, 2200, 1400, 2400}), 4};
  struct Case {
    SizeGrading grading;
    double megabytes;
    std::string advice;  ///< Empty: a mesh size.
  };
  const std::vector<Case> cases = {
      {{.far_size = 8}, 125, ""},
      {{.far_size = 5}, 92, "raise max_memory, layer_height or far_size, or"},
      {{.far_size = 40, .ground_size = 3}, 115, ""},
      {{.regions = {region}}, 150, ""},
      {{.regions = {region}}, 92, "raise max_memory, layer_height or the sizes of `refine`, or"}};
  for (const Case& given : cases) {
    MeshCityOptions options;
    options.mesh_size = 1;
    options.grading = given.grading;
    options.max_bytes = 1e6 * given.megabytes;
    const auto mesh = [&] { mesh_city(city, small.dtm, options); };
    const std::string refused = testing::error_of(mesh, ErrorKind::kUsage);
    const std::string advice = given.advice.empty() ? "with mesh_size " : given.advice;
    const std::size_t at = refused.find(advice);
    ASSERT_NE(at, std::string::npos) << advice << " | " << refused;
    if (!given.advice.empty()) continue;
    options.mesh_size = std::stod(refused.substr(at + advice.size()));
    EXPECT_EQ(testing::error_of(mesh), "") << refused;
  }
}

TEST(MeshCity, TellsWhereTheMeshSizeOfALayerHeightComesFrom) {
  const testing::SmallCity small = level_city();
  MeshCityOptions options;
  options.layering = Layering::kUniform;
  options.layer_height = 2;
  const auto layer_height_of = [&] {
    const CityMesh mesh = mesh_city(testing::city_model(small), small.dtm, options);
    for (const Warning& warning : mesh.warnings)
      if (const auto at = warning.message.find("layer_height"); at != std::string::npos)
        return std::pair(warning.message.substr(at), mesh.ground_facts.size_scale);
    return std::pair(std::string{}, 0.0);
  };
  const auto [given, one] = layer_height_of();
  EXPECT_EQ(given, "layer_height 2 is far from mesh_size 10; layer_height = 0 follows it");
  options.target_cells = 60000;
  const auto [sought, scale] = layer_height_of();
  EXPECT_GT(std::abs(scale - 1), 0.1);
  EXPECT_EQ(sought,
            fmt::format("layer_height 2 is far from mesh_size {:.3g} (10, which target_cells "
                        "multiplied by {:.3g}); layer_height = 0 follows it",
                        10 * scale, scale));
}

using EditRaster = std::function<void(Raster&)>;

TEST(MeshCity, RefusesTerrainsThatAreNone) {
  const testing::SmallCity small = level_city();
  const CityModel city = testing::city_model(small);
  const std::vector<std::pair<std::string, EditRaster>> edits = {
      {"terrain: 0 values for 0 x 0 nodes", [](Raster& raster) { raster = {}; }},
      {"terrain: 50 values for 121 x 91 nodes", [](Raster& raster) { raster.values.resize(50); }},
      {"terrain: 1 values for -1 x -1 nodes",
       [](Raster& raster) { raster = {-1, -1, 0, 0, 1, {3}}; }},
      {"terrain: nodes every 0 m", [](Raster& raster) { raster.step = 0; }},
      {"terrain: nodes every nan m", [](Raster& raster) { raster.step = kNaN; }},
      {"terrain: nodes every 1 m from (nan, 0)", [](Raster& raster) { raster.x0 = kNaN; }},
      {"terrain: nan is not an elevation (node 5, 4)",
       [](Raster& raster) { raster.values[4 * 121 + 5] = kNaN; }},
      {"terrain: -9999 is not an elevation", [](Raster& raster) { raster.values[0] = -9999; }}};
  for (const auto& [words, edit] : edits) {
    Raster raster = small.dtm;
    edit(raster);
    const auto mesh = [&, &raster = raster] { mesh_city(city, raster); };
    const std::string message = testing::error_of(mesh, ErrorKind::kInput);
    EXPECT_TRUE(message.starts_with(words)) << words << " | " << message;
    CitySources sources;
    sources.terrain = TerrainInput{.source = "terrain", .raster = raster, .origin = {}, .crs = {}};
    const auto build = [&, &sources = sources] { build_city(std::move(sources)); };
    EXPECT_EQ(testing::error_of(build, ErrorKind::kInput), message);
  }
}

TEST(MeshCity, RefusesTerrainsThatAreNotUnderTheDomain) {
  const testing::SmallCity small = level_city();
  const CityModel city = testing::city_model(small);
  Raster in_crs = small.dtm;
  in_crs.x0 += city.origin.x;
  in_crs.y0 += city.origin.y;
  const std::string message =
      testing::error_of([&] { mesh_city(city, in_crs); }, ErrorKind::kInput);
  EXPECT_EQ(message,
            "terrain: x 2000.0 .. 2120.0, y 4000.0 .. 4090.0, does not cover the domain, which is "
            "x 1000.0 .. 1120.0, y 2000.0 .. 2090.0; give smaller `bounds` or another terrain");
  Raster short_of = small.dtm;
  short_of.x0 += 0.9;  // a fringe of a step is none
  EXPECT_EQ(testing::error_of([&] { mesh_city(city, short_of); }), "");
  const Raster level = {1, 1, 5e5, 5e5, 1, {3}};
  EXPECT_EQ(testing::error_of([&] { mesh_city(city, level); }), "");
}

}  // namespace
}  // namespace tetropolis
