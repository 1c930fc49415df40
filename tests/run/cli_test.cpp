// The program from outside: exit codes, one clear line per error, nothing left behind.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "tetropolis/io/las/las.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/run/config.h"

#include "io/deferred/library_names.h"
#include "support/bytes.h"
#include "support/sanitized.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;
using Json = nlohmann::json;

struct Outcome {
  int code = -1;
  std::string out;
  std::string err;
};

class Cli : public ::testing::Test {
 protected:
  /// Runs the program in the scratch folder. `arguments` are for the shell.
  Outcome run(const std::string& arguments) {
    return shell("'" TETROPOLIS_PROGRAM "' " + arguments);
  }

  Outcome shell(const std::string& script) {
    const fs::path streams = logs.path();
    const std::string command = "( cd '" + scratch.path().string() + "' && " + script + " ) >'" +
                                (streams / "out").string() + "' 2>'" + (streams / "err").string() +
                                "'";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            bytes_of(streams / "out"), bytes_of(streams / "err")};
  }

  /// A small city in input/.
  void synth(const std::string& options = "--kind blocks --size 300") {
    ASSERT_EQ(run("synth --quiet --out input " + options).code, 0);
  }

  std::set<std::string> left() {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(scratch.path()))
      names.insert(entry.path().filename().string());
    return names;
  }

  /// With --quiet, an error is exactly one line that begins with the program's name and contains
  /// `part`; no file or folder is new.
  void expect_error(const std::string& arguments, int code, const std::string& part) {
    SCOPED_TRACE(arguments);
    const auto before = left();
    const Outcome outcome = run(arguments + " --quiet");
    EXPECT_EQ(outcome.code, code);
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_TRUE(outcome.err.starts_with("tetropolis: ")) << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    EXPECT_EQ(left(), before);
  }

  testing::TemporaryFolder scratch;
  testing::TemporaryFolder logs;
};

TEST_F(Cli, BuildsChecksAndTells) {
  synth();
  const Outcome built = run("build --footprints input/footprints.shp --points input --out result");
  EXPECT_EQ(built.code, 0) << built.err;
  EXPECT_EQ(built.out, "");
  EXPECT_NE(built.err.find("0 inverted"), std::string::npos);
  EXPECT_EQ(built.err.find('\r'), std::string::npos);  // no progress bar off a terminal
  const Outcome checked = run("check result");
  EXPECT_EQ(checked.code, 0) << checked.err;
  EXPECT_NE(checked.out.find("every guarantee holds"), std::string::npos);
  EXPECT_EQ(checked.out.find("not checked"), std::string::npos);
  for (const char* file : {"volume.vtu", "boundary.vtp", "city.city.json", "city_raw.city.json"}) {
    const Outcome alone = run(std::string("check result/") + file);
    EXPECT_EQ(alone.code, 0) << file;
    EXPECT_NE(alone.out.find("\n  not checked: "), std::string::npos) << alone.out;
    EXPECT_NE(alone.out.find("\nwhat was checked holds"), std::string::npos) << alone.out;
    EXPECT_EQ(alone.out.find("every guarantee holds"), std::string::npos) << alone.out;
  }
  const Outcome info =
      run("info input/points.laz input/footprints.shp result/city.city.json result/dtm.tif "
          "result/volume.vtu result/boundary.vtp");
  EXPECT_EQ(info.code, 0) << info.err;
  for (const char* part :
       {"class 6:", "features:", "EPSG:3006", "buildings:", "pixels", "tets:", "wall:"})
    EXPECT_NE(info.out.find(part), std::string::npos) << part;
}

TEST_F(Cli, WhatTheSystemRefusesIsToldWithItsNameAndReason) {
  fs::create_symlink("loop.laz", scratch / "loop.laz");
  expect_error("city --footprints loop.laz --points loop.laz --out result", 3,
               "loop.laz: cannot be opened: Too many levels of symbolic links");
  if (fs::exists("/proc/self/mem"))
    expect_error("city --config /proc/self/mem", 2,
                 "/proc/self/mem: cannot be opened: Input/output error");
}

/// Whatever the way the inputs are named; and a mesh made there later does not read them at all.
TEST_F(Cli, WhatSynthWroteStaysWhereModelsAreMadeBesideIt) {
  const std::set<std::string> data{"footprints.dbf", "footprints.prj", "footprints.shp",
                                   "footprints.shx", "footprints.cpg", "points.laz"};
  for (const auto& [inputs, code] :
       {std::pair{"--footprints input/footprints.shp --points input/points.laz", 0},
        {"--footprints input/footprints.dbf --points input", 0},
        {"--footprints input --points 'input/p*.laz'", 0},
        {"--footprints input --points 'input/*'", 3},  // one of them is no cloud
        {"--footprints input --points 'input/p*.laz' --bounds 0,0,1,1", 3}}) {
    SCOPED_TRACE(inputs);
    synth();
    std::map<std::string, std::string> before;
    for (const std::string& name : data) before[name] = bytes_of(scratch / "input" / name);
    EXPECT_EQ(run(std::string("build --quiet --out input ") + inputs).code, code);
    EXPECT_EQ(run("mesh --quiet --city input/city.city.json --dtm input/dtm.tif --out input").code,
              code);
    for (const std::string& name : data)
      EXPECT_EQ(bytes_of(scratch / "input" / name), before[name]) << name;
  }
  synth();
  ASSERT_EQ(run("build --quiet input/footprints.shp input/points.laz input").code, 0);
  ASSERT_TRUE(fs::exists(scratch / "input/volume.vtu"));
  // Another city there replaces it, and what was made of it.
  ASSERT_EQ(run("synth --quiet --out input --kind adversarial --seed 5 --size 250").code, 0);
  EXPECT_FALSE(fs::exists(scratch / "input/footprints.dbf"));
  EXPECT_FALSE(fs::exists(scratch / "input/volume.vtu"));
  EXPECT_TRUE(fs::exists(scratch / "input/footprints.geojson"));
}

/// A mesh that fits takes no more memory than it may, and has about as many cells as were told.
TEST_F(Cli, TheMeshSizeThatARefusalNamesFits) {
  synth("--kind blocks --buildings 60 --size 600 --seed 20");
  const std::string arguments =
      "build --quiet --footprints input/footprints.shp --points input --out result --max-memory ";
  for (const auto& [limit, layering] :
       {std::pair{125, "graded"}, std::pair{150, "uniform"}, std::pair{300, "graded"},
        std::pair{200, "graded --far-size 40 --ground-size 3"},
        std::pair{250, "graded --refine 100,100,300,300:3"}}) {
    SCOPED_TRACE(limit);
    if (TETROPOLIS_SANITIZED && limit == 300) continue;  // a minute, nothing new
    const std::string limited = arguments + std::to_string(limit) + "M --layering " + layering;
    const Outcome refused = run(limited + " --mesh-size 1.5");
    EXPECT_EQ(refused.code, 2);
    const std::size_t at = refused.err.find("fit, with --mesh-size ");
    ASSERT_NE(at, std::string::npos) << refused.err;
    const double told = std::stod(refused.err.substr(refused.err.find("; about ") + 8));
    const double size = std::stod(refused.err.substr(at + 22));
    ASSERT_EQ(run(limited + " --mesh-size " + std::to_string(size)).code, 0);
    const Json report = Json::parse(bytes_of(scratch / "result/report.json"));
    const double cells = report["volume_mesh"]["cells"];
    EXPECT_LT(cells, 1.4 * told) << refused.err;
    EXPECT_GT(cells, told / 2.5) << refused.err;
    if (!TETROPOLIS_SANITIZED) {
      EXPECT_LE(report["peak_rss_bytes"].get<double>(), 1e6 * limit);
    }
  }
}

TEST_F(Cli, RenderDrawsWhateverTheProgramWrites) {
  synth();
  ASSERT_EQ(run("build input/footprints.shp input city --quiet --formats vtu,xdmf").code, 0);
  ASSERT_EQ(run("city input/footprints.shp input model --quiet").code, 0);
  const std::string size = " -o picture.png --width 320 --height 200";
  std::map<std::string, std::string> drawn;
  for (const char* what :
       {"city", "city --view plan --edges", "city --view section", "city/surface.vtp",
        "city/boundary.vtp", "city/boundary.xdmf", "city/volume.vtu", "city/volume.xdmf",
        "city/surface.stl", "city/city.city.json", "model", "model --colour height",
        "city --view section --colour quality --cut x"}) {
    fs::remove(scratch / "picture.png");
    const Outcome outcome = run("render " + std::string(what) + size);
    EXPECT_EQ(outcome.code, 0) << what << outcome.err;
    EXPECT_EQ(outcome.out, "picture.png: 320 x 200 pixels\n");
    const std::string bytes = bytes_of(scratch / "picture.png");
    EXPECT_TRUE(bytes.starts_with("\x89PNG")) << what;
    drawn[what] = bytes;
  }
  EXPECT_TRUE(drawn["city/surface.vtp"] == drawn["city"]);
  EXPECT_TRUE(drawn["city/boundary.vtp"] == drawn["city/boundary.xdmf"]);
  EXPECT_TRUE(drawn["city/volume.vtu"] == drawn["city/volume.xdmf"]);
  EXPECT_TRUE(drawn["city/city.city.json"] == drawn["model"]);
  for (const char* what : {"city --view plan --edges", "city --view section", "model"})
    EXPECT_FALSE(drawn[what] == drawn["city"]) << what;
  EXPECT_FALSE(drawn["model"] == drawn["model --colour height"]);
  // A folder is drawn with any threads alike, and quietly.
  EXPECT_EQ(run("render city --quiet --threads 1" + size).out, "");
  const std::string one = bytes_of(scratch / "picture.png");
  EXPECT_EQ(run("render city --threads 3" + size).code, 0);
  EXPECT_EQ(bytes_of(scratch / "picture.png"), one);

  std::ofstream(scratch / "notes.txt") << "mine";
  expect_error("render city -o notes.txt", 3, "notes.txt: is there already and no PNG");
  expect_error("render city", 2, "--out is required; usage: tetropolis render");
  expect_error("render city -o a.png --view side", 2, "'side' is not one of city, plan, section");
  expect_error("render city -o a.png --width 3", 2, "--width: 3 is not from 16 to 8192");
  expect_error("render city -o a.png --cut y", 2, "only the view 'section' has a plane");
  expect_error("render city -o a.png --view section --cut up", 2, "'up' is no plane");
  expect_error("render city -o a.png --view section --cut x=1e6", 2, "--cut: the plane misses");
  expect_error("render city -o a.png --width 8000 --height 8000", 2,
               "--width: 8000 x 8000 is more");
  expect_error("render model -o a.png --view section", 3, "model: has no volume for a section");
  expect_error("render input -o a.png", 3, "input: has no surface.vtp");
  expect_error("render input/points.laz -o a.png", 3, "points.laz: no format that is drawn");
  expect_error("render nowhere -o a.png", 3, "nowhere: no such file");
}

