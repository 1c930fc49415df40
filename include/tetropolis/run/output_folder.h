// A folder of results that appears complete or not at all (guarantee 8).
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tetropolis {

/// How a program keeps track of an output. Either may be empty.
struct OutputWatcher {
  /// The hidden folder is there. `discard` removes it again, and what was made for it; it may be
  /// called from any thread, in a signal handler too, until `moves` has returned, by one who then
  /// ends the process.
  std::function<void(std::function<void()> discard)> begins;
  std::function<void()> moves;  ///< Results move to their place from here on.
};

/// Which files of an earlier run (by its report) are removed that the new one does not write.
enum class Replaces {
  kAll,
  kModels,  ///< City models, terrain and meshes; what `synth` wrote is data that others read.
};

/// Results are written to a hidden folder beside the target (".NAME.part-..."), or inside of it
/// where it is a mount of its own or nothing can be made beside it; commit() moves them in. A
/// target that did not exist appears by one rename. In one that did, the results of the earlier run
/// (what its report says it wrote, as `replaces` says) are moved aside, the report first, then the
/// new ones in, the report last: no moment shows a report beside files that it does not describe.
/// All other files stay, and those that were given to keep(); one that has the name of a new result
/// is replaced only if `overwrite` is set. If a move fails, all of them are undone. Without
/// commit() the destructor removes everything, the target is as it was.
///
/// A process that is killed leaves its hidden folder behind, and so does one that cannot undo its
/// moves. The next OutputFolder for the same target removes it, and puts the earlier results back
/// (or removes the half of a new one) if the kill fell between the moves. Folders of processes that
/// still run are left alone: each holds a lock (flock) on its own, so on file systems without such
/// locks nothing is removed.
class OutputFolder {
 public:
  /// Creates the hidden folder. Throws Error(kUsage) if the target is a file, holds a folder with
  /// the name of a result, or nothing can be created beside it.
  explicit OutputFolder(const std::filesystem::path& target, OutputWatcher watcher = {},
                        Replaces replaces = Replaces::kAll, bool overwrite = false);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write a result of this name, which comes with other files. All of them have to be
  /// there at commit(). A folder may have any files in it besides.
  std::filesystem::path result(const std::string& name, const std::vector<std::string>& with = {});

  /// Where that is, or will be.
  std::filesystem::path operator/(const std::string& name) const { return staging_ / name; }

  /// The results, sorted: files that are written, relative to the folder, and those of an earlier
  /// run that stay.
  std::vector<std::string> files() const;

  /// Before the work, what commit() asks again: that results of these names replace no file but
  /// those of an earlier run. Throws Error(kUsage) naming the file.
  void require_free(const std::vector<std::string>& names) const;

  /// An input of this run, or what belongs to it: it stays even if it is a result of an earlier
  /// run. Of a link, both the link and the file.
  void keep(const std::filesystem::path& file);

  /// Throws Error(kInput) naming a result that is gone or could not be moved, Error(kUsage) naming
  /// a file to be kept, or of nobody's run, that a result would replace; the target is as it was,
  /// or the message says that part of it is in the hidden folder.
  void commit();

  /// The hidden folder that commit() could not remove, and why. It holds no result that counts.
  struct Leftover {
    std::filesystem::path folder;
    std::string reason;
  };
  /// After commit(); nothing as a rule.
  const std::optional<Leftover>& leftover() const { return leftover_; }

 private:
  void create_staging(const std::filesystem::path& named);
  void require_all() const;
  std::vector<std::filesystem::path> staying() const;

  OutputWatcher watcher_;
  Replaces replaces_;
  bool overwrite_;
  std::filesystem::path target_;
  std::filesystem::path home_;  // of staging_: beside the target, or the target itself
  std::filesystem::path staging_;
  std::filesystem::path created_parent_;     // topmost folder made for the target, empty if none
  std::vector<std::filesystem::path> kept_;  // relative to the target
  std::vector<std::string> names_;           // of the results to come
  int lock_ = -1;                            // on staging_, for as long as this object lives
  bool committed_ = false;
  bool torn_ = false;  // the target is without part of the earlier result
  std::optional<Leftover> leftover_;
};

/// Whether a file has the place of a result: of a run into `out` (if that is not empty), or of an
/// earlier one, by the report of a folder around it.
bool is_result(const std::filesystem::path& file, const std::filesystem::path& out = {});

}  // namespace tetropolis
