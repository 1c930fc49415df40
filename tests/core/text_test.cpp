#include "core/text.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tetropolis {
namespace {

TEST(Text, LowerCaseChangesTheCapitalsOfAsciiAndNothingElse) {
  // All bytes, so also the neighbours of 'A' and 'Z', and parts of characters of UTF-8.
  for (int byte = 0; byte < 256; ++byte) {
    const std::string capitals = "ABCDEFGHIJKLMNOPQRSTUVWXYZ";
    const char c = static_cast<char>(byte);
    const std::size_t at = capitals.find(c);
    const char small = at == std::string::npos ? c : "abcdefghijklmnopqrstuvwxyz"[at];
    EXPECT_EQ(lower_case(std::string(1, c)), std::string(1, small)) << byte;
  }
  EXPECT_EQ(lower_case("Dach-\xC3\x84rger.GeoJSON"), "dach-\xC3\x84rger.geojson");
  EXPECT_EQ(lower_case(""), "");
}

TEST(Text, FirstBytesKeepWholeCharacters) {
  // Characters of one to four bytes.
  const std::vector<std::string> characters{
      "a", "\xC3\xA9", "\xE2\x82\xAC", "\xF0\x9F\x8F\xA0", "\xE2\x82\xAC", "b"};
  std::string text;
  std::vector<std::string> beginnings{""};
  for (const std::string& character : characters) beginnings.push_back(text += character);
  for (std::size_t most = 0; most <= text.size() + 2; ++most) {
    const auto longest = std::find_if(beginnings.rbegin(), beginnings.rend(),
                                      [&](const std::string& s) { return s.size() <= most; });
    EXPECT_EQ(first_bytes(text, most), *longest) << most;
  }
}

TEST(Text, FirstBytesOfWhatIsNoUtf8EndSomewhere) {
  const std::string parts(10, '\x80');
  EXPECT_EQ(first_bytes(parts, 10), parts);
  EXPECT_LE(first_bytes(parts, 5).size(), 5U);
}

}  // namespace
}  // namespace tetropolis
