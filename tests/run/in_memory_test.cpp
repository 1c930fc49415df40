// The verbs in memory make what the commands write; a report survives its file.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tetropolis/core/error.h"
#include "tetropolis/io/mesh/vtk.h"
#include "tetropolis/pipeline/build_city.h"
#include "tetropolis/pipeline/mesh_city.h"
#include "tetropolis/pipeline/meshable.h"
#include "tetropolis/run/report.h"
#include "tetropolis/run/run.h"

#include "support/bytes.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::bytes_of;
using Json = nlohmann::json;

class InMemory : public ::testing::Test {
 protected:
  InMemory() {
    Config synth;
    synth.kind = SynthKind::kRandom;
    synth.buildings = 12;
    synth.size = 150;
    synth.seed = 4;
    synth.relief = 10;
    synth.out = (scratch / "input").string();
    const Report made = run_synth(synth);
    bounds = made.domain;
    bounds = {bounds.xmin + 5, bounds.ymin + 5, bounds.xmax - 5, bounds.ymax - 5};
  }
  FootprintsInput footprints() const {
    return read_footprints(scratch / "input/footprints.shp", {.id_attribute = "id"});
  }
  PointsInput points() const {
    const std::vector<std::filesystem::path> files{scratch / "input/points.laz"};
    return read_points(files, {.crop = bounds,
                               .origin = Point2{std::floor(bounds.xmin), std::floor(bounds.ymin)}});
  }

  testing::TemporaryFolder scratch;
  Bounds2 bounds;
};

TEST_F(InMemory, VerbsMakeTheBytesOfTheCommand) {
  Config config;
  config.footprints = (scratch / "input/footprints.shp").string();
  config.points = {(scratch / "input/points.laz").string()};
  config.id_attribute = "id";
  config.bounds = {bounds.xmin, bounds.ymin, bounds.xmax, bounds.ymax};
  config.out = (scratch / "out").string();
  const Report report = run_build(config);

  const BuiltCity built = build_city(points(), footprints(), {.bounds = bounds});
  const CityMesh mesh = mesh_city(built.city, built.terrain);
  write_vtu(scratch / "volume.vtu", mesh.volume, mesh.placement);
  write_vtp(scratch / "boundary.vtp", mesh.boundary, mesh.placement);
  for (const char* name : {"volume.vtu", "boundary.vtp"}) {
    ASSERT_FALSE(bytes_of(scratch / name).empty());
    EXPECT_TRUE(bytes_of(scratch / name) == bytes_of(scratch / "out" / name)) << name;
  }
  EXPECT_EQ(built.facts.buildings, report.city->buildings);
  EXPECT_EQ(mesh.volume_facts.cells, report.volume_mesh->cells);
  EXPECT_EQ(mesh.volume_facts.dihedral_min, report.volume_mesh->dihedral_min);
}

TEST_F(InMemory, PointsOfArraysNeedNoCounts) {
  PointsInput bare;
  PointsInput read = points();
  bare.points = std::move(read.points);
  bare.origin = read.origin;
  const BuiltCity with = build_city(points(), footprints(), {.bounds = bounds});
  const BuiltCity without = build_city(std::move(bare), footprints(), {.bounds = bounds});
  EXPECT_EQ(with.terrain.values, without.terrain.values);
  ASSERT_EQ(with.city.buildings.size(), without.city.buildings.size());
  for (std::size_t b = 0; b < with.city.buildings.size(); ++b)
    EXPECT_EQ(with.city.buildings[b].h_roof, without.city.buildings[b].h_roof);
}

TEST_F(InMemory, EditedCitiesMeshAgain) {
  BuiltCity built = build_city(points(), footprints(), {.bounds = bounds});
  ASSERT_FALSE(built.city.buildings.empty());
  const double volume = mesh_city(built.city, built.terrain).volume_facts.volume;
  Building& edited = built.city.buildings.front();
  edited.h_roof += 5;
  const double taller = mesh_city(built.city, built.terrain).volume_facts.volume;
  EXPECT_LT(taller, volume);
  EXPECT_EQ(require_meshable(built.city, 1, "city"), built.facts.min_clearance);
  // Moved out of the domain it cannot be meshed, which is told by name.
  for (Point2& p : edited.footprint.outer) p.x += bounds.width();
  try {
    require_meshable(built.city, 1, "city");
    FAIL() << "meshable outside the domain";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(edited.id), std::string::npos) << error.what();
  }
  EXPECT_EQ(drop_unmeshable(built.city, 1), edited.source_ids.size());
}

TEST_F(InMemory, FootprintsInAnotherSystemAreRefused) {
  FootprintsInput elsewhere = footprints();
  PointsInput here = points();
  ASSERT_FALSE(here.crs.empty());
  elsewhere.crs = "EPSG:28992";
  EXPECT_THROW(build_city(std::move(here), std::move(elsewhere), {.bounds = bounds}), Error);
}

TEST_F(InMemory, ReportSurvivesItsFile) {
  Config config;
  config.footprints = (scratch / "input/footprints.shp").string();
  config.points = {(scratch / "input/points.laz").string()};
  config.min_building_area = 60;  // drops some
  config.layering = Layering::kUniform;
  config.mesh_size = 20;
  config.out = (scratch / "out").string();
  run_build(config);
  const std::string text = bytes_of(scratch / "out/report.json");
  const ReadReport read = report_from_json(text, "report");
  EXPECT_TRUE(read.missing.empty());
  // All but causes of the worst cells, which nobody reads back.
  Json written = Json::parse(text), again = Json::parse(to_json(read.report));
  for (Json* json : {&written, &again})
    for (Json& cell : (*json)["volume_mesh"]["worst_cells"]) cell.erase("cause");
  EXPECT_EQ(written, again);

  // Every member that goes is missed, whatever its depth; those of maps and lists are data.
  int removed = 0;
  const Json flat = written.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    const Json::json_pointer place(pointer);
    const std::string parent = place.parent_pointer().to_string();
    const bool is_data = !written[place.parent_pointer()].is_object() ||
                         parent == "/city/resorts" || parent == "/city/flags" ||
                         parent == "/input/points_by_class" ||
                         parent == "/surface_mesh/faces_by_patch" || pointer.find("/0/") == 0;
    if (is_data) continue;
    Json less = Json::parse(text);
    less[place.parent_pointer()].erase(place.back());
    if (pointer == "/command") {
      EXPECT_THROW(report_from_json(less.dump(), "report"), Error);
      continue;
    }
    const ReadReport other = report_from_json(less.dump(), "report");
    EXPECT_EQ(other.missing, std::vector<std::string>{pointer});
    ++removed;
  }
  EXPECT_GT(removed, 100);
}

TEST(Report, OtherFilesAreNotReports) {
  for (const char* text : {"", "[]", "7", "{\"command\": 7}", "{\"steps\": [3]}"})
    EXPECT_THROW(report_from_json(text, "report"), Error) << text;
}

}  // namespace
}  // namespace tetropolis
