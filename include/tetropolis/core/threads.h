// How many threads the parallel loops of the library use. No result depends on it.
#pragma once

#include <memory>

namespace tetropolis {

/// While it lives, at most `threads` threads work in the parallel loops of this process (0: as many
/// as there are cores). Of several, the least holds.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Control;
  std::unique_ptr<Control> control_;
};

/// The number of threads that the parallel loops may use now.
int thread_count();

}  // namespace tetropolis
