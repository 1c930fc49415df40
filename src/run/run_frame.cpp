#include "run_frame.h"

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <sys/resource.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/threads.h"
#include "tetropolis/core/version.h"

#include "io/file/atomic_file.h"
#include "result_files.h"

namespace tetropolis {

namespace {

std::int64_t peak_rss_bytes() {
  // Of this program: what getrusage tells includes the caller's until it started this one.
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::strtoll(line.c_str() + 6, nullptr, 10) * 1024;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace

void require_given(bool given, const char* setting, const char* what) {
  if (!given) throw Error(ErrorKind::kUsage, fmt::format("`{}` is missing: {}", setting, what));
}

Report begin_report(const char* command, const Config& config) {
  Report report;
  report.version = kVersion;
  report.command = command;
  report.config = config;
  report.threads = thread_count();
  return report;
}

void keep_domain(const CityModel& city, Report& report) {
  report.origin = city.origin;
  report.crs = city.crs;
  report.domain = city.domain.moved(city.origin).bounds();
}

void finish(Report& report, OutputFolder& out) {
  report.peak_rss_bytes = peak_rss_bytes();
  report.files = out.files();
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
