// The whole pipeline on invented cities: results hold together, do not depend on threads, and are
// the same in one go or in two.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <numeric>
#include <regex>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "tetropolis/check/check_results.h"
#include "tetropolis/city/raise_roofs.h"
#include "tetropolis/core/error.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/mesh/vtk.h"
#include "tetropolis/io/raster/geotiff.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/run/run.h"

#include "pipeline/memory.h"
#include "support/bytes.h"
#include "support/errors.h"
#include "support/guarantees.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

using testing::bytes_of;
using testing::expect_guarantees;

class Build : public ::testing::Test {
 protected:
  /// Settings for an invented city, written on first use.
  Config city(SynthKind kind, int buildings, double size, int seed) {
    Config synth;
    synth.kind = kind;
    synth.buildings = buildings;
    synth.size = size;
    synth.seed = seed;
    synth.out = (scratch / "input").string();
    run_synth(synth);
    Config config;
    config.footprints = {(scratch / "input/footprints.shp").string()};
    config.points = {(scratch / "input").string()};
    config.id_attribute = "id";
    config.out = (scratch / "out").string();
    return config;
  }

  testing::TemporaryFolder scratch;
};

TEST_F(Build, CheckFindsAReportThatTellsSomethingElse) {
  Config config = city(SynthKind::kRandom, 10, 150, 4);
  config.mesh_size = 20;
  config.min_building_area = 60;
  run_build(config);
  expect_guarantees(config.out);
  const fs::path file = scratch / "out/report.json";
  const Json truth = Json::parse(bytes_of(file));
  ASSERT_FALSE(truth["city"]["dropped"].empty());
  const auto violations_with = [&](const char* pointer, const Json& value) {
    Json report = truth;
    report[Json::json_pointer(pointer)] = value;
    std::ofstream(file) << report;
    std::size_t count = 0;
    for (const CheckedFile& checked : check_path(config.out, std::nullopt))
      count += checked.violations.size();
    return count;
  };
  EXPECT_EQ(violations_with("/version", "another"), 0U);
  EXPECT_EQ(violations_with("/city/buildings", 55), 2U);  // model, layers
  EXPECT_EQ(violations_with("/city/account/kept", 55), 1U);
  EXPECT_EQ(violations_with("/city/account/merged", 55), 1U);
  EXPECT_EQ(violations_with("/city/account/too_small", 55), 2U);
  EXPECT_EQ(violations_with("/city/account/features", 55), 1U);  // of the layers
  EXPECT_EQ(violations_with("/city/dropped/0/source_id", "nobody"), 1U);
  EXPECT_EQ(violations_with("/city/dropped/0/reason", "too old"), 1U);
  EXPECT_EQ(violations_with("/origin/0", 0), 5U);  // model, volume, boundary, its box, surface
  EXPECT_EQ(violations_with("/domain/0", truth["domain"][0].get<double>() - 0.001), 2U);
  EXPECT_EQ(violations_with("/input/footprint_parts", 99), 2U);  // both models
  EXPECT_EQ(violations_with("/volume_mesh/cells", 1), 1U);
  EXPECT_EQ(violations_with("/volume_mesh/dihedral_deg/min", 50), 1U);
  EXPECT_EQ(violations_with("/volume_mesh/dihedral_deg/max", 50), 1U);
  EXPECT_EQ(violations_with("/surface_mesh/triangles", 1), 1U);
  const double gap = truth["volume_mesh"]["min_vertical_gap"], top = truth["volume_mesh"]["top"];
  EXPECT_EQ(violations_with("/volume_mesh/min_vertical_gap", gap + 1e-4), 1U);
  EXPECT_EQ(violations_with("/volume_mesh/top", top - 1e-4), 2U);  // highest and lowest
  EXPECT_EQ(violations_with("/config/top", "free"), 0U);
  for (const char* member : {"/origin", "/crs", "/domain", "/files", "/city/flags",
                             "/city/min_clearance", "/volume_mesh/feet_cut_back", "/config/top"}) {
    SCOPED_TRACE(member);
    Json report = truth;
    report = report.patch({{{"op", "remove"}, {"path", member}}});
    std::ofstream(file) << report;
    std::size_t told = 0;
    for (const CheckedFile& checked : check_path(config.out, std::nullopt))
      for (const Violation& violation : checked.violations)
        if (violation.what == "members that the report of a run has and this one has not")
          told += violation.first == member ? 1 : 0;
    EXPECT_EQ(told, 1U);
  }
  EXPECT_EQ(violations_with("/city/merged_groups", 77), 1U);
  EXPECT_EQ(violations_with("/config/dtm_step", 0.5), 1U);
  const Json& ground = truth["ground_mesh"];
  const double least = ground["min_angle_deg"];
  const std::int64_t below = ground["triangles_below_min_angle"];
  EXPECT_EQ(violations_with("/ground_mesh/triangles", 1), 1U);
  EXPECT_EQ(violations_with("/ground_mesh/min_angle_deg", least + 1e-4), 1U);
  EXPECT_EQ(violations_with("/ground_mesh/min_angle_deg", least - 1e-4), 1U);
  EXPECT_EQ(violations_with("/ground_mesh/triangles_below_min_angle", below + 1), 1U);
  EXPECT_EQ(violations_with("/config/min_angle", 44), 2U);  // many are, and not at sharp corners
}

TEST_F(Build, UniformLayersArePrismsOfThreeAndHoldEveryGuarantee) {
  Config config = city(SynthKind::kRandom, 20, 200, 4);
  config.layering = Layering::kUniform;
  for (const Top top : {Top::kFlat, Top::kFree}) {
    SCOPED_TRACE(top == Top::kFlat ? "flat top" : "free top");
    config.top = top;
    const Report report = run_build(config);
    expect_guarantees(config.out);
    ASSERT_EQ(report.solver.size(), 2U);
    for (const SolverFacts& step : report.solver) {
      EXPECT_GT(step.unknowns, 0);
      EXPECT_GT(step.iterations, 0);
      EXPECT_TRUE(step.converged);
    }
    const TetMesh mesh = read_vtu(fs::path(config.out) / "volume.vtu");
    std::map<std::set<std::pair<double, double>>, std::int64_t> stacks;
    for (const auto& cell : mesh.cells) {
      std::set<std::pair<double, double>> corners;
      for (const std::int64_t v : cell) {
        const auto& p = mesh.points[static_cast<std::size_t>(v)];
        corners.insert({p[0], p[1]});
      }
      ++stacks[corners];
    }
    std::int64_t highest = 0;
    for (const auto& [corners, cells] : stacks) {
      EXPECT_EQ(corners.size(), 3U);
      EXPECT_EQ(cells % 3, 0);
      highest = std::max(highest, cells / 3);
    }
    EXPECT_EQ(highest, report.volume_mesh->layers);
  }
}

