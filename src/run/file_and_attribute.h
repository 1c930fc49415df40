// Entries of settings that name a file, and perhaps an attribute of it.
#pragma once

#include <string>
#include <string_view>

namespace tetropolis {

struct FileAndAttribute {
  std::string file;
  std::string attribute;  ///< Empty: none is named.
};

/// Of FILE, or FILE:ATTRIBUTE with an attribute of heights. Throws Error(kUsage) naming the setting
/// for what is neither.
FileAndAttribute parse_file_and_attribute(std::string_view setting, const std::string& text);

}  // namespace tetropolis
