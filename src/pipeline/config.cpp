#include "tetropolis/pipeline/config.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

namespace tetropolis {

namespace {

constexpr unsigned kAll = kBuild | kCity | kMesh | kSynth;
constexpr unsigned kData = kBuild | kCity;
constexpr unsigned kMeshing = kBuild | kMesh;
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kTiny = 1e-6;  // stands for "greater than zero"

std::vector<ConfigField> make_fields() {
  using C = Config;
  return {
      {"footprints", "Input", &C::footprints, kData,
       "Building footprints, any vector format of GDAL"},
      {"points", "Input", &C::points, kData, "Point clouds: LAS or LAZ files, folders, patterns"},
      {"city", "Input", &C::city, kMesh, "City model in CityJSON, as `city` and `build` write it"},
      {"dtm", "Input", &C::dtm, kMesh, "Terrain raster, as `city` and `build` write it"},
      {"bounds", "Input", &C::bounds, kBuild | kCity | kMesh,
       "Domain XMIN,YMIN,XMAX,YMAX in the points' CRS; default: footprints and points and a margin",
       "m", -1e9, 1e9},
      {"points_crs", "Input", &C::points_crs, kData, "CRS of the points, overriding the files"},
      {"footprints_crs", "Input", &C::footprints_crs, kData,
       "CRS of the footprints, overriding the file"},
      {"layer", "Input", &C::layer, kData, "Layer of the footprint file"},
      {"id_attribute", "Input", &C::id_attribute, kData,
       "Attribute with the buildings' ids; default: the feature number"},
      {"height_attribute", "Input", &C::height_attribute, kData,
       "Attribute with heights above ground, used where there are no roof points"},
      {"terrain_only", "Input", &C::terrain_only, kBuild | kCity | kMesh,
       "Accept a domain without any building"},

      {"out", "Output", &C::out, kAll, "Folder for the results"},
      {"formats",
       "Output",
       &C::formats,
       kMeshing,
       "Formats of the meshes, comma separated",
       "",
       -kInf,
       kInf,
       {"vtu", "xdmf", "msh", "openfoam", "obj", "ply", "glb"}},
      {"coordinates",
       "Output",
       &C::coordinates,
       kMeshing,
       "Coordinates of meshes: relative to the origin in report.json, or those of the CRS",
       "",
       -kInf,
       kInf,
       {"local", "absolute"}},
      {"compression",
       "Output",
       &C::compression,
       kMeshing,
       "Of volume.vtu, boundary.vtp and volume.h5: a quarter of the size or less, slower to write",
       "",
       -kInf,
       kInf,
       {"none", "zlib"}},

      {"domain_margin", "City model", &C::domain_margin, kData,
       "Margin around the footprints when no bounds are given", "m", 0},
      {"dtm_step", "City model", &C::dtm_step, kData, "Distance between the terrain's nodes", "m",
       0.01},
      {"ground_filter",
       "City model",
       &C::ground_filter,
       kData,
       "Find ground points by a morphological filter: where no point has the ground class, never, "
       "or always",
       "",
       -kInf,
       kInf,
       {"auto", "never", "always"}},
      {"ground_filter_window", "City model", &C::ground_filter_window, kData,
       "For that filter: half the width of the widest building that is not among the footprints",
       "m", 1, 1000},
      {"ground_filter_slope", "City model", &C::ground_filter_slope, kData,
       "For that filter: rise over run of the steepest terrain", "", 0.01, 2},
      {"parallel_tolerance", "City model", &C::parallel_tolerance, kData,
       "Consecutive edges that differ less in direction are one", "rad", 0, 0.5},
      {"ground_margin", "City model", &C::ground_margin, kData,
       "Width of the ring around a footprint that tells its ground height", "m", 0},
      {"outlier_sigma", "City model", &C::outlier_sigma, kData,
       "Points further from the mean height are outliers", "standard deviations", kTiny},
      {"ground_percentile", "City model", &C::ground_percentile, kData,
       "Ground height: percentile of the ground points", "%", 0, 100},
      {"roof_percentile", "City model", &C::roof_percentile, kData,
       "Roof height: percentile of the roof points", "%", 0, 100},
      {"min_building_height", "City model", &C::min_building_height, kData,
       "Lower buildings are raised to it", "m", 0.1},
      {"min_building_distance", "City model", &C::min_building_distance, kData | kMesh,
       "Footprints closer than this are merged; no detail is smaller", "m", 0.05},
      {"merge_growths", "City model", &C::merge_growths, kData,
       "Reaches tried for patches between footprints: the distance, twice that, ...", "", 1, 10},
      {"min_building_area", "City model", &C::min_building_area, kData,
       "Smaller footprints are dropped after merging", "m2", 0},
      {"boundary_buildings",
       "City model",
       &C::boundary_buildings,
       kData,
       "Buildings that cross the domain's boundary",
       "",
       -kInf,
       kInf,
       {"drop", "clip"}},

      {"mesh_size", "Mesh", &C::mesh_size, kMeshing, "Longest edge in the ground mesh", "m", 0.05},
      {"min_angle", "Mesh", &C::min_angle, kMeshing,
       "Least angle of the ground mesh, where footprints allow", "degrees", 0, 30},
      {"domain_height", "Mesh", &C::domain_height, kMeshing,
       "Height of the domain above the highest ground", "m", 0.1},
      {"layering",
       "Mesh",
       &C::layering,
       kMeshing,
       "Nodes of a column as far apart as the triangles around it are wide, or in layers of the "
       "same "
       "height everywhere, moved by two Laplace problems",
       "",
       -kInf,
       kInf,
       {"graded", "uniform"}},
      {"layer_height", "Mesh", &C::layer_height, kMeshing,
       "Mean height of uniform layers, 0: the mesh size; greatest spacing in graded columns, 0: "
       "free",
       "m", 0},
      {"top",
       "Mesh",
       &C::top,
       kMeshing,
       "Top of the domain: kept flat, or free to follow the terrain",
       "",
       -kInf,
       kInf,
       {"flat", "free"}},
      {"min_wall_height", "Mesh", &C::min_wall_height, kMeshing,
       "Where terrain rises above a roof less this, the ground at the wall is lowered", "m", 0.01},
      {"min_gap_share", "Mesh", &C::min_gap_share, kMeshing,
       "Uniform layering: least height of a cell's vertical edge, as a share of the even spacing",
       "", 0.001, 0.9},
      {"solver_tolerance", "Mesh", &C::solver_tolerance, kMeshing,
       "Uniform layering, free top: error, relative to the first guess, at which smoothing stops",
       "", 1e-6, 0.5},
      {"solver_iterations", "Mesh", &C::solver_iterations, kMeshing,
       "Uniform layering, free top: most iterations of one smoothing", "", 1, 100000},

      {"kind",
       "Synthetic city",
       &C::kind,
       kSynth,
       "The paper's random rectangles, a street grid with blocks, park and river, or a village "
       "with a mix of defects",
       "",
       -kInf,
       kInf,
       {"random", "blocks", "adversarial"}},
      {"buildings", "Synthetic city", &C::buildings, kSynth,
       "Number of buildings; 0: as dense as 3096 on 2500 m (random) or as many as fit (blocks)", "",
       0, 1e7},
      {"size", "Synthetic city", &C::size, kSynth,
       "Side of the square; 0: 2500 m (random), 500 m (blocks) or 200 m (adversarial)", "m", 0,
       1e6},
      {"seed", "Synthetic city", &C::seed, kSynth, "Seed of the random numbers", "", 0},
      {"point_density", "Synthetic city", &C::point_density, kSynth, "Points per square metre",
       "1/m2", 0.01, 1000},
      {"relief", "Synthetic city", &C::relief, kSynth,
       "Height of the hills; 0: flat; negative: the kind's own", "m", -1, 2000},
      {"defects", "Synthetic city", &C::defects, kSynth,
       "Exactly these defects (adversarial; see docs/survey.md); default: a mix drawn from the "
       "seed"},

      {"max_memory", "Run", &C::max_memory, kMeshing,
       "Meshes that would need more, as 8G or 500M, are refused; default: 90 % of the machine's"},
      {"threads", "Run", &C::threads, kAll | kCheck,
       "Threads; 0: one per core. Results do not depend on it", "", 0, 4096},
      {"quiet", "Run", &C::quiet, kAll | kCheck, "Print errors only"},
      {"log", "Run", &C::log, kAll | kCheck, "Also write what is printed to this file"},
  };
}

[[noreturn]] void fail(const std::string& origin, const std::string& what) {
  throw Error(ErrorKind::kUsage, origin + ": " + what);
}

std::string number_text(double value) {
  return value == std::floor(value) && std::abs(value) < 1e15 ? fmt::format("{:.1f}", value)
                                                              : fmt::format("{}", value);
}

template <typename Number>
Number parse_number(const ConfigField& field, const std::string& text, const std::string& origin) {
  Number value{};
  const char* begin = text.data();
  const char* end = begin + text.size();
  const auto [stop, code] = std::from_chars(begin, end, value);
  const char* kind = std::is_integral_v<Number> ? "a whole number" : "a number";
  if (code != std::errc() || stop != end) fail(origin, fmt::format("'{}' is not {}", text, kind));
  if (!std::isfinite(static_cast<double>(value)))
    fail(origin, fmt::format("'{}' is not finite", text));
  const auto as_double = static_cast<double>(value);
  if (as_double < field.least) {
    if (field.least == kTiny && as_double <= 0)
      fail(origin, fmt::format("{} is not greater than 0", text));
    fail(origin, fmt::format("{} is less than {}", text, field.least));
  }
  if (as_double > field.most) fail(origin, fmt::format("{} is greater than {}", text, field.most));
  return value;
}

void check_choice(const ConfigField& field, const std::string& text, const std::string& origin) {
  if (field.choices.empty()) return;
  if (std::find(field.choices.begin(), field.choices.end(), text) != field.choices.end()) return;
  fail(origin, fmt::format("'{}' is none of {}", text, fmt::join(field.choices, ", ")));
}

/// "1,2" "3" -> "1" "2" "3": lists may be given with commas, as several values, or both.
std::vector<std::string> split_lists(std::span<const std::string> values) {
  std::vector<std::string> parts;
  for (const std::string& value : values) {
    std::size_t begin = 0;
    while (true) {
      const std::size_t comma = value.find(',', begin);
      parts.push_back(value.substr(begin, comma - begin));
      if (comma == std::string::npos) break;
      begin = comma + 1;
    }
  }
  return parts;
}

void set_numbers(std::vector<double>& target, const ConfigField& field,
                 std::span<const std::string> values, const std::string& origin) {
  target.clear();
  for (const std::string& part : split_lists(values))
    target.push_back(parse_number<double>(field, part, origin));
  // An empty list means "not given", as in the template.
  if (field.name != "bounds" || target.empty()) return;
  if (target.size() != 4) fail(origin, "four numbers expected: XMIN,YMIN,XMAX,YMAX");
  if (!(target[0] < target[2] && target[1] < target[3]))
    fail(origin, "XMIN < XMAX and YMIN < YMAX expected");
}

void set_texts(std::vector<std::string>& target, const ConfigField& field,
               std::span<const std::string> values, const std::string& origin) {
  // Paths may hold commas; names are split.
  target = field.name == "points" ? std::vector<std::string>(values.begin(), values.end())
                                  : split_lists(values);
  for (const std::string& text : target) {
    if (text.empty() && field.choices.empty())
      fail(origin, "an empty text among the values; leave it out or name something");
    check_choice(field, text, origin);
  }
}

/// A basic string of TOML 1.0.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      result += {'\\', c};
    else if (code < 0x20 || code == 0x7F)
      result += fmt::format("\\u{:04x}", code);
    else
      result += c;
  }
  return result + '"';
}

}  // namespace

