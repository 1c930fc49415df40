// Progress and cancellation, handed into long operations. The library never prints by itself.
#pragma once

#include <algorithm>
#include <functional>

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

}  // namespace tetropolis
