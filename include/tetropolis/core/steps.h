// The numbered steps of a long operation: what they are called, how long they took, and how a
// caller follows and ends them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace tetropolis {

/// One step, or a named part of one.
struct StepTime {
  std::string id;  ///< The paper's number: "1.1" to "3.6"; "0.1" and "0.2" of a synthetic city.
  std::string name;
  double seconds = 0;               ///< Wall time; of all calls together.
  double cpu_seconds = 0;           ///< Processor time of the process, all threads together.
  std::int64_t peak_rss_bytes = 0;  ///< Largest resident memory of the process until its end.
};

/// Callbacks of an operation of several steps. All may be empty. They may come from any thread, but
/// none from two at the same time.
struct StepHooks {
  std::function<void(const StepTime& step)> step_begins;  ///< id and name are set.
  std::function<void(double fraction)> step_progress;     ///< Of the current step, in [0, 1].
  std::function<void(const StepTime& step)> step_ends;
  std::function<bool()> cancelled;  ///< Polled; true ends the operation with Cancelled.
};

}  // namespace tetropolis