TEST_F(Build, AnUnfinishedSolveIsToldAndStillValid) {
  Config config = city(SynthKind::kRandom, 20, 200, 4);
  config.layering = Layering::kUniform;
  config.solver_iterations = 1;
  config.solver_tolerance = 1e-6;
  const Report report = run_build(config);
  expect_guarantees(config.out);
  EXPECT_TRUE(std::any_of(report.warnings.begin(), report.warnings.end(),
                          [](const Warning& w) { return w.code == "solver_not_converged"; }));
  for (const SolverFacts& step : report.solver) {
    EXPECT_EQ(step.iterations, 1);
    EXPECT_FALSE(step.converged);
  }
}

TEST_F(Build, CheckFindsFootprintsThatAreNotInTheMesh) {
  Config config = city(SynthKind::kRandom, 10, 150, 4);
  config.lod = Lod::kBlock;
  config.mesh_size = 20;
  for (const Coordinates coordinates : {Coordinates::kLocal, Coordinates::kAbsolute}) {
    SCOPED_TRACE(static_cast<int>(coordinates));
    config.coordinates = coordinates;
    run_build(config);
    expect_guarantees(config.out);
    const fs::path file = scratch / "out/city.city.json";
    CityModel model = read_city(file);
    model.buildings[3].footprint.outer[1].x += 1e-3;
    write_city(file, model);
    std::set<std::string> violated;
    for (const CheckedFile& checked : check_path(config.out, std::nullopt))
      for (const Violation& violation : checked.violations) violated.insert(violation.what);
    EXPECT_EQ(violated, (std::set<std::string>{"area of footprints differs from report.json",
                                               "footprint vertices off the roof's outline",
                                               "roof outlines that leave the footprint's edges"}));
  }
}

TEST_F(Build, CheckSaysWhatItHasNotLookedAt) {
  Config config = city(SynthKind::kRandom, 10, 150, 4);
  config.mesh_size = 20;
  run_build(config);
  const fs::path out = config.out;
  const auto not_checked = [](const fs::path& path) {
    std::string all;
    for (const CheckedFile& file : check_path(path, std::nullopt)) {
      for (const Violation& violation : file.violations)
        EXPECT_EQ(violation.what, "results that report.json lists and that are not here, or empty");
      for (const std::string& what : file.not_checked) all += what + "; ";
    }
    return all;
  };
  const auto says = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_EQ(not_checked(out), "");
  for (const char* name : {"volume.vtu", "boundary.vtp", "city.city.json", "city_raw.city.json"})
    EXPECT_TRUE(says(not_checked(out / name), "check the folder")) << name;
  const fs::path aside = scratch / "aside";
  const auto without = [&](const char* name) {
    fs::rename(out / name, aside);
    const std::string text = not_checked(out);
    fs::rename(aside, out / name);
    return text;
  };
  EXPECT_TRUE(says(without("dtm.tif"), "heights (there is no dtm.tif)"));
  EXPECT_TRUE(says(without("city.city.json"), "there is no city.city.json"));
  for (const char* name : {"volume.vtu", "boundary.vtp"})
    EXPECT_TRUE(says(without(name), "there is neither volume.vtu with boundary.vtp nor"));
  const std::string unreported = without("report.json");
  for (const char* part : {"every input feature", "numbers of the run", "least angle"})
    EXPECT_TRUE(says(unreported, part)) << unreported;
  // Without report and boundary there is still a volume to look at.
  fs::remove(out / "report.json");
  EXPECT_TRUE(says(without("boundary.vtp"), "the boundary's tags"));
  EXPECT_TRUE(says(without("volume.vtu"), "the volume behind it"));
  EXPECT_TRUE(says(not_checked(out / "surface.vtp"), "the volume behind it"));
}

TEST_F(Build, SurfacesAreComparedWithTheBoundary) {
  for (const Coordinates coordinates : {Coordinates::kLocal, Coordinates::kAbsolute}) {
    Config config = city(SynthKind::kRandom, 10, 150, 4);
    config.mesh_size = 20;
    config.coordinates = coordinates;
    run_build(config);
    const fs::path out = config.out;
    const auto violated = [&] {
      std::set<std::string> files;
      for (const CheckedFile& file : check_path(out, std::nullopt))
        if (!file.violations.empty()) files.insert(file.name);
      return files;
    };
    ASSERT_EQ(violated(), std::set<std::string>());
    // A byte of a coordinate, in the middle of the data.
    for (const char* name : {"surface.stl", "surface.vtp"}) {
      const std::string bytes = bytes_of(out / name);
      std::string changed = bytes;
      changed[name == std::string("surface.stl") ? 84 + 50 * 7 + 12 + 6
                                                 : bytes.find("\n_") + 10 + 6] ^= 0x10;
      std::ofstream(out / name, std::ios::binary) << changed;
      EXPECT_EQ(violated(), std::set<std::string>{name});
      std::ofstream(out / name, std::ios::binary) << bytes;
    }
  }
}

TEST_F(Build, XdmfIsCheckedLikeVtk) {
  Config config = city(SynthKind::kRandom, 10, 150, 4);
  config.mesh_size = 20;
  config.formats = {"xdmf"};
  config.coordinates = Coordinates::kAbsolute;
  run_build(config);
  const fs::path out = config.out;
  ASSERT_FALSE(fs::exists(out / "volume.vtu"));
  const auto checked = [&](const fs::path& path) {
    std::string all;
    std::set<std::string> violated;
    for (const CheckedFile& file : check_path(path, std::nullopt)) {
      for (const std::string& what : file.not_checked) all += what + "; ";
      for (const Violation& violation : file.violations) violated.insert(violation.what);
    }
    return std::pair(all, violated);
  };
  EXPECT_EQ(checked(out), std::pair(std::string(), std::set<std::string>()));
  const auto [alone, good] = checked(out / "volume.xdmf");
  EXPECT_NE(alone.find("check the folder that has the other results"), std::string::npos);
  EXPECT_TRUE(good.empty());
  // Another city's model beside it: everything that the volume should stand on is elsewhere.
  CityModel model = read_city(out / "city.city.json");
  for (Building& building : model.buildings) raise_roof(building, 1);
  write_city(out / "city.city.json", model);
  EXPECT_FALSE(checked(out).second.empty());
}

