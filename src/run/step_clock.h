// Runs the steps of a pipeline, timing them and passing progress on.
#pragma once

#include <chrono>
#include <string>
#include <type_traits>
#include <utility>

#include <sys/resource.h>

#include "tetropolis/core/progress.h"
#include "tetropolis/run/run.h"

namespace tetropolis {

/// Processor time of the whole process so far, in seconds.
inline double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) * 1e-6;
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

class StepClock {
 public:
  StepClock(const RunHooks& hooks, Report& report) : hooks_(hooks), report_(report) {}

  /// Calls body(progress) as the step `id` and adds its time to the report: to the entry of the
  /// same id and name if there is one. Parts of a step that have names of their own have entries of
  /// their own, with the step's id.
  template <typename Body>
  auto run(const std::string& id, const std::string& name, const Body& body) {
    StepReport step{id, name, 0, 0};
    if (hooks_.cancelled && hooks_.cancelled()) throw Cancelled();
    if (hooks_.step_begins) hooks_.step_begins(step);
    const auto wall = std::chrono::steady_clock::now();
    const double cpu = cpu_seconds();
    const auto finish = [&] {
      step.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
      step.cpu_seconds = cpu_seconds() - cpu;
      add(step);
      if (hooks_.step_ends) hooks_.step_ends(step);
    };
    const Progress progress{hooks_.step_progress, hooks_.cancelled};
    if constexpr (std::is_void_v<decltype(body(progress))>) {
      body(progress);
      finish();
    } else {
      auto result = body(progress);
      finish();
      return result;
    }
  }

 private:
  void add(const StepReport& step) {
    for (StepReport& earlier : report_.steps)
      if (earlier.id == step.id && earlier.name == step.name) {
        earlier.seconds += step.seconds;
        earlier.cpu_seconds += step.cpu_seconds;
        return;
      }
    report_.steps.push_back(step);
  }

  const RunHooks& hooks_;
  Report& report_;
};

}  // namespace tetropolis