TEST_F(Cli, CheckNamesTheFilesItDoesNotRead) {
  synth("--buildings 20 --size 250");
  const std::string arguments = " --quiet --footprints input/footprints.shp --points input ";
  ASSERT_EQ(run("city --out city" + arguments).code, 0);
  EXPECT_EQ(run("check city").out.find("not read"), std::string::npos);
  ASSERT_EQ(
      run("build --mesh-size 20 --formats vtu,msh,openfoam,glb --out result" + arguments).code, 0);
  const Outcome checked = run("check result");
  EXPECT_EQ(checked.code, 0) << checked.err;
  EXPECT_TRUE(
      checked.out.ends_with("  not read: volume.msh, constant/polyMesh, "
                            "surface.glb\nevery guarantee holds\n"))
      << checked.out;
}

TEST_F(Cli, CheckFailsOnABrokenMesh) {
  synth("--buildings 20 --size 250");
  ASSERT_EQ(run("build --quiet --footprints input/footprints.shp --points input --out result").code,
            0);
  // Overwrite one coordinate in the middle of the points.
  std::string bytes = bytes_of(scratch / "result/volume.vtu");
  const std::size_t data = bytes.find('_', bytes.find("<AppendedData")) + 1;
  const double far = -1000;
  bytes.replace(data + 8 + 24 * 500 + 16, 8, reinterpret_cast<const char*>(&far), 8);
  std::ofstream(scratch / "result/volume.vtu", std::ios::binary) << bytes;
  for (const char* path : {"result", "result/volume.vtu"}) {
    const Outcome outcome = run(std::string("check ") + path);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.out.find("VIOLATED: inverted cells"), std::string::npos);
    EXPECT_EQ(outcome.out.find("every guarantee holds"), std::string::npos);
  }
  const Outcome clearance = run("check result/city.city.json --min-building-distance 50");
  EXPECT_EQ(clearance.code, 1);
  EXPECT_NE(clearance.out.find("VIOLATED: clearance below the threshold"), std::string::npos);
}

TEST_F(Cli, CheckCountsTheLoweredGround) {
  synth("--kind adversarial --defects slope_45,roof_below_terrain --size 100 --relief 3 --seed 3");
  for (const std::string options :
       {"--formats vtu", "--coordinates absolute --formats xdmf --compression zlib",
        "--layering uniform --min-wall-height 3"}) {
    SCOPED_TRACE(options);
    ASSERT_EQ(run("build --quiet --mesh-size 20 --points input --footprints input/foot*[pn] --out "
                  "result " +
                  options)
                  .code,
              0);
    EXPECT_EQ(run("check result").code, 0);
    const fs::path path = scratch / "result/report.json";
    const nlohmann::json report = nlohmann::json::parse(bytes_of(path));
    const int lowered = report["volume_mesh"]["ground_lowered"];
    EXPECT_GT(lowered, 0);
    for (const int wrong : {lowered - 1, lowered + 1, -1}) {
      nlohmann::json edited = report;
      edited["volume_mesh"]["ground_lowered"] = wrong;
      std::ofstream(path) << edited;
      const Outcome outcome = run("check result");
      EXPECT_EQ(outcome.code, 1) << wrong;
      EXPECT_NE(
          outcome.out.find("VIOLATED: number of lowered ground vertices differs from report.json"),
          std::string::npos)
          << outcome.out;
    }
  }
}

TEST_F(Cli, DefectsAreForAdversarialCitiesAndKnown) {
  const std::string synth = "synth --out input --size 100 ";
  for (const char* kind : {"", "--kind random ", "--kind blocks "})
    for (const char* defects : {"--defects unicorn", "--defects bow_tie"})
      expect_error(synth + kind + defects, 2,
                   "--defects: cities of this kind have none; add --kind adversarial");
  expect_error(synth + "--kind adversarial --defects unicorn", 2, "there is no defect 'unicorn'");
}

/// Whatever the numbers, messages are short.
TEST_F(Cli, HugeNumbersAreRefusedOrHaveFewDigits) {
  synth("--buildings 4 --size 100");
  const std::string build = "build --points input --footprints input/footprints.shp --out result ";
  for (const char* option : {"--domain-height", "--layer-height", "--mesh-size",
                             "--min-building-area", "--outlier-sigma", "--domain-margin"}) {
    for (const char* layering : {"graded", "uniform"}) {
      const Outcome outcome = run(build + option + " 1e300 --layering " + layering);
      EXPECT_FALSE(std::regex_search(outcome.err, std::regex("[0-9]{30}"))) << outcome.err;
      EXPECT_TRUE(outcome.code == 0 || outcome.code == 2 || outcome.code == 3) << outcome.err;
    }
  }
  for (const char* option : {"--domain-height", "--layer-height"})
    expect_error(build + option + " 1e300", 2, "1e300 is greater than 100000");
}

TEST_F(Cli, CheckEndsOnCoordinatesThatAreNotFinite) {
  synth("--buildings 20 --size 250");
  ASSERT_EQ(run("build --quiet --footprints input/footprints.shp --points input --out result").code,
            0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const char* name : {"result/volume.vtu", "result/boundary.vtp"})
    for (const std::size_t coordinate : {0, 1, 2}) {
      SCOPED_TRACE(std::string(name) + ", coordinate " + std::to_string(coordinate));
      const std::string whole = bytes_of(scratch / name);
      std::string bytes = whole;
      const std::size_t data = bytes.find('_', bytes.find("<AppendedData")) + 1;
      bytes.replace(data + 8 + 24 * 10 + 8 * coordinate, 8, reinterpret_cast<const char*>(&nan), 8);
      std::ofstream(scratch / name, std::ios::binary) << bytes;
      const Outcome outcome = run("check result");
      EXPECT_EQ(outcome.code, 1) << outcome.err;
      EXPECT_NE(outcome.out.find("VIOLATED: coordinates that are not finite"), std::string::npos);
      std::ofstream(scratch / name, std::ios::binary) << whole;
    }
  EXPECT_EQ(run("check result").code, 0);
}

TEST_F(Cli, CheckSaysWhatIsNoReport) {
  synth("--buildings 20 --size 250");
  ASSERT_EQ(run("build --quiet --footprints input/footprints.shp --points input --out result").code,
            0);
  for (const char* text :
       {"[1, 2]", "{", "", "{}", "{\"volume_mesh\": {}}", "{\"command\": 3}",
        "{\"command\": \"mesh\", \"config\": 3}", "{\"command\": \"mesh\", \"volume_mesh\": []}",
        "{\"command\": \"mesh\", \"volume_mesh\": {\"cells\": {}}}",
        "{\"command\": \"build\", \"input\": \"none\"}",
        "{\"command\": \"build\", \"config\": {\"coordinates\": 1}}",
        "{\"command\": \"build\", \"config\": {\"cut_slope\": -30}}",
        "{\"command\": \"build\", \"config\": {\"cut_slope\": 120}}",
        "{\"command\": \"build\", \"config\": {\"cut_slope\": 0}}",
        "{\"command\": \"build\", \"volume_mesh\": {\"roofs_cut_back\": 3}}",
        "{\"command\": \"build\", \"volume_mesh\": {\"feet_cut_back\": [[1, 2]]}}",
        "{\"command\": \"build\", \"volume_mesh\": {\"roofs_cut_back\": [0], "
        "\"roof_cut_slopes_deg\": []}}",
        "{\"command\": \"build\", \"volume_mesh\": {\"roofs_cut_back\": [0], "
        "\"roof_cut_slopes_deg\": [95]}}"}) {
    SCOPED_TRACE(text);
    std::ofstream(scratch / "result/report.json") << text;
    const Outcome outcome = run("check result");
    EXPECT_EQ(outcome.code, 3);
    EXPECT_EQ(outcome.err, "tetropolis: result/report.json: not a report of tetropolis\n");
    // A single model does not depend on what another program has written beside it.
    const Outcome alone = run("check result/city.city.json");
    EXPECT_EQ(alone.code, 0) << alone.err;
    EXPECT_NE(alone.out.find("not checked: what report.json asks for (result/report.json: not a "
                             "report of tetropolis)"),
              std::string::npos)
        << alone.out;
  }
  // Without what it should say, it is not borne out.
  std::ofstream(scratch / "result/report.json") << "{\"command\": \"build\", \"volume_mesh\": {}}";
  EXPECT_EQ(run("check result").code, 1);
}