TEST_F(Build, MeshesJoinTheCityModelInItsFolder) {
  Config config = city(SynthKind::kRandom, 10, 150, 4);
  run_city(config);
  const std::string model = bytes_of(scratch / "out/city.city.json");
  Config mesh;
  mesh.city = (scratch / "out/city.city.json").string();
  mesh.dtm = {(scratch / "out/dtm.tif").string()};
  mesh.out = config.out;
  for (const double size : {20.0, 15.0}) {
    mesh.mesh_size = size;
    run_mesh(mesh);
    // The report of `mesh` does not know the input of `city`.
    expect_guarantees(config.out, "that every input feature is accounted for");
    for (const char* name :
         {"city_raw.city.json", "dtm.tif", "buildings.gpkg", "volume.vtu", "report.json"})
      EXPECT_TRUE(fs::exists(scratch / "out" / name)) << name;
    EXPECT_EQ(bytes_of(scratch / "out/city.city.json"), model);
  }
  // Into a folder with results of another city, nothing of that one stays.
  Config other = city(SynthKind::kRandom, 5, 120, 9);
  other.out = (scratch / "other").string();
  run_city(other);
  mesh.out = other.out;
  run_mesh(mesh);
  EXPECT_FALSE(fs::exists(scratch / "other/city.city.json"));
  // What leaves a building out says so.
  mesh.bounds = {0, 0, 1, 1};
  EXPECT_THROW(run_mesh(mesh), Error);
}

TEST_F(Build, MeshLeavesOutBuildingsOfOthersThatDoNotFit) {
  Config blocks = city(SynthKind::kRandom, 10, 150, 4);
  blocks.lod = Lod::kBlock;
  run_city(blocks);
  const RasterInput terrain = read_raster(scratch / "out/dtm.tif", {0, 0});
  write_raster(scratch / "foreign.tif", terrain.raster, {0, 0}, terrain.crs);
  nlohmann::json model = nlohmann::json::parse(bytes_of(scratch / "out/city.city.json"));
  model.erase("+tetropolis");
  ASSERT_GE(model["CityObjects"].size(), 5U);
  std::vector<std::string> keys;
  for (auto& [key, object] : model["CityObjects"].items()) {
    object.erase("attributes");
    keys.push_back(key);
  }
  // The first is a kilometre to the east, the second a hundred high, the third broken.
  const auto move = [&](const std::string& key, int axis, int by) {
    std::set<std::size_t> moved;
    for (const auto& surface : model["CityObjects"][key]["geometry"][0]["boundaries"][0])
      for (const auto& ring : surface)
        for (const auto& index : ring) moved.insert(index.get<std::size_t>());
    for (const std::size_t v : moved) {
      nlohmann::json& value = model["vertices"][v][static_cast<std::size_t>(axis)];
      if (axis == 0 || value > model["vertices"][*moved.begin()][2]) value = value.get<int>() + by;
    }
  };
  const double step = model["transform"]["scale"][0];
  move(keys[0], 0, static_cast<int>(1000 / step));
  move(keys[1], 2, static_cast<int>(100'000 / step));
  model["CityObjects"][keys[2]]["geometry"][0]["boundaries"] = "x";
  std::ofstream(scratch / "foreign.city.json") << model.dump();
  Config mesh;
  mesh.city = (scratch / "foreign.city.json").string();
  mesh.dtm = {(scratch / "foreign.tif").string()};
  mesh.mesh_size = 20;
  mesh.out = (scratch / "mesh").string();
  const Report report = run_mesh(mesh);
  ASSERT_TRUE(report.city.has_value());
  EXPECT_EQ(report.city->buildings, std::ssize(keys) - 3);
  std::map<std::string, std::string> reasons;
  for (const Dropped& dropped : report.city->dropped) reasons[dropped.source_id] = dropped.reason;
  EXPECT_EQ(reasons.size(), 3U);
  EXPECT_EQ(reasons[keys[0]], "outside the domain");
  EXPECT_NE(reasons[keys[1]].find("no elevations"), std::string::npos) << reasons[keys[1]];
  EXPECT_NE(reasons[keys[2]].find("is not an array"), std::string::npos) << reasons[keys[2]];
  const auto left_out =
      std::find_if(report.warnings.begin(), report.warnings.end(),
                   [](const Warning& w) { return w.code == "city_buildings_left_out"; });
  ASSERT_NE(left_out, report.warnings.end());
  EXPECT_EQ(left_out->count, 2);
  for (const CheckedFile& file : check_path(mesh.out, std::nullopt))
    for (const Violation& violation : file.violations)
      ADD_FAILURE() << file.name << ": " << violation.what << ": " << violation.first;
  // Of our own for a part of the domain: the ones that are in it.
  mesh.city = (scratch / "out/city.city.json").string();
  mesh.dtm = {(scratch / "out/dtm.tif").string()};
  const CityModel ours = read_city(mesh.city);
  const Bounds2 whole = ours.domain.moved(ours.origin).bounds();
  mesh.bounds = {whole.xmin, whole.ymin, (whole.xmin + whole.xmax) / 2, whole.ymax};
  mesh.out = (scratch / "half").string();
  const Report half = run_mesh(mesh);
  EXPECT_GT(half.city->buildings, 0);
  EXPECT_LT(half.city->buildings, std::ssize(ours.buildings));
  for (const CheckedFile& file : check_path(mesh.out, std::nullopt))
    for (const Violation& violation : file.violations)
      ADD_FAILURE() << file.name << ": " << violation.what << ": " << violation.first;
}

/// Ellipsoidal heights under a city of orthometric ones, for instance.
TEST_F(Build, ATerrainThatIsNotTheCitysIsNamed) {
  run_city(city(SynthKind::kRandom, 10, 150, 4));
  Config mesh;
  mesh.city = (scratch / "out/city.city.json").string();
  mesh.mesh_size = 20;
  const auto buildings = static_cast<std::int64_t>(read_city(mesh.city).buildings.size());
  const RasterInput terrain = read_raster(scratch / "out/dtm.tif", {0, 0});
  for (const double lift : {0.0, 2.5, 43.0, -43.0}) {
    SCOPED_TRACE(lift);
    Raster moved = terrain.raster;
    for (double& z : moved.values) z += lift;
    mesh.dtm = {(scratch / "moved.tif").string()};
    write_raster(mesh.dtm.front(), moved, {0, 0}, terrain.crs);
    mesh.out = (scratch / "mesh").string();
    const std::vector<Warning> warnings = run_mesh(mesh).warnings;
    const auto found = std::find_if(warnings.begin(), warnings.end(), [](const Warning& warning) {
      return warning.code == "city_off_terrain";
    });
    ASSERT_EQ(found != warnings.end(), std::abs(lift) > 3);
    if (found == warnings.end()) continue;
    EXPECT_EQ(found->count, buildings);
    EXPECT_NE(found->message.find(lift > 0 ? "m below" : "m above"), std::string::npos);
  }
}

TEST_F(Build, ATerrainThatIsNotThePointsIsNamed) {
  Config config = city(SynthKind::kRandom, 10, 150, 4);
  run_city(config);
  const RasterInput terrain = read_raster(scratch / "out/dtm.tif", {0, 0});
  config.dtm = {(scratch / "moved.tif").string()};
  config.out = (scratch / "moved").string();
  for (const double lift : {0.0, 2.5, 43.0, -43.0}) {
    SCOPED_TRACE(lift);
    Raster moved = terrain.raster;
    for (double& z : moved.values) z += lift;
    write_raster(config.dtm.front(), moved, {0, 0}, terrain.crs);
    const std::vector<Warning> warnings = run_city(config).warnings;
    const auto found = std::find_if(warnings.begin(), warnings.end(), [](const Warning& warning) {
      return warning.code == "points_off_terrain";
    });
    ASSERT_EQ(found != warnings.end(), std::abs(lift) > 3);
    if (found == warnings.end()) continue;
    EXPECT_NE(found->message.find(lift > 0 ? "43.0 m below" : "43.0 m above"), std::string::npos)
        << found->message;
  }
}

/// Faces of two sides exchanged, counts as they were: the inlet is then partly at the outlet.
TEST_F(Build, CheckKnowsTheSidesOfDomainsThatAreNoBoxes) {
  for (const char* domain : {"auto", "cylinder"}) {
    SCOPED_TRACE(domain);
    Config config = city(SynthKind::kRandom, 6, 100, 4);
    config.domain = domain;
    config.wind_from = 240;
    config.mesh_size = 20;
    config.far_size = 40;
    config.out = (scratch / domain).string();
    run_build(config);
    const std::filesystem::path out = config.out;
    const auto violations_of = [](const std::filesystem::path& path) {
      std::vector<std::string> what;
      for (const CheckedFile& file : check_path(path, std::nullopt))
        for (const Violation& violation : file.violations) what.push_back(violation.what);
      return what;
    };
    EXPECT_EQ(violations_of(out), std::vector<std::string>{});
    EXPECT_EQ(violations_of(out / "surface.vtp"), std::vector<std::string>{});
    SurfaceMesh boundary = read_vtp(out / "boundary.vtp");
    const Patch last = boundary.patch.back();  // the side with the greatest number
    const auto from = std::find(boundary.patch.begin(), boundary.patch.end(), last);
    const auto f = static_cast<std::size_t>(from - boundary.patch.begin());
    ASSERT_GT(f, 0U);
    ASSERT_EQ(boundary.patches.of(boundary.patch[f - 1]).kind, PatchKind::kOther);
    std::swap(boundary.triangles[f - 1], boundary.triangles[f]);
    write_vtp(out / "boundary.vtp", boundary, {});
    const std::vector<std::string> found = violations_of(out / "boundary.vtp");
    EXPECT_EQ(found,
              (std::vector<std::string>{
                  "faces of " + boundary.patches.of(boundary.patch[f - 1]).name + " off that side",
                  "faces of " + boundary.patches.of(last).name + " off that side"}));
  }
}

TEST_F(Build, PrismsThatGaveWayToTetsHoldWhatTheyPromise) {
  Config config = city(SynthKind::kRandom, 6, 100, 4);
  run_city(config);
  RasterInput terrain = read_raster(scratch / "out/dtm.tif", {0, 0});
  Raster& raster = terrain.raster;
  for (std::int32_t j = 0; j < raster.ny; ++j)
    for (std::int32_t i = 0; i < raster.nx; ++i)
      raster.values[static_cast<std::size_t>(j * raster.nx + i)] = i * raster.step;
  config.dtm = {(scratch / "slope.tif").string()};
  write_raster(config.dtm.front(), raster, {0, 0}, terrain.crs);
  config.points.clear();
  config.cells = Cells::kPrisms;
  config.mesh_size = 20;
  config.out = (scratch / "steep").string();
  const Report report = run_build(config);
  ASSERT_TRUE(std::any_of(report.warnings.begin(), report.warnings.end(),
                          [](const Warning& w) { return w.code == "too_steep_for_prisms"; }));
  for (const CheckedFile& file : check_path(config.out, std::nullopt))
    for (const Violation& violation : file.violations)
      ADD_FAILURE() << file.name << ": " << violation.what << ": " << violation.first;
}

// Walls above the least that is asked for, and below the least beside prisms.
TEST_F(Build, PrismsBesideLowWallsPassTheCheck) {
  Config config;
  config.footprints = {(scratch / "sheds.geojson").string()};
  std::ofstream(config.footprints.front()) << R"({"type": "FeatureCollection",
             "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::3006"}},
             "features": [{"type": "Feature", "properties": {"height": 1.8},
                           "geometry": {"type": "Polygon", "coordinates":
                             [[[600030, 6600030], [600045, 6600030], [600045, 6600045],
                               [600030, 6600045], [600030, 6600030]]]}}]})";
  Raster slope;
  slope.nx = slope.ny = 101;
  for (std::int32_t j = 0; j < slope.ny; ++j)
    for (std::int32_t i = 0; i < slope.nx; ++i) slope.values.push_back(0.05 * i);
  config.dtm = {(scratch / "slope.tif").string()};
  write_raster(config.dtm.front(), slope, {600000, 6600000}, "EPSG:3006");
  config.min_building_height = 0.5;
  config.cells = Cells::kPrisms;
  config.first_layer = 0.1;  // thick ones are compressed there
  config.out = (scratch / "out").string();
  const Report report = run_build(config);
  EXPECT_GT(report.volume_mesh->prisms.cells, 0);
  EXPECT_GT(report.volume_mesh->ground_lowered, 0);
  for (const CheckedFile& file : check_path(config.out, std::nullopt))
    for (const Violation& violation : file.violations)
      ADD_FAILURE() << file.name << ": " << violation.what << ": " << violation.first;
}

