// Whether two point files are the same cloud. Private to src/io.
#pragma once

#include <filesystem>

#include "io/las/las_header.h"

namespace tetropolis {

enum class Likeness {
  kDifferent,
  kCopies,
  kOtherClasses,  ///< The same points of other classes, which tell no more in the second file,
  kMoreClasses,   ///< or tell more.
};

/// Compares two files of the same count of points, which is not 0, at their beginning and, where
/// both can be entered, in some other places. Throws Error(kInput) naming the file for points that
/// cannot be decoded.
Likeness compare_files(const std::filesystem::path& a, const LasLayout& in_a,
                       const std::filesystem::path& b, const LasLayout& in_b);

}  // namespace tetropolis
