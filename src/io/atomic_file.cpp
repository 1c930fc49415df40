#include "tetropolis/io/atomic_file.h"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "tetropolis/core/error.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

std::string system_reason(int error) {
  return error == 0 ? "unknown reason" : std::generic_category().message(error);
}

/// Creates an empty file that nobody else has and returns its name.
fs::path create_beside(const fs::path& target) {
  const std::string stem =
      "." + target.filename().string() + ".part-" + std::to_string(::getpid()) + "-";
  for (int attempt = 0;; ++attempt) {
    fs::path name = target.parent_path() / (stem + std::to_string(attempt));
    const int file = ::open(name.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (file >= 0) {
      ::close(file);
      return name;
    }
    if (errno != EEXIST) throw_cannot_write(target, system_reason(errno));
  }
}

}  // namespace

fs::path final_path(const fs::path& path) {
  static constexpr std::string_view kPart = ".part-";
  static constexpr std::size_t kRandom = 6;
  fs::path result;
  for (const fs::path& component : path) {
    const std::string name = component.string();
    const std::size_t end = name.size() - std::min(name.size(), kPart.size() + kRandom);
    const bool hidden = component != path.filename() && end > 1 && name.front() == '.' &&
                        name.compare(end, kPart.size(), kPart) == 0;
    // Inside of NAME itself it is only passed through.
    if (!hidden)
      result /= component;
    else if (const std::string shown = name.substr(1, end - 1); result.filename() != shown)
      result /= shown;
  }
  return result;
}

void throw_cannot_write(const fs::path& path, std::string_view reason) {
  const std::string why(reason.empty() ? "unknown reason" : reason);
  throw Error(ErrorKind::kInput, "cannot write " + final_path(path).string() + ": " + why +
                                     "; choose another output or free disk space");
}

AtomicFile::AtomicFile(fs::path target) : target_(std::move(target)) {
  if (target_.filename().empty()) throw_cannot_write(target_, "the path names no file");
  temporary_ = create_beside(target_);
}

AtomicFile::~AtomicFile() {
  if (committed_) return;
  stream_.close();
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

std::ostream& AtomicFile::stream() {
  if (!stream_.is_open()) {
    // Not truncated: when a file that was is closed, ext4 allocates its blocks and begins to put
    // them on the disk (auto_da_alloc, ext4(5)), which takes as long again as writing it.
    stream_.open(temporary_, std::ios::binary | std::ios::in | std::ios::out);
    if (!stream_) throw_cannot_write(target_, system_reason(errno));
  }
  return stream_;
}

void AtomicFile::write(std::string_view bytes) {
  errno = 0;
  if (!stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size())))
    throw_cannot_write(target_, system_reason(errno));
}

void AtomicFile::overwrite(std::uint64_t position, std::string_view bytes) {
  stream().seekp(static_cast<std::streamoff>(position));
  write(bytes);
  errno = 0;
  if (!stream().seekp(0, std::ios::end)) throw_cannot_write(target_, system_reason(errno));
}

void AtomicFile::commit() {
  assert(!committed_);
  if (stream_.is_open()) {
    const bool good = stream_.good();
    errno = 0;
    stream_.close();
    if (!good || !stream_) throw_cannot_write(target_, system_reason(errno));
  }
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) throw_cannot_write(target_, error.message());
  committed_ = true;
}

}  // namespace tetropolis