TEST_F(Build, CheckFindsATerrainOfAnotherSystem) {
  const Config config = city(SynthKind::kRandom, 10, 150, 4);
  run_city(config);
  const auto violations = [&] {
    std::vector<std::string> what;
    for (const CheckedFile& file : check_path(config.out, std::nullopt))
      for (const Violation& violation : file.violations) what.push_back(violation.what);
    return what;
  };
  EXPECT_TRUE(violations().empty());
  const fs::path path = fs::path(config.out) / "dtm.tif";
  const CityModel model = read_city(fs::path(config.out) / "city.city.json");
  const RasterInput terrain = read_raster(path, model.origin);
  write_raster(path, terrain.raster, model.origin, "EPSG:25833");
  EXPECT_EQ(violations(),
            std::vector<std::string>{"terrain and city model in different reference systems"});
}

/// It is no result of ours, and nobody writes to it.
TEST_F(Build, APipeInThePlaceOfTheReportHoldsNobodyUp) {
  Config config = city(SynthKind::kRandom, 5, 120, 9);
  fs::create_directories(config.out);
  ASSERT_EQ(::mkfifo((fs::path(config.out) / "report.json").c_str(), 0600), 0);
  EXPECT_THROW(check_path(config.out, std::nullopt), Error);
  EXPECT_THROW(run_city(config), Error);
  config.overwrite = true;
  run_city(config);
  EXPECT_TRUE(fs::is_regular_file(fs::path(config.out) / "report.json"));
}