TEST_F(Cli, CheckComparesTheModelsAndTheReport) {
  synth("--buildings 20 --size 250");
  ASSERT_EQ(
      run("city --quiet --lod block --footprints input/footprints.shp --points input --out result")
          .code,
      0);
  ASSERT_EQ(run("check result").code, 0);
  const auto changed = [&](const char* file, const char* what, const char* by,
                           const std::string& violation) {
    SCOPED_TRACE(what);
    const std::string before = bytes_of(scratch / "result" / file);
    const std::string after =
        std::regex_replace(before, std::regex(what), by, std::regex_constants::format_first_only);
    EXPECT_NE(before, after);
    std::ofstream(scratch / "result" / file) << after;
    const Outcome outcome = run("check result");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.out.find(violation), std::string::npos) << outcome.out;
    std::ofstream(scratch / "result" / file) << before;
  };
  changed("city_raw.city.json", "\"source_ids\":\\[\"[^\"]*\"", "\"source_ids\":[\"invented\"",
          "features of city_raw.city.json that are not here");
  changed("city_raw.city.json", "\"source_ids\":\\[\"[^\"]*\"", "\"source_ids\":[\"invented\"",
          "features that are not in city_raw.city.json");
  for (const char* model : {"city_raw.city.json", "city.city.json"})
    for (const auto& [what, by] :
         {std::pair{"\"h_ground\":", "\"h_ground\":-"}, std::pair{"\"h_roof\":", "\"h_roof\":9"},
          std::pair{"\"vertices\":\\[\\s*\\[(\\d+),(\\d+),(\\d+)\\]", "\"vertices\":[[$1,$2,9$3]"}})
      changed(model, what, by,
              "VIOLATED: solids that are not what their ground, h_ground and h_roof make");
  // The same for the folder's name as a shell completes it.
  {
    const fs::path model = scratch / "result/city.city.json";
    const std::string before = bytes_of(model);
    std::ofstream(model) << std::regex_replace(before, std::regex("\"h_roof\":"), "\"h_roof\":9",
                                               std::regex_constants::format_first_only);
    EXPECT_EQ(run("check result/").code, 1);
    std::ofstream(model) << before;
    EXPECT_EQ(run("check result//").code, 0);
  }
  changed("report.json", "\"raw_buildings\": *", "\"raw_buildings\":1",
          "number of raw buildings differs");
  changed("report.json", "EPSG:3006", "EPSG:3007", "reference system differs from report.json");
  changed("report.json", "\"domain\": *\\[\\s*[0-9]", "\"domain\":[9",
          "domain differs from report.json");
  changed("report.json", "\"flags\": *\\{\\s*\"merged\": *[0-9]+", "\"flags\":{\"merged\":99",
          "number of flags differs from report.json");
  changed("report.json", "\"min_clearance\": *[0-9.]+", "\"min_clearance\":1.5",
          "clearance differs from report.json");
  changed("report.json", "\"area_after\": *[0-9]", "\"area_after\":9",
          "area of footprints differs from report.json");
  ASSERT_EQ(run("build --quiet --lod block --footprints input/footprints.shp --points input "
                "--mesh-size 20 --out result")
                .code,
            0);
  ASSERT_EQ(run("check result").code, 0);
  changed("report.json", "\"closed\": *true", "\"closed\":false", "closed boundary differs");
  changed("report.json", "\"roof\": *[0-9]+", "\"roof\":1", "number of faces of roof differs");
  for (const auto& [name, what] :
       {std::pair{"non_orthogonality_deg", "non-orthogonality"}, std::pair{"skewness", "skewness"}})
    changed("report.json", (std::string("\"") + name + "\": *\\{\\s*\"max\": *[0-9.]+").c_str(),
            (std::string("\"") + name + "\":{\"max\":9.5").c_str(),
            (std::string("greatest ") + what + " differs").c_str());
  changed("report.json", "\"faces_above_70_deg\": *", "\"faces_above_70_deg\":1",
          "faces above 70 degrees differs");
  for (const auto& [name, what] : {std::pair{"p0_01", "0.01 % quantile of dihedral angles"},
                                   std::pair{"p0_1", "0.1 % quantile of dihedral angles"},
                                   std::pair{"p1", "1 % quantile of dihedral angles"},
                                   std::pair{"median", "median of dihedral angles"}})
    changed("report.json",
            (std::string("(\"dihedral_deg\": *\\{[^}]*\"") + name + "\": *)").c_str(), "$019",
            (std::string(what) + " differs").c_str());
  for (const auto& [name, what] : {std::pair{"p99", "99 % quantile of aspect ratios"},
                                   std::pair{"median", "median of aspect ratios"}})
    changed("report.json",
            (std::string("(\"aspect_ratio\": *\\{[^}]*\"") + name + "\": *)").c_str(), "$019",
            (std::string(what) + " differs").c_str());
  for (const char* mesh : {"volume.vtu", "boundary.vtp"})
    changed(mesh, "(Name=\"origin\"[^>]*>)", "$019", "origin differs from report.json");
  // A mesh of the model that is there already.
  ASSERT_EQ(run("mesh --quiet --city result/city.city.json --dtm result/dtm.tif --mesh-size 30 "
                "--out result")
                .code,
            0);
  EXPECT_EQ(run("check result").code, 0);
}

TEST_F(Cli, CheckKnowsWhereTheMeshLies) {
  synth("--buildings 4 --size 100");
  for (const std::string coordinates : {"local", "absolute"}) {
    ASSERT_EQ(run("build --quiet --footprints input/footprints.shp --points input --mesh-size 20 "
                  "--formats vtu,xdmf --out result --coordinates " +
                  coordinates)
                  .code,
              0);
    ASSERT_EQ(run("check result").code, 0);
    const fs::path path = scratch / "result/volume.vtu";
    std::string text = bytes_of(path);
    const std::string_view tuple = "NumberOfTuples=\"1\" format=\"ascii\">";
    text.replace(text.find(tuple) + tuple.size(), 1, "9");
    std::ofstream(path) << text;
    const Outcome outcome = run("check result");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.out.find("VIOLATED: origin differs from report.json"), std::string::npos)
        << outcome.out;
  }
}

TEST_F(Cli, CheckReadsCityAndTerrainWhereMeshHasReadThem) {
  synth("--buildings 4 --size 100");
  ASSERT_EQ(run("city --quiet --footprints input/footprints.shp --points input --out one").code, 0);
  ASSERT_EQ(
      run("mesh --quiet --city one/city.city.json --dtm one/dtm.tif --mesh-size 20 --out two").code,
      0);
  Outcome outcome = run("check two");
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  for (const char* words : {"one/city.city.json\n", "regions of cells compared with the footprints",
                            "ground vertices on the terrain"})
    EXPECT_NE(outcome.out.find(words), std::string::npos) << outcome.out;
  // From wherever it is called, and where both have moved.
  const std::string elsewhere =
      "mkdir -p a/b && mv one two a && cp a/one/dtm.tif a/b && cd a/b && '" TETROPOLIS_PROGRAM
      "' check ../two";
  outcome = shell(elsewhere);
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_NE(outcome.out.find("ground vertices on the terrain"), std::string::npos) << outcome.out;
  // By way of a link, beside which another city lies.
  ASSERT_EQ(shell("mkdir c && ln -s ../a/two c/two && cp -r input c/one && touch "
                  "c/one/city.city.json c/one/dtm.tif")
                .code,
            0);
  outcome = run("check c/two");
  EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  EXPECT_NE(outcome.out.find("ground vertices on the terrain"), std::string::npos) << outcome.out;
  ASSERT_EQ(shell("mv a/one a/two .").code, 0);
  // Another terrain than it was.
  ASSERT_EQ(
      run("city --quiet --footprints input/footprints.shp --points input --dtm-step 3 --out one")
          .code,
      0);
  EXPECT_EQ(run("check two").code, 1);
  fs::remove(scratch / "one/dtm.tif");
  outcome = run("check two");
  EXPECT_NE(outcome.out.find("heights (there is no one/dtm.tif)"), std::string::npos)
      << outcome.out;
  fs::remove_all(scratch / "one");
  outcome = run("check two");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.out.find("there is no one/city.city.json"), std::string::npos) << outcome.out;
}

/// A model in the folder is no result there if the report does not tell of it, from anywhere.
TEST_F(Cli, CheckSaysTheSameOfTheFolderItIsIn) {
  synth("--buildings 4 --size 100");
  ASSERT_EQ(
      run("city --quiet --no-html --footprints input/footprints.shp --points input --out one").code,
      0);
  fs::remove(scratch / "one/report.json");
  Json city = Json::parse(bytes_of(scratch / "one/city.city.json"));
  city["metadata"]["geographicalExtent"][0] = 3;
  std::ofstream(scratch / "one/city.city.json") << city.dump();
  ASSERT_EQ(
      run("mesh --quiet --city one/city.city.json --dtm one/dtm.tif --mesh-size 20 --out one").code,
      0);
  for (const char* where :
       {"'" TETROPOLIS_PROGRAM "' check one", "cd one && '" TETROPOLIS_PROGRAM "' check ."}) {
    const Outcome outcome = shell(where);
    EXPECT_EQ(outcome.code, 1) << where;
    EXPECT_NE(outcome.out.find("VIOLATED: wrong extent (1)"), std::string::npos) << outcome.out;
  }
}

/// The system follows links before "..", and so do results.
TEST_F(Cli, ResultsBesideWhatALinkLeadsTo) {
  synth("--buildings 4 --size 100");
  ASSERT_EQ(run("city --quiet --footprints input/footprints.shp --points input --out one").code, 0);
  ASSERT_EQ(shell("mkdir -p far/away && ln -s far/away link").code, 0);
  ASSERT_EQ(run("mesh --quiet --city one/city.city.json --dtm one/dtm.tif --mesh-size 20 "
                "--out link/../two")
                .code,
            0);
  EXPECT_FALSE(fs::exists(scratch / "two"));
  const Outcome outcome = run("check far/two");
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_NE(outcome.out.find("ground vertices on the terrain"), std::string::npos) << outcome.out;
  expect_error(
      "mesh --city one/city.city.json --dtm one/dtm.tif --out link/../two --log "
      "far/two/surface.obj",
      2, "far/two/surface.obj is a result");
}

TEST_F(Cli, InfoOfFoldersWhoseReportIsNone) {
  ASSERT_EQ(shell("mkdir -p folder/report.json pipe && mkfifo pipe/report.json").code, 0);
  for (const std::string folder : {"folder", "pipe"}) {
    const Outcome outcome = run("info " + folder);
    EXPECT_EQ(outcome.code, 3);
    EXPECT_EQ(outcome.err.find("tetropolis: " + folder), 0U) << outcome.err;
  }
}

/// What a document is, its root says, wherever in the file that is.
TEST_F(Cli, JsonIsKnownByItsRoot) {
  synth("--buildings 4 --size 100");
  ASSERT_EQ(run("city --quiet --footprints input/footprints.shp --points input --out one").code, 0);
  Json city = Json::parse(bytes_of(scratch / "one/city.city.json"));
  const Json type = city["type"];
  city.erase("type");
  city["Title"] = std::string(5000, 'x');  // before "type", as keys are sorted
  city["metadata"]["title"] = "\"command\" \"version\"";
  city["type"] = type;
  std::ofstream(scratch / "late.CityJSON") << city.dump();
  const Outcome info = run("info late.CityJSON");
  EXPECT_EQ(info.code, 0) << info.err;
  EXPECT_NE(info.out.find("buildings"), std::string::npos) << info.out;
  EXPECT_EQ(run("check late.CityJSON").code, 0);
  std::ofstream(scratch / "members.geojson") << R"({"command":"x","version":1,)"
                                             << R"("type":"FeatureCollection","features":[]})";
  const Outcome members = run("info members.geojson");
  EXPECT_NE(members.out.find("members.geojson: vector"), std::string::npos)
      << members.out << members.err;
  // A report of somebody else's beside points.
  fs::create_directory(scratch / "tiles");
  fs::copy(scratch / "input/points.laz", scratch / "tiles/points.laz");
  std::ofstream(scratch / "tiles/report.json") << "{}";
  const Outcome tiles = run("info tiles");
  EXPECT_EQ(tiles.code, 0) << tiles.err;
  EXPECT_NE(tiles.out.find("points.laz"), std::string::npos) << tiles.out;
  EXPECT_EQ(run("info tiles/report.json").code, 3);
}

/// Data of `synth` that a model was made from may go elsewhere.
TEST_F(Cli, DataBesideAModelAreNoResultsOfIt) {
  synth("--buildings 4 --size 100");
  ASSERT_EQ(run("build --quiet --footprints input/footprints.shp --points input --mesh-size 20 "
                "--out input")
                .code,
            0);
  fs::remove(scratch / "input/points.laz");
  const Outcome checked = run("check input");
  EXPECT_EQ(checked.code, 0) << checked.out;
  fs::remove(scratch / "input/surface.stl");
  EXPECT_EQ(run("check input").code, 1);
}

