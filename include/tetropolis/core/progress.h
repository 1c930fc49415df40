// Progress and cancellation, handed into long operations. The library never prints by itself.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <mutex>

#include "tetropolis/core/error.h"

namespace tetropolis {

/// Both callbacks may be empty and may be called from any thread, not concurrently by one
/// operation.
struct Progress {
  std::function<void(double fraction)> report;  ///< Called with a share in [0, 1], non-decreasing.
  std::function<bool()> cancelled;              ///< Polled; true makes the operation stop.

  /// Reports `fraction`. Throws Cancelled if the caller wants to stop.
  void update(double fraction) const {
    if (cancelled && cancelled()) throw Cancelled();
    if (report) report(fraction);
  }
};

/// A progress that maps [0, 1] to [begin, end] of `whole`, for operations of several parts. Keeps a
/// reference: `whole` must outlive it.
inline Progress portion(const Progress& whole, double begin, double end) {
  Progress part;
  part.cancelled = whole.cancelled;
  if (whole.report)
    part.report = [&whole, begin, end](double fraction) {
      whole.report(begin + (end - begin) * std::min(fraction, 1.0));
    };
  return part;
}

/// The progress of a parallel loop: what its threads have done, of `total`. Keeps a reference.
class SharedProgress {
 public:
  SharedProgress(const Progress& progress, std::int64_t total)
      : progress_(progress), total_(total) {}
  /// From any thread. Throws Cancelled if the caller wants to stop.
  void add(std::int64_t done) {
    const std::lock_guard lock(mutex_);
    done_ += done;
    progress_.update(total_ > 0 ? static_cast<double>(done_) / static_cast<double>(total_) : 1.0);
  }

 private:
  const Progress& progress_;
  std::int64_t total_;
  std::mutex mutex_;
  std::int64_t done_ = 0;
};

}  // namespace tetropolis