TEST_F(Build, BlocksPassEveryCheckAndTheReportTellsTheTruth) {
  Config config = city(SynthKind::kBlocks, 0, 320, 3);
  const Report report = run_build(config);
  expect_guarantees(config.out);
  const std::set<std::string> expected{
      "city_raw.city.json", "city.city.json", "dtm.tif",     "buildings.gpkg", "volume.vtu",
      "boundary.vtp",       "surface.vtp",    "surface.stl", "index.html",     "report.json"};
  std::set<std::string> found;
  for (const auto& entry : fs::directory_iterator(config.out))
    found.insert(entry.path().filename().string());
  EXPECT_EQ(found, expected);

  const Json json = Json::parse(bytes_of(scratch / "out/report.json"));
  for (const char* key :
       {"version", "command", "config", "origin", "crs", "steps", "peak_rss_bytes", "threads",
        "input", "city", "ground_mesh", "volume_mesh", "surface_mesh", "solver", "warnings"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["crs"], "EPSG:3006");
  EXPECT_EQ(json["config"]["mesh_size"], 10);
  std::set<std::string> steps;
  std::set<std::pair<std::string, std::string>> parts;
  for (const Json& step : json["steps"]) {
    steps.insert(step["id"].get<std::string>());
    EXPECT_TRUE(parts.emplace(step["id"], step["name"]).second) << step;
  }
  EXPECT_EQ(steps,
            (std::set<std::string>{"1.1", "1.2", "1.3", "1.4", "1.5", "1.6", "1.7", "2.1", "2.2",
                                   "2.3", "2.4", "3.1", "3.2", "3.3", "3.4", "3.5", "3.6"}));
  EXPECT_EQ(json["volume_mesh"]["inverted"], 0);
  EXPECT_TRUE(json["surface_mesh"]["closed"].get<bool>() &&
              json["surface_mesh"]["manifold"].get<bool>());
  EXPECT_GE(json["city"]["min_clearance"].get<double>(), 1.0 - 1e-9);
  EXPECT_GE(json["ground_mesh"]["min_angle_deg"].get<double>(), 25 - 1e-6);
  for (const Json& solve : json["solver"]) EXPECT_TRUE(solve["converged"].get<bool>());
  EXPECT_EQ(json["input"]["footprints_read"].get<std::int64_t>(), report.input->footprints_read);

  // Guarantee 1 from the files alone: every feature once, in a building or dropped.
  const Json model = Json::parse(bytes_of(scratch / "out/city.city.json"));
  std::multiset<std::string> accounted;
  for (const auto& [id, object] : model["CityObjects"].items())
    for (const Json& source : object["attributes"]["source_ids"])
      accounted.insert(source.get<std::string>());
  for (const Json& dropped : json["city"]["dropped"])
    accounted.insert(dropped["source_id"].get<std::string>());
  EXPECT_EQ(static_cast<std::int64_t>(accounted.size()), report.input->footprints_read);
  EXPECT_EQ(std::set<std::string>(accounted.begin(), accounted.end()).size(), accounted.size());
}

TEST_F(Build, SameBytesForAnyNumberOfThreads) {
  Config config = city(SynthKind::kRandom, 300, 400, 5);
  config.threads = 1;
  run_build(config);
  Config again = config;
  again.threads = 2;
  again.out = (scratch / "again").string();
  run_build(again);
  for (const char* name : {"city_raw.city.json", "city.city.json", "dtm.tif", "buildings.gpkg",
                           "volume.vtu", "boundary.vtp", "surface.vtp", "surface.stl"})
    EXPECT_TRUE(bytes_of(scratch / "out" / name) == bytes_of(scratch / "again" / name)) << name;
}

TEST_F(Build, CityAndMeshInTwoStepsGiveTheSameMesh) {
  Config config = city(SynthKind::kBlocks, 0, 320, 4);
  run_build(config);
  Config first = config;
  first.out = (scratch / "city").string();
  run_city(first);
  Config second;
  second.city = (scratch / "city/city.city.json").string();
  second.dtm = {(scratch / "city/dtm.tif").string()};
  second.out = (scratch / "mesh").string();
  // Benchmarks add up the steps of 3; reading is none of these.
  std::set<std::string> meshing;
  for (const StepTime& step : run_mesh(second).steps)
    if (step.id == "3.1") meshing.insert(step.name);
  EXPECT_EQ(meshing, std::set<std::string>{"ground mesh"});
  for (const char* name : {"city_raw.city.json", "city.city.json", "dtm.tif", "buildings.gpkg"})
    EXPECT_TRUE(bytes_of(scratch / "out" / name) == bytes_of(scratch / "city" / name)) << name;
  for (const char* name : {"volume.vtu", "boundary.vtp", "surface.vtp", "surface.stl"})
    EXPECT_TRUE(bytes_of(scratch / "out" / name) == bytes_of(scratch / "mesh" / name)) << name;
  EXPECT_FALSE(fs::exists(scratch / "city/volume.vtu"));
}

/// What `mesh` says to unusable input; nothing is written.
std::string refusal_of(const Config& mesh) {
  try {
    run_mesh(mesh);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput);
    EXPECT_FALSE(fs::exists(mesh.out));
    return error.what();
  }
  return "";
}

TEST_F(Build, MeshRefusesCitiesAndTerrainsThatDoNotFit) {
  Config config = city(SynthKind::kBlocks, 0, 320, 4);
  run_city(config);
  const auto refused = [&](const std::string& city, const std::string& dtm,
                           std::vector<double> bounds = {}) {
    Config mesh;
    mesh.city = city;
    mesh.dtm = {dtm};
    mesh.bounds = std::move(bounds);
    mesh.out = (scratch / "mesh").string();
    return refusal_of(mesh);
  };
  const std::string out = config.out;
  EXPECT_NE(refused(out + "/city_raw.city.json", out + "/dtm.tif").find("mesh the city.city.json"),
            std::string::npos);
  EXPECT_NE(refused(out + "/city.city.json", out + "/dtm.tif", {319000, 6396000, 321000, 6398000})
                .find("does not cover the domain"),
            std::string::npos);
  TETROPOLIS_REQUIRE_DATA(elsewhere, "alexandria_dsm_dtm/dtm.tif");
  EXPECT_NE(refused(out + "/city.city.json", elsewhere.string()).find("EPSG:26918"),
            std::string::npos);
}

