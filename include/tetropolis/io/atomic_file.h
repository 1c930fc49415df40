// Files that appear complete or not at all (guarantee 8).
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <string_view>

namespace tetropolis {

/// A new file beside its target, under a hidden temporary name (".NAME.part-..."), renamed to the
/// target by commit() and removed by the destructor if commit() was not reached.
///
/// Every failure (no such folder, no permission, disk full) throws Error(kInput) with the target's
/// path and the system's reason: exit code 3, "an output that cannot be written".
class AtomicFile {
 public:
  /// Creates the empty temporary file. The target's folder must exist; a target that is there
  /// already stays untouched until commit() replaces it.
  explicit AtomicFile(std::filesystem::path target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// The name under which a library that wants a path may (re)write the file.
  const std::filesystem::path& path() const { return temporary_; }

  /// A binary stream that begins with the temporary file's first byte; what a library wrote there
  /// stays where it is not overwritten. Failures of the stream are reported by write() and
  /// commit().
  std::ostream& stream();

  /// Appends bytes to stream() and checks that they arrived.
  void write(std::string_view bytes);

  /// Replaces bytes written before, from byte `position` of the file; write() goes on at its end.
  void overwrite(std::uint64_t position, std::string_view bytes);

  /// Flushes, closes and renames. Call once, last.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;
  std::ofstream stream_;
  bool committed_ = false;
};

/// Where a file will be: unfinished results are in a hidden folder ".NAME.part-XXXXXX" until
/// they are moved to NAME, which is the name that the user knows.
std::filesystem::path final_path(const std::filesystem::path& path);

/// The error for an output that cannot be written: "cannot write PATH: REASON". A path inside the
/// hidden folder of an OutputFolder is shown as it will be.
[[noreturn]] void throw_cannot_write(const std::filesystem::path& path, std::string_view reason);

}  // namespace tetropolis