std::span<const ConfigField> config_fields() {
  static const std::vector<ConfigField> fields = make_fields();
  return fields;
}

std::string option_name(const ConfigField& field) {
  std::string name = "--" + std::string(field.name);
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

std::string value_text(const ConfigField& field, const Config& config) {
  return std::visit(
      [&](auto member) -> std::string {
        const auto& value = config.*member;
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, bool>)
          return value ? "true" : "false";
        else if constexpr (std::is_same_v<Value, int>)
          return fmt::format("{}", value);
        else if constexpr (std::is_same_v<Value, double>)
          return number_text(value);
        else if constexpr (std::is_same_v<Value, std::string>)
          return quoted(value);
        else {
          std::vector<std::string> parts;
          for (const auto& part : value) {
            if constexpr (std::is_same_v<std::decay_t<decltype(part)>, double>)
              parts.push_back(number_text(part));
            else
              parts.push_back(quoted(part));
          }
          return fmt::format("[{}]", fmt::join(parts, ", "));
        }
      },
      field.member);
}

void set_field(Config& config, const ConfigField& field, std::span<const std::string> values,
               const std::string& origin) {
  const auto single = [&]() -> const std::string& {
    if (values.size() != 1) fail(origin, "one value expected");
    return values[0];
  };
  std::visit(
      [&](auto member) {
        auto& target = config.*member;
        using Value = std::decay_t<decltype(target)>;
        if constexpr (std::is_same_v<Value, bool>) {
          if (single() != "true" && single() != "false") fail(origin, "true or false expected");
          target = single() == "true";
        } else if constexpr (std::is_arithmetic_v<Value>) {
          target = parse_number<Value>(field, single(), origin);
        } else if constexpr (std::is_same_v<Value, std::string>) {
          check_choice(field, single(), origin);
          target = single();
        } else if constexpr (std::is_same_v<Value, std::vector<double>>) {
          set_numbers(target, field, values, origin);
        } else {
          set_texts(target, field, values, origin);
        }
      },
      field.member);
}