TEST_F(Build, MeshRefusesWhatIsNotInMetres) {
  Config config = city(SynthKind::kRandom, 30, 250, 6);
  run_city(config);
  const std::string model = bytes_of(scratch / "out/city.city.json");
  const RasterInput terrain = read_raster(scratch / "out/dtm.tif", {0, 0});
  const auto refusal = [&](const std::string& city_crs, const std::string& terrain_crs,
                           const std::string& unit = "") {
    // The model says its system twice.
    std::string text = std::regex_replace(
        model, std::regex("\"(https://www.opengis.net/def/crs/EPSG/0/|EPSG:)3006\""),
        "\"" + city_crs + "\"");
    std::ofstream(scratch / "foreign.city.json") << text;
    write_raster(scratch / "foreign.tif", terrain.raster, {0, 0}, terrain_crs, terrain.domain);
    Config mesh;
    mesh.city = (scratch / "foreign.city.json").string();
    mesh.dtm = {(scratch / "foreign.tif").string()};
    if (!unit.empty()) {
      mesh.dtm = {(scratch / "foreign.vrt").string()};
      const Raster& r = terrain.raster;
      std::ofstream(mesh.dtm.front()) << fmt::format(
          "<VRTDataset rasterXSize=\"{0}\" rasterYSize=\"{1}\"><SRS>{6}</SRS><GeoTransform>{2}, "
          "{3}, 0, {4}, 0, "
          "-{3}</GeoTransform><VRTRasterBand dataType=\"Float64\" band=\"1\"><UnitType>{5}"
          "</UnitType><SimpleSource><SourceFilename relativeToVRT=\"1\">foreign.tif"
          "</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand>"
          "</VRTDataset>",
          r.nx, r.ny, r.x0 - r.step / 2, r.step, r.y0 + (r.ny - 0.5) * r.step, unit, terrain_crs);
    }
    mesh.out = (scratch / "mesh").string();
    return refusal_of(mesh);
  };
  const auto says = [](const std::string& message, const char* file, const char* what) {
    return message.find(file) != std::string::npos && message.find(what) != std::string::npos;
  };
  std::string said = refusal("EPSG:4326", "EPSG:4326");
  EXPECT_TRUE(says(said, "foreign.city.json", "coordinates are degrees")) << said;
  said = refusal("EPSG:2263", "EPSG:2263");
  EXPECT_TRUE(says(said, "foreign.city.json", "in units of 0.3048")) << said;
  said = refusal("", "EPSG:2263");
  EXPECT_TRUE(says(said, "foreign.tif", "in units of 0.3048")) << said;
  EXPECT_EQ(refusal("EPSG:3006", "EPSG:3006"), "");
  fs::remove_all(scratch / "mesh");
  // A model without a system is in that of its terrain.
  EXPECT_EQ(refusal("", "EPSG:3006"), "");
  EXPECT_NE(bytes_of(scratch / "mesh/report.json").find("\"crs\": \"EPSG:3006\""),
            std::string::npos);
  for (const CheckedFile& file : check_path(scratch / "mesh", std::nullopt))
    EXPECT_TRUE(file.violations.empty()) << file.name << ": " << file.violations[0].what;
  fs::remove_all(scratch / "mesh");
  said = refusal("EPSG:3006+5715", "EPSG:3006");
  EXPECT_TRUE(says(said, "foreign.city.json", "depths instead of heights")) << said;
  // GDAL gives the band of a terrain in depths the unit of its system, without the direction.
  said = refusal("EPSG:3006", "EPSG:3006+5715", "metre");
  EXPECT_TRUE(says(said, "foreign.vrt", "counted downwards")) << said;
  // Heights in feet: of a compound system of the model, and of the raster's band.
  said = refusal("EPSG:3006+6360", "EPSG:3006");
  EXPECT_TRUE(says(said, "foreign.city.json", "heights in units of 0.3048")) << said;
  for (const auto& [unit, metres] :
       {std::pair{"ft", "0.3048"}, {"US survey foot", "0.3048006"}, {"cm", "0.01"}}) {
    said = refusal("EPSG:3006", "EPSG:3006", unit);
    EXPECT_TRUE(says(said, "foreign.vrt", "heights are in units of")) << said;
    EXPECT_TRUE(says(said, "foreign.vrt", metres)) << said;
  }
  EXPECT_EQ(refusal("EPSG:3006", "EPSG:3006", "metre"), "");
}

TEST_F(Build, MeshTakesTheDomainOfTheCityModel) {
  Config config = city(SynthKind::kRandom, 30, 250, 6);
  run_city(config);
  const CityModel model = read_city(scratch / "out/city.city.json");
  const Bounds2 domain = model.domain.moved(model.origin).bounds();
  const RasterInput terrain = read_raster(scratch / "out/dtm.tif", {0, 0});
  const Bounds2 other{domain.xmin - 20, domain.ymin, domain.xmax + 5, domain.ymax + 9};
  write_raster(scratch / "other.tif", terrain.raster, {0, 0}, "EPSG:3006", other);
  Config mesh;
  mesh.city = (scratch / "out/city.city.json").string();
  mesh.dtm = {(scratch / "other.tif").string()};
  mesh.out = (scratch / "mesh").string();
  const Bounds2 found = run_mesh(mesh).domain;
  EXPECT_EQ((std::array{found.xmin, found.ymin, found.xmax, found.ymax}),
            (std::array{domain.xmin, domain.ymin, domain.xmax, domain.ymax}));
}

TEST_F(Build, MeshRefusesHeightsThatAreNone) {
  Config config = city(SynthKind::kRandom, 30, 250, 6);
  run_city(config);
  std::string text = bytes_of(scratch / "out/city.city.json");
  text = std::regex_replace(text, std::regex("\"h_roof\":[0-9.e+-]+"), "\"h_roof\":100000",
                            std::regex_constants::format_first_only);
  std::ofstream(scratch / "tall.city.json") << text;
  Config mesh;
  mesh.city = (scratch / "tall.city.json").string();
  mesh.dtm = {(scratch / "out/dtm.tif").string()};
  mesh.out = (scratch / "mesh").string();
  const std::string said = refusal_of(mesh);
  EXPECT_NE(said.find("tall.city.json: building b0 (feature "), std::string::npos) << said;
  EXPECT_NE(said.find("to 100000 m"), std::string::npos) << said;
}

TEST_F(Build, ResultsOfAnEarlierRunAreNotMixedWithNewOnes) {
  Config config = city(SynthKind::kRandom, 30, 250, 6);
  run_build(config);
  std::ofstream(scratch / "out/notes.txt") << "mine";
  run_city(config);
  EXPECT_FALSE(fs::exists(scratch / "out/volume.vtu"));
  EXPECT_FALSE(fs::exists(scratch / "out/surface.stl"));
  EXPECT_TRUE(fs::exists(scratch / "out/city.city.json"));
  EXPECT_TRUE(fs::exists(scratch / "out/notes.txt"));
}

/// With a margin of 50 m every point is near many buildings, and in the list of each.
TEST_F(Build, TheMemoryOfAWideMarginIsTakenIntoAccount) {
  constexpr double kLimit = 1e9;
  EXPECT_NO_THROW(require_points_fit({1e7, 0, 1}, kLimit));
  EXPECT_NO_THROW(require_points_fit({1e6, 0, 50}, kLimit));
  const std::string message = testing::error_of([&] { require_points_fit({1e7, 0, 50}, kLimit); });
  EXPECT_NE(message.find("lower ground_margin"), std::string::npos) << message;
}

