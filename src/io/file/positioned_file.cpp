#include "positioned_file.h"

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "input_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

int open_ordinary(const fs::path& path) {
  require_ordinary_file(path);
  // Without waiting, should a pipe have come in its place.
  return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
}

}  // namespace

PositionedFile::PositionedFile(const fs::path& path) : path_(path), file_(open_ordinary(path)) {
  struct stat status {};
  if (!file_.good() || ::fstat(file_.get(), &status) != 0)
    fail_input(path, "cannot be opened: " + std::generic_category().message(errno));
  size_ = status.st_size;
}

std::string PositionedFile::head(std::int64_t most) const {
  std::string bytes(static_cast<std::size_t>(std::min(most, size_)), '\0');
  bytes.resize(read(0, bytes.data(), bytes.size()));
  return bytes;
}

std::size_t PositionedFile::read(std::int64_t position, void* data, std::size_t size) const {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t n = ::pread(file_.get(), static_cast<char*>(data) + done, size - done,
                              position + static_cast<std::int64_t>(done));
    if (n == 0) break;
    if (n < 0 && errno == EINTR) continue;
    if (n < 0)
      fail_input(path_, fmt::format("cannot be read at byte {}: {}",
                                    position + static_cast<std::int64_t>(done),
                                    std::generic_category().message(errno)));
    done += static_cast<std::size_t>(n);
  }
  return done;
}

}  // namespace tetropolis
