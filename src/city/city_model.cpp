#include "tetropolis/city/city_model.h"

#include <array>
#include <cmath>

namespace tetropolis {

namespace {

constexpr std::array kFlagNames = {"ground_from_dtm",
                                   "roof_from_unclassified",
                                   "roof_from_attribute",
                                   "no_roof_points",
                                   "minimum_height",
                                   "merged",
                                   "convex_hull",
                                   "repaired",
                                   "clipped",
                                   "roof_from_floors",
                                   "default_height",
                                   "planned"};

}  // namespace

std::vector<std::string> flag_names(std::uint32_t flags) {
  std::vector<std::string> names;
  for (std::size_t bit = 0; bit < kFlagNames.size(); ++bit)
    if ((flags >> bit & 1U) != 0) names.emplace_back(kFlagNames[bit]);
  return names;
}

std::uint32_t flags_from_names(const std::vector<std::string>& names) {
  std::uint32_t flags = 0;
  for (const std::string& name : names)
    for (std::size_t bit = 0; bit < kFlagNames.size(); ++bit)
      if (name == kFlagNames[bit]) flags |= 1U << bit;
  return flags;
}

const char* name_of(DropCause cause) {
  constexpr std::array kNames = {"unusable",   "outside",     "boundary", "too_small",
                                 "too_narrow", "no_building", "outlined", "replaced"};
  return kNames[static_cast<std::size_t>(cause)];
}

const char* name_of(Lod lod) {
  constexpr std::array kNames = {"block", "1.2", "1.3", "2.2"};
  return kNames[static_cast<std::size_t>(lod)];
}

RoofPlane snap_plane(const RoofPlane& plane) {
  constexpr double kPerUnit = 1e6;
  RoofPlane snapped;
  snapped.at = {std::nearbyint(plane.at.x), std::nearbyint(plane.at.y)};
  snapped.elevation = snap_height(plane(snapped.at));
  snapped.slope_x = std::nearbyint(plane.slope_x * kPerUnit) / kPerUnit;
  snapped.slope_y = std::nearbyint(plane.slope_y * kPerUnit) / kPerUnit;
  return snapped;
}

double snap_height(double value) {
  constexpr double kPerMetre = 1000;
  return std::nearbyint(value * kPerMetre) / kPerMetre;
}

double snap_coordinate(double value) {
  // Division by an integer rounds once, so that n steps read from a file as n / kStepsPerMetre give
  // the same double as here; n * 1e-4 would not.
  static_assert(kCoordinateStep == 1.0 / kStepsPerMetre);
  return std::nearbyint(value * kStepsPerMetre) / kStepsPerMetre;
}

}  // namespace tetropolis
