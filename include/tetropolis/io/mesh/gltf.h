// glTF 2.0 in one binary file (GLB), for looking at a city in a browser or a game engine.
// Format: Khronos Group, "glTF 2.0 Specification" (ISO/IEC 12113:2022); Cesium, EXT_mesh_features
// and EXT_structural_metadata (extensions of glTF).
#pragma once

#include <filesystem>
#include <span>

#include "tetropolis/city/city_model.h"
#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/column/boundary.h"

namespace tetropolis {

/// Writes `surface` as one node, mesh and material per patch that has faces, named after it,
/// each with its own vertices: positions in single precision (x, z, -y), as glTF's y axis points
/// up, always in the local frame, since the numbers of a CRS do not fit into single precision.
/// Faces have the orientation of `surface`; there are no normals, for which viewers shade flat. The
/// number of the patch is extras.patch of its node. asset.extras.origin is where the local zero is
/// in the CRS, in its axes: the sum of `placement`'s shift and origin.
///
/// With `buildings`, those of the city model, vertices of roofs and walls have the number of their
/// building as a feature id (EXT_mesh_features, attribute _FEATURE_ID_0), and the property table
/// `buildings` has a row for each: id, source_ids, h_ground and h_roof (EXT_structural_metadata).
///
/// The file appears complete or not at all. Throws Error(kInput) if it cannot be written or needs
/// more than the format's 4 GiB (about 150 million triangles).
void write_glb(const std::filesystem::path& path, const SurfaceMesh& surface,
               const Placement& placement, std::span<const Building> buildings = {});

}  // namespace tetropolis
