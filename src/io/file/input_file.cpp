#include "input_file.h"

#include <system_error>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/system_memory.h"

namespace tetropolis {

namespace fs = std::filesystem;

void fail_input(const fs::path& path, const std::string& what) {
  throw Error(ErrorKind::kInput, path.string() + ": " + what);
}

void require_ordinary_file(const fs::path& path) {
  std::error_code error;
  switch (fs::status(path, error).type()) {
    case fs::file_type::regular:
      return;
    case fs::file_type::not_found:
      fail_input(path, "no such file; check the path");
    case fs::file_type::none:
      fail_input(path, "cannot be opened: " + error.message() + "; check the path");
    case fs::file_type::directory:
      fail_input(path, "is a folder; name a file");
    default:
      fail_input(path, "is not an ordinary file; name one");
  }
}

void require_memory(const fs::path& path, double bytes, const std::string& task,
                    const std::string& remedy) {
  const double room = usable_memory();
  if (bytes <= room) return;
  fail_input(path, fmt::format("to {} takes about {:.1f} GB, but {:.1f} GB are free; {}", task,
                               bytes / 1e9, room / 1e9, remedy));
}

}  // namespace tetropolis
