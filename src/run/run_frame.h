// What all commands begin and end with.
#pragma once

#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/run/config.h"
#include "tetropolis/run/output_folder.h"
#include "tetropolis/run/report.h"
#include "tetropolis/run/run.h"

namespace tetropolis {

/// A setting that a command cannot do without.
struct Needed {
  bool given;
  const char* setting;
  const char* what;  ///< What to give.
};

/// Throws Error(kUsage) that names all of them that are not given.
void require_given(const std::vector<Needed>& settings);

/// What a city is made of.
std::vector<Needed> needed_for_city(const Config& config);

Report begin_report(const char* command, const Config& config);

/// That the run may write results of these names to `out`. Tells whose it replaces. Throws
/// Error(kUsage).
void claim(const OutputFolder& out, const std::vector<std::string>& names, const Config& config,
           const RunHooks& hooks);

/// Tells the report where the city is.
void keep_domain(const CityModel& city, Report& report);

/// Tells the report how much memory the process has needed so far, and the files there are.
void tell_process(Report& report, const OutputFolder& out);

/// Writes the report as the last file and makes the results appear. What goes wrong after that is
/// told by the report that is returned only.
void finish(Report& report, OutputFolder& out);

}  // namespace tetropolis
