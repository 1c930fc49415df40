// Files that lack classes which others of the cloud have.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "tetropolis/core/progress.h"

#include "city_input.h"

namespace tetropolis {

/// The share of points up to which those of the ground are strays: a few of a class do not make
/// classified points.
constexpr double kStrayGround = 1e-3;

/// Whether there are points of the class, and they are at least the share `stray` of all.
bool has_class(const std::map<int, std::int64_t>& by_class, int code, double stray);

/// Whether there are points that nobody has classified: 0, 1, 12.
bool has_unclassified(const std::map<int, std::int64_t>& by_class);

/// The files with points in the domain that have points which nobody has classified but
/// none of class 2 (or strays: fewer than one in 1000), if others have. Not those where the ground
/// is in another file, as where each class has a file of its own or a strip without classes lies
/// over classified ones: more than half of the squares of 20 m that such a file has points in have
/// ground points.
std::vector<FilePoints> find_files_without_ground(const CityInput& input, const Progress& progress);

/// The points of files without class 6 (or strays: fewer than one in 10,000) that either are
/// `without_ground` or have class 2 themselves: these are not the rest of others.
std::vector<PointRange> find_ranges_without_buildings(const CityInput& input,
                                                      std::span<const FilePoints> without_ground);

/// The points in squares of 20 m at most `reach` metres (and a square) from points of the files,
/// ascending.
std::vector<std::size_t> find_points_near(const CityInput& input, std::span<const FilePoints> files,
                                          double reach, const Progress& progress);

}  // namespace tetropolis
