#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "tetropolis/case/fenicsx_case.h"
#include "tetropolis/case/openfoam_case.h"
#include "tetropolis/core/error.h"

#include "bindings.h"

namespace tetropolis::python {

namespace {

namespace nb = nanobind;

Wind wind_of(double speed, double from, double height, double roughness) {
  Wind wind;
  wind.speed = speed;
  wind.from = from;
  wind.height = height;
  wind.roughness = roughness;
  return wind;
}

nb::dict dict_of(const OpenfoamCase& made) {
  nb::dict sides;
  for (const OpenfoamCase::Side& side : made.sides)
    sides[side.patch.c_str()] =
        std::string(kSideRoleNames[static_cast<std::size_t>(side.role)]).c_str();
  nb::dict result;
  result["sides"] = sides;
  result["canopies"] = made.canopies;
  result["canopy_cells"] = made.canopy_cells;
  result["ground_faces"] = made.ground_faces;
  result["first_cell"] = made.first_cell;
  result["layers_top"] = made.layers_top;
  result["open_layers_top"] = made.open_layers_top;
  result["open_width"] = made.open_width;
  result["samples"] = made.samples;
  result["sample_spacing"] = made.sample_spacing;
  return result;
}

/// One of `from`: a case in the folder; `several`: one in a folder of it for each.
nb::list case_openfoam(const std::filesystem::path& folder, double speed,
                       const std::vector<double>& from, bool several,
                       const std::vector<std::array<double, 3>>& levels, double height,
                       double roughness, double ground,
                       const std::map<std::string, double>& patches, double building,
                       double leaf_drag, bool leaf_turbulence, double sample_height,
                       double sample_spacing, int iterations, const std::string& dialect,
                       bool overwrite) {
  OpenfoamCaseOptions options;
  options.wind = wind_of(speed, several ? 0 : from.at(0), height, roughness);
  for (const std::array<double, 3>& level : levels)
    options.wind.levels.push_back({level[0], level[1], level[2]});
  const auto& names = kFoamDialectNames;
  const auto found = std::find(names.begin(), names.end(), dialect);
  if (found == names.end())
    throw Error(ErrorKind::kUsage,
                fmt::format("dialect: '{}' is not one of {}", dialect, fmt::join(names, ", ")));
  options.dialect = static_cast<FoamDialect>(found - names.begin());
  options.ground_roughness = ground;
  for (const auto& [patch, value] : patches) options.patch_roughness[patch] = value;
  options.building_roughness = building;
  options.leaf_drag = leaf_drag;
  options.leaf_turbulence = leaf_turbulence;
  options.sample_height = sample_height;
  options.sample_spacing = sample_spacing;
  options.iterations = iterations;
  options.overwrite = overwrite;
  std::vector<OpenfoamCase> made;
  {
    const nb::gil_scoped_release release;
    if (several)
      made = write_openfoam_cases(folder, options, from);
    else
      made.push_back(write_openfoam_case(folder, options));
  }
  nb::list results;
  for (const OpenfoamCase& one : made) results.append(dict_of(one));
  return results;
}

void case_fenicsx(const std::filesystem::path& folder, double speed, double from, bool overwrite) {
  Wind wind;
  wind.speed = speed;
  wind.from = from;
  const nb::gil_scoped_release release;
  write_fenicsx_case(folder, wind, overwrite);
}

}  // namespace

void bind_case(nb::module_& module) {
  module.def("case_openfoam", case_openfoam, nb::arg("folder"), nb::arg("wind_speed"),
             nb::arg("wind_from"), nb::arg("several"), nb::arg("wind_profile"),
             nb::arg("wind_height"), nb::arg("roughness"), nb::arg("ground_roughness"),
             nb::arg("patch_roughness"), nb::arg("building_roughness"), nb::arg("leaf_drag"),
             nb::arg("leaf_turbulence"), nb::arg("sample_height"), nb::arg("sample_spacing"),
             nb::arg("iterations"), nb::arg("dialect"), nb::arg("overwrite"));
  module.def("case_fenicsx", case_fenicsx, nb::arg("folder"), nb::arg("wind_speed"),
             nb::arg("wind_from"), nb::arg("overwrite"));
}

}  // namespace tetropolis::python
