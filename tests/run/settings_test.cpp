// Every setting has an effect: each one is changed alone, and a stated result moves as it must.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <ostream>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tetropolis/check/check_results.h"
#include "tetropolis/city/city_model.h"
#include "tetropolis/core/error.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/io/mesh/vtk.h"
#include "tetropolis/io/raster/geotiff.h"
#include "tetropolis/run/config.h"
#include "tetropolis/run/run.h"
#include "tetropolis/terrain/raster.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/tet_mesh.h"

#include "support/bytes.h"
#include "support/test_data.h"
#include "village.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;

using testing::Village;

/// What one run came to.
struct Result {
  Report report;
  std::string error;  ///< Empty if there are results.
  ErrorKind kind{};
  fs::path out;

  CityModel raw() const { return read_city(out / "city_raw.city.json"); }
  Raster dtm() const { return read_raster(out / "dtm.tif", report.origin).raster; }
  const VolumeMeshFacts& volume() const { return report.volume_mesh.value(); }
  const CityFacts& city() const { return report.city.value(); }
  /// The building of step 1 made of this feature alone.
  Building building(const std::string& id) const {
    for (const Building& building : raw().buildings)
      if (building.source_ids == std::vector{id}) return building;
    throw std::runtime_error("no building " + id);
  }
  int iterations() const {
    int sum = 0;
    for (const SolverFacts& step : report.solver) sum += step.iterations;
    return sum;
  }
  std::int64_t unknowns() const {
    std::int64_t sum = 0;
    for (const SolverFacts& step : report.solver) sum += step.unknowns;
    return sum;
  }
};

using Run = Report (*)(const Config&, const RunHooks&);

struct Setting {
  std::string_view name;
  std::vector<std::string> value;  ///< Instead of the default.
  Run run;
  void (*expect)(const Result& plain, const Result& changed);
  /// What both runs have in common beside the village.
  void (*given)(Village&, Config&) = [](Village&, Config&) {};
};

/// For messages of GoogleTest, which prints bytes otherwise.
void PrintTo(const Setting& setting, std::ostream* out) { *out << setting.name; }

void two_layers(Village&, Config& config) { config.boundary_layers = 2; }

void uniform(Village&, Config& config) { config.layering = Layering::kUniform; }

void steep_shed(Village& village, Config&) {
  // From its lower wall to its upper one the ground rises above the shed's roof.
  for (std::size_t p = 0; p < village.cloud.size(); ++p) {
    const double x = village.cloud.x[p];
    if (village.cloud.classification[p] == kGround) village.raise(p, std::max(0.0, x - 62));
  }
}

/// The shed stands at the foot of a cliff that is higher than it.
void buried_shed(Village& village, Config& config) {
  for (std::size_t p = 0; p < village.cloud.size(); ++p) {
    const double x = village.cloud.x[p];
    if (village.cloud.classification[p] == kGround && x > 66) village.raise(p, 15);
  }
  config.mesh_size = 5;
}

/// A hall and a dam that are no footprints, in a cloud without classes.
void unclassified(Village& village, Config& config) {
  for (std::size_t p = 0; p < village.cloud.size(); ++p) {
    const double x = village.cloud.x[p], y = village.cloud.y[p];
    village.cloud.classification[p] = kUnclassified;
    if (x < 90 || x > 120) continue;
    if (y > 8 && y < 38) village.raise(p, 6);
    village.raise(p, std::max(0.0, 2.5 * (1 - std::abs(y - 60) / 8)));
  }
  config.domain_margin = 60;
}

double rise_at(const Result& result, Point2 p) {
  return sample(result.dtm(), p) - Village::ground(p.x);
}

/// All of the points, so that local coordinates are those of the village.
void whole(Village& village, Config& config) {
  config.bounds = {village.origin.x, village.origin.y, village.origin.x + Village::kWidth,
                   village.origin.y + Village::kDepth};
}

void unclassified_whole(Village& village, Config& config) {
  unclassified(village, config);
  whole(village, config);
}

/// Footprints in another system, which their file does not name.
void elsewhere(Village& village, Config&) {
  for (Polygon& footprint : village.footprints)
    for (Point2& p : footprint.outer)
      p = reproject(std::array{Point2{p.x + village.origin.x, p.y + village.origin.y}},
                    "EPSG:28992", "EPSG:25831")[0];
  for (Polygon& footprint : village.footprints)
    for (Point2& p : footprint.outer) p = {p.x - village.origin.x, p.y - village.origin.y};
  village.footprints_crs.clear();
}

