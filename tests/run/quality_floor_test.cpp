// The quality every mesh of an ordinary city has: least dihedral angle at least 8 degrees, below 12
// degrees for at most one cell in ten thousand, greatest at most 160; non-orthogonality below 70
// degrees and skewness below 4 (what OpenFOAM's checkMesh asks for).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/check/check_results.h"
#include "tetropolis/city/city_model.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/io/mesh/vtk.h"
#include "tetropolis/io/raster/geotiff.h"
#include "tetropolis/run/run.h"

#include "block_city.h"
#include "support/sanitized.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;

void expect_good_angles(const VolumeMeshFacts& mesh) {
  EXPECT_GE(mesh.dihedral_min, 8);
  // All but one in 10,000; of fewer, the quantile is the worst.
  if (mesh.cells < 10'000)
    EXPECT_LE(std::count_if(mesh.worst.begin(), mesh.worst.end(),
                            [](const WorstCell& cell) { return cell.min_dihedral_deg < 12; }),
              1);
  else
    EXPECT_GE(mesh.dihedral_p0_01, 12) << mesh.cells;
  EXPECT_LE(mesh.dihedral_max, 160);
  EXPECT_LT(mesh.faces.worst.non_orthogonality_deg, 70);
  EXPECT_EQ(mesh.faces.above_70, 0);
}

void expect_above_the_floor(const Report& report) {
  const VolumeMeshFacts& mesh = *report.volume_mesh;
  EXPECT_EQ(mesh.inverted, 0);
  expect_good_angles(mesh);
  EXPECT_LT(mesh.faces.worst.skewness, 4);
  ASSERT_EQ(mesh.worst.size(), 10U);
  EXPECT_GE(mesh.worst.front().share_of_floor, 8.0 / 12);
  EXPECT_LE(mesh.worst.front().share_of_floor, mesh.worst.back().share_of_floor);
}

/// Meshes the city in `folder`.
Report mesh_at(const fs::path& folder, double size) {
  Config config;
  config.city = folder / "city.city.json";
  config.dtm = {folder / "dtm.tif"};
  config.out = folder / "mesh";
  config.mesh_size = size;
  return run_mesh(config);
}

/// The same at each size.
void expect_good_meshes(const fs::path& folder, const std::vector<double>& sizes) {
  for (const double size : sizes) {
    SCOPED_TRACE(size);
    expect_above_the_floor(mesh_at(folder, size));
  }
}

void make_city(const fs::path& footprints, const std::vector<fs::path>& points,
               const fs::path& out) {
  Config config;
  config.footprints = {footprints};
  for (const fs::path& path : points) config.points.push_back(path);
  config.lod = Lod::kBlock;
  config.out = out;
  run_city(config);
}

TEST(QualityFloor, Delft) {
  TETROPOLIS_REQUIRE_DATA(data, "delft_3dfier");
  const testing::TemporaryFolder folder;
  make_city(data / "footprints.shp", {data / "ahn3_cropped_1.laz", data / "ahn3_cropped_2.laz"},
            folder / "city");
  expect_good_meshes(folder / "city", {10, 5, 2.5});
}

TEST(QualityFloor, AmsterdamSouth) {
  TETROPOLIS_REQUIRE_DATA(data, "amsterdam_south");
  const testing::TemporaryFolder folder;
  make_city(data / "footprints.gpkg", {data / "ahn3"}, folder / "city");
  expect_good_meshes(folder / "city", {10, 5});
}

/// Random with the paper's density of buildings, or blocks as the demonstration.
void expect_good_synthetic(SynthKind kind, double size, std::int64_t buildings) {
  const testing::TemporaryFolder folder;
  Config config;
  config.kind = kind;
  config.size = size;
  config.buildings = buildings;
  config.point_density = 1;
  config.out = folder / "input";
  run_synth(config);
  make_city(folder / "input/footprints.shp", {folder / "input/points.laz"}, folder / "city");
  expect_good_meshes(folder / "city", {10, 5});
}

TEST(QualityFloor, RandomCity) { expect_good_synthetic(SynthKind::kRandom, 900, 400); }

TEST(QualityFloor, Blocks) { expect_good_synthetic(SynthKind::kBlocks, 600, 0); }

/// Huts of three metres in a mesh of thirty.
TEST(QualityFloor, LowWallsInACoarseMesh) {
  const testing::TemporaryFolder folder;
  CityModel city;
  city.domain = {0, 0, 200, 200};
  city.crs = "EPSG:28992";
  for (int i = 0; i < 9; ++i) {
    const double x = 30 + 60 * (i % 3), y = 30 + 60.0 * (i / 3);
    Building hut;
    hut.id = "b" + std::to_string(i);
    hut.source_ids = {std::to_string(i)};
    hut.footprint.outer = {{x, y}, {x + 8, y + 2}, {x + 6, y + 10}, {x - 2, y + 8}};
    hut.h_ground = 10;
    hut.h_roof = 13 + 0.1 * i;
    city.buildings.push_back(hut);
  }
  write_city(folder / "city.city.json", city);
  const Raster dtm{201, 201, 0, 0, 1, std::vector<double>(std::size_t{201} * 201, 10.0)};
  write_raster(folder / "dtm.tif", dtm, {}, "EPSG:28992");
  expect_good_meshes(folder.path(), {30, 20});
}

/// Villages on a slope of 45 degrees and across a rock wall of 20 m, which in the terrain is 1 m
/// wide: beyond what cells of 3 m can follow, so that it is cut back. The surface stays exact
/// elsewhere, which check knows with the report and without.
TEST(QualityFloor, SlopesOf45DegreesAndRockWalls) {
  for (const char* defect : {"slope_45", "quarry_wall"})
    for (const std::uint64_t seed : {1, 2, 3}) {
      if (TETROPOLIS_SANITIZED && seed > 1) continue;  // minutes, for the same code
      SCOPED_TRACE(::testing::Message() << defect << " " << seed);
      const testing::TemporaryFolder folder;
      Config config;
      config.kind = SynthKind::kAdversarial;
      config.defects = {defect};
      config.seed = seed;
      config.size = 200;
      config.out = folder / "input";
      run_synth(config);
      const fs::path shapefile = folder / "input/footprints.shp";
      make_city(fs::exists(shapefile) ? shapefile : folder / "input/footprints.geojson",
                {folder / "input"}, folder / "city");
      for (const double size : {10, 5, 3}) {
        const bool is_cut = size < 5 && config.defects[0] == "quarry_wall" && seed == 1;
        if (size < 5 && !is_cut) continue;
        SCOPED_TRACE(size);
        const Report report = mesh_at(folder / "city", size);
        expect_good_angles(*report.volume_mesh);
        EXPECT_GT(report.volume_mesh->ground_lowered, 0);
        if (!is_cut) continue;
        EXPECT_FALSE(report.volume_mesh->feet_cut_back.empty());
        EXPECT_LT(report.volume_mesh->ground_lowered, report.ground_mesh->vertices / 20);
        fs::copy_file(folder / "city/dtm.tif", folder / "city/mesh/dtm.tif");
        fs::copy_file(folder / "city/city.city.json", folder / "city/mesh/city.city.json");
        for (const bool with_report : {true, false}) {
          if (!with_report) fs::remove(folder / "city/mesh/report.json");
          for (const CheckedFile& file : check_path(folder / "city/mesh", std::nullopt))
            EXPECT_TRUE(file.violations.empty()) << file.violations[0].what;
        }
      }
    }
}

/// A city and the settings that `scripts/survey --seed` prints for it.
struct SurveyedCity {
  std::uint64_t seed;
  double size, relief, point_density;
  double mesh_size, domain_height, distance;
  Top top;
  BoundaryBuildings boundary;
  std::vector<double> bounds;
  Lod lod = Lod::kBlock;
  double dtm_step = 1;
  SynthKind kind = SynthKind::kAdversarial;
};

/// Cities whose meshes were below the floor once: level ground at the foot of a rock wall, whose
/// columns have segments as long as the wall is high (3074, 3737); a free top with a cliff above
/// the wall of a building as large as the domain on a slope (3132); a column of the upper part
/// that ended above a slope (1728); a step of 0.77 m between roofs beside long triangles (1739).
TEST(QualityFloor, FoundByTheSurvey) {
  const std::vector<SurveyedCity> cities{
      {3074,
       224,
       0.4,
       0.6,
       10,
       30,
       1,
       Top::kFlat,
       BoundaryBuildings::kClip,
       {319000.0457, 6396000.0516, 319224.0457, 6396224.0516}},
      {3132,
       279,
       7.4,
       0.91,
       30,
       39,
       0.5,
       Top::kFree,
       BoundaryBuildings::kClip,
       {-139.5, -93, 139.5, 186}},
      {3737,
       172,
       3.6,
       0.95,
       5,
       44,
       1,
       Top::kFlat,
       BoundaryBuildings::kDrop,
       {319000, 6396000, 319172, 6396172}},
      {1728,
       184,
       13.9,
       1.57,
       20,
       48,
       1,
       Top::kFlat,
       BoundaryBuildings::kClip,
       {319000, 6396000, 319184, 6396184},
       Lod::k2_2,
       0.5},
      {1739,
       353,
       24.2,
       1.59,
       15,
       91,
       1,
       Top::kFlat,
       BoundaryBuildings::kClip,
       {},
       Lod::k2_2,
       1,
       SynthKind::kBlocks},
  };
  for (const SurveyedCity& c : cities) {
    SCOPED_TRACE(c.seed);
    const testing::TemporaryFolder folder;
    Config config;
    config.kind = c.kind;
    if (c.kind == SynthKind::kBlocks) config.roofs = SynthRoofs::kSloped;
    config.seed = c.seed;
    config.size = c.size;
    config.relief = c.relief;
    config.point_density = c.point_density;
    config.out = folder / "input";
    run_synth(config);
    Config build;
    const bool is_adversarial = c.kind == SynthKind::kAdversarial;
    build.footprints = {folder /
                        (is_adversarial ? "input/footprints.geojson" : "input/footprints.shp")};
    build.points = {folder / "input"};
    build.id_attribute = "id";
    build.measured_ground = MeasuredGround::kKeep;
    build.dtm_step = c.dtm_step;
    build.mesh_size = c.mesh_size;
    build.domain_height = c.domain_height;
    build.min_building_distance = c.distance;
    build.top = c.top;
    build.boundary_buildings = c.boundary;
    build.bounds = c.bounds;
    build.lod = c.lod;
    build.out = folder / "out";
    expect_good_angles(*run_build(build).volume_mesh);
  }
}

/// Every point is ground, as in surface models sold for terrain: roofs and trees are cliffs, and
/// walls of a metre are left at the buildings, which get the minimum height above the terrain.
TEST(QualityFloor, RoofsAndTreesInTheTerrain) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE(seed);
    const testing::TemporaryFolder folder;
    Config config;
    config.kind = SynthKind::kAdversarial;
    config.defects = {"no_classes"};
    config.seed = seed;
    config.size = 200;
    config.out = folder / "input";
    run_synth(config);
    const PointsInput input =
        read_points(expand_point_paths(std::vector{(folder / "input").string()}));
    PointCloud cloud = input.points;
    std::fill(cloud.classification.begin(), cloud.classification.end(), kGround);
    fs::create_directory(folder / "points");
    write_points(folder / "points/all.las", cloud, input.origin, {.crs = "EPSG:3006"});
    const fs::path shapefile = folder / "input/footprints.shp";
    make_city(fs::exists(shapefile) ? shapefile : folder / "input/footprints.geojson",
              {folder / "points"}, folder / "city");
    for (const double size : {10, 5}) {
      SCOPED_TRACE(size);
      expect_good_angles(*mesh_at(folder / "city", size).volume_mesh);
    }
  }
}