/// Of such files buildings are read: they would become water.
TEST_F(Cli, BuildingsOfAnExtractAreNoAreas) {
  synth("--buildings 4 --size 100");
  const std::string build =
      "build --quiet --footprints input/footprints.shp --points input --out one ";
  ASSERT_EQ(run(build).code, 0);
  const std::string mesh = "mesh --quiet --city one/city.city.json --dtm one/dtm.tif --out two ";
  std::ofstream(scratch / "town.osm") << "<?xml version='1.0'?>\n<osm version='0.6'>\n</osm>\n";
  for (const std::string option : {"--surface-layers town.osm:water", "--refine town.osm:5"})
    expect_error(mesh + option, 3, "town.osm: is an OpenStreetMap extract");
  expect_error(mesh + "--surface-layers one/city.city.json:road", 3,
               "one/city.city.json: is a city model");
}

TEST_F(Cli, MistakesInBoundsListsAndSizes) {
  synth("--buildings 4 --size 100");
  ASSERT_EQ(run("city --quiet --footprints input/footprints.shp --points input --out one").code, 0);
  const std::string mesh = "mesh --city one/city.city.json --dtm one/dtm.tif --out two ";
  expect_error(mesh + "--terrain-only --bounds 319050.001,6396050.001,319050.002,6396050.002", 3,
               "--bounds: the domain is 0.001 m x 0.001 m");
  expect_error(mesh + "--max-memory inf", 2, "--max-memory: 'inf' is not a size");
  expect_error(mesh + "--mesh-size 10,5", 2,
               "'10,5' is not a number; a point goes before decimals");
  std::ofstream(scratch / "none.toml") << "formats = []\n";
  expect_error(mesh + "--config none.toml", 2, "none.toml:1: formats: is empty; give one or more");
}

TEST_F(Cli, InfoOfFoldersAndOfFormatsThatAreNotRead) {
  synth("--buildings 4 --size 100");
  const Outcome folder = run("info input");
  EXPECT_EQ(folder.code, 0);
  EXPECT_NE(folder.out.find("report of 'tetropolis synth'"), std::string::npos);
  fs::create_directory(scratch / "cloud");
  fs::copy_file(scratch / "input/points.laz", scratch / "cloud/a.laz");
  fs::copy_file(scratch / "input/points.laz", scratch / "cloud/b.laz");
  const Outcome cloud = run("info cloud");
  EXPECT_EQ(cloud.code, 0);
  for (const char* name : {"cloud/a.laz: LAZ", "cloud/b.laz: LAZ"})
    EXPECT_NE(cloud.out.find(name), std::string::npos) << cloud.out;
  fs::create_directory(scratch / "bare");
  EXPECT_NE(run("info bare").err.find("bare: is a folder, but no data set"), std::string::npos);
  std::ofstream(scratch / "a.obj") << "v 0 0 0\n";
  const Outcome written = run("info a.obj");
  EXPECT_EQ(written.code, 3);
  EXPECT_NE(written.err.find(".obj files are written but not read"), std::string::npos);
}

TEST_F(Cli, InfoTellsOfEveryLayer) {
  fs::create_directory(scratch / "set");
  const std::vector<Polygon> polygons(12, {{{0, 0}, {9, 0}, {9, 9}}, {}});
  std::vector<std::string> ids;
  for (int i = 0; i < 12; ++i) ids.push_back("h" + std::to_string(i));
  write_footprints(scratch / "set/houses.shp", polygons, ids, std::vector<double>(12, 5.0), {},
                   "EPSG:3006");
  write_footprints(scratch / "set/sheds.shp", polygons, ids, {}, {}, "EPSG:3006");
  const Outcome outcome = run("info set");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  for (const char* line : {"layer houses\n", "layer sheds\n", "attributes: id, height\n",
                           "attributes: id\n", "choose one of these layers by --layer\n"})
    EXPECT_NE(outcome.out.find(line), std::string::npos) << outcome.out;
  // The first of many that are no polygons.
  std::ofstream points(scratch / "points.geojson");
  points << R"({"type": "FeatureCollection", "features": [)";
  for (int i = 0; i < 25; ++i)
    points << (i > 0 ? "," : "") << R"({"type": "Feature", "properties": {}, "geometry":)"
           << R"({"type": "Point", "coordinates": [1, 2]}})";
  points << "]}";
  points.close();
  const std::string told = run("info points.geojson").out;
  EXPECT_NE(told.find("dropped: 15 more\n"), std::string::npos) << told;
}

TEST_F(Cli, CheckNamesResultsThatAreMissing) {
  synth("--buildings 4 --size 100");
  ASSERT_EQ(run("build --quiet --footprints input/footprints.shp --points input --mesh-size 20 "
                "--formats vtu,ply,openfoam --out result")
                .code,
            0);
  for (const char* name : {"surface.stl", "surface.ply", "city_raw.city.json", "dtm.tif"})
    ASSERT_TRUE(fs::remove(scratch / "result" / name)) << name;
  ASSERT_GT(fs::remove_all(scratch / "result/constant"), 0);
  const Outcome outcome = run("check result");
  EXPECT_EQ(outcome.code, 1);
  for (const char* line :
       {"  missing: city_raw.city.json, constant/polyMesh/boundary, constant/polyMesh/faces, "
        "constant/polyMesh/neighbour, constant/polyMesh/owner, constant/polyMesh/points, dtm.tif, "
        "surface.ply, surface.stl\n",
        "  VIOLATED: results that report.json lists and that are not here, or empty (9); first: "
        "city_raw.city.json\n"})
    EXPECT_NE(outcome.out.find(line), std::string::npos) << outcome.out;
}

TEST_F(Cli, CheckTakesTheOptionsOfEveryRun) {
  synth("--buildings 20 --size 250");
  ASSERT_EQ(run("city --quiet --footprints input/footprints.shp --points input --out result").code,
            0);
  const std::string loud = run("check result").out;
  const Outcome quiet = run("check result --quiet --threads 1 --log check.log");
  EXPECT_EQ(quiet.code, 0) << quiet.err;
  EXPECT_EQ(quiet.out + quiet.err, "");
  EXPECT_EQ(bytes_of(scratch / "check.log"), loud);
  const Outcome broken =
      run("check result/city.city.json --quiet --log check.log --min-building-distance 50");
  EXPECT_EQ(broken.code, 1);
  EXPECT_NE(broken.out.find("VIOLATED: clearance"), std::string::npos);
  EXPECT_TRUE(bytes_of(scratch / "check.log").ends_with(broken.err)) << broken.err;
  EXPECT_EQ(run("check result --threads -1").code, 2);
}

TEST_F(Cli, CheckRefusesClearancesThatAreNone) {
  synth("--buildings 20 --size 250");
  ASSERT_EQ(run("city --quiet --footprints input/footprints.shp --points input --out result").code,
            0);
  for (const char* value : {"nan", "inf", "-inf", "-1", "-0.5", "1e999", "one", "''"})
    expect_error(std::string("check result --min-building-distance=") + value, 2,
                 "--min-building-distance");
  for (const char* value : {"0", "1e-3", "1"})
    EXPECT_EQ(run(std::string("check result --min-building-distance ") + value).code, 0) << value;
  EXPECT_EQ(run("check result --min-building-distance 1000").code, 1);
}

TEST_F(Cli, TheLogHasTheErrorToo) {
  synth("--buildings 20 --size 250");
  const Outcome outcome = run(
      "build --footprints input/footprints.shp --points nowhere.laz --out result --log run.log");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_EQ(outcome.err, "tetropolis: nowhere.laz: no such file or folder; check the path\n");
  EXPECT_EQ(bytes_of(scratch / "run.log"), outcome.err);
}

TEST_F(Cli, ALogNeverReplacesDataOrAnInput) {
  synth("--buildings 20 --size 250");
  ASSERT_EQ(run("city --quiet --footprints input/footprints.shp --points input --out result").code,
            0);
  ASSERT_EQ(run("mesh --quiet --city result/city.city.json --dtm result/dtm.tif --mesh-size 40 "
                "--formats obj,openfoam --out mesh")
                .code,
            0);
  std::ofstream(scratch / "house.csv") << "id,WKT\n1,\"POLYGON EMPTY\"\n";
  std::ofstream(scratch / "my.toml") << "mesh_size = 12\n";
  const std::string build = "build --footprints input/footprints.shp --points input --out new ";
  const std::pair<std::string, const char*> cases[] = {
      {build, "input/points.laz"},
      {build, "input/footprints.dbf"},
      {build, "input/footprints.prj"},
      {build, "input/footprints.cpg"},
      {"city --config my.toml --footprints input/footprints.shp --points input --out new ",
       "my.toml"},
      {build, "result/city.city.json"},
      {"build --footprints house.csv --points input --out new ", "house.csv"},
      {"check result ", "result/dtm.tif"},
      {"check mesh ", "mesh/surface.obj"},
      {"build --footprints nowhere.shp --points input --out mesh ", "mesh/surface.obj"},
      {build, "mesh/constant/polyMesh/boundary"},
  };
  for (const auto& [arguments, file] : cases) {
    const std::string before = bytes_of(scratch / file);
    expect_error(arguments + "--log " + file, 2, file);
    EXPECT_EQ(bytes_of(scratch / file), before) << file;
  }
  // Nor is it where a result is to come.
  expect_error(build + "--log new/boundary.vtp", 2, "new/boundary.vtp is a result");
  EXPECT_FALSE(fs::exists(scratch / "new"));
  fs::create_directory(scratch / "data");
  const std::string village = "synth --kind adversarial --size 100 --defects tiles_overlap ";
  ASSERT_EQ(run(village + "--out village").code, 0);
  std::vector<std::string> names{"footprints.geojson", "points.laz"};
  for (const auto& entry : fs::directory_iterator(scratch / "village"))
    names.push_back(entry.path().filename().string());
  EXPECT_GT(names.size(), 10U);
  for (const std::string& name : names)
    expect_error(village + "--out data --log data/" + name, 2, name + " is a result");
  // A log of an earlier run is what it is for.
  for (int i = 0; i < 2; ++i) EXPECT_EQ(run("check result --quiet --log check.log").code, 0);
}

/// Names that have only their stem in common with an input, or with a folder of results.
TEST_F(Cli, LogsMayHaveTheNameOfTheCity) {
  synth("--buildings 20 --size 250");
  fs::rename(scratch / "input", scratch / "tiles");
  std::ofstream(scratch / "delft.toml")
      << "footprints = \"tiles/footprints.shp\"\npoints = [\"tiles\"]\nout = \"delft\"\n";
  for (const char* command :
       {"city --config delft.toml --log delft.log", "check delft --log delft.log",
        "city --config delft.toml --log tiles.log",
        "city --config delft.toml --log tiles/footprints.log",
        "mesh --city delft/city.city.json --dtm delft/dtm.tif --out mesh --log delft/dtm.log"})
    for (int i = 0; i < 2; ++i) {
      const Outcome outcome = run(command + std::string(" --quiet"));
      EXPECT_EQ(outcome.code, 0) << command << ": " << outcome.err;
    }
}

