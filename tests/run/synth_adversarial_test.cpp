// The files of a city with defects.
#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tetropolis/core/error.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/run/run.h"

#include "support/bytes.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;
using testing::TemporaryFolder;

Report synth(const fs::path& out, int seed, std::vector<std::string> defects,
             bool overwrite = false) {
  Config config;
  config.kind = SynthKind::kAdversarial;
  config.out = out.string();
  config.seed = seed;
  config.size = 150;
  config.point_density = 0.1;
  config.defects = std::move(defects);
  config.overwrite = overwrite;
  return run_synth(config);
}

std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    files[entry.path().filename().string()] = testing::bytes_of(entry.path());
  }
  return files;
}

TEST(SynthAdversarial, TheManifestTellsWhatIsThere) {
  const TemporaryFolder folder;
  const Report report = synth(folder / "a", 4, {"bow_tie", "null_shape", "tiles_overlap"});
  const auto files = contents(folder / "a");
  const auto manifest = nlohmann::json::parse(files.at("manifest.json"));
  std::set<std::string> listed{"manifest.json", "report.json"};
  for (const auto& name : manifest["files"]) listed.insert(name.get<std::string>());
  std::set<std::string> there;
  for (const auto& [name, text] : files) there.insert(name);
  EXPECT_EQ(there, listed);
  std::vector<std::string> defects, told;
  for (const auto& defect : manifest["defects"]) defects.push_back(defect["name"]);
  for (const Warning& warning : report.warnings) told.push_back(warning.code);
  EXPECT_EQ(told, defects);
  std::sort(defects.begin(), defects.end());
  EXPECT_EQ(defects, (std::vector<std::string>{"bow_tie", "null_shape", "tiles_overlap"}));
  EXPECT_FALSE(manifest["refusable"].get<bool>());

  ReadFootprintsOptions options;
  options.id_attribute = "id";
  const FootprintsInput input =
      read_footprints(folder / "a" / manifest["footprints"].get<std::string>(), options);
  std::set<std::string> ids, named;
  const auto plain = [](const std::string& id) { return id.substr(0, id.find('#')); };
  for (const Footprint& feature : input.features) ids.insert(plain(feature.source_id));
  for (const Dropped& feature : input.dropped) ids.insert(plain(feature.source_id));
  for (const auto& id : manifest["ids"]) named.insert(id.get<std::string>());
  EXPECT_EQ(ids, named);
  EXPECT_EQ(input.features_read, static_cast<std::int64_t>(named.size()));
  const std::vector<std::string> arguments{(folder / "a").string()};
  const PointsInput points = read_points(expand_point_paths(arguments));
  EXPECT_EQ(points.points_read, report.input->points_read);
}

TEST(SynthAdversarial, ASecondCityInTheFolderLeavesNothingOfTheFirst) {
  const TemporaryFolder folder;
  std::set<std::string> formats;
  for (const int seed : {1, 2, 3, 4}) {
    // Tiles and formats come and go.
    synth(folder / "both", seed, {seed % 2 == 0 ? "tiles_gap" : "points_twice"});
    synth(folder / ("only" + std::to_string(seed)), seed,
          {seed % 2 == 0 ? "tiles_gap" : "points_twice"});
    auto both = contents(folder / "both");
    auto only = contents(folder / ("only" + std::to_string(seed)));
    both.erase("report.json");  // Times and the folder's name are in it.
    only.erase("report.json");
    EXPECT_EQ(both, only) << "seed " << seed;
    for (const auto& [name, text] : only) formats.insert(fs::path(name).extension().string());
  }
  EXPECT_TRUE(formats.contains(".shp") && formats.contains(".geojson"));
}

TEST(SynthAdversarial, CitiesOfAllKindsReplaceEachOther) {
  const TemporaryFolder folder;
  constexpr auto kRandom = SynthKind::kRandom, kBlocks = SynthKind::kBlocks,
                 kAdversarial = SynthKind::kAdversarial;
  const auto synth_kind = [&](SynthKind kind, const std::string& name) {
    Config config;
    config.kind = kind;
    config.out = (folder / name).string();
    config.size = kind == kBlocks ? 300 : 100;
    config.point_density = 0.1;
    if (kind == kAdversarial) config.defects = {"tiles_gap"};
    run_synth(config);
    auto files = contents(folder / name);
    files.erase("report.json");
    return files;
  };
  std::map<SynthKind, std::map<std::string, std::string>> alone;
  for (const SynthKind kind : {kRandom, kBlocks, kAdversarial})
    alone[kind] = synth_kind(kind, "alone" + std::to_string(static_cast<int>(kind)));
  EXPECT_FALSE(alone[kAdversarial].contains("points.laz"));
  fs::create_directory(folder / "mixed");
  std::ofstream(folder / "mixed" / "mine.laz") << "mine";
  for (const SynthKind kind : {kRandom, kAdversarial, kBlocks, kAdversarial, kRandom, kBlocks}) {
    auto files = synth_kind(kind, "mixed");
    EXPECT_EQ(files.erase("mine.laz"), 1U);
    EXPECT_EQ(files, alone[kind]) << static_cast<int>(kind);
  }
}

TEST(SynthAdversarial, WithoutAReportOfASyntheticCityNothingIsTaken) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "a");
  for (const char* name : {"points.laz", "footprints.prj"})
    std::ofstream(folder / "a" / name) << "x";
  std::ofstream(folder / "a" / "report.json")
      << R"({"command": "city", "config": {"kind": "random"}})";
  const auto before = contents(folder / "a");
  EXPECT_THROW(synth(folder / "a", 2, {"tiles_gap"}), Error);
  EXPECT_EQ(contents(folder / "a"), before);
  synth(folder / "a", 2, {"tiles_gap"}, true);
  EXPECT_EQ(contents(folder / "a").at("points.laz"), "x");  // the city has others
}

TEST(SynthAdversarial, FilesOfTheUserStay) {
  const TemporaryFolder folder;
  synth(folder / "a", 1, {"tiles_gap"});
  std::ofstream(folder / "a" / "mine.laz") << "mine";
  std::ofstream(folder / "outside.txt") << "mine";
  auto manifest = nlohmann::json::parse(contents(folder / "a").at("manifest.json"));
  manifest["files"].push_back("../outside.txt");
  manifest["files"].push_back(7);
  std::ofstream(folder / "a" / "manifest.json") << manifest.dump();
  synth(folder / "a", 1, {"points_twice"});
  EXPECT_TRUE(fs::exists(folder / "a" / "mine.laz"));
  EXPECT_TRUE(fs::exists(folder / "outside.txt"));
  EXPECT_FALSE(fs::exists(folder / "a" / "points_2.laz"));
}

TEST(SynthAdversarial, UnknownDefectsLeaveNothing) {
  const TemporaryFolder folder;
  EXPECT_THROW(synth(folder / "a", 1, {"unicorn"}), Error);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace tetropolis
