// Files read at positions. Private to src/io.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "core/descriptor.h"

namespace tetropolis {

/// An ordinary file opened for reading at positions, from several threads at once. Errors are
/// Error(kInput) and name the file.
class PositionedFile {
 public:
  explicit PositionedFile(const std::filesystem::path& path);

  std::int64_t size() const { return size_; }
  /// Reads up to `size` bytes at `position`; returns how many there were before the end.
  std::size_t read(std::int64_t position, void* data, std::size_t size) const;
  /// The first `most` bytes, or all if there are fewer.
  std::string head(std::int64_t most) const;

 private:
  std::filesystem::path path_;
  Descriptor file_;
  std::int64_t size_ = 0;
};

}  // namespace tetropolis
