#include "folders.h"

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <random>
#include <string_view>
#include <system_error>

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kRandomCharacters = 6;

/// Removes a file, or a folder with all in it.
void remove_at(int parent, const char* name) {
  const int folder = ::openat(parent, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder < 0) {
    ::unlinkat(parent, name, 0);
    return;
  }
  alignas(dirent64) char entries[2048];
  for (ssize_t size = 0; (size = ::getdents64(folder, entries, sizeof entries)) > 0;)
    for (ssize_t at = 0; at < size;) {
      const auto* entry = reinterpret_cast<const dirent64*>(entries + at);
      at += entry->d_reclen;
      if (std::strcmp(entry->d_name, ".") != 0 && std::strcmp(entry->d_name, "..") != 0)
        remove_at(folder, entry->d_name);
    }
  ::close(folder);
  ::unlinkat(parent, name, AT_REMOVEDIR);
}

}  // namespace

bool exists_itself(const fs::path& path) {
  std::error_code error;
  return fs::exists(fs::symlink_status(path, error));
}

fs::path real_path(const fs::path& path) {
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  if (error) return path.lexically_normal();
  const fs::path real = fs::weakly_canonical(absolute, error);
  return error ? absolute.lexically_normal() : real;
}

bool same_mount(const fs::path& a, const fs::path& b) {
  struct statx first {
  }, second{};
  if (::statx(AT_FDCWD, a.c_str(), 0, STATX_BASIC_STATS | STATX_MNT_ID, &first) != 0 ||
      ::statx(AT_FDCWD, b.c_str(), 0, STATX_BASIC_STATS | STATX_MNT_ID, &second) != 0)
    return true;
  if (first.stx_dev_major != second.stx_dev_major || first.stx_dev_minor != second.stx_dev_minor)
    return false;
  return (first.stx_mask & second.stx_mask & STATX_MNT_ID) == 0 ||
         first.stx_mnt_id == second.stx_mnt_id;
}

bool can_make_files_in(const fs::path& folder) {
  return ::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) == 0;
}

Descriptor lock_folder(const fs::path& folder, bool wait) {
  Descriptor file(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW));
  if (!file.good() || ::flock(file.get(), LOCK_EX | (wait ? 0 : LOCK_NB)) == 0) return file;
  const int reason = errno;
  file = Descriptor();
  errno = reason;
  return file;
}

bool make_random_folder(const fs::path& home, const std::string& prefix, fs::path& made) {
  constexpr std::string_view kCharacters = "abcdefghijklmnopqrstuvwxyz0123456789";
  std::random_device random;
  for (;;) {
    std::string name = prefix;
    while (name.size() < prefix.size() + kRandomCharacters)
      name += kCharacters[random() % kCharacters.size()];
    made = home / name;
    if (::mkdir(made.c_str(), 0777) == 0) return true;
    if (errno != EEXIST) return false;
  }
}

bool is_random_folder(const fs::path& folder, const std::string& prefix) {
  const std::string name = folder.filename().string();
  if (name.size() != prefix.size() + kRandomCharacters || !name.starts_with(prefix)) return false;
  struct stat status {};
  return ::lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) &&
         status.st_uid == ::geteuid();
}

std::vector<fs::path> folders_up_to(const fs::path& innermost, const fs::path& created) {
  std::vector<fs::path> folders;
  if (created.empty()) return folders;
  for (fs::path p = innermost;; p = p.parent_path()) {
    folders.push_back(p);
    if (p == created) return folders;
  }
}

void remove_empty(const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders)
    if (::rmdir(folder.c_str()) != 0) return;
}

void remove_from_handler(const fs::path& folder) {
  constexpr int attempts = 20;
  for (int i = 0; i < attempts && ::access(folder.c_str(), F_OK) == 0; ++i)
    remove_at(AT_FDCWD, folder.c_str());
}

}  // namespace tetropolis
