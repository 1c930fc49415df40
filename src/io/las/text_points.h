// Points in XYZ text and PLY files. Private to src.
//
// Source: Turk, The PLY Polygon File Format, 1994.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace tetropolis {

struct PlainPoints {
  std::vector<std::array<double, 3>> xyz;    ///< As in the file.
  std::vector<std::uint8_t> classification;  ///< One per point, or none.
};

/// By its name: .xyz, .txt, .csv, .asc, .pts or .ply.
bool is_plain_points(const std::filesystem::path& path);

/// Text: a point per line, x y z first, separated by blanks, commas or semicolons; what else stands
/// in a line is passed over, and so are lines before the first point. PLY: the element vertex with
/// x, y, z, and classification (also class, scalar_Classification) if it is there; ascii or binary,
/// little-endian. Errors, kInput with the path and the line: a line that is no point, a file that
/// is cut, another kind of PLY.
PlainPoints read_plain_points(const std::filesystem::path& path);

}  // namespace tetropolis
