#include "atomic_file.h"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/file/write_file.h"

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

template <typename Result>
Result AtomicFile::Buffer::keep_reason(Result result, Result failure) {
  if (result == failure && error_ == 0) error_ = errno == 0 ? EIO : errno;
  return result;
}

void AtomicFile::Buffer::close_file() {
  errno = 0;
  keep_reason(close(), static_cast<std::filebuf*>(nullptr));
}

AtomicFile::Buffer::int_type AtomicFile::Buffer::overflow(int_type c) {
  errno = 0;
  return keep_reason(std::filebuf::overflow(c), traits_type::eof());
}

std::streamsize AtomicFile::Buffer::xsputn(const char* bytes, std::streamsize size) {
  errno = 0;
  const std::streamsize put = std::filebuf::xsputn(bytes, size);
  keep_reason(put == size, false);
  return put;
}

int AtomicFile::Buffer::sync() {
  errno = 0;
  return keep_reason(std::filebuf::sync(), -1);
}

AtomicFile::Buffer::pos_type AtomicFile::Buffer::seekoff(off_type offset, std::ios::seekdir from,
                                                         std::ios::openmode which) {
  errno = 0;
  return keep_reason(std::filebuf::seekoff(offset, from, which), pos_type(off_type(-1)));
}

AtomicFile::Buffer::pos_type AtomicFile::Buffer::seekpos(pos_type position,
                                                         std::ios::openmode which) {
  errno = 0;
  return keep_reason(std::filebuf::seekpos(position, which), pos_type(off_type(-1)));
}

AtomicFile::AtomicFile(fs::path target) : target_(std::move(target)), stream_(&buffer_) {
  if (target_.filename().empty()) throw_cannot_write(target_, "the path names no file");
  temporary_ = create_beside(target_);
}

AtomicFile::~AtomicFile() {
  if (committed_) return;
  buffer_.close_file();
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void AtomicFile::fail() const { throw_cannot_write(target_, system_reason(buffer_.error())); }

void AtomicFile::require_written() const {
  if (!stream_.good() || buffer_.error() != 0) fail();
}

std::ostream& AtomicFile::stream() {
  if (!buffer_.is_open()) {
    errno = 0;
    // Not truncated: when a file that was is closed, ext4 allocates its blocks and begins to put
    // them on the disk (auto_da_alloc, ext4(5)), which takes as long again as writing it.
    if (buffer_.open(temporary_, std::ios::binary | std::ios::in | std::ios::out) == nullptr)
      throw_cannot_write(target_, system_reason(errno));
  }
  return stream_;
}

void AtomicFile::write(std::string_view bytes) {
  if (!stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()))) fail();
}

void AtomicFile::overwrite(std::uint64_t position, std::string_view bytes) {
  stream().seekp(static_cast<std::streamoff>(position));
  write(bytes);
  if (!stream().seekp(0, std::ios::end)) fail();
}

void AtomicFile::commit() {
  assert(!committed_);
  if (buffer_.is_open()) {
    buffer_.close_file();
    require_written();
  }
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) throw_cannot_write(target_, error.message());
  committed_ = true;
}

void write_file(const fs::path& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace tetropolis