TEST_F(Cli, SideFilesAreNoLogsWhateverTheirNames) {
  synth("--buildings 20 --size 250");
  fs::rename(scratch / "input/footprints.prj", scratch / "input/footprints.PRJ");
  fs::create_symlink("input/footprints.PRJ", scratch / "run.log");
  for (const char* log : {"input/footprints.PRJ", "run.log", "./input/../run.log"})
    expect_error(std::string("city --footprints input/footprints.shp --points input --out new "
                             "--log ") +
                     log,
                 2, "is an input of this run");
}

TEST_F(Cli, SpecialFilesAreNoInputs) {
  synth("--buildings 20 --size 250");
  ASSERT_EQ(run("city --quiet --footprints input/footprints.shp --points input --out result").code,
            0);
  expect_error("mesh --city /dev/zero --dtm result/dtm.tif --out new", 3,
               "/dev/zero: is not an ordinary file");
  expect_error("mesh --city result/city.city.json --dtm /dev/zero --out new", 3,
               "/dev/zero: is not an ordinary file");
}

TEST_F(Cli, TheOptionOfAnUnknownReferenceSystemIsNamed) {
  synth("--buildings 20 --size 250");
  for (const char* option : {"--points-crs", "--footprints-crs"})
    expect_error(std::string("city --footprints input/footprints.shp --points input --out new ") +
                     option + " nope",
                 2, std::string(option) + ": 'nope'");
}

TEST_F(Cli, ADatabaseThatProjCannotUseIsNamedAsTheReason) {
  synth();
  const auto before = left();
  for (const char* name : {"PROJ_DATA", "PROJ_LIB"}) {
    const Outcome outcome =
        shell(std::string(name) +
              "=/nowhere '" TETROPOLIS_PROGRAM
              "' city --footprints input/footprints.shp --points input --out a --quiet");
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("proj.db"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find(std::string("unset ") + name + " (/nowhere)"), std::string::npos)
        << outcome.err;
    EXPECT_EQ(left(), before);
  }
  ASSERT_EQ(run("city --footprints input/footprints.shp --points input --out a --quiet").code, 0);
  const Outcome checked = shell("PROJ_DATA=/nowhere '" TETROPOLIS_PROGRAM "' check a");
  EXPECT_EQ(checked.code, 2);
  EXPECT_NE(checked.err.find("proj.db"), std::string::npos) << checked.err;
}

/// For a shell: until the program `$pid` writes, or has ended.
const std::string kUntilItWrites =
    "while kill -0 $pid && ! ls -d .result.part-* >/dev/null 2>&1; do sleep 0.01; done; ";

TEST_F(Cli, AnIgnoredHangupDoesNotEndTheRun) {
  synth("--buildings 20 --size 250");
  for (const bool ignored : {true, false}) {
    const Outcome outcome =
        shell(std::string("{ ") + (ignored ? "trap '' HUP; " : "") +
              "'" TETROPOLIS_PROGRAM
              "' build --quiet --mesh-size 3 --footprints input/footprints.shp --points input "
              "--out result & pid=$!; " +
              kUntilItWrites + "kill -HUP $pid; wait $pid; }");
    EXPECT_EQ(outcome.code, ignored ? 0 : 130) << outcome.err;
    EXPECT_EQ(fs::exists(scratch / "result"), ignored);
    fs::remove_all(scratch / "result");
  }
}

TEST_F(Cli, FoldersThatCannotBeEnteredAreNamed) {
  if (geteuid() == 0 && std::system("command -v setpriv >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "permissions do not count here";
  fs::create_directories(scratch / "closed/result");
  fs::permissions(scratch / "closed", fs::perms(0));
  fs::permissions(scratch.path(), fs::perms(0755));
  const std::string others =
      geteuid() == 0 ? "setpriv --reuid 65534 --regid 65534 --clear-groups " : "";
  const auto run_as_other = [&](const std::string& arguments) {
    return shell(others + "'" TETROPOLIS_PROGRAM "' " + arguments);
  };
  const bool runs = run_as_other("--version").code == 0;
  if (runs) {
    const Outcome checked = run_as_other("check closed/result");
    EXPECT_EQ(checked.code, 3);
    EXPECT_EQ(checked.err, "tetropolis: closed/result: cannot be read: Permission denied\n");
    EXPECT_EQ(run_as_other("check closed").code, 3);
    EXPECT_EQ(run_as_other("info closed/result").err,
              "tetropolis: closed/result: cannot be read: Permission denied\n");
    EXPECT_EQ(run_as_other("init closed/my.toml").code, 3);
    const Outcome built = run_as_other("build --config closed/my.toml");
    EXPECT_EQ(built.code, 2);
    EXPECT_EQ(built.err, "tetropolis: closed/my.toml: cannot be opened: Permission denied\n");
    std::ofstream(scratch / "secret.toml") << "mesh_size = 5\n";
    fs::permissions(scratch / "secret.toml", fs::perms(0));
    EXPECT_EQ(run_as_other("build --config secret.toml").err,
              "tetropolis: secret.toml: cannot be opened: Permission denied\n");
  }
  fs::permissions(scratch / "closed", fs::perms(0755));
  if (!runs) GTEST_SKIP() << "the program cannot be run by others";
}

TEST_F(Cli, WrongOptionsExitWithTwo) {
  synth("--buildings 20 --size 250");
  const std::string input =
      "build --footprints input/footprints.shp --points input/points.laz --out result ";
  expect_error("build --points input/points.laz --out result", 2, "missing: --footprints (");
  expect_error("build --footprints input/footprints.shp --points input/points.laz", 2,
               "missing: --out (");
  expect_error(input + "--mesh-sise 5", 2, "did you mean '--mesh-size'?");
  expect_error(input + "--mesh-size five", 2, "--mesh-size: 'five' is not a number");
  expect_error(input + "--mesh-size -3", 2, "less than 0.05");
  expect_error(input + "--mesh-size 1e999", 2,
               "--mesh-size: 1e999 is out of range; give 0.05 to 10000");
  expect_error("synth --out x --seed 5000000000", 2,
               "--seed: 5000000000 is out of range; give 0 to 2147483647");
  expect_error(input + "--top open", 2, "is not one of flat, free");
  expect_error(input + "--bounds 1,2,3", 2, "four numbers");
  expect_error(input + "--bounds 1 2 3 4 5", 2, "four numbers");
  expect_error(input + "--points-crs EPSG:999999", 2, "EPSG:999999");
  expect_error(input + "--config missing.toml", 2, "missing.toml: no such configuration file");
  std::ofstream(scratch / "c.toml") << "# settings\nmesh_sise = 5\n";
  expect_error(input + "--config c.toml", 2,
               "c.toml:2: unknown key 'mesh_sise'; did you mean 'mesh_size'?");
  std::ofstream(scratch / "file") << "x";
  expect_error("build --footprints input/footprints.shp --points input/points.laz --out file", 2,
               "file: cannot be written");
  expect_error(
      "build --footprints input/footprints.shp --points input/points.laz --out file/inside", 2,
      "cannot be written");
  EXPECT_EQ(run("biuld").code, 2);
  EXPECT_NE(run("biuld").err.find("did you mean 'build'?"), std::string::npos);
}

TEST_F(Cli, WithoutArgumentsTellsWhatToTypeNext) {
  const Outcome bare = run("");
  EXPECT_EQ(bare.code, 2);
  EXPECT_EQ(bare.out, "");
  for (const char* part : {"build ", "synth ", "check ", "info ", "First steps:", "help COMMAND"})
    EXPECT_NE(bare.err.find(part), std::string::npos) << part << " in " << bare.err;
  EXPECT_EQ(bare.err.find("subcommand"), std::string::npos) << bare.err;
}

TEST_F(Cli, EmptyAndTooSmallValuesAreNamed) {
  synth("--buildings 20 --size 250");
  expect_error("build --footprints input/footprints.shp --points '' --out result", 2,
               "--points: one of the values is empty");
  expect_error("build --footprints '' --points input --out result", 2,
               "--footprints: one of the values is empty");
  std::ofstream(scratch / "c.toml") << "points = [\"\"]\n";
  expect_error("build --footprints input/footprints.shp --config c.toml --out result", 2,
               "c.toml:1: points: one of the values is empty");
  expect_error("synth --size 40 --out small", 2, "--size: 40 m is too small");
  expect_error("synth --size 100 --kind blocks --out small", 2, "give 300 or more");
  expect_error("synth --size 100 --buildings 100000 --out small", 2,
               "fewer --buildings or a larger --size");
  expect_error("synth --size 200000 --out large", 2, "--size: 200000 is greater than 100000");
  expect_error("synth --size 50 --kind adversarial --out small", 2, "--size: 50 m is too small");
  expect_error("synth --size 2000 --kind adversarial --out large", 2,
               "--size: 2000 m is too large");
  expect_error("synth --size 100000 --point-density 1000 --out large", 2,
               "give a smaller --size or a lower --point-density");
  EXPECT_EQ(run("synth --quiet --size 100 --out small").code, 0);
  const Outcome crowded = run("synth --kind blocks --size 300 --buildings 5000 --out crowded");
  EXPECT_EQ(crowded.code, 0);
  EXPECT_NE(crowded.err.find("of 5000 buildings fit"), std::string::npos) << crowded.err;
}

TEST_F(Cli, UnitsAndSystemsAreNamedShortly) {
  synth("--buildings 20 --size 250");
  const std::string build =
      "build --footprints input/footprints.shp --points input/points.laz --out result ";
  const std::string feet =
      R"x('PROJCS["Town grid (ft)",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,)x"
      R"x(298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],)x"
      R"x(PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],)x"
      R"x(PARAMETER["central_meridian",15],PARAMETER["scale_factor",1],)x"
      R"x(PARAMETER["false_easting",0],PARAMETER["false_northing",0],UNIT["foot",0.3048]]')x";
  expect_error(build + "--points-crs " + feet, 3, "points and domain do not overlap");
  expect_error(build + "--points-crs EPSG:4326", 3, "(EPSG:4326)");
}

TEST_F(Cli, InfoGoesOnAfterABadFile) {
  synth("--buildings 20 --size 250");
  ASSERT_EQ(run("city --quiet --footprints input/footprints.shp --points input --out result").code,
            0);
  std::ofstream(scratch / "notes.txt") << "no data\n";
  const Outcome info =
      run("info nowhere.laz input/footprints.shp notes.txt result/report.json result");
  EXPECT_EQ(info.code, 3);
  EXPECT_EQ(std::count(info.err.begin(), info.err.end(), '\n'), 2) << info.err;
  EXPECT_NE(info.err.find("nowhere.laz: no such file"), std::string::npos) << info.err;
  EXPECT_NE(info.err.find("notes.txt: not a vector file"), std::string::npos) << info.err;
  EXPECT_NE(info.out.find("features: 20"), std::string::npos) << info.out;
  EXPECT_NE(info.out.find("result/report.json: report of 'tetropolis city'"), std::string::npos)
      << info.out;
  EXPECT_NE(info.out.find("20 footprints"), std::string::npos) << info.out;
  for (const char* layering : {"graded", "uniform"}) {
    ASSERT_EQ(run("mesh --quiet --city result/city.city.json --dtm result/dtm.tif --mesh-size 20 "
                  "--out mesh --layering " +
                  std::string(layering))
                  .code,
              0);
    EXPECT_EQ(run("info mesh").out.find(" layers") != std::string::npos,
              std::string(layering) == "uniform");
  }
  std::ofstream(scratch / "cut.json") << R"({"version": "0.1.0", "command": "bui)";
  EXPECT_EQ(run("info cut.json").code, 3);
  std::ofstream(scratch / "odd.json") << R"({"version": 1, "command": {}, "steps": 3})";
  EXPECT_EQ(run("info odd.json").code, 3);
}

TEST_F(Cli, InfoQuotesWhatFilesSayInOneLineEach) {
  std::ofstream(scratch / "report.json") << R"({"version": "0", "command": "build", "steps": [],
    "city": {"dropped": [{"source_id": "two\nlines", "reason": "a \u001b[2Jb"}]},
    "warnings": [{"code": "odd", "message": "one\r\ntwo", "count": 3}]})";
  const Outcome info = run("info report.json");
  EXPECT_EQ(info.code, 0) << info.err;
  for (const char* line : {"\n  dropped: two lines: a  [2Jb\n", "\n  note: odd: one  two (3)\n"})
    EXPECT_NE(info.out.find(line), std::string::npos) << info.out;
}

