// Text in file names and formats, whatever the locale.
#pragma once

#include <string>

namespace tetropolis {

/// With small letters for the capital ones of ASCII.
inline std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

}  // namespace tetropolis