/// The least height of a wall, from the written boundary.
double least_wall(const Result& result) {
  const SurfaceMesh surface = read_vtp(result.out / "boundary.vtp");
  std::map<std::tuple<BuildingIndex, double, double>, std::pair<double, double>> columns;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (surface.patch[t] != Patch::kWall) continue;
    for (const std::int32_t v : surface.triangles[t]) {
      const auto& [x, y, z] = surface.points[static_cast<std::size_t>(v)];
      auto& [low, high] =
          columns.try_emplace({surface.building[t], x, y}, std::pair(z, z)).first->second;
      low = std::min(low, z);
      high = std::max(high, z);
    }
  }
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [column, ends] : columns) least = std::min(least, ends.second - ends.first);
  return least;
}

std::uintmax_t size_of(const Result& result, const char* name) {
  return fs::file_size(result.out / name);
}

void small_synth(Village&, Config& config) {
  config.buildings = 10;
  config.size = 150;
}

PointsInput points_of(const Result& synth) {
  return read_points(std::array{synth.out / "points.laz"});
}

/// Of the ground.
double relief_of(const Result& synth) {
  const PointCloud cloud = points_of(synth).points;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t p = 0; p < cloud.size(); ++p) {
    if (cloud.classification[p] != kGround) continue;
    low = std::min<double>(low, cloud.z[p]);
    high = std::max<double>(high, cloud.z[p]);
  }
  return high - low;
}

bool says(const Result& result, ErrorKind kind, const char* part) {
  return result.kind == kind && result.error.find(part) != std::string::npos;
}

