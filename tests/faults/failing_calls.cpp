#include "failing_calls.h"

#include <atomic>
#include <cerrno>
#include <cstdio>

#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

namespace tetropolis::testing {

namespace {

// Shared with the functions below, which have no other way to know.
Call wanted{};
int first_to_fail = 0, last_to_fail = -1, reason = 0;
std::atomic<int> seen = 0, failures = 0;

bool fails(Call call) {
  if (call != wanted || last_to_fail < 0) return false;
  const int number = ++seen;
  if (number < first_to_fail || number > last_to_fail) return false;
  ++failures;
  errno = reason;
  return true;
}

}  // namespace

FailingCalls::FailingCalls(Call call, int first, int last, int error) {
  seen = failures = 0;
  wanted = call;
  first_to_fail = first;
  last_to_fail = last;
  reason = error;
}

FailingCalls::~FailingCalls() { last_to_fail = -1; }

int FailingCalls::failed() const { return failures; }

}  // namespace tetropolis::testing

// A program's own functions come before those of the C library, for the C++ library, too.
using tetropolis::testing::Call;
using tetropolis::testing::fails;

extern "C" int rename(const char* from, const char* to) noexcept {
  if (fails(Call::kRename)) return -1;
  return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0U));
}

extern "C" ssize_t write(int file, const void* bytes, size_t size) {
  return fails(Call::kWrite) ? -1 : syscall(SYS_write, file, bytes, size);
}

extern "C" ssize_t writev(int file, const iovec* parts, int count) {
  return fails(Call::kWrite) ? -1 : syscall(SYS_writev, file, parts, count);
}

extern "C" int unlinkat(int folder, const char* name, int flags) noexcept {
  return fails(Call::kUnlinkat) ? -1 : static_cast<int>(syscall(SYS_unlinkat, folder, name, flags));
}
