// Where write_xdmf puts what in the HDF5 files, for writer and reader.
#pragma once

namespace tetropolis::xdmf {

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
