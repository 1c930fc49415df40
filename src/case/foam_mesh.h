// The mesh of an OpenFOAM case, as write_openfoam writes it, read back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// The ground outside the town, once a case has made it a patch.
inline constexpr const char* kOpenLand = "open_land";

struct FoamPatch {
  std::string name;
  bool is_wall = false;
  std::size_t begin = 0;  ///< Faces [begin, end).
  std::size_t end = 0;
  /// Whether its faces are of buildings, by its name.
  bool of_building() const {
    return is_wall && (name.starts_with("roof") || name.starts_with("wall"));
  }
};

/// A zone of leaves.
struct FoamCanopy {
  std::string name;
  double leaf_area_density = 0;     ///< [1/m], > 0.
  std::vector<std::int32_t> cells;  ///< One or more.
};

struct FoamMesh {
  std::vector<Point3> points;
  Point3 origin{};                       ///< What the points' coordinates are relative to.
  std::vector<std::int32_t> face_start;  ///< F + 1 offsets into face_points.
  std::vector<std::int32_t> face_points;
  std::vector<std::int32_t> owner;      ///< Per face.
  std::vector<std::int32_t> neighbour;  ///< Per internal face; these come first.
  std::vector<FoamPatch> patches;
  std::vector<FoamCanopy> canopies;   ///< Zones of cells that have a leafAreaDensity.
  Bounds2 town = Bounds2::nothing();  ///< As write_openfoam has noted it.
  /// What constant/polyMesh/boundary has to be for `patches`; empty if that is what it is.
  std::string new_boundary;

  std::size_t faces() const { return owner.size(); }
  std::size_t cells() const { return cell_count; }
  std::span<const std::int32_t> face(std::size_t f) const {
    return std::span(face_points)
        .subspan(static_cast<std::size_t>(face_start[f]),
                 static_cast<std::size_t>(face_start[f + 1] - face_start[f]));
  }
  const Point3& point(std::int32_t p) const { return points[static_cast<std::size_t>(p)]; }
  std::size_t cell_count = 0;
};

/// Centre and area vector (leaves the owner) of a face: sums over triangles around the mean of its
/// corners, as OpenFOAM has them.
struct FaceGeometry {
  Point3 centre{};
  Point3 area{};
};
FaceGeometry face_geometry(const FoamMesh& mesh, std::size_t f);

/// Reads `folder` (constant/polyMesh). Ground outside the town becomes the patch kOpenLand, behind
/// `ground`. Throws Error(kInput) naming the file, what is wrong and what to do.
FoamMesh read_foam_mesh(const std::filesystem::path& folder);

}  // namespace tetropolis
