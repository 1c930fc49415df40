// Files read at positions. Private to src/io.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "core/descriptor.h"

namespace tetropolis {

/// A file opened for reading at positions, from several threads at once. Errors are Error(kInput)
/// and name the file.
class PositionedFile {
 public:
  explicit PositionedFile(const std::filesystem::path& path);

  std::int64_t size() const { return size_; }
  /// Reads up to `size` bytes at `position`; returns how many there were before the end.
  std::size_t read(std::int64_t position, void* data, std::size_t size) const;

 private:
  std::filesystem::path path_;
  Descriptor file_;
  std::int64_t size_ = 0;
};

}  // namespace tetropolis
