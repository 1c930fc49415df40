// Reading in a process with little memory.
#pragma once

#include <cstdio>
#include <cstdlib>

#include <sys/resource.h>

#include "tetropolis/core/error.h"

namespace tetropolis::testing {

/// For death tests: reads where the process may take no more than 4 GiB. Leaves with 3 and the
/// message on the error stream if an Error(kInput) says why it cannot, with 0 if it can.
template <typename Read>
[[noreturn]] void read_in_four_gigabytes(const Read& read) {
  constexpr rlim_t kBytes = rlim_t{4} << 30;
  const rlimit limit{kBytes, kBytes};
  setrlimit(RLIMIT_AS, &limit);
  try {
    read();
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    std::exit(error.kind() == ErrorKind::kInput ? 3 : 1);
  }
  std::exit(0);
}

}  // namespace tetropolis::testing