const std::vector<Setting>& table() {
  using R = const Result&;
  static const std::vector<Setting> settings{
      // Input.
      {"bounds",
       {"85000", "447000", "85090", "447080"},
       run_city,
       [](R plain, R changed) {
         EXPECT_NEAR(plain.report.domain.xmax, 85125, 1);  // footprints and margin
         EXPECT_EQ(changed.report.domain, (Bounds2{85000, 447000, 85090, 447080}));
       }},
      {"points_crs",
       {"EPSG:28992"},
       run_city,
       [](R plain, R changed) {
         EXPECT_EQ(plain.report.crs, "");
         EXPECT_EQ(changed.report.crs, "EPSG:28992");
       },
       [](Village& village, Config&) { village.footprints_crs = village.points_crs = ""; }},
      {"footprints_crs",
       {"EPSG:25831"},
       run_city,
       [](R plain, R changed) {
         EXPECT_TRUE(says(plain, ErrorKind::kInput, "do not overlap")) << plain.error;
         ASSERT_EQ(changed.city().raw_buildings, 7);
         EXPECT_NEAR(area(changed.building("shed").footprint), 36, 0.1);
         EXPECT_EQ(changed.report.crs, "EPSG:28992");
       },
       elsewhere},
      {"id_attribute",
       {"id"},
       run_city,
       [](R plain, R changed) {
         EXPECT_EQ(plain.raw().buildings[2].source_ids, std::vector<std::string>{"2"});
         EXPECT_EQ(changed.raw().buildings[2].source_ids, std::vector<std::string>{"shed"});
       },
       [](Village&, Config& config) { config.id_attribute.clear(); }},
      {"terrain_only",
       {"true"},
       run_city,
       [](R plain, R changed) {
         EXPECT_TRUE(says(plain, ErrorKind::kInput, "terrain_only")) << plain.error;
         EXPECT_EQ(changed.error, "");
       },
       [](Village&, Config& config) {
         config.bounds = {85100, 447010, 85120, 447030};
       }},

      // Output.
      {"formats",
       {"obj"},
       run_build,
       [](R plain, R changed) {
         EXPECT_TRUE(fs::exists(plain.out / "volume.vtu") &&
                     !fs::exists(plain.out / "surface.obj"));
         EXPECT_TRUE(!fs::exists(changed.out / "volume.vtu") &&
                     fs::exists(changed.out / "surface.obj"));
       }},
      {"building_patches",
       {"true"},
       run_build,
       [](R plain, R changed) {
         const auto boundary = [](R result) {
           return testing::bytes_of(result.out / "constant/polyMesh/boundary");
         };
         EXPECT_EQ(boundary(plain).find("    roof_"), std::string::npos);
         for (const Building& building : read_city(changed.out / "city.city.json").buildings) {
           EXPECT_NE(boundary(changed).find("    roof_" + building.id + "\n"), std::string::npos);
           EXPECT_NE(boundary(changed).find("    wall_" + building.id + "\n"), std::string::npos);
         }
         EXPECT_EQ(plain.report.surface_mesh->faces_by_patch,
                   changed.report.surface_mesh->faces_by_patch);
       },
       [](Village&, Config& config) { config.formats = {"openfoam"}; }},
      {"building_zones",
       {"true"},
       run_build,
       [](R plain, R changed) {
         EXPECT_FALSE(fs::exists(plain.out / "constant/polyMesh/cellZones"));
         const std::string zones = testing::bytes_of(changed.out / "constant/polyMesh/cellZones");
         for (const Building& building : read_city(changed.out / "city.city.json").buildings)
           EXPECT_NE(zones.find("\nover_" + building.id + "\n"), std::string::npos);
       },
       [](Village&, Config& config) { config.formats = {"openfoam"}; }},
      {"coordinates",
       {"absolute"},
       run_build,
       [](R plain, R changed) {
         EXPECT_LT(read_vtu(plain.out / "volume.vtu").points[0][0], 200);
         EXPECT_GE(read_vtu(changed.out / "volume.vtu").points[0][0], 85000);
       }},
      {"compression",
       {"zlib"},
       run_build,
       [](R plain, R changed) {
         EXPECT_LT(2 * size_of(changed, "volume.vtu"), size_of(plain, "volume.vtu"));
         EXPECT_LT(size_of(changed, "boundary.vtp"), size_of(plain, "boundary.vtp"));
       }},
      {"no_html",
       {"true"},
       run_build,
       [](R plain, R changed) {
         EXPECT_TRUE(fs::exists(plain.out / "index.html"));
         EXPECT_FALSE(fs::exists(changed.out / "index.html"));
       }},

      // City model.
      {"domain_margin",
       {"5"},
       run_city,
       [](R plain, R changed) {
         EXPECT_NEAR(plain.report.domain.xmax, 85125, 1);  // as far as there are points
         EXPECT_NEAR(changed.report.domain.xmax, 85090, 1);
         EXPECT_NEAR(changed.report.domain.xmin, 85010, 1);
       }},
      {"dtm_step",
       {"4"},
       run_city,
       [](R plain, R changed) {
         EXPECT_EQ(plain.dtm().step, 1);
         EXPECT_EQ(changed.dtm().step, 4);
         EXPECT_LT(10 * changed.dtm().values.size(), plain.dtm().values.size());
       }},
      {"ground_filter",
       {"always"},
       run_city,
       [](R plain, R changed) {
         EXPECT_EQ(plain.report.input->ground_filtered, 0);
         EXPECT_GT(changed.report.input->ground_filtered, 1000);
       }},
      {"ground_filter_window",
       {"5"},
       run_city,
       [](R plain, R changed) {
         // Half of the hall's width is 15 m: too wide for windows of 5 m.
         EXPECT_NEAR(rise_at(plain, {105, 23}), 0, 0.5);  // filled
         EXPECT_NEAR(rise_at(changed, {105, 23}), 6, 0.1);
         EXPECT_GT(changed.report.input->ground_filtered,
                   plain.report.input->ground_filtered + 500);
       },
       unclassified_whole},
      {"ground_filter_slope",
       {"0.6"},
       run_city,
       [](R plain, R changed) {
         // The dam rises by 0.31.
         EXPECT_LT(rise_at(plain, {105, 60}), 1.8);
         EXPECT_GT(rise_at(changed, {105, 60}), 2.2);
       },
       unclassified_whole},
      {"parallel_tolerance",
       {"0.1"},
       run_city,
       [](R plain, R changed) {
         EXPECT_EQ(plain.building("bent").footprint.outer.size(), 5U);
         EXPECT_EQ(changed.building("bent").footprint.outer.size(), 4U);
       }},
      {"ground_margin",
       {"3"},
       run_city,
       [](R plain, R changed) {
         // One square metre and point each: rings of 1 m and 3 m around 6 m x 6 m, less the
         // corners.
         EXPECT_EQ(plain.building("shed").n_ground_points, 24 + 4);
         EXPECT_NEAR(static_cast<double>(changed.building("shed").n_ground_points),
                     3 * 24 + 3.14159 * 9, 4);
         EXPECT_LT(changed.building("shed").h_ground, plain.building("shed").h_ground - 0.04);
       }},
      {"outlier_sigma",
       {"100"},
       run_city,
       [](R plain, R changed) {
         EXPECT_EQ(plain.building("hall").n_roof_points, 300);
         EXPECT_EQ(changed.building("hall").n_roof_points, 302);  // and the masts
       }},
      {"ground_percentile",
       {"90"},
       run_city,
       [](R plain, R changed) {
         // The ground rises by 5 % over some 22 m.
         const double rise = changed.building("hall").h_ground - plain.building("hall").h_ground;
         EXPECT_GT(rise, 0.7);
         EXPECT_LT(rise, 1.1);
       }},
      {"roof_percentile",
       {"50"},
       run_city,
       [](R plain, R changed) {
         // From 20.1 m to 23.9 m.
         EXPECT_NEAR(plain.building("hall").h_roof, 22.8, 0.11);
         EXPECT_NEAR(changed.building("hall").h_roof, 22, 0.11);
       }},
      {"lod",
       {"2.2"},
       run_city,
       [](R plain, R changed) {
         EXPECT_EQ(plain.city().roofs.parts, 0);
         const RoofFacts& roofs = changed.city().roofs;
         EXPECT_GE(roofs.parts, changed.city().buildings);
         EXPECT_GE(roofs.parts_by_lod.at("2.2"), 3);
         EXPECT_GT(roofs.max_slope_deg, 5);  // the hall's
         EXPECT_LT(roofs.rmse_median, 0.2);
       }},
      {"min_building_height",
       {"4"},
       run_city,
       [](R plain, R changed) {
         const Building low = plain.building("shed"), raised = changed.building("shed");
         EXPECT_NEAR(low.h_roof - low.h_ground, 2.5, 1e-9);
         EXPECT_NEAR(raised.h_roof - raised.h_ground, 4, 1e-9);
         EXPECT_NE(raised.flags & kMinimumHeight, 0U);
         EXPECT_EQ(plain.building("bent").h_roof, changed.building("bent").h_roof);
       }},
      {"min_building_distance",
       {"0.5"},
       run_city,
       [](R plain, R changed) {
         EXPECT_EQ(plain.city().buildings, 5);
         EXPECT_EQ(changed.city().buildings, 6);  // hall and annex apart
       }},
      {"close_gaps",
       {"3"},
       run_city,
       [](R plain, R changed) {
         EXPECT_EQ(plain.city().resorts.at("dead_ends_closed"), 0);
         EXPECT_EQ(changed.city().resorts.at("dead_ends_closed"), 1);
         EXPECT_NEAR(changed.city().area_after, plain.city().area_after + 20, 0.1);
       },
       [](Village& village, Config&) {  // a yard of 2 m
         village.footprints[Village::kHall].holes = {{{20, 18}, {20, 28}, {22, 28}, {22, 18}}};
       }},
      {"merge_growths",
       {"1"},
       run_city,
       [](R plain, R changed) {
         // Two reaches less are there to be tried; here the first one does.
         const auto has = [](R result, const char* resort) {
           return result.city().resorts.contains(resort);
         };
         EXPECT_TRUE(has(plain, "merged_by_patch_3"));
         EXPECT_FALSE(has(changed, "merged_by_patch_2"));
         EXPECT_EQ(changed.city().resorts.at("merged_by_patch_1"), 2);
       }},
      {"min_building_area",
       {"50"},
       run_city,
       [](R plain, R changed) {
         EXPECT_TRUE(plain.city().dropped.empty());
         ASSERT_EQ(changed.city().dropped.size(), 1U);
         EXPECT_EQ(changed.city().dropped[0].source_id, "shed");
       }},
      {"boundary_buildings",
       {"clip"},
       run_city,
       [](R plain, R changed) {
         EXPECT_EQ(plain.city().raw_buildings, 1);
         EXPECT_EQ(changed.city().raw_buildings, 2);
         EXPECT_EQ(changed.city().flags.at("clipped"), 1);
       },
       [](Village&, Config& config) {
         config.bounds = {85050, 447002, 85080.5, 447045};
       }},

      {"origin",
       {"84000,446000"},
       run_build,
       [](R plain, R changed) {
         EXPECT_EQ(changed.report.origin, (Point2{84000, 446000}));
         EXPECT_NE(plain.report.origin, changed.report.origin);
         EXPECT_EQ(plain.report.domain, changed.report.domain);
       }},
      {"domain",
       {"auto"},
       run_build,
       [](R plain, R changed) {
         EXPECT_EQ(plain.city().domain.building_height, 0);
         EXPECT_GE(changed.report.domain.width(), 20 * changed.city().domain.building_height);
       }},
      {"wind_from",
       {"0"},
       run_build,
       [](R plain, R changed) {
         EXPECT_EQ(plain.city().domain.inlet, "xmin");
         EXPECT_EQ(changed.city().domain.inlet, "ymax");
       },
       [](Village&, Config& config) { config.domain = "auto"; }},
      {"sectors",
       {"5"},
       run_build,
       [](R plain, R changed) {
         EXPECT_EQ(plain.report.surface_mesh->faces_by_patch.size(), 8U + 36U);
         EXPECT_EQ(changed.report.surface_mesh->faces_by_patch.size(), 8U + 5U);
       },
       [](Village&, Config& config) { config.domain = "cylinder"; }},

      // Mesh.
      {"mesh_size",
       {"5"},
       run_build,
       [](R plain, R changed) {
         EXPECT_GT(changed.report.ground_mesh->triangles,
                   3 * plain.report.ground_mesh->triangles / 2);
       }},
      {"far_size",
       {"40"},
       run_build,
       [](R plain, R changed) {
         EXPECT_LT(5 * changed.report.ground_mesh->triangles,
                   4 * plain.report.ground_mesh->triangles);
       },
       [](Village&, Config& config) { config.mesh_size = 4; }},
      {"ground_size",
       {"4"},
       run_build,
       [](R plain, R changed) {
         EXPECT_GT(changed.report.ground_mesh->triangles, plain.report.ground_mesh->triangles);
       },
       [](Village&, Config& config) {
         config.mesh_size = 4;
         config.far_size = 40;
       }},
      {"size_growth",
       {"1.05"},
       run_build,
       [](R plain, R changed) {
         EXPECT_GT(changed.report.ground_mesh->triangles,
                   5 * plain.report.ground_mesh->triangles / 4);
       },
       [](Village&, Config& config) {
         config.mesh_size = 4;
         config.far_size = 40;
       }},
      {"refine",
       {"85020,447020,85040,447040:1"},
       run_build,
       [](R plain, R changed) {
         // Three triangles per square metre of 400, and what grows around it.
         EXPECT_GT(changed.report.ground_mesh->triangles,
                   800 + plain.report.ground_mesh->triangles);
         EXPECT_LT(changed.report.ground_mesh->triangles,
                   6000 + plain.report.ground_mesh->triangles);
       }},
      {"target_cells",
       {"40000"},
       run_build,
       [](R plain, R changed) {
         EXPECT_LT(plain.report.volume_mesh->cells, 36000);
         EXPECT_NEAR(static_cast<double>(changed.report.volume_mesh->cells), 40000, 1600);
         EXPECT_EQ(plain.report.ground_mesh->size_scale, 1);
         EXPECT_LT(changed.report.ground_mesh->size_scale, 0.95);
       }},
      {"min_angle",
       {"5"},
       run_build,
       [](R plain, R changed) {
         EXPECT_GE(plain.report.ground_mesh->min_angle_deg, 25 - 1e-9);
         EXPECT_LT(changed.report.ground_mesh->min_angle_deg, 25);
         EXPECT_GE(changed.report.ground_mesh->min_angle_deg, 5 - 1e-9);
       }},
      {"domain_height",
       {"70"},
       run_build,
       [](R plain, R changed) {
         EXPECT_NEAR(plain.volume().top - changed.volume().top, 30, 1e-9);
       }},
      {"cells",
       {"prisms"},
       run_build,
       [](R plain, R changed) {
         EXPECT_EQ(plain.volume().prisms.cells, 0);
         EXPECT_EQ(changed.volume().prisms.cells, changed.volume().cells);
         EXPECT_LT(changed.volume().cells, plain.volume().cells);
         EXPECT_TRUE(read_vtu(changed.out / "volume.vtu").cells.empty());
         for (const CheckedFile& file : check_path(changed.out, std::nullopt))
           EXPECT_TRUE(file.violations.empty()) << file.violations[0].what;
       }},
      {"layering",
       {"uniform"},
       run_build,
       [](R plain, R changed) {
         EXPECT_EQ(plain.unknowns(), 0);
         EXPECT_GT(changed.unknowns(), 0);
       }},
      {"layer_height",
       {"20"},
       run_build,
       [](R plain, R changed) {
         EXPECT_EQ(plain.volume().layers, 10);
         EXPECT_EQ(changed.volume().layers, 5);
       },
       uniform},
      {"boundary_layers",
       {"4"},
       run_build,
       [](R plain, R changed) {
         EXPECT_EQ(plain.volume().prisms.cells, 0);
         EXPECT_EQ(plain.report.surface_mesh->quads, 0);
         EXPECT_GT(changed.volume().prisms.cells, 0);
         EXPECT_EQ(changed.volume().prisms.cells % 4, 0);
         EXPECT_GT(changed.report.surface_mesh->quads, 0);
         EXPECT_NEAR(changed.volume().volume / plain.volume().volume, 1, 1e-2);
         EXPECT_EQ(std::ssize(read_vtu(changed.out / "volume.vtu").wedges),
                   changed.volume().prisms.cells);
         for (const CheckedFile& file : check_path(changed.out, std::nullopt))
           EXPECT_TRUE(file.violations.empty()) << file.violations[0].what;
       }},
      {"first_layer",
       {"0.25"},
       run_build,
       [](R plain, R changed) {
         EXPECT_LE(plain.volume().prisms.least_height, 0.5);
         EXPECT_GT(plain.volume().prisms.least_height, changed.volume().prisms.least_height);
         EXPECT_GT(changed.volume().prisms.share_as_asked, 0.9);
         EXPECT_NEAR(changed.volume().prisms.volume / plain.volume().prisms.volume, 0.5, 0.1);
       },
       two_layers},
      {"layer_growth",
       {"1"},
       run_build,
       [](R plain, R changed) {
         EXPECT_NEAR(plain.volume().prisms.volume / changed.volume().prisms.volume, 1.1, 0.02);
       },
       two_layers},
      {"top",
       {"free"},
       run_build,
       [](R plain, R changed) {
         const auto rise = [](R result) {
           const SurfaceMesh surface = read_vtp(result.out / "boundary.vtp");
           double low = std::numeric_limits<double>::infinity(), high = -low;
           for (std::size_t t = 0; t < surface.triangles.size(); ++t)
             for (const std::int32_t v : surface.triangles[t]) {
               if (surface.patch[t] != Patch::kTop) continue;
               low = std::min(low, surface.points[static_cast<std::size_t>(v)][2]);
               high = std::max(high, surface.points[static_cast<std::size_t>(v)][2]);
             }
           return high - low;
         };
         EXPECT_EQ(rise(plain), 0);
         EXPECT_GT(rise(changed), 0.1);
       }},
      {"min_wall_height",
       {"2"},
       run_build,
       [](R plain, R changed) {
         EXPECT_NEAR(least_wall(plain), 1, 1e-6);
         EXPECT_NEAR(least_wall(changed), 2, 1e-6);
       },
       [](Village& village, Config& config) {
         steep_shed(village, config);
         uniform(village, config);
       }},
      {"cut_slope",
       {"90"},
       run_build,
       [](R plain, R changed) {
         EXPECT_EQ(plain.volume().roofs_cut_back.size(), 2U);
         EXPECT_TRUE(changed.volume().roofs_cut_back.empty());
         EXPECT_GT(plain.volume().ground_lowered, changed.volume().ground_lowered);
         EXPECT_GT(plain.volume().dihedral_min, 8);
         EXPECT_LT(changed.volume().dihedral_min, 8);
         const auto warns = [](const Report& report) {
           return std::any_of(report.warnings.begin(), report.warnings.end(), [](const Warning& w) {
             return w.code == "below_quality_floor" && w.count > 0;
           });
         };
         EXPECT_FALSE(warns(plain.report));
         EXPECT_TRUE(warns(changed.report));
         // Nor does check need the report to find such ground sound.
         fs::remove(plain.out / "report.json");
         for (const CheckedFile& file : check_path(plain.out, std::nullopt))
           EXPECT_TRUE(file.violations.empty()) << file.violations[0].what;
       },
       buried_shed},
      {"min_gap_share",
       {"0.9"},
       run_build,
       [](R plain, R changed) {
         EXPECT_GT(changed.volume().moved_by_guard, plain.volume().moved_by_guard);
         EXPECT_GT(changed.volume().min_vertical_gap, plain.volume().min_vertical_gap);
       },
       [](Village& village, Config& config) {
         uniform(village, config);
         config.min_building_height = 35;  // several layers at every wall
       }},
      {"solver_tolerance",
       {"1e-6"},
       run_build,
       [](R plain, R changed) {
         for (const SolverFacts& step : plain.report.solver)
           EXPECT_LE(step.relative_residual, 1e-3);
         for (const SolverFacts& step : changed.report.solver)
           EXPECT_LE(step.relative_residual, 1e-6);
         EXPECT_GT(changed.iterations(), plain.iterations());
       },
       uniform},
      {"solver_iterations",
       {"1"},
       run_build,
       [](R plain, R changed) {
         EXPECT_GT(plain.iterations(), 2);
         for (const SolverFacts& step : changed.report.solver) {
           EXPECT_LE(step.iterations, 1) << step.step;
           EXPECT_FALSE(step.converged) << step.step;
         }
       },
       uniform},

      // Synthetic city.
      {"kind",
       {"adversarial"},
       run_synth,
       [](R plain, R changed) {
         EXPECT_FALSE(fs::exists(plain.out / "manifest.json"));
         EXPECT_TRUE(fs::exists(changed.out / "manifest.json"));
       },
       small_synth},
      {"buildings",
       {"7"},
       run_synth,
       [](R plain, R changed) {
         EXPECT_EQ(plain.report.input->footprints_read, 10);
         EXPECT_EQ(changed.report.input->footprints_read, 7);
       },
       small_synth},
      {"size",
       {"200"},
       run_synth,
       [](R plain, R changed) {
         EXPECT_NEAR(points_of(plain).extent.width(), 150, 2);
         EXPECT_NEAR(points_of(changed).extent.width(), 200, 2);
       },
       small_synth},
      {"seed",
       {"2"},
       run_synth,
       [](R plain, R changed) {
         EXPECT_NE(testing::bytes_of(plain.out / "footprints.shp"),
                   testing::bytes_of(changed.out / "footprints.shp"));
       },
       small_synth},
      {"point_density",
       {"4"},
       run_synth,
       [](R plain, R changed) {
         EXPECT_NEAR(static_cast<double>(changed.report.input->points_read) /
                         static_cast<double>(plain.report.input->points_read),
                     2, 0.1);
       },
       small_synth},
      {"relief",
       {"40"},
       run_synth,
       [](R plain, R changed) {
         EXPECT_LT(relief_of(plain), 1);
         EXPECT_GT(relief_of(changed), 10);
       },
       [](Village& village, Config& config) {
         small_synth(village, config);
         config.relief = 0;
       }},
      {"roofs",
       {"sloped"},
       run_synth,
       [](R plain, R changed) {
         EXPECT_FALSE(fs::exists(plain.out / "truth.city.json"));
         EXPECT_TRUE(fs::exists(changed.out / "truth.city.json"));
         EXPECT_EQ(testing::bytes_of(plain.out / "footprints.shp"),
                   testing::bytes_of(changed.out / "footprints.shp"));
       },
       [](Village&, Config& config) {
         config.kind = SynthKind::kBlocks;
         config.size = 300;
         config.point_density = 0.5;
       }},
      {"defects",
       {"bow_tie"},
       run_synth,
       [](R plain, R changed) {
         const auto defects = [](R result) {
           return nlohmann::json::parse(testing::bytes_of(result.out / "manifest.json"))["defects"];
         };
         EXPECT_GT(defects(plain).size(), 1U);
         EXPECT_EQ(defects(changed).size(), 1U);
       },
       [](Village& village, Config& config) {
         small_synth(village, config);
         config.kind = SynthKind::kAdversarial;
       }},

      // Run.
      {"max_memory",
       {"1M"},
       run_city,
       [](R plain, R changed) {
         EXPECT_EQ(plain.error, "");
         EXPECT_TRUE(says(changed, ErrorKind::kUsage, "max_memory")) << changed.error;
       }},
      {"threads",
       {"1"},
       run_city,
       [](R plain, R changed) {
         EXPECT_EQ(plain.report.threads, 2);
         EXPECT_EQ(changed.report.threads, 1);
       },
       [](Village&, Config& config) { config.threads = 2; }},
  };
  return settings;
}

