#include "tetropolis/core/system_memory.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

namespace tetropolis {
namespace {

TEST(SystemMemory, IsPositiveAndNotMoreThanTheMachineHas) {
  const double machine =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  EXPECT_GT(usable_memory(), 0);
  EXPECT_LE(usable_memory(), machine);
}

TEST(SystemMemory, HeedsTheLimitOfAddressSpace) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizers need more address space than any limit";
#endif
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

TEST(SystemMemory, AddressSpaceThatIsTakenIsNotLeft) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizers need more address space than any limit";
#endif
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  rlimit limit = before;
  limit.rlim_cur = static_cast<rlim_t>(8) << 30;
  ASSERT_EQ(setrlimit(RLIMIT_AS, &limit), 0);
  const double left = address_space_left();
  constexpr std::size_t kTaken = std::size_t{1} << 30;
  void* taken = mmap(nullptr, kTaken, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  const double left_then = address_space_left();
  munmap(taken, kTaken);
  ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
  ASSERT_NE(taken, MAP_FAILED);
  EXPECT_LT(left, static_cast<double>(limit.rlim_cur));
  EXPECT_GT(left, static_cast<double>(kTaken));
  EXPECT_NEAR(left - left_then, static_cast<double>(kTaken), 1 << 20);
}

}  // namespace
}  // namespace tetropolis