/// A long hall on a slope of one to a hundred: its walls get lower along the slope, until the
/// ground is above the roof.
TEST(QualityFloor, WallsThatSinkIntoASlope) {
  const testing::TemporaryFolder folder;
  CityModel city;
  city.domain = {0, 0, 300, 160};
  city.crs = "EPSG:28992";
  Building hall;
  hall.id = "b0";
  hall.source_ids = {"0"};
  hall.footprint.outer = {{45, 40}, {255, 40}, {255, 120}, {45, 120}};
  hall.h_ground = 10.5;
  hall.h_roof = 12;
  city.buildings.push_back(hall);
  write_city(folder / "city.city.json", city);
  Raster dtm{301, 161, 0, 0, 1, {}};
  for (int j = 0; j < dtm.ny; ++j)
    for (int i = 0; i < dtm.nx; ++i) dtm.values.push_back(10 + 0.01 * i);
  write_raster(folder / "dtm.tif", dtm, {}, "EPSG:28992");
  expect_good_meshes(folder.path(), {10, 20, 5});
}

/// The lowest ground of the mesh in `folder`.
double lowest_ground(const fs::path& folder) {
  const SurfaceMesh boundary = read_vtp(folder / "mesh/boundary.vtp");
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < boundary.triangles.size(); ++f)
    if (boundary.patch[f] == Patch::kGround)
      for (const std::int32_t v : boundary.triangles[f])
        lowest = std::min(lowest, boundary.points[static_cast<std::size_t>(v)][2]);
  return lowest;
}

