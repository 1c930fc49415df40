// Where write_xdmf puts what in the HDF5 file, for writer and reader.
#pragma once

namespace tetropolis::xdmf {

inline constexpr const char* kGeometry = "/Mesh/mesh/geometry";
inline constexpr const char* kTopology = "/Mesh/mesh/topology";
inline constexpr const char* kRegion = "/Mesh/mesh/region";
inline constexpr const char* kFaces = "/MeshTags/boundary/topology";
inline constexpr const char* kPatch = "/MeshTags/boundary/patch";
inline constexpr const char* kBuilding = "/MeshTags/boundary/building";

}  // namespace tetropolis::xdmf