TEST_F(Cli, ErrorsStayOneLineWhateverTheNames) {
  expect_error("build --footprints x.shp --points 'two\nlines.laz' --out result", 3,
               "two lines.laz");
  expect_error("build --mesh-size '1\n2'", 2, "is not a number");
  expect_error("'bu\nild'", 2, "there is no command 'bu ild'");
}

TEST_F(Cli, NotesStayOneLineWhateverTheNames) {
  synth("--buildings 20 --size 250");
  fs::remove(scratch / "input/footprints.prj");
  fs::rename(scratch / "input", scratch / "two\nlines");
  const Outcome outcome =
      run("city --footprints 'two\nlines/footprints.shp' --points two* --out result --log run.log");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  for (const std::string& text : {outcome.err, bytes_of(scratch / "run.log")})
    EXPECT_NE(text.find(": two lines/footprints.shp: states no CRS"), std::string::npos) << text;
}

/// As a shell makes them of a folder's name with a blank in it.
TEST_F(Cli, WordsTooManyAreRefused) {
  expect_error("build --footprints a.shp --points p.laz --mesh-size 5 --mesh-size 6 --out x", 2,
               "--mesh-size is given 2 times; give it once");
  expect_error("build --footprints a.shp --points p.laz --out my city", 2,
               "unknown argument 'city'");
  expect_error("build --mesh-size 5 20 --footprints a.shp --points p.laz --out x", 2,
               "unknown argument '20'");
}

TEST_F(Cli, OptionsWithoutTheirValueTakeNoOtherOption) {
  expect_error("synth --log= --quiet --out x", 2, "--log has no value");
  expect_error("build --footprints= --points p.laz --out x", 2, "--footprints has no value");
  expect_error("synth --out x --log --quiet", 2, "--log has no value");
  expect_error("build --footprints --points p.laz --out x", 2, "--footprints has no value");
  expect_error("build --footprints a.shp --points --out x", 2, "--points has no value");
  EXPECT_FALSE(fs::exists(scratch / "--quiet"));
  EXPECT_EQ(run("synth --quiet --buildings 2 --size 60 --out=a=").code, 0);
  EXPECT_EQ(run("info ''").code, 2);
  expect_error("check ''", 2, "an empty name");
}

TEST_F(Cli, AReferenceSystemThatNobodyKnowsIsNamedAsTheReason) {
  std::ofstream(scratch / "a.geojson")
      << R"({"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name":
         "EPSG::999999"}}, "features": [{"type": "Feature", "properties": {}, "geometry":
         {"type": "Polygon", "coordinates": [[[0, 0], [9, 0], [9, 9], [0, 0]]]}}]})";
  const Outcome outcome = run("info a.geojson");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_NE(outcome.err.find("a.geojson: states a CRS that PROJ does not"), std::string::npos)
      << outcome.err;
}

TEST_F(Cli, UnusableInputExitsWithThree) {
  synth("--buildings 40 --size 250");
  const auto build = [](const std::string& footprints, const std::string& points,
                        const std::string& more = "") {
    return "build --footprints " + footprints + " --points " + points + " --out result " + more;
  };
  const std::string shp = "input/footprints.shp", laz = "input/points.laz";
  expect_error(build("nowhere.shp", laz), 3, "nowhere.shp");
  expect_error(build(shp, "nowhere.laz"), 3, "nowhere.laz: no such file");
  fs::create_directory(scratch / "empty");
  expect_error(build(shp, "empty"), 3, "empty");
  std::ofstream(scratch / "text.laz") << "these are no points\n";
  expect_error(build(shp, "text.laz"), 3, "text.laz");
  std::ofstream(scratch / "zero.laz") << "";
  expect_error(build(shp, "zero.laz"), 3, "zero.laz");
  const std::string whole = bytes_of(scratch / "input/points.laz");
  for (const double share : {0.01, 0.3, 0.7, 0.999}) {
    std::ofstream(scratch / "cut.laz", std::ios::binary)
        << whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size())));
    expect_error(build(shp, "cut.laz"), 3, "cut.laz");
  }
  std::ofstream(scratch / "text.shp") << "no shapes here";
  expect_error(build("text.shp", laz), 3, "text.shp");
  expect_error(build(shp, laz, "--bounds 0,0,100,100"), 3, "do not overlap");
  expect_error(build(shp, laz, "--bounds 319000,6396000,319010,6396010"), 3, "no usable footprint");
  expect_error(build(shp, laz, "--bounds 319000 6396000 319010 6396010"), 3, "no usable footprint");
  for (const char* sides : {"-20 -1e1 -5 5", "-20, -10, -5, 5", "'-20, -10, -5, 5'"})
    expect_error(build(shp, laz, std::string("--bounds ") + sides), 3,
                 "the domain is x -20 .. -5, y -10 .. 5");
  expect_error(build(shp, laz, "--id-attribute nme"), 3, "nme");
  expect_error(build(shp, laz, "--layer roads"), 3, "roads");
  std::ofstream(scratch / "degrees.geojson")
      << R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[[11.9,57.7],[11.901,57.7],[11.901,57.701],[11.9,57.7]]]}}]})";
  expect_error(build("degrees.geojson", laz), 3, "overlap");
  expect_error(build(shp, laz, "--points-crs EPSG:4326"), 3, "degrees");
  std::ofstream(scratch / "none.geojson") << R"({"type":"FeatureCollection","features":[]})";
  expect_error(build("none.geojson", laz), 3, "none.geojson");
  std::ofstream(scratch / "bad.city.json") << "{";
  expect_error("mesh --city bad.city.json --dtm x.tif --out result", 3, "bad.city.json");
  EXPECT_EQ(run("check nowhere").code, 3);
  EXPECT_EQ(run("check text.shp").code, 3);
  EXPECT_EQ(run("info nowhere.las").code, 3);
}

TEST_F(Cli, ShapefileWithoutPrjTakesThePointsSystem) {
  synth("--buildings 40 --size 250");
  fs::remove(scratch / "input/footprints.prj");
  const Outcome outcome =
      run("build --footprints input/footprints.shp --points input/points.laz --out result");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("footprints_crs_unknown"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("states no CRS: taken from the points (EPSG:3006)"), std::string::npos)
      << outcome.err;
  EXPECT_NE(bytes_of(scratch / "result/report.json").find("\"crs\": \"EPSG:3006\""),
            std::string::npos);
}

TEST_F(Cli, OfAFolderWithFilesOfBuildingsOnlyTheseAreRead) {
  synth("--buildings 10 --size 150");
  fs::create_directory(scratch / "extract");
  for (const char* end : {"shp", "shx", "dbf", "prj"})
    for (const char* name : {"buildings_a_free_1", "landuse_a_free_1"})
      fs::copy_file(scratch / ("input/footprints." + std::string(end)),
                    scratch / fmt::format("extract/{}.{}", name, end));
  const Outcome outcome = run("city extract input/points.laz result");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("of 10 footprints"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("files_of_buildings: extract: 1 files without 'building' in their "
                             "names are not read (first: landuse_a_free_1.shp)"),
            std::string::npos)
      << outcome.err;
  // Both by name, or where no name tells.
  EXPECT_NE(run("city --footprints extract/*.shp --points input/points.laz --out result")
                .err.find("of 20 footprints"),
            std::string::npos);
  for (const char* end : {"shp", "shx", "dbf", "prj"})
    fs::rename(scratch / ("extract/buildings_a_free_1." + std::string(end)),
               scratch / ("extract/houses." + std::string(end)));
  EXPECT_NE(run("city extract input/points.laz result").err.find("of 20 footprints"),
            std::string::npos);
}

TEST_F(Cli, AFailedRunLeavesAnEarlierResultWhole) {
  synth("--buildings 20 --size 250");
  ASSERT_EQ(run("build --quiet --footprints input/footprints.shp --points input --out result").code,
            0);
  const std::string report = bytes_of(scratch / "result/report.json"),
                    mesh = bytes_of(scratch / "result/volume.vtu");
  expect_error("build --footprints input/footprints.shp --points nowhere.laz --out result", 3,
               "nowhere.laz");
  EXPECT_TRUE(bytes_of(scratch / "result/report.json") == report);
  EXPECT_TRUE(bytes_of(scratch / "result/volume.vtu") == mesh);
}

TEST_F(Cli, InterruptEndsTheRunAndLeavesNothing) {
  synth("--buildings 3000 --size 2500 --point-density 0.5");
  for (const double seconds : {0.0, 0.4, 1.0}) {
    // The signal is sent once the run has begun to write: before that a shell's child ignores it.
    const Outcome outcome = shell(
        "{ '" TETROPOLIS_PROGRAM
        "' build --quiet --mesh-size 3 --footprints input/footprints.shp --points input "
        "--out result & "
        "pid=$!; " +
        kUntilItWrites + "sleep " + std::to_string(seconds) + "; kill -INT $pid; wait $pid; }");
    EXPECT_EQ(outcome.code, 130) << seconds;
    EXPECT_EQ(outcome.err, "tetropolis: interrupted; nothing was written\n");
    EXPECT_EQ(left(), (std::set<std::string>{"input"})) << seconds;
  }
}

