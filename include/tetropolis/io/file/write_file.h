// Files that appear complete or not at all (guarantee 8).
#pragma once

#include <filesystem>
#include <string_view>

namespace tetropolis {

/// Writes a file: under a hidden name beside `path` first, then by renaming. Error, kInput with the
/// path and the system's reason: it cannot be written; what was there stays.
void write_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace tetropolis
