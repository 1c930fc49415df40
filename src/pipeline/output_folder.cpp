#include "tetropolis/pipeline/output_folder.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <fstream>
#include <random>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <dirent.h>
#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/atomic_file.h"

#include "core/descriptor.h"
#include "result_files.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// Inside the hidden folder: results of an earlier run while they are being moved aside (or back),
/// and once all of them are. The name is the journal from which a killed commit is undone.
constexpr const char* kBeingMoved = ".earlier-moving";
constexpr const char* kMovedAside = ".earlier";

/// There, too: the names of the new results, one a line, before any of them is moved.
constexpr const char* kNewNames = ".new";

/// The files that were written, relative to the folder: a folder in it (constant/polyMesh) may hold
/// files of the user in the target. The report comes last.
std::vector<fs::path> results_below(const fs::path& folder) {
  std::vector<fs::path> names;
  // A link, also one to a folder, is a file here.
  const auto is_folder = [](const fs::directory_entry& entry) {
    return entry.is_directory() && !entry.is_symlink();
  };
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path name = entry.path().filename();
    if (name.string().front() == '.') continue;
    if (!is_folder(entry)) {
      names.push_back(name);
      continue;
    }
    for (const auto& inner : fs::recursive_directory_iterator(entry))
      if (!is_folder(inner)) names.push_back(inner.path().lexically_relative(folder));
  }
  std::sort(names.begin(), names.end(), [](const fs::path& a, const fs::path& b) {
    return std::pair(a == results::kReport, a) < std::pair(b == results::kReport, b);
  });
  return names;
}

[[noreturn]] void fail(const fs::path& target, const std::string& reason) {
  throw Error(ErrorKind::kUsage, target.string() + ": cannot be written: " + reason +
                                     "; choose another folder with --out");
}

/// A folder of the user's that has the name of a result would be replaced with all in it.
void require_no_folder(const fs::path& target, const fs::path& name) {
  std::error_code error;
  if (fs::is_directory(fs::symlink_status(target / name, error)))
    fail(target / name, "it is a folder, not a result");
}

/// Links count for themselves. What cannot be looked at is not there: moving it would fail too.
bool exists_itself(const fs::path& path) {
  std::error_code error;
  return fs::exists(fs::symlink_status(path, error));
}

/// A move that failed, of the result `shown`.
struct MoveFailed {
  fs::path shown;
  std::error_code reason;
};

/// Renames that can be taken back.
class Moves {
 public:
  /// Throws MoveFailed.
  void move(const fs::path& from, const fs::path& to, const fs::path& shown) {
    std::error_code error;
    make_folders(to.parent_path(), error);
    if (!error) fs::rename(from, to, error);
    if (error) throw MoveFailed{shown, error};
    done_.emplace_back(from, to);
  }

  /// Backwards, so that the earlier report comes last. What cannot be moved back ends it, with the
  /// result false: then put_back_earlier() finds no report and the rest where it was moved to.
  bool undo() {
    std::error_code error;
    for (; !done_.empty(); done_.pop_back()) {
      fs::create_directories(done_.back().first.parent_path(), error);
      fs::rename(done_.back().second, done_.back().first, error);
      if (error) return false;
    }
    for (; !made_.empty(); made_.pop_back()) ::rmdir(made_.back().c_str());
    return true;
  }

 private:
  void make_folders(const fs::path& folder, std::error_code& error) {
    std::vector<fs::path> missing;
    for (fs::path p = folder; !exists_itself(p) && p.has_relative_path(); p = p.parent_path())
      missing.push_back(p);
    made_.insert(made_.end(), missing.rbegin(), missing.rend());
    fs::create_directories(folder, error);
  }

  std::vector<std::pair<fs::path, fs::path>> done_;
  std::vector<fs::path> made_;  // folders, each after the one around it
};

/// Opens a folder and locks it against other processes. Not good if it is locked or cannot be.
Descriptor lock_folder(const fs::path& folder, bool wait = false) {
  Descriptor file(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW));
  if (!file.good() || ::flock(file.get(), LOCK_EX | (wait ? 0 : LOCK_NB)) == 0) return file;
  const int reason = errno;
  file = Descriptor();
  errno = reason;
  return file;
}

