#include "tetropolis/run/output_folder.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tetropolis/core/error.h"

#include "core/is_among.h"
#include "core/mix64.h"
#include "core/sort_once.h"
#include "earlier_results.h"
#include "folders.h"
#include "replace_results.h"
#include "result_files.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse(const fs::path& target, const std::string& reason) {
  throw Error(ErrorKind::kUsage, target.string() + ": cannot be written: " + reason +
                                     "; choose another folder with `out`");
}

/// Removes the folders made for a run, of which only some may have been.
void remove_made(fs::path innermost, const fs::path& created) {
  std::error_code ignored;
  while (!created.empty() && innermost != created && !fs::exists(innermost, ignored))
    innermost = innermost.parent_path();
  remove_empty(folders_up_to(innermost, created));
}

/// How the names of hidden folders for a target begin. What is too long for a name of its own
/// stands there with a number in place of its end.
std::string staging_prefix(const std::string& name) {
  constexpr std::size_t kMost = 200;  // bytes; names have 255
  if (name.size() <= kMost) return "." + name + ".part-";
  std::uint64_t number = 0;
  for (const char c : name) number = mix64(number ^ static_cast<unsigned char>(c));
  std::size_t end = kMost;
  while ((static_cast<unsigned char>(name[end]) & 0xC0U) == 0x80U) --end;  // whole characters
  return fmt::format(".{}-{:016x}.part-", name.substr(0, end), number);
}

/// Removes hidden folders whose process is gone.
void remove_stale(const fs::path& home, const fs::path& target, const std::string& prefix) {
  std::error_code error;
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(home, error))
    if (is_random_folder(entry.path(), prefix)) found.push_back(entry.path());
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
  const std::string prefix = staging_prefix(target_.filename().string());
  remove_stale(home_, target_, prefix);
  for (;;) {
    if (!make_random_folder(home_, prefix, staging_)) {
      staging_.clear();
      refuse(named, std::strerror(errno));
    }
    lock_ = lock_folder(staging_).release();
    const bool taken = lock_ < 0 && (errno == EWOULDBLOCK || errno == ENOENT);
    struct stat status {};
    if (!taken && ::stat(staging_.c_str(), &status) == 0) return;
    if (lock_ >= 0) ::close(std::exchange(lock_, -1));
  }
}

OutputFolder::OutputFolder(const fs::path& target, OutputWatcher watcher, Replaces replaces,
                           bool overwrite)
    : watcher_(std::move(watcher)), replaces_(replaces), overwrite_(overwrite) {
  if (target.empty()) refuse("`out`", "no folder given");
  // Of a link, the folder it leads to.
  target_ = real_path(target);
  if (!target_.has_filename()) target_ = target_.parent_path();
  std::error_code error;
  if (fs::exists(target_, error) && !fs::is_directory(target_, error))
    refuse(target, "it is a file");
  if (exists_itself(target_) && !fs::exists(target_, error))
    refuse(target, "it is a dangling link");
  const fs::path parent = target_.parent_path();
  for (fs::path p = parent; !fs::exists(p, error) && p.has_relative_path(); p = p.parent_path())
    created_parent_ = p;
  try {
    fs::create_directories(parent, error);
    if (error) refuse(target, error.message());
    if (!fs::exists(target_, error) && error == std::errc::filename_too_long)
      refuse(target, error.message());
    const bool inside = fs::is_directory(target_, error) &&
                        (!same_mount(parent, target_) || !can_make_files_in(parent));
    home_ = inside ? target_ : parent;
    create_staging(target);
    for (const std::string& name : results::all_names()) require_no_folder(target_, name);
    // An existing target must be writable itself: find out before the work, not after it.
    if (fs::exists(target_, error) && !can_make_files_in(target_))
      refuse(target, std::strerror(errno));
  } catch (...) {
    if (!staging_.empty()) fs::remove_all(staging_, error);
    if (lock_ >= 0) ::close(lock_);
    remove_made(parent, created_parent_);
    throw;
  }
  if (watcher_.begins)
    watcher_.begins([staging = staging_, made = folders_up_to(parent, created_parent_)] {
      remove_from_handler(staging);
      remove_empty(made);
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

std::vector<std::string> OutputFolder::files() const {
  std::vector<std::string> names;
  for (const fs::path& name : results_below(staging_)) names.push_back(name.string());
  const std::vector<fs::path> stay = staying();
  for (const std::string& name : earlier_run(target_).files)
    if (is_among(name, stay) && exists_itself(target_ / name)) names.push_back(name);
  sort_once(names);
  return names;
}

/// What stays where it is, relative to the target.
std::vector<fs::path> OutputFolder::staying() const {
  std::vector<fs::path> names = kept_;
  if (replaces_ == Replaces::kAll) return names;
  const std::vector<std::string> models = results::all_names();
  for (const std::string& name : earlier_run(target_).files)
    if (!is_among(name, models)) names.emplace_back(name);
  return names;
}

void OutputFolder::require_free(const std::vector<std::string>& names) const {
  if (!overwrite_) require_ours(target_, {names.begin(), names.end()});
}

/// A cleaner of hidden files may have come by.
void OutputFolder::require_all() const {
  for (const std::string& name : names_)
    if (!exists_itself(staging_ / name))
      throw Error(ErrorKind::kInput, (target_ / name).string() +
                                         ": cannot be written: it is gone from " +
                                         staging_.string() + "; was it removed during the run?");
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
    replace_results(staging_, target_, staying(), overwrite_, torn_);
  }
  committed_ = true;
  // Of results that came by one rename, nothing is left there.
  std::error_code not_removed;
  fs::remove_all(staging_, not_removed);
  if (not_removed && exists_itself(staging_)) leftover_ = {staging_, not_removed.message()};
}

bool is_result(const fs::path& file, const fs::path& out) {
  const fs::path real = real_path(file);
  if (!out.empty()) {
    const std::string name = real.lexically_relative(real_path(out)).string();
    if (is_among(name, results::all_names()) || results::is_of_synth(name)) return true;
  }
  constexpr int kDeepest = 3;  // constant/polyMesh/points
  fs::path folder = real.parent_path();
  for (int k = 0; k < kDeepest; ++k, folder = folder.parent_path())
    if (is_among(real.lexically_relative(folder).string(), earlier_run(folder).files)) return true;
  return false;
}

}  // namespace tetropolis
