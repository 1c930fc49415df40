#include "case_command.h"

#include <array>
#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>
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

void tell(const CaseArguments& arguments, const OpenfoamCase& made, Console& console) {
  const OpenfoamCaseOptions& options = arguments.options;
  const Wind& wind = options.wind;
  std::string sides;
  for (const OpenfoamCase::Side& side : made.sides)
    sides += fmt::format("{}{} {}", sides.empty() ? "" : ", ", side.patch,
                         kSideRoleNames[static_cast<std::size_t>(side.role)]);
  console.result(fmt::format("wind     {} m/s at {} m from {} degrees over roughness {} m",
                             wind.speed, wind.height, wind.from, wind.roughness));
  console.result(fmt::format("sides    {}", sides));
  console.result(
      fmt::format("ground   cells {:.2f} m high (median); {} points {} m above it, every "
                  "{} m",
                  made.first_cell, made.samples, options.sample_height, made.sample_spacing));
  if (made.shallow > 0)
    console.line(fmt::format(
        "note     {} of {} cells on the ground are lower than {} times its roughness: the wind "
        "near "
        "the ground comes out too fast; raise --mesh-size, or give the ground among the buildings "
        "its own --ground-roughness",
        made.shallow, made.ground_faces, kRoughnessLengths));
  if (made.ground_faces > 0 && 2 * made.first_cell > options.sample_height)
    console.line(fmt::format(
        "note     {} m above the ground is in the first two cells, where the wall function rules: "
        "cells lower than {:.2f} m would resolve the wind there (a smaller --mesh-size)",
        options.sample_height, options.sample_height / 2));
  console.result(
      fmt::format("solve    {}/Allrun, or Allrun 8 with eight processes", arguments.folder));
}

}  // namespace

void add_case_options(CLI::App& command, CaseArguments& arguments) {
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
      ->check([](const std::string& text) { return text.empty() ? "an empty name" : ""; });
  number("--wind-speed", options.wind.speed, "Speed at --wind-height [m/s]");
  number("--wind-from", options.wind.from,
         "Where the wind comes from [degrees], clockwise from north");
  openfoam(
      number("--wind-height", options.wind.height, "Height of --wind-speed above the ground [m]"));
  openfoam(
      number("--roughness", options.wind.roughness, "Roughness length of the land upwind [m]"));
  openfoam(command
               .add_option(
                   "--ground-roughness", options.ground_roughness,
                   "Roughness length of the ground among the buildings [m] (default: that of the "
                   "land upwind)")
               ->type_name("NUMBER"));
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
  openfoam(number("--sample-height", options.sample_height,
                  "Where the wind is sampled, above the ground [m]"));
  openfoam(number("--sample-spacing", options.sample_spacing, "Spacing of the points there [m]"));
  openfoam(number("--iterations", options.iterations, "Iterations at most", "INT"));
  add_choice(command, "--dialect", arguments.dialect, kFoamDialectNames,
             "OpenFOAM of openfoam.com or openfoam.org");
  command.add_flag("--overwrite", options.overwrite, "Replace a case that is there");
}

void make_case(const CaseArguments& arguments, Console& console) {
  OpenfoamCaseOptions options = arguments.options;
  options.dialect = named<FoamDialect>(arguments.dialect, kFoamDialectNames);
  try {
    if (arguments.solver == "fenicsx") {
      for (const CLI::Option* option : arguments.openfoam_only)
        if (option->count() > 0)
          throw Error(ErrorKind::kUsage, fmt::format("{} is for openfoam only; leave it out",
                                                     option->get_name().substr(2)));
      write_fenicsx_case(arguments.folder, options.wind, options.overwrite);
      console.result(fmt::format("solve    python3 {}/smoke.py", arguments.folder));
      return;
    }
    tell(arguments, write_openfoam_case(arguments.folder, options), console);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kUsage) throw;
    const std::string what = error.what();  // of options, they begin with the option's name
    const bool is_option = what.find('/') == std::string::npos;
    throw Error(ErrorKind::kUsage, (is_option ? "--" : "") + what);
  }
}

}  // namespace tetropolis::app
