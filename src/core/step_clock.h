// Runs the steps of an operation, timing them and passing progress on.
#pragma once

#include <chrono>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <sys/resource.h>

#include "tetropolis/core/progress.h"
#include "tetropolis/core/steps.h"
#include "tetropolis/core/system_memory.h"

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

/// Adds `step` to `times`: to the entry of the same id and name if there is one.
inline void add_time(const StepTime& step, std::vector<StepTime>& times) {
  for (StepTime& earlier : times)
    if (earlier.id == step.id && earlier.name == step.name) {
      earlier.seconds += step.seconds;
      earlier.cpu_seconds += step.cpu_seconds;
      earlier.peak_rss_bytes = step.peak_rss_bytes;
      return;
    }
  times.push_back(step);
}

class StepClock {
 public:
  /// Keeps references to both.
  StepClock(const StepHooks& hooks, std::vector<StepTime>& times) : hooks_(hooks), times_(times) {}

  /// Calls body(progress) as the step `id` and adds its time (add_time).
  template <typename Body>
  auto run(const std::string& id, const std::string& name, const Body& body) {
    StepTime step{id, name};
    if (hooks_.cancelled && hooks_.cancelled()) throw Cancelled();
    if (hooks_.step_begins) hooks_.step_begins(step);
    const auto wall = std::chrono::steady_clock::now();
    const double cpu = cpu_seconds();
    const auto finish = [&] {
      step.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
      step.cpu_seconds = cpu_seconds() - cpu;
      step.peak_rss_bytes = peak_rss_bytes();
      add_time(step, times_);
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
  const StepHooks& hooks_;
  std::vector<StepTime>& times_;
};

}  // namespace tetropolis