TEST_F(Build, AbsurdSizesAreRefusedBeforeTheWork) {
  Config config = city(SynthKind::kRandom, 30, 1000, 6);
  const auto refused = [&](const char* part) {
    RunHooks hooks;
    std::string last;
    hooks.step_begins = [&](const StepTime& step) { last = step.id; };
    const std::string message = testing::error_of([&] { run_build(config, hooks); });
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_FALSE(fs::exists(config.out));
    return last;
  };
  const Config good = config;
  config.layering = Layering::kUniform;
  config.layer_height = 1e-2;
  config.max_memory = "1T";
  EXPECT_EQ(refused("layers between the mean ground"), "3.2");
  config = good;
  config.domain_height = 1e5;
  config.max_memory = "1T";
  EXPECT_EQ(refused("layers between the mean ground"), "3.3");
  config = good;
  config.layer_height = 1e-9;
  EXPECT_EQ(refused("no mesh size is sure to fit"), "1.2");
  config = good;
  config.mesh_size = 0.05;  // a thousand million triangles
  EXPECT_EQ(refused("cells fit, with mesh_size"), "1.2");
  config = good;
  config.max_memory = "eight";
  EXPECT_EQ(refused("`max_memory`: 'eight' is not a size"), "");
  config.max_memory = "81M";
  EXPECT_EQ(refused("points fit: give smaller `bounds`"), "1.2");
  config = good;
  config.dtm_step = 0.01;  // some 600 million nodes
  config.max_memory = "4G";
  EXPECT_EQ(refused("raise dtm_step or max_memory"), "1.2");
  config = good;
  config.min_building_area = 1e6;
  EXPECT_EQ(refused("all 30 buildings were dropped"), "2.2");
}

TEST_F(Build, AbsoluteCoordinatesAreThoseOfTheReferenceSystem) {
  Config config = city(SynthKind::kRandom, 30, 250, 6);
  config.coordinates = Coordinates::kAbsolute;
  const Report report = run_build(config);
  expect_guarantees(config.out);
  EXPECT_GT(report.origin.y, 6e6);
}

TEST_F(Build, CompressedMeshesHoldTheGuaranteesToo) {
  Config config = city(SynthKind::kRandom, 30, 250, 6);
  run_build(config);
  const auto plain = fs::file_size(scratch / "out/volume.vtu");
  config.compression = Compression::kZlib;
  config.formats = {"vtu", "xdmf"};
  run_build(config);
  expect_guarantees(config.out);
  EXPECT_LT(2 * fs::file_size(scratch / "out/volume.vtu"), plain);
  EXPECT_LT(2 * fs::file_size(scratch / "out/volume.h5"), plain);
}

TEST_F(Build, FreeTopAndOtherSizesHoldTheGuaranteesToo) {
  Config config = city(SynthKind::kBlocks, 0, 300, 8);
  config.top = Top::kFree;
  config.mesh_size = 6;
  config.layer_height = 9;
  config.min_angle = 30;
  config.min_building_distance = 2.5;
  run_build(config);
  expect_guarantees(config.out);
}

TEST_F(Build, OfACountryAroundACityOnlyTheNumberIsKept) {
  Config config = city(SynthKind::kRandom, 20, 200, 9);
  ReadFootprintsOptions options;
  options.id_attribute = "id";
  const FootprintsInput here = read_footprints(config.footprints.front(), options);
  std::vector<Polygon> polygons;
  std::vector<std::string> ids;
  const auto add = [&](const std::string& file) {
    config.footprints = {(scratch / file).string()};
    write_footprints(config.footprints.front(), polygons, ids, {}, {}, here.crs);
  };
  for (const Footprint& feature : here.features) {
    polygons.push_back(feature.polygon);
    ids.push_back(feature.source_id);
  }
  config.bounds = {here.bounds.xmin - 20, here.bounds.ymin - 20, here.bounds.xmax - 50,
                   here.bounds.ymax + 20};
  add("city.gpkg");
  run_build(config);
  const fs::path alone = scratch / "alone";
  fs::rename(config.out, alone);
  // They come first, so that features of the city are read after the last that is listed.
  constexpr std::int64_t kListed = kMostListedBeyond, kMore = 50;
  std::vector<Polygon> country;
  std::vector<std::string> names;
  for (std::int64_t i = 0; i < kListed + kMore; ++i) {
    const double x = here.bounds.xmin + 1000 + 20.0 * static_cast<double>(i % 300);
    const double y = here.bounds.ymin + 20.0 * static_cast<double>(i / 300);
    country.push_back(Polygon{{{x, y}, {x + 9, y}, {x + 9, y + 9}, {x, y + 9}}, {}});
    names.push_back(fmt::format("far{}", i));
  }
  polygons.insert(polygons.begin(), country.begin(), country.end());
  ids.insert(ids.begin(), names.begin(), names.end());
  add("country.gpkg");
  const Report report = run_build(config);
  const FootprintAccount& account = report.city->account;
  EXPECT_EQ(account.features, std::ssize(polygons));
  EXPECT_EQ(account.unlisted, kMore);
  EXPECT_GE(account.of(DropCause::kOutside), kListed + kMore);
  EXPECT_EQ(account.kept + account.merged +
                std::accumulate(account.dropped.begin(), account.dropped.end(), std::int64_t{0}),
            account.features + account.further_parts);
  for (const char* name : {"volume.vtu", "boundary.vtp", "surface.stl", "dtm.tif"})
    EXPECT_EQ(bytes_of(fs::path(config.out) / name), bytes_of(alone / name)) << name;
  // The attributes are of another file, but not what became of the footprints.
  EXPECT_EQ(read_footprints(fs::path(config.out) / "buildings.gpkg", {.layer = "footprints"})
                .features.size(),
            read_footprints(alone / "buildings.gpkg", {.layer = "footprints"}).features.size());
  bool accounted = false;
  for (const CheckedFile& file : check_path(config.out, std::nullopt)) {
    for (const Violation& violation : file.violations)
      ADD_FAILURE() << file.name << ": " << violation.what << ": " << violation.first;
    for (const std::string& fact : file.facts)
      accounted =
          accounted || fact == fmt::format("all {} input features accounted for", polygons.size());
  }
  EXPECT_TRUE(accounted);
  // Who gives no bounds is told of them.
  config.bounds.clear();
  const Report whole = run_build(config);
  const auto told =
      std::find_if(whole.warnings.begin(), whole.warnings.end(),
                   [](const Warning& warning) { return warning.code == "footprints_outside"; });
  ASSERT_NE(told, whole.warnings.end());
  EXPECT_EQ(told->count, kListed + kMore);
  EXPECT_EQ(whole.city->account.unlisted, 0);
  EXPECT_NE(
      told->message.find(fmt::format("{:.10g},{:.10g}", whole.domain.xmin, whole.domain.ymin)),
      std::string::npos)
      << told->message;
  for (const Warning& warning : report.warnings) EXPECT_NE(warning.code, "footprints_outside");
}

