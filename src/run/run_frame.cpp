#include "run_frame.h"

#include <cstdint>
#include <ctime>
#include <string>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/system_memory.h"
#include "tetropolis/core/threads.h"
#include "tetropolis/core/version.h"

#include "earlier_results.h"
#include "io/file/atomic_file.h"
#include "result_files.h"

namespace tetropolis {

namespace {

/// Of Report::started.
constexpr const char* kTime = "{:%Y-%m-%dT%H:%M:%SZ}";

/// "2026-11-26 10:14" where the user is; "" for what is no time.
std::string local_time(const std::string& utc) {
  std::tm time{};
  if (::strptime(utc.c_str(), "%Y-%m-%dT%H:%M:%SZ", &time) == nullptr) return "";
  return fmt::format("{:%Y-%m-%d %H:%M}", fmt::localtime(::timegm(&time)));
}

}  // namespace

std::vector<Needed> needed_for_city(const Config& config) {
  const bool has_outlines = !config.footprints.empty() || !config.planned.empty();
  return {{has_outlines || config.terrain_only, "footprints",
           "a vector file with building footprints, or add terrain_only"},
          {has_outlines || !config.points.empty() || !config.dtm.empty() || !config.dsm.empty(),
           "points", "LAS or LAZ files or a folder of them, or rasters with dtm or dsm"}};
}

void require_given(const std::vector<Needed>& settings) {
  std::vector<std::string> missing;
  for (const Needed& needed : settings)
    if (!needed.given) missing.push_back(fmt::format("`{}` ({})", needed.setting, needed.what));
  if (!missing.empty())
    throw Error(ErrorKind::kUsage, fmt::format("missing: {}", fmt::join(missing, ", ")));
}

Report begin_report(const char* command, const Config& config) {
  Report report;
  report.version = kVersion;
  report.command = command;
  report.started = fmt::format(kTime, fmt::gmtime(std::time(nullptr)));
  report.config = config;
  report.threads = thread_count();
  return report;
}

void claim(const OutputFolder& out, const std::vector<std::string>& names, const Config& config,
           const RunHooks& hooks) {
  out.require_free(names);
  const EarlierRun earlier = earlier_run(config.out);
  if (earlier.files.empty() || !hooks.tell) return;
  const std::string when = local_time(earlier.started);
  hooks.tell(fmt::format("{}: replaces {}", config.out,
                         when.empty() ? "an earlier run" : "the run of " + when));
}

void keep_domain(const CityModel& city, Report& report) {
  report.origin = city.origin;
  report.crs = city.crs;
  report.domain = city.domain.moved(city.origin).bounds();
  report.place = place_of(city.crs, report.domain);
}

void tell_process(Report& report, const OutputFolder& out) {
  report.peak_rss_bytes = peak_rss_bytes();
  report.files = out.files();
}

void finish(Report& report, OutputFolder& out) {
  tell_process(report, out);
  AtomicFile file(out.result(results::kReport));
  file.write(to_json(report));
  file.commit();
  out.commit();
  if (const auto& left = out.leftover())
    report.warnings.push_back(
        {"hidden_folder_left", 1,
         fmt::format("{}: cannot be removed: {}; the results are complete without it, remove it",
                     left->folder.string(), left->reason)});
}

}  // namespace tetropolis
