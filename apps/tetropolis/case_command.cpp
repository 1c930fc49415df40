#include "case_command.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/case/fenicsx_case.h"
#include "tetropolis/core/error.h"

#include "choice.h"

namespace tetropolis::app {

namespace {

constexpr std::array<std::string_view, 2> kSolvers = {"openfoam", "fenicsx"};

/// "water=0.0002".
void add_roughness(const std::string& word, OpenfoamCaseOptions& options) {
  const std::size_t sign = word.find('=');
  double value = 0;
  const char* const end = word.data() + word.size();
  if (sign == std::string::npos || sign == 0 ||
      std::from_chars(word.data() + sign + 1, end, value).ptr != end || !(value > 0))
    throw CLI::ValidationError("--patch-roughness",
                               fmt::format("'{}' is not like water=0.0002", word));
  options.patch_roughness[word.substr(0, sign)] = value;
}

/// "240" or "0,45,90".
void read_winds(const std::string& words, CaseArguments& arguments) {
  arguments.winds.clear();
  const char* at = words.data();
  const char* const end = at + words.size();
  for (bool more = true; more;) {
    double value = 0;
    const auto read = std::from_chars(at, end, value);
    if (read.ec != std::errc() || (read.ptr != end && *read.ptr != ','))
      throw CLI::ValidationError("--wind-from",
                                 fmt::format("'{}' is not like 240 or 0,45,90", words));
    arguments.winds.push_back(value);
    more = read.ptr != end;
    at = read.ptr + (more ? 1 : 0);
  }
  arguments.options.wind.from = arguments.winds.front();
}

/// A side that domain = auto made for the wind that it was told.
bool is_of_other_wind(const OpenfoamCase::Side& side) {
  return (side.patch == "inlet" && side.role != SideRole::kInlet) ||
         (side.patch == "outlet" && side.role != SideRole::kOutlet) ||
         ((side.patch == "side_left" || side.patch == "side_right") &&
          side.role != SideRole::kAlong);
}

std::string sides_of(const OpenfoamCase& made) {
  std::string sides;
  for (const OpenfoamCase::Side& side : made.sides)
    sides += fmt::format("{}{} {}", sides.empty() ? "" : ", ", side.patch,
                         kSideRoleNames[static_cast<std::size_t>(side.role)]);
  return sides;
}

/// `cases`: of the winds, one at least; the ground is that of all.
void tell(const CaseArguments& arguments, const std::vector<OpenfoamCase>& cases,
          Console& console) {
  const OpenfoamCaseOptions& options = arguments.options;
  const Wind& wind = options.wind;
  const OpenfoamCase& made = cases.front();
  if (arguments.winds.size() > 1) {
    console.result(fmt::format(
        "wind     {} m/s at {} m over roughness {} m, {} directions: {} to {}", wind.speed,
        wind.height, wind.roughness, cases.size(), folder_of_wind(arguments.winds.front()),
        folder_of_wind(arguments.winds.back())));
  } else {
    console.result(fmt::format("wind     {} m/s at {} m from {} degrees over roughness {} m",
                               wind.speed, wind.height, wind.from, wind.roughness));
    console.result(fmt::format("sides    {}", sides_of(made)));
  }
  console.result(
      fmt::format("ground   cells {:.2f} m high (median); {} points {} m above it, every "
                  "{} m",
                  made.first_cell, made.samples, options.sample_height, made.sample_spacing));
  if (made.canopies > 0)
    console.result(fmt::format("canopies {} zones of {} cells slow the wind", made.canopies,
                               made.canopy_cells));
  if (made.ground_faces > 0 && 2 * made.first_cell > options.sample_height)
    console.line(fmt::format(
        "note     {} m above the ground is in the first two cells, where speeds come out too low "
        "(by half in cells of 4 m): cells lower than {:.2f} m would resolve the wind there "
        "(--boundary-layers, or a smaller --mesh-size)",
        options.sample_height, options.sample_height / 2));
  // Over Delft and empty ground points are 9 to 40 % too fast at 1.06 of that height, 1 % at 1.53.
  if (made.layers_top > 0 && made.layers_top < 1.5 * options.sample_height)
    console.line(fmt::format(
        "note     layers end {:.2f} m above the ground: the higher cells above raise the "
        "speeds at {} m; let layers reach {:.2f} m (--boundary-layers)",
        made.layers_top, options.sample_height, 1.5 * options.sample_height));
  // Over 1 km of empty ground k grows by 46 and 115 % where layers reach 0.24 and 0.12 of the
  // cells' width, by 26 % at 0.4, 7 to 13 % from 0.47 on.
  const double least = 0.4 * made.open_width;
  if (made.open_layers_top > 0 && made.open_layers_top < least)
    console.line(fmt::format(
        "note     layers end {:.1f} m above the ground, under cells {:.0f} m wide far away, where "
        "turbulence grows on the way of the wind (k to 1.5 to 2 times over 1 km): let layers reach "
        "{:.0f} m ({}), or lower --far-size",
        made.open_layers_top, made.open_width, least,
        least > 21 ? "more --boundary-layers, or a larger --layer-growth"
                   : "--boundary-layers 10 --layer-growth 1.3 reach 21 m"));
  if (std::any_of(cases.begin(), cases.end(), [](const OpenfoamCase& one) {
        return std::any_of(one.sides.begin(), one.sides.end(), is_of_other_wind);
      }))
    console.line("note     the domain is a box for another wind: --domain cylinder is one for all");
  console.result(
      fmt::format("solve    {}/Allrun, or Allrun 8 with eight processes", arguments.folder));
}

/// The library's "wind_speed: ..." as "--wind-speed: ...".
std::string with_option_of(const CLI::App& command, const std::string& message) {
  std::string option = "--" + message.substr(0, message.find(':'));
  const std::size_t rest = option.size() - 2;
  std::replace(option.begin(), option.end(), '_', '-');
  return command.get_option_no_throw(option) == nullptr ? message : option + message.substr(rest);
}

}  // namespace

void add_case_options(CLI::App& command, CaseArguments& arguments) {
  arguments.command = &command;
  OpenfoamCaseOptions& options = arguments.options;
  const auto number = [&](const std::string& name, auto& value, const std::string& help,
                          const char* type = "NUMBER") {
    return command.add_option(name, value, fmt::format("{} (default {})", help, value))
        ->type_name(type);
  };
  const auto openfoam = [&](const CLI::Option* option) {
    arguments.openfoam_only.push_back(option);
  };
  command.add_option("solver", arguments.solver, "Program that solves it")
      ->required()
      ->type_name("{openfoam,fenicsx}")
      ->check([](const std::string& word) { return not_one_of(word, kSolvers); });
  command.add_option("folder", arguments.folder, "Folder of results; the case is put there")
      ->required()
      ->type_name("DIR")
      ->check(wrong_name);
  CLI::Option* const speed =
      number("--wind-speed", options.wind.speed, "Speed at --wind-height [m/s]");
  CLI::Option* const from =
      command
          .add_option_function<std::string>(
              "--wind-from", [&](const std::string& words) { read_winds(words, arguments); },
              fmt::format("Where the wind comes from [degrees], clockwise from north (default {}); "
                          "openfoam: several, as 0,45,90, are a case each over one mesh",
                          options.wind.from))
          ->type_name("NUMBER,...");
  openfoam(command
               .add_option("--directions", arguments.directions,
                           "A case for each of so many winds, evenly from north on")
               ->type_name("INT")
               ->check(CLI::Range(2, 360))
               ->excludes(from));
  openfoam(command
               .add_option("--wind-profile", arguments.profile,
                           "Measured wind instead of --wind-speed: a table height,speed,k [m, m/s, "
                           "m2/s2]")
               ->type_name("FILE")
               ->excludes(speed));
  openfoam(
      number("--wind-height", options.wind.height, "Height of --wind-speed above the ground [m]"));
  openfoam(
      number("--roughness", options.wind.roughness, "Roughness length of the land upwind [m]"));
  openfoam(number("--ground-roughness", options.ground_roughness,
                  "Roughness length of the ground among the buildings [m], 0: that of the land "
                  "upwind"));
  openfoam(command
               .add_option_function<std::vector<std::string>>(
                   "--patch-roughness",
                   [&](const std::vector<std::string>& words) {
                     for (const std::string& word : words) add_roughness(word, options);
                   },
                   "Roughness length of a patch of the ground [m] (default water=0.0002, "
                   "road=0.005, vegetation=0.1)")
               ->type_name("PATCH=NUMBER"));
  openfoam(number("--building-roughness", options.building_roughness,
                  "Roughness length of roofs and walls [m], 0: smooth"));
  openfoam(number("--leaf-drag", options.leaf_drag, "Drag coefficient of leaves in canopies"));
  openfoam(command.add_flag_callback(
      "--no-leaf-turbulence", [&] { options.leaf_turbulence = false; },
      "Leaves make and destroy no turbulence: for an OpenFOAM without kEpsilonLopesdaCosta"));
  openfoam(number("--sample-height", options.sample_height,
                  "Where the wind is sampled, above the ground [m]"));
  openfoam(number("--sample-spacing", options.sample_spacing, "Spacing of the points there [m]"));
  openfoam(number("--iterations", options.iterations, "Iterations at most", "INT"));
  add_choice(command, "--dialect", arguments.dialect, kFoamDialectNames,
             "OpenFOAM of openfoam.com or openfoam.org");
  command.add_flag("--overwrite", options.overwrite,
                   "Replace a case that is there, with what it has solved");
}

void make_case(const CaseArguments& arguments, Console& console) {
  OpenfoamCaseOptions options = arguments.options;
  options.dialect = named<FoamDialect>(arguments.dialect, kFoamDialectNames);
  CaseArguments told = arguments;
  for (int i = 0; i < arguments.directions; ++i)
    told.winds.push_back(360.0 * i / arguments.directions);
  try {
    if (arguments.solver == "fenicsx") {
      if (arguments.winds.size() > 1)
        throw Error(ErrorKind::kUsage, "wind_from: several are for openfoam only; name one");
      for (const CLI::Option* option : arguments.openfoam_only)
        if (option->count() > 0)
          throw Error(ErrorKind::kUsage,
                      fmt::format("{} is for openfoam only; leave it out", option->get_name()));
      write_fenicsx_case(arguments.folder, options.wind, options.overwrite);
      console.result(fmt::format("solve    python3 {}/smoke.py", arguments.folder));
      return;
    }
    if (!arguments.profile.empty()) {
      options.wind.levels = read_wind_levels(arguments.profile);
      told.options.wind.speed = WindProfile(options.wind).speed(options.wind.height);
    }
    if (told.winds.size() > 1)
      tell(told, write_openfoam_cases(arguments.folder, options, told.winds), console);
    else
      tell(told, {write_openfoam_case(arguments.folder, options)}, console);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kUsage) throw;
    throw Error(ErrorKind::kUsage, with_option_of(*arguments.command, error.what()));
  }
}

}  // namespace tetropolis::app