/// Removes the folders in `target` around where a result was, while they are empty.
void remove_empty_folders(const fs::path& target, const fs::path& name) {
  std::error_code error;
  for (fs::path p = name.parent_path(); !p.empty() && fs::remove(target / p, error);)
    p = p.parent_path();
}

/// Removes the new results that a killed commit has moved to `target`: no other file is there of
/// their names, it had been moved aside.
void remove_new_results(const fs::path& stale, const fs::path& target) {
  std::error_code error;
  std::ifstream list(stale / kNewNames);
  for (std::string name; std::getline(list, name);) {
    fs::remove(target / name, error);
    remove_empty_folders(target, name);
  }
}

/// Whether the results in a folder are of an earlier run, and not files of the user's that happen
/// to have their names.
bool holds_our_report(const fs::path& folder) {
  std::error_code error;
  // A pipe would be waited for.
  if (!fs::is_regular_file(folder / results::kReport, error)) return false;
  std::ifstream file(folder / results::kReport);
  const auto report = nlohmann::json::parse(file, nullptr, false);
  return report.is_object() && report.contains("version") && report.contains("command") &&
         report.contains("steps");
}

/// Puts back what a killed commit had moved aside; false if something is in the way, or there are
/// no handles or memory for it. May itself be killed and run again. The target must be locked.
bool put_back_earlier(const fs::path& stale, const fs::path& target) try {
  std::error_code error;
  const fs::path moved = stale / kMovedAside, moving = stale / kBeingMoved;
  // A report says that the commit was over. No folder: somebody removed it, and meant it.
  if (!fs::is_directory(target, error) || fs::exists(target / results::kReport, error)) return true;
  if (fs::exists(moved, error)) {
    remove_new_results(stale, target);
    fs::rename(moved, moving, error);
    if (error) return false;
  }
  if (!fs::exists(moving, error)) return true;
  for (const fs::path& name : results_below(moving)) {
    fs::create_directories((target / name).parent_path(), error);
    fs::rename(moving / name, target / name, error);
    if (error) return false;
  }
  return true;
} catch (const std::exception&) {
  return false;
}

/// The same where another run may be moving its results to the target.
bool restore_earlier(const fs::path& stale, const fs::path& target) {
  const Descriptor lock = lock_folder(target, true);
  return put_back_earlier(stale, target);
}

bool is_staging_of(const fs::path& folder, const std::string& prefix) {
  const std::string name = folder.filename().string();
  if (name.size() != prefix.size() + 6 || !name.starts_with(prefix)) return false;
  struct stat status {};
  return ::lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) &&
         status.st_uid == ::geteuid();
}

/// The folders from the innermost up to `created`, none if that is empty.
std::vector<fs::path> folders_up_to(const fs::path& innermost, const fs::path& created) {
  std::vector<fs::path> folders;
  if (created.empty()) return folders;
  for (fs::path p = innermost;; p = p.parent_path()) {
    folders.push_back(p);
    if (p == created) return folders;
  }
}

/// Removes folders made for a run, one around the other, while they are empty. For signal handlers.
void remove_empty(const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders)
    if (::rmdir(folder.c_str()) != 0) return;
}

/// The same where only some of them may have been made.
void remove_made(fs::path innermost, const fs::path& created) {
  std::error_code ignored;
  while (!created.empty() && innermost != created && !fs::exists(innermost, ignored))
    innermost = innermost.parent_path();
  remove_empty(folders_up_to(innermost, created));
}

/// A new folder with the permissions that folders of this process usually have: mkdtemp's are
/// private. Its name is `prefix` and six random characters. False, and errno, where it fails.
bool make_random_folder(const fs::path& home, const std::string& prefix, fs::path& made) {
  constexpr std::string_view kCharacters = "abcdefghijklmnopqrstuvwxyz0123456789";
  std::random_device random;
  for (;;) {
    std::string name = prefix;
    for (int i = 0; i < 6; ++i) name += kCharacters[random() % kCharacters.size()];
    made = home / name;
    if (::mkdir(made.c_str(), 0777) == 0) return true;
    if (errno != EEXIST) return false;
  }
}

