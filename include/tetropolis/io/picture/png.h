// Pictures as PNG, without any library for pictures.
// Format: W3C, "Portable Network Graphics (PNG) Specification", third edition.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace tetropolis {

/// Pixels row by row from the top, each red, green, blue (sRGB).
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< width * height * 3.
};

/// Writes 8-bit RGB. Precondition: both sides >= 1. The same picture gives the same bytes; the file
/// appears complete or not at all. Throws Error(kInput) if it cannot be written, or if `path` is
/// there and no PNG, which would be lost.
void write_png(const std::filesystem::path& path, const Picture& picture);

}  // namespace tetropolis
