// What report.json says that the other files of a folder must bear out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tetropolis/geometry/types.h"
#include "tetropolis/run/config.h"

#include "check_heights.h"

namespace tetropolis {

struct ReportedMesh {
  double cells, vertices, inverted, volume, triangles, ground_lowered, non_orthogonality, skewness;
  double min_vertical_gap;
  std::optional<double> top;                      ///< Of a flat one.
  std::map<std::string, double> angles, aspects;  ///< By the names of report.json.
  double faces_above_70;
  bool closed, manifold;
  std::map<std::string, std::int64_t> faces_by_patch;
};

struct ReportedGround {
  double triangles, least_angle, below_min_angle;
};

/// Of city.city.json.
struct ReportedCity {
  std::int64_t raw_buildings;  ///< Of city_raw.city.json.
  std::int64_t buildings;
  std::int64_t merged_groups;
  std::vector<std::pair<std::string, std::string>> dropped;  ///< Ids and reasons, sorted.
  std::map<std::string, std::int64_t> flags;
  std::optional<double> min_clearance;
  double area;
  std::optional<double> max_distance;
};

struct ReportedFacts {
  double min_distance = Config{}.min_building_distance;
  bool absolute = false;
  std::optional<std::size_t> footprint_parts;
  std::optional<ReportedCity> city;
  std::optional<Point2> origin;
  std::optional<std::array<double, 4>> domain;  ///< CRS coordinates.
  std::optional<std::string> crs;
  std::optional<ReportedMesh> mesh;
  std::vector<std::string> files;             ///< What the run wrote.
  std::vector<std::string> missing;           ///< Members that it should have ("/city/flags").
  std::filesystem::path city_model, terrain;  ///< What `mesh` has read; empty for other commands.
  std::optional<double> dtm_step;             ///< Of the run that made the terrain.
  std::optional<double> min_angle;
  double min_wall = Config{}.min_wall_height;
  std::optional<ExcavationSources> excavated;  ///< In the local frame; nothing: not known.
  ReportedGround ground{};
};

/// Of report.json in the folder, if there is one. What is not in it differs from every file. Throws
/// Error(kInput) if it is no report.
std::optional<ReportedFacts> read_report(const std::filesystem::path& folder);

}  // namespace tetropolis