/// A city of one building on a hundred metres by as many, with that terrain.
template <typename Elevation>
void write_lone_building(const fs::path& folder, const Polygon& footprint, double roof,
                         const Elevation& elevation) {
  CityModel city;
  city.domain = {0, 0, 100, 100};
  city.crs = "EPSG:28992";
  Building building;
  building.id = "b0";
  building.source_ids = {"0"};
  building.footprint = footprint;
  building.h_ground = roof - 2.5;
  building.h_roof = roof;
  city.buildings.push_back(building);
  write_city(folder / "city.city.json", city);
  Raster dtm{101, 101, 0, 0, 1, {}};
  for (int j = 0; j < dtm.ny; ++j)
    for (int i = 0; i < dtm.nx; ++i) dtm.values.push_back(elevation(i, j));
  write_raster(folder / "dtm.tif", dtm, {}, "EPSG:28992");
}

/// A house before a rock wall higher than itself, and one that stands half in it. The ground at
/// their walls goes down to the street, and not below it, as a pit would. (A tester's.)
TEST(QualityFloor, HousesBeforeARockWallGetNoPit) {
  constexpr double height = 40;
  for (const double east : {57, 59, 63})
    for (const double size : {20, 10, 5}) {
      SCOPED_TRACE(::testing::Message() << east << " " << size);
      const testing::TemporaryFolder folder;
      write_lone_building(folder.path(), {{{45, 40}, {east, 40}, {east, 60}, {45, 60}}, {}}, 12,
                          [&](int x, int) { return x < 60 ? 0 : height; });
      expect_above_the_floor(mesh_at(folder.path(), size));
      EXPECT_GE(lowest_ground(folder.path()), -1e-9);
    }
}

