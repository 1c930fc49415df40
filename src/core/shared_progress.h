// The progress of a parallel loop. Private to the library.
#pragma once

#include <cstdint>
#include <mutex>

#include "tetropolis/core/progress.h"

namespace tetropolis {

/// What the threads of a loop have done, of `total`. Keeps a reference.
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
