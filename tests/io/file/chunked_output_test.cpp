// Formatting in parallel, writing in order.
#include "io/file/chunked_output.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace tetropolis {
namespace {

TEST(ChunkedOutput, ChunksFillACacheAndNoMore) {
  using Case = std::pair<std::size_t, std::uint64_t>;
  for (const auto& [items, bytes] :
       {Case{1, 1}, Case{7, 1'000'000'000'000}, Case{1'000'000, 4'000'000}, Case{3, 2'000'000},
        Case{180'000, 160'000'000}, Case{100'000'000, 100'000'000}}) {
    SCOPED_TRACE(testing::Message() << items << " items of " << bytes << " bytes");
    const std::size_t grain = grain_for(items, bytes);
    const double chunk =
        static_cast<double>(grain) * static_cast<double>(bytes) / static_cast<double>(items);
    EXPECT_GE(grain, 1U);
    EXPECT_LE(grain, items);
    EXPECT_TRUE(chunk <= 1 << 20 || grain == 1) << chunk;
    EXPECT_TRUE(chunk >= 1 << 19 || grain == items) << chunk;
  }
  EXPECT_EQ(grain_for(0, 0), 1U);
  EXPECT_EQ(grain_for(5, 0), 5U);
}

TEST(ChunkedOutput, WritesWhatOneLoopWouldWhateverTheGrain) {
  struct Sink {
    std::string bytes;
    void write(const std::string& more) { bytes += more; }
  };
  std::string wanted;
  for (std::size_t i = 0; i < 1000; ++i) wanted += std::to_string(i) + ' ';
  for (const std::size_t grain : {1U, 7U, 333U, 1000U, 5000U}) {
    Sink sink;
    write_chunked(sink, 1000, grain, [](std::size_t begin, std::size_t end, std::string& buffer) {
      for (std::size_t i = begin; i < end; ++i) buffer += std::to_string(i) + ' ';
    });
    EXPECT_EQ(sink.bytes, wanted) << grain;
  }
}

}  // namespace
}  // namespace tetropolis
