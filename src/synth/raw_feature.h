// Footprints as files hold them, before any repair.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace tetropolis {

struct RawVertex {
  double x = 0;
  double y = 0;
  double z = 0;
  friend bool operator==(const RawVertex&, const RawVertex&) = default;
};

/// As stored: a proper ring repeats its first vertex at the end, but nothing says that this one
/// does, that it has four vertices, or that they are finite.
using RawRing = std::vector<RawVertex>;

/// Rings of one polygon, the outer one first.
using RawPolygon = std::vector<RawRing>;

struct RawFeature {
  std::string id;
  double height = std::numeric_limits<double>::quiet_NaN();  ///< Above ground; NaN: unknown.
  std::vector<RawPolygon> polygons;                          ///< None: a feature without geometry.
};

}  // namespace tetropolis
