// Libraries that are loaded when first needed.
#include "io/deferred/deferred_library.h"

#include <array>
#include <cstddef>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <zlib.h>

#include "support/errors.h"

namespace tetropolis {
namespace {

TEST(DeferredLibrary, IsFoundByNameWhereverItIs) {
  static constinit DeferredLibrary library("/nowhere/libz.so.1");
  static constinit const DeferredFunction<decltype(::zlibVersion)> version(library, "zlibVersion");
  std::array<const char* (*)(), 8> found{};
  std::array<std::thread, 8> threads;
  for (std::size_t i = 0; i < threads.size(); ++i)
    threads[i] = std::thread([&, i] { found[i] = version; });
  for (std::thread& t : threads) t.join();
  for (const auto each : found) EXPECT_EQ(each, &::zlibVersion);  // that which is linked
  EXPECT_STREQ(version(), ZLIB_VERSION);
}

TEST(DeferredLibrary, TellsWhatIsMissing) {
  DeferredLibrary none("/nowhere/libtetropolis_none.so.7");
  for (int i = 0; i < 2; ++i) {  // it may be there at the next attempt
    const std::string message =
        testing::error_of([&] { none.address("zlibVersion"); }, ErrorKind::kUsage);
    EXPECT_NE(message.find("libtetropolis_none.so.7: "), std::string::npos) << message;
    EXPECT_NE(message.find("install"), std::string::npos) << message;
  }
  DeferredLibrary zlib("/nowhere/libz.so.1");
  const std::string message =
      testing::error_of([&] { zlib.address("tetropolis_none"); }, ErrorKind::kUsage);
  EXPECT_NE(message.find("libz.so.1"), std::string::npos) << message;
  EXPECT_NE(message.find("tetropolis_none"), std::string::npos) << message;
}

}  // namespace
}  // namespace tetropolis
