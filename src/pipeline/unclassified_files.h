// Files that nobody has classified, in a cloud of which others are.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "tetropolis/core/progress.h"

#include "read_input.h"

namespace tetropolis {

/// The files with points in the domain and no class (FilePoints::classified), if others have one.
/// Not those where the ground is in another file, as where each class has a file of its own or a
/// strip without classes lies over classified ones: more than half of the squares of 20 m that such
/// a file has points in have ground points.
std::vector<PointFile> find_unclassified_files(const InputData& input, const Progress& progress);

/// The points in squares of 20 m at most `reach` metres (and a square) from points of the files,
/// ascending.
std::vector<std::size_t> find_points_near(const InputData& input, std::span<const PointFile> files,
                                          double reach, const Progress& progress);

}  // namespace tetropolis
