#include "file_and_attribute.h"

#include <fmt/format.h>

#include "tetropolis/core/error.h"

namespace tetropolis {

FileAndAttribute parse_file_and_attribute(std::string_view setting, const std::string& text) {
  const std::size_t colon = text.rfind(':');
  FileAndAttribute entry{text.substr(0, colon), {}};
  if (colon == std::string::npos) {
    if (!text.empty()) return entry;
  } else {
    entry.attribute = text.substr(colon + 1);
    // "C:\trees.gpkg" is a file.
    if (entry.attribute.find_first_of("/\\") != std::string::npos) return {text, ""};
    if (!entry.file.empty() && !entry.attribute.empty()) return entry;
  }
  throw Error(ErrorKind::kUsage,
              fmt::format("{}: '{}': give FILE, or FILE:ATTRIBUTE with an attribute of heights in "
                          "metres",
                          setting, text));
}

}  // namespace tetropolis
