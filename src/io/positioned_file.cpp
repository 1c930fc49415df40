#include "positioned_file.h"

#include <cerrno>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tetropolis/core/error.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Error(ErrorKind::kInput, path.string() + ": " + what);
}

}  // namespace

PositionedFile::PositionedFile(const fs::path& path)
    // Without waiting: a pipe that nobody writes to would hold us up before it can be refused.
    : path_(path), file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  if (!file_.good())
    fail(path, errno == ENOENT ? std::string("no such file; check the path")
                               : "cannot be opened: " + std::generic_category().message(errno));
  struct stat status {};
  if (::fstat(file_.get(), &status) != 0 || !S_ISREG(status.st_mode))
    fail(path, "is not an ordinary file");
  size_ = status.st_size;
}

std::size_t PositionedFile::read(std::int64_t position, void* data, std::size_t size) const {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t n = ::pread(file_.get(), static_cast<char*>(data) + done, size - done,
                              position + static_cast<std::int64_t>(done));
    if (n == 0) break;
    if (n < 0 && errno == EINTR) continue;
    if (n < 0)
      fail(path_,
           fmt::format("cannot be read at byte {}: {}", position + static_cast<std::int64_t>(done),
                       std::generic_category().message(errno)));
    done += static_cast<std::size_t>(n);
  }
  return done;
}

}  // namespace tetropolis