/// A hut 2 m before a rock wall: a wall as low as its is seen from the rock only if that is cut
/// back gently, and not under the street. (A tester's.)
TEST(QualityFloor, HutsBeforeARockWallGetNoPit) {
  for (const double rock : {10, 20, 30})
    for (const double size : {5, 10, 20, 40}) {
      SCOPED_TRACE(::testing::Message() << rock << " " << size);
      const testing::TemporaryFolder folder;
      write_lone_building(folder.path(), {{{50, 47}, {56, 47}, {56, 52}, {50, 52}}, {}}, 2.5,
                          [&](int x, int) { return x < 58 ? 0 : rock; });
      expect_good_angles(*mesh_at(folder.path(), size).volume_mesh);
      // What a hut of 2.5 m needs; more where coarse cells reach up a high wall.
      EXPECT_GE(lowest_ground(folder.path()), rock > 20 && size > 10 ? -2.5 : -0.7);
    }
}

/// Buildings sunk into flat ground, whose yards and inner corners leave little room to cut. (A
/// tester's.)
TEST(QualityFloor, SunkBuildings) {
  const Polygon box{{{40, 40}, {60, 40}, {60, 60}, {40, 60}}, {}};
  const Polygon thin{{{30, 50}, {70, 50}, {70, 51.2}, {30, 51.2}}, {}};
  const Polygon l{{{30, 30}, {60, 30}, {60, 36}, {36, 36}, {36, 60}, {30, 60}}, {}};
  const Polygon e{{{30, 30},
                   {50, 30},
                   {50, 34},
                   {34, 34},
                   {34, 37},
                   {50, 37},
                   {50, 41},
                   {34, 41},
                   {34, 44},
                   {50, 44},
                   {50, 48},
                   {30, 48}},
                  {}};
  struct Sunk {
    const Polygon& footprint;
    double depth, size;
  };
  for (const Sunk& sunk : {Sunk{e, 2, 4}, Sunk{thin, 2, 15}, Sunk{box, 5, 20}, Sunk{l, 10, 15},
                           Sunk{thin, 10, 40}, Sunk{box, 10, 10}}) {
    SCOPED_TRACE(::testing::Message() << sunk.depth << " " << sunk.size);
    const testing::TemporaryFolder folder;
    write_lone_building(folder.path(), sunk.footprint, -sunk.depth, [](int, int) { return 0.0; });
    expect_good_angles(*mesh_at(folder.path(), sunk.size).volume_mesh);
  }
}

