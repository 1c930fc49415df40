// Progress and cancellation, handed into long operations. The library never prints by itself.
#pragma once

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

}  // namespace tetropolis
