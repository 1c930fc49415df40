// Calls of the system that fail when a test wants them to.
#pragma once

namespace tetropolis::testing {

enum class Call { kRename, kWrite, kUnlinkat };

/// While it lives, those of this process's calls that come as number `first` to `last` since its
/// beginning fail with `error`. One at a time.
class FailingCalls {
 public:
  FailingCalls(Call call, int first, int last, int error);
  ~FailingCalls();
  FailingCalls(const FailingCalls&) = delete;
  FailingCalls& operator=(const FailingCalls&) = delete;

  /// How many have failed.
  int failed() const;
};

}  // namespace tetropolis::testing
