#include <filesystem>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "tetropolis/check/check_results.h"
#include "tetropolis/run/run.h"

#include "bindings.h"
#include "call.h"
#include "settings.h"

namespace tetropolis::python {

namespace {

std::string synth(const nb::dict& settings, const std::string& out, const nb::object& progress) {
  Config config = config_of("synth", settings);
  config.out = out;
  Report report;
  call(progress, kSynth, config, [&](const StepHooks& hooks) {
    RunHooks run;
    static_cast<StepHooks&>(run) = hooks;
    report = run_synth(config, run);
  });
  return to_json(report);
}

using Violations = std::vector<std::tuple<std::string, std::int64_t, std::string>>;
using Checked =
    std::tuple<std::string, std::vector<std::string>, Violations, std::vector<std::string>>;

std::vector<Checked> check(const std::filesystem::path& path, std::optional<double> min_distance,
                           const nb::object& progress) {
  std::vector<CheckedFile> files;
  call(progress, "check", [&](const StepHooks& hooks) {
    files = check_path(path, min_distance, {hooks.step_progress, hooks.cancelled});
  });
  std::vector<Checked> result;
  for (const CheckedFile& file : files) {
    Violations violations;
    for (const Violation& violation : file.violations)
      violations.emplace_back(violation.what, violation.count, violation.first);
    result.emplace_back(file.name, file.facts, violations, file.not_checked);
  }
  return result;
}

}  // namespace

void bind_files(nb::module_& module) {
  module.def("synth", synth, nb::arg("settings"), nb::arg("out"), nb::arg("progress").none());
  module.def("check", check, nb::arg("path"), nb::arg("min_building_distance").none(),
             nb::arg("progress").none());
}

}  // namespace tetropolis::python
