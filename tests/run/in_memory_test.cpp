// The verbs in memory make what the commands write; a report survives its file.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tetropolis/city/raise_roofs.h"
#include "tetropolis/core/error.h"
#include "tetropolis/io/mesh/vtk.h"
#include "tetropolis/pipeline/build_city.h"
#include "tetropolis/pipeline/mesh_city.h"
#include "tetropolis/pipeline/meshable.h"
#include "tetropolis/run/report.h"
#include "tetropolis/run/run.h"

#include "support/bytes.h"
#include "support/errors.h"
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
  config.footprints = {(scratch / "input/footprints.shp").string()};
  config.points = {(scratch / "input/points.laz").string()};
  config.id_attribute = "id";
  config.bounds = {bounds.xmin, bounds.ymin, bounds.xmax, bounds.ymax};
  config.out = (scratch / "out").string();
  const Report report = run_build(config);

  const BuiltCity built = build_city(points(), footprints(), {.bounds = bounds});
  const CityMesh mesh = mesh_city(built.city, built.terrain);
  write_vtu(scratch / "volume.vtu", mesh.volume, mesh.placement, {}, Compression::kNone,
            built.city.buildings);
  write_vtp(scratch / "boundary.vtp", mesh.boundary, mesh.placement, Compression::kNone,
            built.city.buildings);
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

TEST_F(InMemory, AccountCountsEveryFootprintOnce) {
  // So narrow that the boundary cuts some and leaves others outside.
  const Bounds2 narrow{bounds.xmin, bounds.ymin, (bounds.xmin + bounds.xmax) / 2, bounds.ymax};
  for (const BoundaryBuildings boundary : {BoundaryBuildings::kDrop, BoundaryBuildings::kClip}) {
    BuildCityOptions options;
    options.bounds = narrow;
    options.boundary_buildings = boundary;
    options.simplify.min_area = 60;
    FootprintsInput input = footprints();
    input.dropped.push_back({{"lost", "no geometry"}, -1});
    ++input.features_read;
    const BuiltCity built = build_city(points(), std::move(input), options);
    const FootprintAccount& account = built.facts.account;
    EXPECT_EQ(account.features, built.input.footprints_read);
    EXPECT_EQ(account.features + account.further_parts,
              account.kept + account.merged +
                  std::accumulate(account.dropped.begin(), account.dropped.end(), std::int64_t{0}));
    std::map<DropCause, std::int64_t> dropped;
    for (const Dropped& feature : built.city.dropped) ++dropped[feature.cause];
    EXPECT_EQ(account.of(DropCause::kUnusable), 1);
    EXPECT_GT(account.of(DropCause::kOutside), 0);
    EXPECT_EQ(account.of(DropCause::kOutside), dropped[DropCause::kOutside]);
    EXPECT_EQ(account.of(DropCause::kBoundary), dropped[DropCause::kBoundary]);
    EXPECT_EQ(account.of(DropCause::kBoundary) > 0, boundary == BoundaryBuildings::kDrop);
    EXPECT_EQ(account.of(DropCause::kTooSmall), dropped[DropCause::kTooSmall]);
    std::int64_t alone = 0;
    for (const Building& building : built.city.buildings)
      alone += building.source_ids.size() == 1 ? 1 : 0;
    EXPECT_EQ(account.kept, alone);
    const bool warned =
        std::any_of(built.warnings.begin(), built.warnings.end(),
                    [](const Warning& warning) { return warning.code == "boundary_loss"; });
    EXPECT_EQ(warned, boundary == BoundaryBuildings::kDrop);
    EXPECT_EQ(built.facts.area_at_boundary > 0, boundary == BoundaryBuildings::kDrop);
  }
}

TEST(Account, IsOneLine) {
  CityFacts facts;
  BuildCityOptions options;
  EXPECT_EQ(account_in_words(facts, options), "");
  facts.buildings = 46;
  facts.merged_groups = 34;
  facts.account = {.features = 800, .kept = 12, .merged = 751};
  facts.account.of(DropCause::kBoundary) = 22;
  facts.account.of(DropCause::kTooSmall) = 15;
  EXPECT_EQ(
      account_in_words(facts, options),
      "800 footprints make 46 buildings: 751 in 34 blocks, closer than 1 m, 12 alone; dropped: "
      "22 at the boundary (`boundary_buildings` clip keeps them), 15 smaller than 15 m2");
  options.boundary_buildings = BoundaryBuildings::kClip;
  facts.buildings = 1;
  facts.account = {.features = 1, .further_parts = 5, .kept = 1};
  for (const DropCause cause : {DropCause::kUnusable, DropCause::kOutside, DropCause::kBoundary,
                                DropCause::kTooSmall, DropCause::kTooNarrow})
    facts.account.of(cause) = 1;
  EXPECT_EQ(account_in_words(facts, options),
            "1 footprint with 6 polygons makes 1 building: 1 alone; dropped: 1 at the boundary, 1 "
            "outside the domain, 1 smaller than 15 m2, 1 narrower than 1 m, 1 without a usable "
            "outline");
}

TEST_F(InMemory, HeightsAreWholeMillimetres) {
  const BuiltCity built = build_city(points(), footprints(), {.bounds = bounds});
  for (const CityModel* model : {&built.raw, &built.city})
    for (const Building& building : model->buildings)
      for (const double height : {building.h_ground, building.h_roof})
        EXPECT_EQ(height, std::stod(fmt::format("{:.3f}", height))) << building.id;
}

TEST_F(InMemory, EditedCitiesMeshAgain) {
  BuiltCity built = build_city(points(), footprints(), {.bounds = bounds});
  ASSERT_FALSE(built.city.buildings.empty());
  const double volume = mesh_city(built.city, built.terrain).volume_facts.volume;
  Building& edited = built.city.buildings.front();
  raise_roof(edited, 5);
  const double taller = mesh_city(built.city, built.terrain).volume_facts.volume;
  EXPECT_LT(taller, volume);
  EXPECT_EQ(require_meshable(built.city, 1, "city"), built.facts.min_clearance);
  // Moved out of the domain it cannot be meshed, which is told by name.
  for (Point2& p : edited.footprint.outer) p.x += bounds.width();
  const std::string message = testing::error_of([&] { require_meshable(built.city, 1, "city"); });
  EXPECT_NE(message.find(edited.id), std::string::npos) << message;
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
  config.footprints = {(scratch / "input/footprints.shp").string()};
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
                         parent == "/city/roofs/parts_by_lod" ||
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
