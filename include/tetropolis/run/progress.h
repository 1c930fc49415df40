// How far a run is: a handful of stages, and the share of the whole that is done.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tetropolis/core/steps.h"
#include "tetropolis/run/config.h"

namespace tetropolis {

/// Follows the steps of one run. Steps count by what they take in usual runs, so shares and times
/// are estimates.
class RunProgress {
 public:
  /// A stage that is over; its name is empty if none is.
  struct Ended {
    std::string_view name;
    double seconds = 0;
  };

  RunProgress(Command command, const Config& config);

  Ended begin(const StepTime& step);
  void update(double fraction);
  void end(const StepTime& step);
  /// The last stage is over.
  Ended finish() const;

  std::string_view stage() const;
  /// Of the whole run, in [0, 1]; never less than before.
  double share() const { return share_; }
  /// "12 s left"; "" while there is too little to tell from.
  std::string time_left() const;

 private:
  double weight(std::size_t step) const;

  unsigned command_;
  bool solves_;
  std::size_t stage_ = 0;
  std::size_t step_;          ///< The current one, kSteps.size() for one that is not known.
  std::vector<double> done_;  ///< Of each step, in [0, 1].
  double seconds_ = 0;        ///< In the current stage.
  double share_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace tetropolis
