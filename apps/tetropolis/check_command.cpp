#include <optional>

#include <fmt/format.h>

#include "tetropolis/check/check_results.h"

#include "commands.h"
#include "interrupts.h"

namespace tetropolis::app {

bool check(const std::string& path, std::optional<double> min_distance, Console& console) {
  Progress progress;
  progress.cancelled = interrupted;
  const auto files = check_path(path, min_distance, progress);
  std::int64_t violations = 0;
  bool everything = true;
  for (const CheckedFile& file : files) {
    if (file.violations.empty())
      console.result(file.name);
    else
      console.important_result(file.name);
    for (const std::string& fact : file.facts) console.result("  " + fact);
    for (const std::string& what : file.not_checked) console.result("  not checked: " + what);
    everything = everything && file.not_checked.empty();
    for (const Violation& violation : file.violations) {
      console.important_result(fmt::format("  VIOLATED: {} ({}); first: {}", violation.what,
                                           violation.count, violation.first));
      ++violations;
    }
  }
  if (violations == 0)
    console.result(everything ? "every guarantee holds"
                              : "what was checked holds; see 'not checked' above");
  else
    console.error(fmt::format("tetropolis: {}: {} guarantee{} broken", path, violations,
                              violations == 1 ? "" : "s"));
  return violations == 0;
}

}  // namespace tetropolis::app