TEST_F(Build, ClippedBuildingsStayClearOfTheBoundary) {
  Config config = city(SynthKind::kBlocks, 0, 320, 9);
  const double x = 319000, y = 6396000;
  config.bounds = {x + 60.5, y + 90, x + 231.25, y + 260};
  const Report dropped = run_build(config);
  expect_guarantees(config.out);
  config.boundary_buildings = BoundaryBuildings::kClip;
  const Report clipped = run_build(config);
  expect_guarantees(config.out);
  EXPECT_GT(clipped.city->flags.at("clipped"), 0);
  EXPECT_GT(clipped.city->raw_buildings, dropped.city->raw_buildings);
  EXPECT_EQ(clipped.domain.xmin, config.bounds[0]);
  EXPECT_EQ(clipped.domain.ymax, config.bounds[3]);
}

TEST_F(Build, TerrainAloneNeedsToBeAskedFor) {
  Config config = city(SynthKind::kBlocks, 0, 300, 10);
  config.bounds = {319000, 6396000, 319012, 6396012};  // the margin of the city
  EXPECT_THROW(run_build(config), Error);
  EXPECT_FALSE(fs::exists(config.out));
  config.terrain_only = true;
  const Report report = run_build(config);
  EXPECT_EQ(report.city->buildings, 0);
  expect_guarantees(config.out);
}

TEST_F(Build, StopsWhenAskedAndLeavesNothing) {
  const Config config = city(SynthKind::kRandom, 50, 250, 11);
  for (const char* last :
       {"read points", "terrain", "merge footprints", "ground mesh", "write meshes"}) {
    bool stop = false;
    RunHooks hooks;
    hooks.step_begins = [&](const StepTime& step) { stop = stop || step.name == last; };
    // In the middle of the step, not before the next.
    hooks.step_ends = [&](const StepTime& step) { EXPECT_FALSE(stop) << step.id << " went on"; };
    hooks.cancelled = [&] { return stop; };
    EXPECT_THROW(run_build(config, hooks), Cancelled) << last;
    EXPECT_TRUE(stop) << last;
    std::set<std::string> left;
    for (const auto& entry : fs::directory_iterator(scratch.path()))
      left.insert(entry.path().filename().string());
    EXPECT_EQ(left, (std::set<std::string>{"input"})) << last;
  }
}

TEST(Docs, NameThePatches) {
  std::string list;
  for (const PatchInfo& info : PatchTable())
    list += fmt::format("{}{} {}", list.empty() ? "Patches: " : ", ", static_cast<int>(info.patch),
                        info.name);
  const std::string text = bytes_of(std::string(TETROPOLIS_SOURCE) + "/docs/files.md");
  EXPECT_NE(text.find(list + ".\n"), std::string::npos) << list;
}

/// Keys of a report as docs/report.md writes them: "a.b[].c"; members of maps are left out.
void collect_keys(const nlohmann::json& value, const std::string& path,
                  std::set<std::string>& keys) {
  static const std::set<std::string> maps{
      "config",       "input.points_by_class",   "city.flags",
      "city.resorts", "city.roofs.parts_by_lod", "surface_mesh.faces_by_patch"};
  if (maps.contains(path)) {
    keys.insert(path);
  } else if (value.is_object()) {
    for (const auto& [key, member] : value.items())
      collect_keys(member, path.empty() ? key : path + "." + key, keys);
  } else if (value.is_array() && !value.empty() && value[0].is_object()) {
    for (const nlohmann::json& element : value) collect_keys(element, path + "[]", keys);
  } else if (value.is_primitive() || !value.empty()) {
    keys.insert(path);
  }
}

TEST_F(Build, EveryKeyOfTheReportIsDocumented) {
  std::set<std::string> documented;
  std::ifstream page(std::string(TETROPOLIS_SOURCE) + "/docs/report.md");
  for (std::string line; std::getline(page, line);)
    if (line.starts_with("| `")) documented.insert(line.substr(3, line.find('`', 3) - 3));
  Config config = city(SynthKind::kRandom, 12, 150, 4);
  config.mesh_size = 20;
  config.min_building_area = 60;
  run_build(config);
  std::ifstream file(scratch / "out/report.json");
  std::set<std::string> keys;
  collect_keys(nlohmann::json::parse(file), "", keys);
  EXPECT_GT(keys.size(), 60U);
  for (const std::string& key : keys) EXPECT_TRUE(documented.contains(key)) << key;
}

TEST(Documents, EveryWarningIsDocumented) {
  std::set<std::string> documented, given;
  std::ifstream page(std::string(TETROPOLIS_SOURCE) + "/docs/files.md");
  bool here = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("## ")) here = line == "## Warnings";
    if (here && line.starts_with("| `")) documented.insert(line.substr(3, line.find('`', 3) - 3));
  }
  const std::regex code(
      "(warnings(->|\\.)push_back\\(\\s*\\{|warnings = "
      "\\{\\s*\\{|Warning\\s*\\w*\\s*\\{|(warn|tell)\\()\\s*"
      "\"([a-z_]+)\"");
  for (const auto& file :
       fs::recursive_directory_iterator(std::string(TETROPOLIS_SOURCE) + "/src")) {
    if (file.path().extension() != ".cpp") continue;
    const std::string text = bytes_of(file.path());
    for (std::sregex_iterator match(text.begin(), text.end(), code), end; match != end; ++match)
      given.insert((*match)[4]);
  }
  EXPECT_GT(given.size(), 40U);
  EXPECT_EQ(documented, given);
}

TEST_F(Build, SynthWritesTheSameBytesForTheSameSeed) {
  for (const SynthKind kind : {SynthKind::kRandom, SynthKind::kBlocks}) {
    Config config;
    config.kind = kind;
    config.buildings = 100;
    config.size = 320;
    config.seed = 12;
    for (const char* name : {"one", "two", "other"}) {
      config.out = (scratch / name).string();
      config.threads = std::string(name) == "two" ? 2 : 1;
      if (std::string(name) == "other") config.seed = 13;
      run_synth(config);
    }
    for (const char* file : {"footprints.shp", "footprints.dbf", "points.laz"}) {
      EXPECT_TRUE(bytes_of(scratch / "one" / file) == bytes_of(scratch / "two" / file))
          << static_cast<int>(kind) << " " << file;
      if (std::string(file) == "footprints.dbf") continue;  // ids and heights may agree
      EXPECT_FALSE(bytes_of(scratch / "one" / file) == bytes_of(scratch / "other" / file))
          << static_cast<int>(kind) << " " << file;
    }
  }
}

}  // namespace
}  // namespace tetropolis
