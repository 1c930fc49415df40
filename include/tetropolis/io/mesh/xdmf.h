// XDMF 3: a small XML file that describes arrays in an HDF5 file beside it; what FEniCSx and
// ParaView read. Format: "XDMF Model and Format" (xdmf.org); layout as DOLFINx reads it
// (dolfinx.io.XDMFFile.read_mesh and read_meshtags, DOLFINx 0.10 documentation):
//
//   with dolfinx.io.XDMFFile(MPI.COMM_WORLD, "volume.xdmf", "r") as file:
//       mesh = file.read_mesh()
//       mesh.topology.create_connectivity(2, 3)
//       regions = file.read_meshtags(mesh, name="mesh")
//       patches = file.read_meshtags(mesh, name="boundary")
//       buildings = file.read_meshtags(mesh, name="boundary", attribute_name="building")
#pragma once

#include <filesystem>
#include <optional>

#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/io/file/compression.h"
#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/column/column_mesh.h"
#include "tetropolis/volume/tet_mesh.h"

namespace tetropolis {

/// Writes `path` (NAME.xdmf) and NAME.h5 beside it, to which it refers by name.
///
/// Grid "mesh": the tets, nodes and cells numbered as write_vtu does. HDF5 datasets
/// /Mesh/mesh/geometry (n x 3, float64, Placement::shift added), /Mesh/mesh/topology (m x 4,
/// int64), /Mesh/mesh/region (m, int32: building the cell stands over, or -1). Grid "boundary": the
/// faces of `surface` over the same nodes. /MeshTags/boundary/topology (f x 3, int64, normals
/// leaving the air), /patch (f, int32, see Patch) and /building (f, int32, -1 where none).
/// Placement::origin is the Information element "origin" of the Domain.
///
/// Compressed, the datasets have chunks with the filters deflate and, for whole numbers, shuffle;
/// every program that reads HDF5 unpacks them.
///
/// Precondition: `surface` is extract_boundary of `mesh`, else Error(kGuarantee). Streams: memory
/// beside mesh and surface is a few numbers per ground vertex, triangle and boundary point. The two
/// files appear complete, the one with the data first. Throws Error(kInput) if they cannot be
/// written or `path` ends in .h5, Cancelled.
void write_xdmf(const std::filesystem::path& path, const ColumnMesh& mesh,
                const SurfaceMesh& surface, const Placement& placement,
                const Progress& progress = {}, Compression compression = Compression::kNone);

struct XdmfMesh {
  TetMesh volume;
  SurfaceMesh boundary;          ///< Points in the order of the volume's.
  std::optional<Point3> origin;  ///< Placement::origin, if the file has it.
};

/// Reads what write_xdmf has written, plain or compressed: `path` and the HDF5 file beside it that
/// it names. Throws as read_vtu; other layouts of XDMF are not supported.
XdmfMesh read_xdmf(const std::filesystem::path& path);

}  // namespace tetropolis
