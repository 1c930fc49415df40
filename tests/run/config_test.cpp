#include "tetropolis/run/config.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"
#include "tetropolis/run/run.h"

#include "run/command_line.h"
#include "support/errors.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

std::string write(const testing::TemporaryFolder& folder, const std::string& text) {
  std::ofstream(folder / "c.toml") << text;
  return (folder / "c.toml").string();
}

/// The message of the usage error that loading `text` ends with.
std::string error_of(const std::string& text) {
  const testing::TemporaryFolder folder;
  Config config;
  return testing::error_of([&] { load_config(config, write(folder, text)); }, ErrorKind::kUsage);
}

void expect_part(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(Config, TomlSetsEveryKindOfValue) {
  const testing::TemporaryFolder folder;
  Config config;
  load_config(config, write(folder, R"(
footprints = "a b.shp"
points = ["x.laz", "dir,with,commas"]
bounds = [1, 2.5, 3e2, 400]
terrain_only = true
mesh_size = 5
merge_growths = 2
top = "free"
formats = ["vtu", "obj"]
)"));
  EXPECT_EQ(config.footprints, (std::vector<std::string>{"a b.shp"}));
  EXPECT_EQ(config.points, (std::vector<std::string>{"x.laz", "dir,with,commas"}));
  EXPECT_EQ(config.bounds, (std::vector<double>{1, 2.5, 300, 400}));
  EXPECT_TRUE(config.terrain_only);
  EXPECT_EQ(config.mesh_size, 5);
  EXPECT_EQ(config.merge_growths, 2);
  EXPECT_EQ(config.top, Top::kFree);
  EXPECT_EQ(config.formats, (std::vector<std::string>{"vtu", "obj"}));
}

TEST(Config, ErrorsNameFileLineAndWhatToDo) {
  expect_part(error_of("\nmesh_sise = 5\n"),
              "c.toml:2: unknown key 'mesh_sise'; did you mean 'mesh_size'?");
  expect_part(error_of("colour_of_money = 5\n"),
              "unknown key 'colour_of_money'; see 'tetropolis init'");
  expect_part(error_of("mesh_size = -1\n"), "c.toml:1: mesh_size: -1 is less than 0.05");
  expect_part(error_of("mesh_size = \"5\"\n"), "takes a number, without quotes");
  expect_part(error_of("top = 5\n"), "takes text in quotes");
  expect_part(error_of("bounds = [1, 2, \"3\", 4]\n"), "takes numbers in brackets");
  expect_part(error_of("points = [\"a\", 3]\n"), "takes text in quotes");
  expect_part(error_of("points = [[\"a\"]]\n"), "points takes text in quotes");
  expect_part(error_of("mesh_size = {a = 1}\n"), "mesh_size takes a number");
  expect_part(error_of("seed = 2020-01-01\n"), "seed takes a number");
  expect_part(error_of("mesh_size = [5.0]\n"), "mesh_size takes one value, without brackets");
  expect_part(error_of("top = [\"flat\"]\n"), "top takes one value, without brackets");
  expect_part(error_of("ground_margin = 1e308\n"), "1e+308 is greater than");
  expect_part(error_of("top = \"open\"\n"), "'open' is not one of flat, free");
  expect_part(error_of("mesh_size = nan\n"), "not finite");
  expect_part(error_of("merge_growths = 2.5\n"), "'2.5' is not a whole number");
  expect_part(error_of("seed = 5000000000\n"),
              "seed: 5000000000 is out of range; give 0 to 2147483647");
  expect_part(error_of("domain_height = 1e300\n"), "1e+300 is greater than 100000");
  expect_part(error_of("bounds = [1, 2, 3]\n"), "four numbers expected");
  expect_part(error_of("bounds = [5, 2, 3, 4]\n"), "XMIN < XMAX");
  expect_part(error_of("terrain_only = 1\n"), "true or false expected");
  expect_part(error_of("mesh_size = \n"), "c.toml:1: not valid TOML");
  std::string deep = "# as deep as it gets\n";
  for (int i = 0; i < 300000; ++i) deep += "a.";
  expect_part(error_of(deep + "a = 1\n"), "c.toml:2: not valid TOML: more than 1000 dots");
  expect_part(error_of("[" + deep.substr(22) + "a]\n"), "not valid TOML: more than 1000 dots");
  expect_part(error_of("formats = [\"vtu\", \"dwg\"]\n"), "'dwg' is not one of");
  expect_part(error_of("out = \"a\\u0000x\"\n"), "c.toml:1: out: holds a NUL character");
  expect_part(error_of("\nmax_memory = \"eight\"\n"),
              "c.toml:2: max_memory: 'eight' is not a size");
  expect_part(error_of("points_crs = \"nonsense\"\n"), "c.toml:1: points_crs: 'nonsense'");
  expect_part(error_of("footprints_crs = \"nonsense\"\n"), "c.toml:1: footprints_crs: 'nonsense'");
  expect_part(error_of("points = [\"a\", \"b\\u0000\"]\n"), "points: holds a NUL character");
  Config config;
  EXPECT_THROW(load_config(config, "/nowhere/c.toml"), Error);
}

TEST(Config, TemplateListsEveryKeyAndLoadsWhenUncommented) {
  const testing::TemporaryFolder folder;
  std::string text = config_template(kBuild | kCity | kMesh | kSynth), active;
  std::set<std::string> keys;
  std::size_t begin = 0;
  for (std::size_t end; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    const std::string line = text.substr(begin, end - begin);
    for (const ConfigField& field : config_fields())
      if (line.starts_with("# " + std::string(field.name) + " = ")) {
        keys.insert(std::string(field.name));
        // Empty texts and lists stand for "not given".
        if (!line.ends_with("\"\"") && !line.ends_with("[]")) active += line.substr(2) + "\n";
      }
  }
  EXPECT_EQ(keys.size(), config_fields().size());
  Config config;
  load_config(config, write(folder, active));
  const Config defaults;
  for (const ConfigField& field : config_fields())
    EXPECT_EQ(value_text(field, config), value_text(field, defaults)) << field.name;
  for (const ConfigField& field : config_fields())
    EXPECT_NE(
        config_markdown().find("| `" + std::string(field.name) + "` | `" + option_name(field)),
        std::string::npos);
}

TEST(Config, DefaultsAreWithinTheirRanges) {
  const Config defaults;
  for (const ConfigField& field : config_fields())
    std::visit(
        [&](auto member) {
          if constexpr (std::is_same_v<decltype(member), ChoiceMember>) {
            EXPECT_LT(member.get(defaults), field.choices.size()) << field.name;
          } else {
            using Value = std::decay_t<decltype(defaults.*member)>;
            if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, double>) {
              EXPECT_GE(static_cast<double>(defaults.*member), field.min) << field.name;
              EXPECT_LE(static_cast<double>(defaults.*member), field.max) << field.name;
            }
          }
        },
        field.member);
}

/// What is told of a range is what is refused.
TEST(Config, WholeNumbersHaveBothEndsOfTheirRange) {
  for (const ConfigField& field : config_fields()) {
    if (!std::holds_alternative<int Config::*>(field.member)) continue;
    const auto number = [](double value) {
      return std::vector{std::to_string(static_cast<std::int64_t>(value))};
    };
    Config config;
    for (const double end : {field.min, field.max}) {
      ASSERT_TRUE(std::isfinite(end)) << field.name;
      EXPECT_NO_THROW(set_field(config, field, number(end), "test")) << field.name;
    }
    EXPECT_THROW(set_field(config, field, number(field.min - 1), "test"), Error) << field.name;
    EXPECT_THROW(set_field(config, field, number(field.max + 1), "test"), Error) << field.name;
  }
}

/// Whoever fills a Config himself is told as whoever types options.
TEST(Config, SettingsOutOfTheirRangeAreRefusedWhereverTheyComeFrom) {
  for (const unsigned commands : {kBuild, kCity, kMesh, kSynth})
    EXPECT_NO_THROW(require_in_range(Config{}, commands));
  const auto error_with = [](const auto& change) -> std::string {
    Config config;
    change(config);
    return testing::error_of([&] { require_in_range(config, kBuild); }, ErrorKind::kUsage);
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error_with([](Config& c) {
              c.bounds = {0, 0, 2};
            }),
            "`bounds`: four numbers expected: XMIN,YMIN,XMAX,YMAX");
  EXPECT_EQ(error_with([](Config& c) {
              c.bounds = {0, 5, 2, 5};
            }),
            "`bounds`: XMIN < XMAX and YMIN < YMAX expected");
  EXPECT_EQ(error_with([](Config& c) { c.ground_percentile = 400; }),
            "`ground_percentile`: 400.0 is greater than 100");
  EXPECT_EQ(error_with([](Config& c) { c.dtm_step = kNaN; }), "`dtm_step`: 'nan' is not finite");
  EXPECT_NE(error_with([](Config& c) {
              c.formats = {"vtu", "doc"};
            }).find("'doc' is not one of"),
            std::string::npos);
  EXPECT_NE(error_with([](Config& c) { c.top = static_cast<Top>(7); }).find("`top`: is not one of"),
            std::string::npos);
  // Another command's.
  EXPECT_EQ(error_with([](Config& c) { c.point_density = -1; }), "");
  Config config;
  config.mesh_size = -1;
  EXPECT_THROW(run_mesh(config), Error);
}

TEST(Config, FindsTheNearestName) {
  const std::vector<std::string> known{"mesh_size", "min_angle", "bounds"};
  EXPECT_EQ(nearest_name("mesh-size", known), "mesh_size");
  EXPECT_EQ(nearest_name("minangle", known), "min_angle");
  EXPECT_EQ(nearest_name("xyz", known), "");
}

/// The words of a command line as a shell splits it.
std::vector<std::string> words_by_shell(const std::string& line) {
  const testing::TemporaryFolder folder;
  const std::string file = (folder / "words").string();
  EXPECT_EQ(std::system(("printf '%s\\0' " + line + " > '" + file + "'").c_str()), 0);
  std::ifstream stream(file, std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(stream, word, '\0');) words.push_back(word);
  return words;
}

TEST(Config, CommandLineRepeatsTheRun) {
  Config config;
  config.footprints = {"it's $HOME; `x` \"quoted\"/f.gpkg"};
  config.points = {"a b/*.laz", "c,d"};
  config.out = "result";
  config.bounds = {0.1, -2, 85000.123456, 3};
  config.mesh_size = 7.5;
  config.formats = {"vtu", "xdmf"};
  config.boundary_buildings = BoundaryBuildings::kClip;
  config.terrain_only = true;
  config.threads = 3;
  config.size = 99;  // of another command
  const std::vector<std::string> words = words_by_shell(command_line(config, "build"));
  ASSERT_EQ(words[0] + " " + words[1], "tetropolis build");

  Config again;
  for (std::size_t i = 2; i < words.size();) {
    const auto field =
        std::find_if(config_fields().begin(), config_fields().end(),
                     [&](const ConfigField& known) { return option_name(known) == words[i]; });
    ASSERT_NE(field, config_fields().end()) << words[i];
    std::vector<std::string> values;
    for (++i; i < words.size() && !words[i].starts_with("--"); ++i) values.push_back(words[i]);
    if (values.empty()) values.emplace_back("true");
    set_field(again, *field, values, words[i - 1]);
  }
  config.size = again.size;
  for (const ConfigField& field : config_fields())
    EXPECT_EQ(value_text(field, again), value_text(field, config)) << field.name;
}

}  // namespace
}  // namespace tetropolis
