// What the fuzz targets share: values from bytes, a file that holds the bytes, and claims.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include <fcntl.h>
#include <stdlib.h>  // mkdtemp
#include <unistd.h>

#include "tetropolis/core/error.h"

/// The entry that libFuzzer and the replaying program call.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace tetropolis::fuzz {

/// Ends the process, which the fuzzer takes for a finding, unless `holds`.
inline void claim(bool holds, std::string_view what) {
  if (holds) return;
  std::fprintf(stderr, "claim broken: %.*s\n", static_cast<int>(what.size()), what.data());
  std::abort();
}

/// Every error for the user is one line that says something and carries the kind expected of it.
inline void claim_error(const Error& error, ErrorKind kind, std::string_view mentions = "") {
  const std::string_view text = error.what();
  claim(error.kind() == kind, text);
  claim(!text.empty() && text.find('\n') == std::string_view::npos, text);
  claim(text.find(mentions) != std::string_view::npos, text);
}

/// Reads values from bytes; behind the end all are zero.
class ByteReader {
 public:
  ByteReader(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  bool empty() const { return at_ >= size_; }

  template <typename Value>
  Value take() {
    Value value{};
    const std::size_t n = std::min(sizeof value, size_ - at_);
    if (n > 0) std::memcpy(&value, data_ + at_, n);
    at_ += n;
    return value;
  }

  /// A number in [least, most].
  int between(int least, int most) { return least + take<std::uint8_t>() % (most - least + 1); }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t at_ = 0;
};

/// A folder of this process, removed when it ends well; TMPDIR says where.
inline const std::filesystem::path& scratch_folder() {
  struct Folder {
    Folder() {
      std::string pattern =
          (std::filesystem::temp_directory_path() / "tetropolis-fuzz-XXXXXX").string();
      claim(mkdtemp(pattern.data()) != nullptr, "a folder can be made in TMPDIR");
      path = pattern;
    }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
    std::filesystem::path path;
  };
  static const Folder folder;
  return folder.path;
}

/// Puts the bytes into a file of the scratch folder.
inline std::filesystem::path write_scratch(const char* name, const std::uint8_t* data,
                                           std::size_t size) {
  const std::filesystem::path path = scratch_folder() / name;
  const int file = ::open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0600);
  claim(file >= 0, "the scratch file can be opened");
  claim(::write(file, data, size) == static_cast<ssize_t>(size), "the scratch file can be written");
  ::close(file);
  return path;
}

}  // namespace tetropolis::fuzz
