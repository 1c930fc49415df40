// The settings of the list in config.h as keyword arguments.
#pragma once

#include <string>

#include <nanobind/nanobind.h>

#include "tetropolis/run/config.h"

namespace tetropolis::python {

namespace nb = nanobind;

/// The keyword arguments of a function: name, group, type, default, help, unit, choices of each.
nb::list settings_of(const std::string& function);

/// Keyword arguments as settings; None is the default. Throws Error(kUsage): a keyword that the
/// function does not take (with the nearest one that it does), a value out of its range.
Config config_of(const std::string& function, const nb::dict& keywords);

/// A message with settings spelled as keywords: "raise `mesh_size`" becomes "raise mesh_size=".
std::string with_keywords(const std::string& message);

}  // namespace tetropolis::python