/// A building with a corner that no cut makes blunter, and others between a quarry and a rock wall
/// a long way off: there the terrain is cut back all the same. (A tester's.)
TEST(QualityFloor, ASharpCornerKeepsNoTerrainElsewhereFromBeingCut) {
  // Rises by 30 m within 2 m, and a hole of 35 m by 27 m, 40 m deep.
  const auto ramp = [](double t) { return std::clamp(t, 0.0, 1.0); };
  const auto elevation = [&](double x, double y) {
    const double rise = -0.82871 * (x - 69.99433) + 0.55968 * (y - 33.02795);
    const double along = -0.55968 * (x - 57.90626) - 0.82871 * (y - 44.29611);
    const double across = 0.82871 * (x - 57.90626) - 0.55968 * (y - 44.29611);
    return 30 * ramp(rise / 2 + 0.5) -
           40 * ramp(17.68217 - std::abs(along)) * ramp(13.44741 - std::abs(across));
  };
  Raster dtm{135, 135, -2, -2, 1, {}};
  for (int j = 0; j < dtm.ny; ++j)
    for (int i = 0; i < dtm.nx; ++i) dtm.values.push_back(elevation(std::min(i - 2, 80), j - 2));
  for (const double degrees : {15, 8, 5}) {
    SCOPED_TRACE(degrees);
    const testing::TemporaryFolder folder;
    CityModel city;
    city.domain = {0, 0, 130, 130};
    city.crs = "EPSG:28992";
    const auto add = [&](Ring outer, double roof) {
      Building building;
      building.id = "b" + std::to_string(city.buildings.size());
      building.source_ids = {building.id};
      for (Point2& p : outer) p = snap_coordinate(p);
      building.footprint.outer = std::move(outer);
      building.h_ground = roof - 3;
      building.h_roof = roof;
      city.buildings.push_back(building);
    };
    add({{26.0871, 20.1348}, {35.0376, 33.3878}, {29.965, 35.6498}}, 32.5);
    add({{5.7428, 38.1312}, {51.8786, 35.6937}, {50.7632, 48.5048}}, 180);
    add({{71.6989, 58.2027}, {54.1199, 70.0748}, {43.6293, 54.5415}, {61.2083, 42.6694}}, 180);
    add({{76.4699, 42.8424}, {67.7265, 48.7473}, {60.7434, 38.4075}, {69.4868, 32.5026}}, 80);
    const double angle = degrees * std::numbers::pi / 180;
    add({{98, 40}, {112, 40}, {98 + 14 * std::cos(angle), 40 + 14 * std::sin(angle)}}, 12);
    write_city(folder / "city.city.json", city);
    write_raster(folder / "dtm.tif", dtm, {}, "EPSG:28992");
    const VolumeMeshFacts mesh = *mesh_at(folder.path(), 10).volume_mesh;
    EXPECT_FALSE(mesh.feet_cut_back.empty());
    // Above the lid a few may stay, between roofs 180 m high and a hole 40 m deep.
    EXPECT_LE(mesh.faces.above_70, 3);
  }
}