std::string config_template(unsigned commands) {
  const Config defaults;
  std::string text =
      "# Settings of Tetropolis. Remove the '#' before a key to set it; options of the\n"
      "# command line win over this file.\n";
  std::string_view group;
  for (const ConfigField& field : config_fields()) {
    if ((field.commands & commands) == 0) continue;
    if (field.group != group) text += fmt::format("\n# --- {} ---\n", field.group);
    group = field.group;
    text += fmt::format(
        "\n# {}{}{}\n", field.help, field.unit.empty() ? "" : fmt::format(" [{}]", field.unit),
        field.choices.empty() ? "" : fmt::format(" ({})", fmt::join(field.choices, ", ")));
    text += fmt::format("# {} = {}\n", field.name, value_text(field, defaults));
  }
  return text;
}

std::string config_markdown() {
  const Config defaults;
  std::string text;
  std::string_view group;
  for (const ConfigField& field : config_fields()) {
    if (field.group != group)
      text += fmt::format(
          "{}### {}\n\n| key | option | default | unit | meaning |\n|---|---|---|---|---|\n",
          group.empty() ? "" : "\n", field.group);
    group = field.group;
    std::string help(field.help);
    if (!field.choices.empty()) help += fmt::format(" ({})", fmt::join(field.choices, ", "));
    text += fmt::format("| `{}` | `{}` | `{}` | {} | {} |\n", field.name, option_name(field),
                        value_text(field, defaults), field.unit, help);
  }
  return text;
}

std::string nearest_name(std::string_view name, std::span<const std::string> known) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, name.size() / 3) + 1;
  for (const std::string& candidate : known) {
    std::vector<std::size_t> row(candidate.size() + 1);
    for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= name.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j < row.size(); ++j) {
        const std::size_t substitution = diagonal + (name[i - 1] == candidate[j - 1] ? 0 : 1);
        diagonal = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitution});
      }
    }
    if (row.back() >= best_distance) continue;
    best_distance = row.back();
    best = candidate;
  }
  return best;
}

}  // namespace tetropolis