/// Removes a file, or a folder with all in it. System calls and nothing else: a signal may have
/// come while its thread held the lock of the heap.
void remove_from_handler(int parent, const char* name) {
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
        remove_from_handler(folder, entry->d_name);
    }
  ::close(folder);
  ::unlinkat(parent, name, AT_REMOVEDIR);
}

/// Removes the results in the making, while a run may still be writing them, and the folders made
/// for it, while they are empty. For signal handlers.
void discard(const fs::path& staging, const std::vector<fs::path>& made) {
  constexpr int attempts = 20;
  for (int i = 0; i < attempts && ::access(staging.c_str(), F_OK) == 0; ++i)
    remove_from_handler(AT_FDCWD, staging.c_str());
  remove_empty(made);
}

/// Whether files can be renamed from one of two folders to the other, as far as the system tells.
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

/// Removes hidden folders whose process is gone.
void remove_stale(const fs::path& home, const fs::path& target, const std::string& prefix) {
  std::error_code error;
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(home, error))
    if (is_staging_of(entry.path(), prefix)) found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  for (const fs::path& stale : found) {
    const Descriptor lock = lock_folder(stale);
    if (lock.good() && restore_earlier(stale, target)) fs::remove_all(stale, error);
  }
}

}  // namespace

/// A new folder, locked. Another process may take the new folder for a stale one in the moment
/// before it is locked: then there will be another.
void OutputFolder::create_staging(const fs::path& named) {
  const std::string prefix = "." + target_.filename().string() + ".part-";
  remove_stale(home_, target_, prefix);
  for (;;) {
    if (!make_random_folder(home_, prefix, staging_)) {
      staging_.clear();
      fail(named, std::strerror(errno));
    }
    lock_ = lock_folder(staging_).release();
    const bool taken = lock_ < 0 && (errno == EWOULDBLOCK || errno == ENOENT);
    struct stat status {};
    if (!taken && ::stat(staging_.c_str(), &status) == 0) return;
    if (lock_ >= 0) ::close(std::exchange(lock_, -1));
  }
}

OutputFolder::OutputFolder(const fs::path& target, OutputWatcher watcher)
    : watcher_(std::move(watcher)) {
  if (target.empty()) fail("--out", "no folder given");
  target_ = fs::absolute(target).lexically_normal();
  if (!target_.has_filename()) target_ = target_.parent_path();
  std::error_code error;
  if (fs::exists(target_, error) && !fs::is_directory(target_, error)) fail(target, "it is a file");
  // Of a link, the folder it leads to.
  if (fs::is_directory(target_, error)) {
    fs::path real = fs::canonical(target_, error);
    if (!error) target_ = std::move(real);
  }
  if (exists_itself(target_) && !fs::exists(target_, error)) fail(target, "it is a dangling link");
  const fs::path parent = target_.parent_path();
  for (fs::path p = parent; !fs::exists(p, error) && p.has_relative_path(); p = p.parent_path())
    created_parent_ = p;
  try {
    fs::create_directories(parent, error);
    if (error) fail(target, error.message());
    const bool inside = fs::is_directory(target_, error) &&
                        (!same_mount(parent, target_) || !can_make_files_in(parent));
    home_ = inside ? target_ : parent;
    create_staging(target);
    for (const std::string& name : results::all_names()) require_no_folder(target_, name);
    // An existing target must be writable itself: find out before the work, not after it.
    if (fs::exists(target_, error) && !can_make_files_in(target_))
      fail(target, std::strerror(errno));
  } catch (...) {
    if (!staging_.empty()) fs::remove_all(staging_, error);
    if (lock_ >= 0) ::close(lock_);
    remove_made(parent, created_parent_);
    throw;
  }
  if (watcher_.begins)
    watcher_.begins([staging = staging_, made = folders_up_to(parent, created_parent_)] {
      discard(staging, made);
    });
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  // Earlier results that could not be put back stay in the hidden folder for the next run to try.
  if (!torn_ && !committed_ && restore_earlier(staging_, target_))
    fs::remove_all(staging_, ignored);
  if (lock_ >= 0) ::close(lock_);
  if (!committed_) remove_empty(folders_up_to(target_.parent_path(), created_parent_));
}

fs::path OutputFolder::result(const std::string& name, const std::vector<std::string>& with) {
  names_.push_back(name);
  names_.insert(names_.end(), with.begin(), with.end());
  return staging_ / name;
}

