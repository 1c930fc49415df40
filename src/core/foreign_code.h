// Calls into libraries that broken input may crash: what input they read, and a stack to say so.
// Private to the library.
#pragma once

#include <memory>

#include <signal.h>

namespace tetropolis {

/// As long as it lives, foreign_input() in this thread is `input`, and the thread has a second
/// stack for signal handlers, so that one can run when the first is full.
class ForeignCode {
 public:
  /// `input`: what the library is reading; must outlive this. Throws std::bad_alloc.
  explicit ForeignCode(const char* input);
  ~ForeignCode();
  ForeignCode(const ForeignCode&) = delete;
  ForeignCode& operator=(const ForeignCode&) = delete;

 private:
  std::unique_ptr<char[]> stack_;
  stack_t stack_before_{};
  const char* input_before_;
};

}  // namespace tetropolis
