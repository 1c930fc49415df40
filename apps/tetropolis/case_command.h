// The command that makes cases for solvers.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tetropolis/case/openfoam_case.h"

#include "console.h"

namespace tetropolis::app {

/// What `case` is told.
struct CaseArguments {
  std::string solver;
  std::string folder;
  std::string dialect{kFoamDialectNames.front()};
  OpenfoamCaseOptions options;
  std::string profile;                ///< File of a measured wind.
  std::vector<double> winds;          ///< Where it comes from, if several are named.
  int directions = 0;                 ///< So many, evenly from north on; 0: those named.
  const CLI::App* command = nullptr;  ///< That has the options.
  std::vector<const CLI::Option*> openfoam_only;
};

/// Adds the options to `command`; `arguments` is filled when the command line is parsed.
void add_case_options(CLI::App& command, CaseArguments& arguments);

/// Writes the case, and prints what it is and what to do next unless quiet. Throws Error.
void make_case(const CaseArguments& arguments, Console& console);

}  // namespace tetropolis::app
