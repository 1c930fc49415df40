// Clouds that lie in a folder twice: as .las and as .laz (as in the test data of laspy and PDAL),
// or before and after their points were classified. Read twice, they double the density and mix
// classes. Private to src/io.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "io/las/las_plan.h"

namespace tetropolis {

/// Marks files that state the count and the box of another one and have the same points in a few
/// places: all but the first of those whose classes tell most there. Throws Error(kInput) naming
/// the file for points that cannot be decoded.
void find_twins(std::span<const std::filesystem::path> paths, std::vector<LasPlan>& plans);

}  // namespace tetropolis
