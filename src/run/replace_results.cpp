#include "replace_results.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>

#include <unistd.h>

#include "tetropolis/core/error.h"

#include "core/is_among.h"
#include "earlier_results.h"
#include "folders.h"
#include "io/file/atomic_file.h"
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

/// As restore_earlier(), where the target is locked.
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

/// The results in `staging`, none of which is `kept`.
std::vector<fs::path> new_results(const fs::path& staging, const fs::path& target,
                                  std::span<const fs::path> kept) {
  std::vector<fs::path> names;
  try {
    names = results_below(staging);
  } catch (const fs::filesystem_error& error) {
    throw Error(ErrorKind::kInput, target.string() + ": the results being written are gone: " +
                                       error.code().message() + "; was " + staging.string() +
                                       " removed during the run?");
  }
  for (const fs::path& name : names)
    if (is_among(name, kept))
      throw Error(ErrorKind::kUsage, (target / name).string() +
                                         ": is an input of this run, which would replace it; "
                                         "choose another folder with `out`");
  for (const fs::path& name : names) require_no_folder(target, name);
  return names;
}

void write_names(const fs::path& staging, const fs::path& target,
                 const std::vector<fs::path>& names) {
  std::ofstream list(staging / kNewNames);
  for (const fs::path& name : names) list << name.string() << '\n';
  if (!list.flush()) throw_cannot_write(target, std::strerror(errno));
}

}  // namespace

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

void require_no_folder(const fs::path& target, const fs::path& name) {
  std::error_code error;
  if (fs::is_directory(fs::symlink_status(target / name, error)))
    throw Error(ErrorKind::kUsage, (target / name).string() +
                                       ": cannot be written: it is a folder, not a result; choose "
                                       "another folder with `out`");
}

void require_ours(const fs::path& target, const std::vector<fs::path>& names) {
  const std::vector<std::string> ours = earlier_run(target).files;
  for (const fs::path& name : names)
    if (exists_itself(target / name) && !is_among(name.string(), ours))
      throw Error(ErrorKind::kUsage, (target / name).string() +
                                         ": is in the way, and no earlier run has written "
                                         "it; choose another folder with `out`, or add "
                                         "`overwrite`");
}

void replace_results(const fs::path& staging, const fs::path& target,
                     std::span<const fs::path> kept, bool overwrite, bool& torn) {
  const std::vector<fs::path> names = new_results(staging, target, kept);
  if (!overwrite) require_ours(target, names);
  const fs::path moving = staging / kBeingMoved, moved = staging / kMovedAside;
  write_names(staging, target, names);
  // There whether or not anything is moved aside: it tells that new results have begun to come.
  std::error_code error;
  fs::create_directory(moving, error);
  if (error) throw_cannot_write(target, error.message());
  const std::vector<std::string> earlier = earlier_run(target).files;
  Moves moves;
  const auto move_aside = [&](const fs::path& name) {
    if (!exists_itself(target / name) || is_among(name, kept)) return;
    moves.move(target / name, moving / name, target / name);
    remove_empty_folders(target, name);
  };
  try {
    // The report, which vouches for the others, before all of them.
    move_aside(results::kReport);
    for (const fs::path name : earlier) move_aside(name);
    // Files of the user's that have the names of new results.
    for (const fs::path& name : names) move_aside(name);
    moves.move(moving, moved, target);
    for (const fs::path& name : names) moves.move(staging / name, target / name, target / name);
  } catch (const MoveFailed& failed) {
    torn = !moves.undo() && !put_back_earlier(staging, target);
    const std::string left =
        earlier.empty() ? "nothing was written" : "the earlier result is unchanged";
    throw Error(ErrorKind::kInput,
                failed.shown.string() + ": cannot be replaced: " + failed.reason.message() + "; " +
                    (torn ? "part of the earlier result is in " + staging.string() +
                                ": keep that, the next run with this `out` puts it back"
                          : left));
  }
}

bool restore_earlier(const fs::path& staging, const fs::path& target) {
  const Descriptor lock = lock_folder(target, true);
  return put_back_earlier(staging, target);
}

}  // namespace tetropolis
