// Text in file names and formats, whatever the locale.
#pragma once

#include <cstddef>
#include <string>

namespace tetropolis {

/// With small letters for the capital ones of ASCII.
inline std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

/// The first bytes of UTF-8, `most` at most, without a part of a character at the end.
inline std::string first_bytes(std::string text, std::size_t most) {
  if (text.size() <= most) return text;
  const auto continues = [&](std::size_t i) {
    return (static_cast<unsigned char>(text[i]) & 0xC0) == 0x80;
  };
  while (most > 0 && continues(most)) --most;
  text.resize(most);
  return text;
}

}  // namespace tetropolis