/// Settings that are seen to have their effect by other tests.
const std::map<std::string_view, std::string_view>& elsewhere_tested() {
  static const std::map<std::string_view, std::string_view> names{
      {"footprints", "every run reads them; names of missing files: cli_test"},
      {"points", "every run reads them; names of missing files: cli_test"},
      {"city", "Build.CityAndMeshInTwoStepsGiveTheSameMesh"},
      {"dtm", "Build.CityAndMeshInTwoStepsGiveTheSameMesh"},
      {"layer", "robustness: file_defects_test"},
      {"dsm", "sources_test: 16-no-point-cloud"},
      {"planned", "sources_test: planned"},
      {"ground_level", "sources_test: settings"},
      {"raster_crs", "sources_test: settings"},
      {"require_grids", "sources_test: 03-osgb-datum-shift"},
      {"where", "sources_test: settings"},
      {"height_attribute", "sources_test: 15-us-feet"},
      {"height_unit", "sources_test: 15-us-feet"},
      {"floors_attribute", "sources_test: settings"},
      {"floor_height", "sources_test: settings"},
      {"default_height", "sources_test: settings"},
      {"measured_ground", "sources_test: settings"},
      {"surface_layers", "case_test: surfaces"},
      {"canopies", "case_test: canopies"},
      {"leaf_area_density", "case_test: canopies"},
      {"out", "every test looks there for results"},
      {"overwrite", "OutputFolder.ReplacesNobodysFiles; of the program: cli_test"},
      {"quiet", "of the program, not of the library: cli_test"},
      {"verbose", "of the program, not of the library: cli_test"},
      {"log", "of the program, not of the library: cli_test"},
  };
  return names;
}

