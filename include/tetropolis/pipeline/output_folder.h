// A folder of results that appears complete or not at all (guarantee 8).
#pragma once

#include <filesystem>
#include <string>

namespace tetropolis {

/// Results are written to a hidden folder beside the target; commit() moves them in. A target that
/// did not exist appears by one rename; in one that did, each file replaces its predecessor by a
/// rename, report.json last, results of an earlier run that this one did not make are removed (they
/// would be taken for its own), and all other files stay. Without commit() the destructor removes
/// everything, the target is as it was.
class OutputFolder {
 public:
  /// Creates the hidden folder. Throws Error(kUsage) if the target is a file or nothing can be
  /// created beside it.
  explicit OutputFolder(const std::filesystem::path& target);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write a result of this name.
  std::filesystem::path operator/(const std::string& name) const { return staging_ / name; }

  /// Throws Error(kInput) naming the file that could not be moved or removed.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path staging_;
  std::filesystem::path created_parent_;  // topmost folder made for the target, empty if none
  bool committed_ = false;
};

}  // namespace tetropolis