TEST_F(Cli, ClosedAndFullStreamsAreNoReasonToFail) {
  synth("--buildings 20 --size 250");
  const std::string build =
      "'" TETROPOLIS_PROGRAM
      "' build --footprints input/footprints.shp --points input --out result ";
  EXPECT_EQ(shell(build + "2>&-").code, 0);
  if (fs::exists("/dev/full")) {
    EXPECT_EQ(shell(build + "2>/dev/full").code, 0);
    // What was asked for and is lost is told, once; a lost log, too.
    const Outcome unseen = shell("'" TETROPOLIS_PROGRAM "' check result >/dev/full");
    EXPECT_EQ(unseen.code, 3);
    EXPECT_EQ(unseen.err, "tetropolis: cannot write to standard output: disk full?\n");
    for (const char* asked : {"--help", "build --help", "--version", "settings", "init -"}) {
      const Outcome lost = shell(std::string("'" TETROPOLIS_PROGRAM "' ") + asked + " >/dev/full");
      EXPECT_EQ(lost.code, 3) << asked;
      EXPECT_EQ(lost.err, unseen.err) << asked;
    }
    const Outcome unlogged = shell(build + "--quiet --log /dev/full");
    EXPECT_EQ(unlogged.code, 0);
    EXPECT_EQ(unlogged.err,
              "tetropolis: /dev/full: the log could not be written whole; make room\n");
  }
  EXPECT_EQ(shell("{ " + build + "2>&1; echo $? >code; } | true; cat code").out, "0\n");
  // A reader that has seen enough is no full disk. The pipe is closed before anything is printed.
  for (const char* asked : {"check result", "--help", "settings"}) {
    const Outcome closed = shell(std::string("{ sleep 0.3; '" TETROPOLIS_PROGRAM "' ") + asked +
                                 "; echo $? >code; } | true; cat code");
    EXPECT_EQ(closed.out, "0\n") << asked;
    EXPECT_EQ(closed.err, "") << asked;
  }
  EXPECT_EQ(shell("'" TETROPOLIS_PROGRAM "' nothing 2>&-").code, 2);
  fs::remove(scratch / "code");
  EXPECT_EQ(left(), (std::set<std::string>{"input", "result"}));
}

TEST_F(Cli, ConfigurationFileAndOptionsMeet) {
  synth("--buildings 20 --size 250");
  ASSERT_EQ(run("init my.toml").code, 0);
  EXPECT_EQ(run("init my.toml").code, 2);  // never overwrites
  fs::create_symlink("elsewhere.toml", scratch / "link.toml");
  EXPECT_EQ(run("init link.toml").code, 2);
  EXPECT_TRUE(fs::is_symlink(scratch / "link.toml"));
  const Outcome nowhere = run("init nowhere/my.toml");
  EXPECT_EQ(nowhere.code, 2);
  EXPECT_NE(nowhere.err.find("there is no folder nowhere"), std::string::npos) << nowhere.err;
  std::ofstream(scratch / "my.toml", std::ios::app)
      << "footprints = \"input/footprints.shp\"\npoints = [\"input\"]\nmesh_size = 20\nout = "
         "\"result\"\n";
  ASSERT_EQ(run("build --quiet --config my.toml").code, 0);
  EXPECT_NE(bytes_of(scratch / "result/report.json").find("\"mesh_size\": 20.0"),
            std::string::npos);
  ASSERT_EQ(run("build --quiet --config my.toml --mesh-size 15 --log run.log").code, 0);
  EXPECT_NE(bytes_of(scratch / "result/report.json").find("\"mesh_size\": 15.0"),
            std::string::npos);
  EXPECT_NE(bytes_of(scratch / "run.log").find("3.1  ground mesh"), std::string::npos);
}

TEST_F(Cli, OptionsTakeSwitchesOfTheFileBack) {
  synth("--buildings 20 --size 250");
  std::ofstream(scratch / "my.toml") << "footprints = \"input/footprints.shp\"\npoints = "
                                        "[\"input\"]\nout = \"result\"\nquiet = true\n";
  EXPECT_EQ(run("city --config my.toml").err, "");
  EXPECT_EQ(run("city --config my.toml --quiet").err, "");
  const Outcome loud = run("city --config my.toml --quiet=false");
  EXPECT_EQ(loud.code, 0);
  EXPECT_NE(loud.err.find("results in result"), std::string::npos) << loud.err;
}

TEST_F(Cli, HelpNamesWhatMattersAndHelpAllEveryOption) {
  const std::string help = run("build --help").out, all = run("build --help-all").out;
  EXPECT_EQ(run("help build").out, help);
  const auto options_in = [](const std::string& text) {
    const std::regex option("\n  (-.,)?--");
    return std::distance(std::sregex_iterator(text.begin(), text.end(), option), {});
  };
  EXPECT_EQ(options_in(help), 18 + 2);  // and those of help itself
  for (const char* part : {"--footprints PATH...", "--points PATH...", "-o,--out DIR",
                           "--mesh-size", "FOOTPRINTS POINTS... OUT", "Example:\n", "--help-all"})
    EXPECT_NE(help.find(part), std::string::npos) << part;
  for (const ConfigField& field : config_fields())
    EXPECT_EQ(all.find(option_name(field) + ' ') != std::string::npos ||
                  all.find(option_name(field) + '\n') != std::string::npos,
              (field.commands & kBuild) != 0)
        << field.name;
  EXPECT_NE(run("synth --help-all").out.find("--defects NAME,..."), std::string::npos);
  for (const char* asked : {"--version", "-V"})
    EXPECT_EQ(run(asked).out.substr(0, 11), "tetropolis ");
  EXPECT_EQ(run("help").out, run("--help").out);
  EXPECT_NE(run("help biuld").err.find("did you mean 'build'?"), std::string::npos);
}

#ifdef TETROPOLIS_DEFERRED
/// GDAL brings a hundred libraries along, which a start would wait for.
TEST_F(Cli, LibrariesOfFormatsAreLoadedWhenNeeded) {
  const Outcome start = shell("LD_TRACE_LOADED_OBJECTS=1 '" TETROPOLIS_PROGRAM "'");
  EXPECT_NE(start.out.find("libtbb"), std::string::npos) << start.out;
  for (const char* library : {"libgdal", "libproj", "libhdf5"})
    EXPECT_EQ(start.out.find(library), std::string::npos) << start.out;
}
#endif

TEST_F(Cli, HelpFitsTheTerminal) {
  for (const char* columns : {"40", "60", "80", "133"}) {
    for (const char* asked : {"build --help-all", "--help", "check --help"}) {
      const Outcome help =
          shell(std::string("COLUMNS=") + columns + " '" TETROPOLIS_PROGRAM "' " + asked);
      std::istringstream lines(help.out);
      std::size_t widest = 0;
      for (std::string line; std::getline(lines, line);)
        // Names of options, usage and examples are copied, not wrapped.
        if (line.find("--") == std::string::npos && line.find("tetropolis") == std::string::npos)
          widest = std::max(widest, line.size());
      EXPECT_LE(widest, std::stoul(columns)) << help.out;
      if (asked == std::string("build --help-all")) {
        EXPECT_GT(widest + 12, std::stoul(columns)) << help.out;
      }
    }
  }
}

/// Words without an option stand for what is not given otherwise.
TEST_F(Cli, WordsStandForInputAndOutput) {
  synth("--buildings 20 --size 250");
  const auto same_as = [&](const std::string& arguments) {
    SCOPED_TRACE(arguments);
    const Outcome outcome = run(arguments + " --quiet");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const Json report = Json::parse(bytes_of(scratch / "two/report.json"));
    EXPECT_EQ(report["config"]["out"], "two");
    EXPECT_EQ(report["config"]["footprints"], Json({"input/footprints.shp"}));
    EXPECT_TRUE(bytes_of(scratch / "two/city.city.json") ==
                bytes_of(scratch / "one/city.city.json"));
    fs::remove_all(scratch / "two");
  };
  ASSERT_EQ(
      run("city --quiet --footprints input/footprints.shp --points input/points.laz --out one")
          .code,
      0);
  same_as("city input/footprints.shp input/points.laz two");
  same_as("city input/footprints.shp input/points.laz input two");
  same_as("city input/footprints.shp input/points.laz -o two");
  same_as("city two --footprints input/footprints.shp --points input");
  EXPECT_EQ(run("city -q -- input/footprints.shp input dashes").code, 0);
  same_as("city --dtm-step 1 input/footprints.shp input/points.laz two --threads 1");
  std::ofstream(scratch / "c.toml") << "points = [\"input\"]\n";
  same_as("city --config c.toml input/footprints.shp two");
  ASSERT_EQ(run("mesh one/city.city.json one/dtm.tif mesh --quiet --mesh-size 20").code, 0);
  EXPECT_EQ(run("check mesh").code, 0);
  EXPECT_EQ(run("city --quiet --terrain-only input bare").code, 0);
  EXPECT_EQ(run("synth other --quiet --buildings 2 --size 60").code, 0);
  expect_error("city input/footprints.shp input", 2, "missing: --out (");
  // A word that is nowhere, or has results already, is their folder.
  EXPECT_EQ(run("city --quiet input/footprints.shp level").code, 0);  // without points
  EXPECT_EQ(run("city --quiet input/footprints.shp level").code, 0);
  fs::create_directory(scratch / "empty");
  EXPECT_EQ(run("city --quiet input/footprints.shp empty").code, 0);
  EXPECT_EQ(run("mesh --quiet --mesh-size 20 one/city.city.json again").code, 0);  // one/dtm.tif
  expect_error("city input/footprints.shp input new extra", 3,
               "new: no such file or folder; all words but the first and the last");
  expect_error("city", 2, "missing: --footprints (");
  expect_error(
      "city", 2,
      "--points (LAS or LAZ files or a folder of them, or rasters with dtm or dsm), --out (");
  expect_error("mesh a b c d", 2, "unknown argument 'd'; the words of this command are CITY DTM");
  // Sides without commas are not words.
  expect_error("city --bounds 1 2 3 4 input/footprints.shp input two", 3, "do not overlap");
  expect_error("city --bounds 1,2,3,4 input/footprints.shp input two", 3, "do not overlap");
}

