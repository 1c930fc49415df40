// What all commands begin and end with.
#pragma once

#include "tetropolis/city/city_model.h"
#include "tetropolis/run/config.h"
#include "tetropolis/run/output_folder.h"
#include "tetropolis/run/report.h"

namespace tetropolis {

/// Throws Error(kUsage) that `setting` is missing, and what it is for, if it is not given.
void require_given(bool given, const char* setting, const char* what);

Report begin_report(const char* command, const Config& config);

/// Tells the report where the city is.
void keep_domain(const CityModel& city, Report& report);

/// Writes the report as the last file and makes the results appear. What goes wrong after that is
/// told by the report that is returned only.
void finish(Report& report, OutputFolder& out);

}  // namespace tetropolis
