// Where write_xdmf puts what in the HDF5 files, for writer and reader.
#pragma once

#include <cstdint>

namespace tetropolis::xdmf {

/// A kind of elements; where a grid has two, each element has the number of its kind before its
/// corners, and all are one list.
struct Kind {
  const char* name;
  std::int64_t corners;
  std::int64_t number;
};
inline constexpr Kind kTetrahedron{"Tetrahedron", 4, 6}, kWedge{"Wedge", 6, 8};
inline constexpr Kind kTriangle{"Triangle", 3, 4}, kQuadrilateral{"Quadrilateral", 4, 5};

/// Elements of a grid: tets or triangles, and prisms or quadrilaterals.
struct Elements {
  std::int64_t small = 0, large = 0;
  std::int64_t all() const { return small + large; }
  bool mixed() const { return small > 0 && large > 0; }
};

/// Numbers in the list of elements of both kinds.
inline std::int64_t mixed_size(const Kind& small, const Kind& large, const Elements& elements) {
  return elements.small * (1 + small.corners) + elements.large * (1 + large.corners);
}

// Of the volume.
inline constexpr const char* kGeometry = "/Mesh/mesh/geometry";
inline constexpr const char* kTopology = "/Mesh/mesh/topology";
inline constexpr const char* kRegion = "/Mesh/mesh/region";
inline constexpr const char* kZone = "/Mesh/mesh/zone";  ///< With zones.

// Of the boundary.
inline constexpr const char* kFaces = "/MeshTags/boundary/topology";
inline constexpr const char* kPatch = "/MeshTags/boundary/patch";
inline constexpr const char* kBuilding = "/MeshTags/boundary/building";

// Of both.
inline constexpr const char* kOrigin = "/origin";

}  // namespace tetropolis::xdmf