TEST_F(Cli, SwappedArgumentsAreRecognised) {
  synth("--buildings 20 --size 250");
  expect_error("city input/points.laz input/footprints.shp out", 2,
               "input/points.laz: is a point cloud, but given as --footprints; swap --footprints "
               "and --points");
  fs::create_directory(scratch / "tiles");
  fs::copy(scratch / "input/points.laz", scratch / "tiles/a.laz");
  expect_error("city tiles input/footprints.shp out", 2,
               "tiles: is a folder of point clouds, but given as --footprints; swap");
  expect_error("city --footprints tiles --out out", 2, "name it as --points");
  expect_error("city input/footprints.shp input/footprints.shp tiles out", 2,
               "input/footprints.shp: is a vector file, but given as --points");
  ASSERT_EQ(run("city input/footprints.shp tiles one --quiet").code, 0);
  expect_error("mesh one/dtm.tif one/city.city.json out", 2,
               "one/dtm.tif: is a raster, but given as --city; swap --city and --dtm");
  expect_error("city input/footprints.shp one/dtm.tif out", 2, "name it as --dsm");
  expect_error("city input/footprints.shp tiles/a.laz one/dtm.tif out", 2, "name it as --dtm");
  expect_error("city input/footprints.shp input/footprints.dbf tiles out", 2,
               "input/footprints.dbf: is a vector file, but given as --points");
  // The folder is forgotten.
  expect_error("city input/footprints.shp tiles/a.laz tiles/a.laz", 2,
               "tiles/a.laz: is given as --out, the folder for the results");
  expect_error("city input/footprints.shp tiles --out result.vtu", 2, "result.vtu: is given as");
  EXPECT_EQ(run("city --quiet one/city.city.json tiles modelled").code, 0);
  expect_error("city input/footprints.shp one/city.city.json out", 2,
               "one/city.city.json: is a city model; 'tetropolis mesh' makes a mesh of it");
  expect_error("one", 2, "there is no command 'one'; write it after one: tetropolis build one");
}

TEST_F(Cli, BoundsInDegreesAreRecognised) {
  synth("--buildings 20 --size 250");
  for (const char* bounds : {"11.95,57.66,11.97,57.68", "57.66,11.95,57.68,11.97"}) {
    const Outcome outcome =
        run(std::string("city input/footprints.shp input out --quiet ") + "--bounds " + bounds);
    EXPECT_EQ(outcome.code, 2);
    const std::regex message(
        "tetropolis: --bounds: [0-9.,]+ look like degrees( \\(latitude first\\))?, but the data "
        "are in EPSG:3006; give (--bounds [0-9,]+)\n");
    std::smatch match;
    ASSERT_TRUE(std::regex_match(outcome.err, match, message)) << outcome.err;
    EXPECT_EQ(match[1].matched, bounds[0] == '5') << outcome.err;
    // What it proposes has the city in it.
    const Outcome proposed =
        run("city input/footprints.shp input out --quiet " + std::string(match[2]));
    EXPECT_EQ(proposed.code, 0) << proposed.err;
    EXPECT_EQ(Json::parse(bytes_of(scratch / "out/report.json"))["preflight"]["footprints"], 20);
  }
  expect_error("city input/footprints.shp input out --bounds 4.35,52.0,4.36,52.01", 2,
               "look like degrees; in EPSG:3006 they are ");
  ASSERT_EQ(run("city input/footprints.shp input one --quiet").code, 0);
  expect_error("mesh one/city.city.json one/dtm.tif two --bounds 11.95,57.66,11.97,57.68", 2,
               "look like degrees");
}

TEST_F(Cli, NobodysFilesAreReplaced) {
  synth("--buildings 20 --size 250");
  fs::create_directory(scratch / "mine");
  std::ofstream(scratch / "mine/dtm.tif") << "mine";
  const std::string city = "city input/footprints.shp input mine ";
  expect_error(city, 2,
               "mine/dtm.tif: is in the way, and no earlier run has written it; choose another "
               "folder with --out, or add --overwrite");
  EXPECT_EQ(bytes_of(scratch / "mine/dtm.tif"), "mine");
  // Before anything is read.
  expect_error("city nowhere.shp nowhere.laz mine", 2, "mine/dtm.tif");
  ASSERT_EQ(run(city + "--overwrite --quiet").code, 0);
  EXPECT_NE(bytes_of(scratch / "mine/dtm.tif"), "mine");
  const Outcome again = run(city);
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_TRUE(std::regex_search(
      again.err,
      std::regex("^mine: replaces the run of 20[0-9]{2}-[01][0-9]-[0-3][0-9] [012][0-9]:[0-5]")))
      << again.err;
  std::ofstream(scratch / "mine/volume.vtu") << "mine";
  expect_error("build input/footprints.shp input mine", 2, "mine/volume.vtu: is in the way");
  fs::remove(scratch / "mine/report.json");
  expect_error("city input/footprints.shp input mine", 2, "mine/city_raw.city.json: is in the way");
  expect_error("city input/footprints.shp mine", 2, "if mine is it, write --out mine");
  expect_error("city --footprints input/footprints.shp nowhere", 2, "write --out nowhere");
}

TEST_F(Cli, SaysWhatTheInputIsAndWhatWasAssumed) {
  synth("--buildings 20 --size 250");
  const Outcome outcome = run("city input/footprints.shp input out");
  EXPECT_TRUE(std::regex_search(
      outcome.err,
      std::regex("input: 57\\.[0-9]+ N, 11\\.[0-9]+ E \\(Sweden\\), EPSG:3006; 2 points per m2, "
                 "classes 2 6; they cover 100 % of the footprints' box, 20 of 20 footprints have "
                 "some\n")))
      << outcome.err;
  const Json report = Json::parse(bytes_of(scratch / "out/report.json"));
  EXPECT_EQ(report["preflight"]["footprints_with_points"], 20);
  EXPECT_EQ(report["place"]["area"], "Sweden");
  // Points that state no system: the same cloud without its records.
  write_points(scratch / "plain.las", read_points(std::array{scratch / "input/points.laz"}).points,
               read_points(std::array{scratch / "input/points.laz"}).origin);
  const Outcome assumed = run("city input/footprints.shp plain.las out");
  EXPECT_EQ(assumed.code, 0) << assumed.err;
  EXPECT_NE(assumed.err.find("EPSG:3006 (of the footprints: the points have none)"),
            std::string::npos)
      << assumed.err;
  EXPECT_NE(
      assumed.err.find("plain.las: the points have no CRS: taken from the footprints (EPSG:3006)"),
      std::string::npos)
      << assumed.err;
  EXPECT_EQ(run("city --quiet input/footprints.shp input out").err, "");
  // A system that is made for another place.
  const Outcome elsewhere =
      run("city input/footprints.shp input out --points-crs 28992 --footprints-crs 28992");
  EXPECT_NE(elsewhere.err.find("crs_elsewhere"), std::string::npos) << elsewhere.err;
}

TEST_F(Cli, StepsHaveTheNumbersOfThePaperWhenAskedFor) {
  synth("--buildings 20 --size 250");
  const std::string build = "build input/footprints.shp input out --mesh-size 20 ";
  const Outcome plain = run(build + "--log plain.log");
  const Outcome verbose = run(build + "-v");
  EXPECT_EQ(plain.err.find("3.5  place nodes"), std::string::npos) << plain.err;
  EXPECT_NE(verbose.err.find("3.5  place nodes"), std::string::npos) << verbose.err;
  EXPECT_NE(bytes_of(scratch / "plain.log").find("3.5  place nodes"), std::string::npos);
  std::size_t at = 0;
  for (const char* stage : {"\nReading ", "\nTerrain ", "\nBuildings ", "\nMeshing ", "\nWriting ",
                            "\nBuilt 1", "\nMeshed ", "\nOpen out/", "\ncells ", "\ndone "}) {
    at = plain.err.find(stage, at);
    ASSERT_NE(at, std::string::npos) << stage << " in " << plain.err;
  }
}

TEST_F(Cli, ShellsCompleteCommandsOptionsAndChoices) {
  for (const char* sh : {"bash", "zsh", "fish"}) {
    const Outcome text = run(std::string("completions ") + sh);
    EXPECT_EQ(text.code, 0);
    for (const ConfigField& field : config_fields())
      EXPECT_NE(text.out.find(option_name(field).substr(2)), std::string::npos) << field.name;
    std::ofstream(scratch / sh) << text.out;
    if (shell(std::string(sh) + " --version").code == 0) {
      EXPECT_EQ(shell(std::string(sh) + " -n " + sh).code, 0) << sh;
    }
  }
  EXPECT_NE(run("completions tcsh").err.find("name bash, zsh or fish"), std::string::npos);
  if (shell("bash --version").code != 0) GTEST_SKIP() << "needs bash";
  const auto completed = [&](const std::string& line) {
    return shell("bash -c '. ./bash; COMP_WORDS=(" + line +
                 "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _tetropolis; echo \"${COMPREPLY[*]}\"'")
        .out;
  };
  EXPECT_EQ(completed("tetropolis bu"), "build\n");
  EXPECT_EQ(completed("tetropolis build --mesh"), "--mesh-size\n");
  EXPECT_EQ(completed("tetropolis city --mesh"), "\n");
  EXPECT_EQ(completed("tetropolis build --formats o"), "openfoam obj\n");
  EXPECT_EQ(completed("tetropolis help ch"), "check\n");
  EXPECT_EQ(completed("tetropolis build --footprints f"), "\n");  // the shell's own: files
}

TEST_F(Cli, TheManualNamesCommandsAndSettings) {
  const Outcome man = run("man");
  EXPECT_EQ(man.code, 0);
  EXPECT_TRUE(man.out.starts_with(".TH TETROPOLIS 1 ")) << man.out.substr(0, 80);
  for (const ConfigField& field : config_fields()) {
    const std::string name = std::regex_replace(option_name(field), std::regex("-"), "\\-");
    EXPECT_NE(man.out.find(name), std::string::npos) << field.name;
  }
  if (shell("groff --version").code != 0) GTEST_SKIP() << "needs groff";
  std::ofstream(scratch / "tetropolis.1") << man.out;
  const Outcome set = shell("groff -man -Tutf8 -ww tetropolis.1");
  EXPECT_EQ(set.err, "");
}

TEST_F(Cli, ReferencePagesAreThisPrograms) {
  const std::string page = bytes_of(fs::path(TETROPOLIS_SOURCE) / "docs/settings.md");
  const std::size_t tables = page.find("### Input");
  ASSERT_NE(tables, std::string::npos);
  EXPECT_EQ(page.substr(tables), run("settings").out) << "regenerate it: make docs";
  const std::string keys = bytes_of(fs::path(TETROPOLIS_SOURCE) / "docs/report.md");
  const std::size_t table = keys.find("| key |");
  ASSERT_NE(table, std::string::npos);
  EXPECT_EQ(keys.substr(table), run("report-keys").out) << "regenerate it: make docs";
}

}  // namespace
}  // namespace tetropolis