/// A hillside with houses and halls at random, some of them low; walls of the long ones sink into
/// the ground. Elevations rise by up to one in twenty.
void make_hillside(std::mt19937_64& random, double side, const fs::path& folder) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const double direction = uniform(0, 2 * std::numbers::pi), slope = uniform(0, 0.05);
  const auto elevation = [&](Point2 p) {
    return 50 + slope * (p.x * std::cos(direction) + p.y * std::sin(direction));
  };
  const auto nodes = static_cast<std::int32_t>(side) + 1;
  Raster dtm{nodes, nodes, 0, 0, 1, {}};
  for (int j = 0; j < nodes; ++j)
    for (int i = 0; i < nodes; ++i) dtm.values.push_back(elevation({1.0 * i, 1.0 * j}));
  write_raster(folder / "dtm.tif", dtm, {}, "EPSG:28992");

  CityModel city;
  city.domain = {0, 0, side, side};
  city.crs = "EPSG:28992";
  struct Disk {
    Point2 centre;
    double radius;
  };
  std::vector<Disk> taken;
  for (int trial = 0; trial < 60; ++trial) {
    const double length = uniform(4, trial < 20 ? 90 : 25), width = uniform(4, 25);
    const double angle = trial % 3 == 0 ? 0 : uniform(0, std::numbers::pi);
    const double radius = std::hypot(length, width) / 2, rim = radius + 25;
    const Point2 centre{uniform(0, side), uniform(0, side)};
    if (centre.x < rim || centre.y < rim || centre.x > side - rim || centre.y > side - rim)
      continue;
    const double gap = uniform(1, 10);
    if (std::any_of(taken.begin(), taken.end(), [&](const Disk& disk) {
          return std::hypot(disk.centre.x - centre.x, disk.centre.y - centre.y) <
                 disk.radius + radius + gap;
        }))
      continue;
    taken.push_back({centre, radius});
    Building building;
    building.id = "b" + std::to_string(city.buildings.size());
    building.source_ids = {building.id};
    double lowest = std::numeric_limits<double>::infinity();
    for (const auto& [u, v] : {Point2{-1, -1}, Point2{1, -1}, Point2{1, 1}, Point2{-1, 1}}) {
      const double x = u * length / 2, y = v * width / 2;
      const Point2 corner{snap_coordinate(centre.x + x * std::cos(angle) - y * std::sin(angle)),
                          snap_coordinate(centre.y + x * std::sin(angle) + y * std::cos(angle))};
      building.footprint.outer.push_back(corner);
      lowest = std::min(lowest, elevation(corner));
    }
    building.h_ground = lowest + 0.1 * slope * length;
    building.h_roof = building.h_ground + uniform(2.5, trial % 2 == 0 ? 4 : 25);
    city.buildings.push_back(building);
  }
  write_city(folder / "city.city.json", city);
}