/// A cleaner of hidden files may have come by.
void OutputFolder::require_all() const {
  for (const std::string& name : names_)
    if (!exists_itself(staging_ / name))
      throw Error(ErrorKind::kInput, (target_ / name).string() +
                                         ": cannot be written: it is gone from " +
                                         staging_.string() + "; was it removed during the run?");
}

void OutputFolder::replace_results() {
  std::vector<fs::path> names;
  try {
    names = results_below(staging_);
  } catch (const fs::filesystem_error& error) {
    throw Error(ErrorKind::kInput, target_.string() + ": the results being written are gone: " +
                                       error.code().message() + "; was " + staging_.string() +
                                       " removed during the run?");
  }
  const auto is_kept = [&](const fs::path& name) {
    return std::find(kept_.begin(), kept_.end(), name) != kept_.end();
  };
  for (const fs::path& name : names)
    if (is_kept(name))
      throw Error(ErrorKind::kUsage, (target_ / name).string() +
                                         ": is an input of this run, which would replace it; "
                                         "choose another folder with --out");
  for (const fs::path& name : names) require_no_folder(target_, name);
  const fs::path moving = staging_ / kBeingMoved, moved = staging_ / kMovedAside;
  {
    std::ofstream list(staging_ / kNewNames);
    for (const fs::path& name : names) list << name.string() << '\n';
    if (!list.flush()) throw_cannot_write(target_, std::strerror(errno));
  }
  // There whether or not anything is moved aside: it tells that new results have begun to come.
  std::error_code error;
  fs::create_directory(moving, error);
  if (error) throw_cannot_write(target_, error.message());
  Moves moves;
  const auto move_aside = [&](const fs::path& name) {
    if (!exists_itself(target_ / name) || is_kept(name)) return;
    moves.move(target_ / name, moving / name, target_ / name);
    remove_empty_folders(target_, name);
  };
  try {
    const bool all = holds_our_report(target_);
    for (const fs::path name : results::all_names())
      if (all || std::find(names.begin(), names.end(), name) != names.end()) move_aside(name);
    // A result of a name that no earlier version knew may replace a file too.
    for (const fs::path& name : names) move_aside(name);
    moves.move(moving, moved, target_);
    for (const fs::path& name : names) moves.move(staging_ / name, target_ / name, target_ / name);
  } catch (const MoveFailed& failed) {
    torn_ = !moves.undo() && !put_back_earlier(staging_, target_);
    throw Error(ErrorKind::kInput,
                failed.shown.string() + ": cannot be replaced: " + failed.reason.message() +
                    (torn_ ? "; part of the earlier result is in " + staging_.string() +
                                 ": keep that, the next run with this --out puts it back"
                           : "; the earlier result is unchanged"));
  }
}

void OutputFolder::keep(const fs::path& file) {
  std::error_code error;
  const fs::path target = fs::canonical(target_, error);
  if (error) return;
  const auto keep_at = [&](const fs::path& place) {
    if (!error) kept_.push_back(place.lexically_relative(target));
  };
  keep_at(fs::canonical(file, error));
  // A link in the folder is the user's as well as what it leads to.
  const fs::path named = fs::absolute(file);
  keep_at(fs::canonical(named.parent_path(), error) / named.filename());
}

void OutputFolder::commit() {
  // Two runs that end together replace the results one after the other. Until its turn has come, a
  // run can be interrupted.
  const bool is_new = !exists_itself(target_);
  const Descriptor lock = is_new ? Descriptor() : lock_folder(target_, true);
  if (watcher_.moves) watcher_.moves();
  require_all();
  std::error_code error;
  if (is_new) {
    fs::rename(staging_, target_, error);
    if (error)
      throw Error(ErrorKind::kInput,
                  target_.string() + ": cannot be written: " + error.message() +
                      "; was the folder around it moved or locked during the run?");
  } else {
    replace_results();
  }
  committed_ = true;
  // Of results that came by one rename, nothing is left there.
  std::error_code not_removed;
  fs::remove_all(staging_, not_removed);
  if (not_removed && exists_itself(staging_)) leftover_ = {staging_, not_removed.message()};
}

}  // namespace tetropolis