const ConfigField& field_named(std::string_view name) {
  for (const ConfigField& field : config_fields())
    if (field.name == name) return field;
  throw std::runtime_error("no setting " + std::string(name));
}

class Settings : public ::testing::TestWithParam<Setting> {};

Result run(const Setting& setting, const Config& config) {
  Result result;
  result.out = config.out;
  try {
    result.report = setting.run(config, {});
  } catch (const Error& error) {
    result.error = error.what();
    result.kind = error.kind();
  }
  return result;
}

TEST_P(Settings, HasItsEffect) {
  const Setting& setting = GetParam();
  const testing::TemporaryFolder scratch;
  Village village;
  Config config;
  config.id_attribute = "id";
  config.lod = Lod::kBlock;
  setting.given(village, config);
  village.write(scratch.path(), config);
  const Config plain = config;
  set_field(config, field_named(setting.name), setting.value, "the test");
  config.out = (scratch / "changed").string();
  // Nothing else may explain the difference.
  for (const ConfigField& field : config_fields())
    EXPECT_EQ(value_text(field, plain) != value_text(field, config),
              field.name == setting.name || field.name == "out")
        << field.name;
  setting.expect(run(setting, plain), run(setting, config));
}

INSTANTIATE_TEST_SUITE_P(Each, Settings, ::testing::ValuesIn(table()),
                         [](const auto& each) { return std::string(each.param.name); });

TEST(SettingsTable, LeavesNoSettingOut) {
  std::multiset<std::string_view> tested;
  for (const Setting& setting : table()) tested.insert(setting.name);
  for (const auto& [name, reason] : elsewhere_tested()) tested.insert(name);
  std::multiset<std::string_view> all;
  for (const ConfigField& field : config_fields()) all.insert(field.name);
  EXPECT_EQ(tested, all);
}

}  // namespace
}  // namespace tetropolis
