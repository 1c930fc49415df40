// What a path names, with an answer for paths that cannot be looked at.
#pragma once

#include <filesystem>
#include <system_error>

#include "tetropolis/core/error.h"

namespace tetropolis {

/// Whether something is there; of a link, what it leads to. Throws Error(kInput) naming the path if
/// that cannot be found out, as in a folder that may not be entered.
inline bool is_there(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::none)
    throw Error(ErrorKind::kInput, path.string() + ": cannot be read: " + error.message());
  return std::filesystem::exists(status);
}

/// Whether an ordinary file is there, or a link to one; false if that cannot be found out.
inline bool is_file(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

}  // namespace tetropolis
