// The extension `_core`: arrays and verbs of the library for the package `tetropolis`, which is its
// only caller.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "tetropolis/core/version.h"

#include "bindings.h"
#include "settings.h"

NB_MODULE(_core, module) {
  using namespace tetropolis::python;
  nanobind::set_leak_warnings(
      false);  // what other libraries hold when the interpreter ends is no leak
  module.attr("version") = tetropolis::kVersion;
  module.def("settings_of", settings_of, nanobind::arg("function"),
             "Keyword arguments: name, group, type, default, help, unit, choices of each.");
  module.def("with_keywords", with_keywords, nanobind::arg("message"),
             "A message with settings spelled as keywords.");
  bind_errors(module);
  bind_city(module);
  bind_mesh(module);
  bind_files(module);
  bind_render(module);
  bind_case(module);
}
