// What the headers of point clouds say before points are read; clouds in feet.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tetropolis/core/warning.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/io/las/point_arrays.h"
#include "tetropolis/run/config.h"

namespace tetropolis {

/// What the headers of all clouds say together.
struct CloudHeaders {
  std::string crs;
  std::string crs_file;
  std::optional<double> vertical_unit;  ///< Of the first file that states one.
  std::string vertical_file;
  Bounds2 box = Bounds2::nothing();
  std::vector<std::pair<Bounds2, std::int64_t>> points;  ///< Per file: where, and how many.
};

/// Errors: those of inspect_las; kInput naming two files whose heights have different units.
CloudHeaders read_headers(std::span<const std::filesystem::path> paths);

/// The same of points in memory.
CloudHeaders headers_of(const PointArrays& points);

/// About how many points are in `box`, CRS coordinates, as far as headers tell.
double expected_points(const CloudHeaders& headers, const Bounds2& box);

/// Metres per unit of coordinates and heights of a cloud.
struct CloudUnits {
  double across = 1;
  double up = 1;

  bool are_metres() const { return is_metre(across) && is_metre(up); }
};

/// The points' reference system as far as files and settings name it, in metres; "" if they do not.
/// Boxes of the headers become those in metres. Where points are in feet, `units` tell and a
/// warning ("points_units"). Throws Error(kInput) for degrees and units that are no lengths.
std::string stated_points_crs(const Config& config, const std::string& first_file, bool in_memory,
                              CloudHeaders& headers, CloudUnits& units,
                              std::vector<Warning>& warnings);

/// How points are to be read in their units where `reading` places them in metres.
ReadPointsOptions in_units(const CloudUnits& units, const ReadPointsOptions& reading);

/// Of a cloud that was read in other units; its origin is then in whole metres.
void convert_to_metres(const CloudUnits& units, PointsInput& input);

}  // namespace tetropolis