TEST(QualityFloor, Hillsides) {
  std::mt19937_64 random(testing::test_seed());
  for (int city = 0; city < 12; ++city) {
    SCOPED_TRACE("city " + std::to_string(city));
    const testing::TemporaryFolder folder;
    make_hillside(random, 250, folder.path());
    expect_good_meshes(folder.path(), {30, 20, 10});
  }
}

/// OpenFOAM's own judgement of the mesh in `folder`, where that is installed: `apt-get install
/// openfoam`.
class CheckMesh : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v checkMesh >/dev/null 2>&1") != 0)
      GTEST_SKIP() << "checkMesh (package openfoam) is not installed";
  }

  /// Meshes at 10 m and asks checkMesh.
  void expect_good(const fs::path& footprints, const std::vector<fs::path>& points) {
    Config config;
    config.footprints = {footprints};
    for (const fs::path& path : points) config.points.push_back(path);
    config.formats = {"openfoam"};
    config.out = folder / "result";
    expect_agreement(run_build(config));
  }

  void expect_agreement(const Report& report);

  testing::TemporaryFolder folder;
};

void CheckMesh::expect_agreement(const Report& report) {
  fs::create_directories(folder / "result/system");
  const auto write = [&](const char* name, const std::string& text) {
    std::ofstream(folder / "result/system" / name)
        << "FoamFile { version 2.0; format ascii; class dictionary; object " << name << "; }\n"
        << text << "\n";
  };
  write("controlDict",
        "application checkMesh; startFrom startTime; startTime 0; stopAt endTime; endTime 1; "
        "deltaT 1; writeControl timeStep; writeInterval 1;");
  write("fvSchemes",
        "ddtSchemes { default steadyState; } gradSchemes { default Gauss linear; } divSchemes { "
        "default none; } laplacianSchemes { default none; } interpolationSchemes { default linear; "
        "} snGradSchemes { default corrected; }");
  write("fvSolution", "");
  // Debian's package finds its etc folder only when told where it is.
  const std::string log = folder / "log";
  const std::string run = "WM_PROJECT_DIR=${WM_PROJECT_DIR:-/usr/share/openfoam} checkMesh -case " +
                          (folder / "result").string() + " >" + log + " 2>&1";
  EXPECT_EQ(std::system(run.c_str()), 0);
  std::ifstream stream(log);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_NE(text.find("Mesh OK."), std::string::npos) << text;
  const std::string mark = "Mesh non-orthogonality Max: ";
  const std::size_t at = text.find(mark);
  ASSERT_NE(at, std::string::npos) << text;
  EXPECT_NEAR(std::stod(text.substr(at + mark.size())),
              report.volume_mesh->faces.worst.non_orthogonality_deg, 1e-3);
  expect_above_the_floor(report);
}

TEST_F(CheckMesh, AgreesOnASmallCity) {
  expect_agreement(testing::build_blocks(folder, "openfoam"));
}

TEST_F(CheckMesh, AgreesOnTheDemonstration) {
  Config config;  // as in the Makefile
  config.kind = SynthKind::kBlocks;
  config.size = 500;
  config.seed = 7;
  config.out = folder / "input";
  run_synth(config);
  expect_good(folder / "input/footprints.shp", {folder / "input"});
}

TEST_F(CheckMesh, AgreesOnDelft) {
  TETROPOLIS_REQUIRE_DATA(data, "delft_3dfier");
  expect_good(data / "footprints.shp", {data / "ahn3_cropped_1.laz", data / "ahn3_cropped_2.laz"});
}

TEST_F(CheckMesh, AgreesOnAmsterdamSouth) {
  TETROPOLIS_REQUIRE_DATA(data, "amsterdam_south");
  expect_good(data / "footprints.gpkg", {data / "ahn3"});
}

}  // namespace
}  // namespace tetropolis
