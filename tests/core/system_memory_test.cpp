#include "tetropolis/core/system_memory.h"

#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include "support/sanitized.h"

namespace tetropolis {
namespace {

TEST(SystemMemory, IsPositiveAndNotMoreThanTheMachineHas) {
  const double machine =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  EXPECT_GT(usable_memory(), 0);
  EXPECT_LE(usable_memory(), machine);
}

TEST(SystemMemory, HeedsTheLimitOfAddressSpace) {
  if (TETROPOLIS_SANITIZED) GTEST_SKIP() << "the sanitizers need more address space than any limit";
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  const double half = usable_memory() / 2;
  rlimit limit = before;
  limit.rlim_cur = static_cast<rlim_t>(half);
  ASSERT_EQ(setrlimit(RLIMIT_AS, &limit), 0);
  const double limited = usable_memory();
  ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
  EXPECT_NEAR(limited, half, 1);
}

/// Bytes, as /proc/self/status states them in kB.
double address_space_taken() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (double kilobytes = 0; word == "VmSize:" && status >> kilobytes) return kilobytes * 1024;
  return -1;
}

TEST(SystemMemory, AddressSpaceThatIsTakenIsNotLeft) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  constexpr double kLeft = 8.0 * (1 << 30);
  rlimit limit = before;
  limit.rlim_cur = static_cast<rlim_t>(address_space_taken() + kLeft);
  ASSERT_EQ(setrlimit(RLIMIT_AS, &limit), 0);
  const double left = address_space_left();
  constexpr std::size_t kTaken = std::size_t{1} << 30;
  void* taken = mmap(nullptr, kTaken, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  const double left_then = address_space_left();
  if (taken != MAP_FAILED) munmap(taken, kTaken);
  ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
  ASSERT_NE(taken, MAP_FAILED);
  EXPECT_NEAR(left, kLeft, 16 << 20);  // reading the status may take some
  EXPECT_NEAR(left - left_then, static_cast<double>(kTaken), 16 << 20);
}

}  // namespace
}  // namespace tetropolis
