// Files that appear complete or not at all (guarantee 8). Private to the library.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <ios>
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

  /// Throws as commit() if anything written to stream() so far did not arrive.
  void require_written() const;

  /// Appends bytes to stream() and checks that they arrived.
  void write(std::string_view bytes);

  /// Replaces bytes written before, from byte `position` of the file; write() goes on at its end.
  void overwrite(std::uint64_t position, std::string_view bytes);

  /// Flushes, closes and renames. Call once, last.
  void commit();

 private:
  /// Keeps why an operation failed first: streams tell that one did, later and without a reason.
  class Buffer final : public std::filebuf {
   public:
    int error() const { return error_; }
    void close_file();  ///< Its failure is kept, too.

   protected:
    int_type overflow(int_type c) override;
    std::streamsize xsputn(const char* bytes, std::streamsize size) override;
    int sync() override;
    pos_type seekoff(off_type offset, std::ios::seekdir from, std::ios::openmode which) override;
    pos_type seekpos(pos_type position, std::ios::openmode which) override;

   private:
    template <typename Result>
    Result keep_reason(Result result, Result failure);

    int error_ = 0;
  };

  [[noreturn]] void fail() const;

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  Buffer buffer_;
  std::ostream stream_;
  bool committed_ = false;
};

/// Where a file will be: unfinished results are in a hidden folder ".NAME.part-XXXXXX" until
/// they are moved to NAME, which is the name that the user knows.
std::filesystem::path final_path(const std::filesystem::path& path);

/// The error for an output that cannot be written: "cannot write PATH: REASON". A path inside the
/// hidden folder of an OutputFolder is shown as it will be.
[[noreturn]] void throw_cannot_write(const std::filesystem::path& path, std::string_view reason);

}  // namespace tetropolis
