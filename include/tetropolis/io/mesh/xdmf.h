// XDMF 3: small XML files that describe arrays in HDF5 files beside them; what FEniCSx, meshio and
// ParaView read. Format: "XDMF Model and Format" (xdmf.org); layout as DOLFINx reads it
// (dolfinx.io.XDMFFile.read_mesh and read_meshtags, DOLFINx 0.10 documentation):
//
//   with dolfinx.io.XDMFFile(MPI.COMM_WORLD, "volume.xdmf", "r") as file:
//       mesh = file.read_mesh()
//       regions = file.read_meshtags(mesh, name="mesh")
//   mesh.topology.create_connectivity(2, 3)
//   with dolfinx.io.XDMFFile(MPI.COMM_WORLD, "boundary.xdmf", "r") as file:
//       patches = file.read_meshtags(mesh, name="boundary")
//       buildings = file.read_meshtags(mesh, name="boundary", attribute_name="building")
#pragma once

#include <filesystem>
#include <variant>

#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/io/file/compression.h"
#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/cell_zones.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/column/column_mesh.h"
#include "tetropolis/volume/tet_mesh.h"

namespace tetropolis {

/// Writes `volume` (NAME.xdmf) with NAME.h5 beside it, and `boundary` with an HDF5 file beside
/// that: DOLFINx opens the one of the description's name, meshio one grid a file.
///
/// Grid "mesh" of the volume: the tets, nodes and cells numbered as write_vtu does. HDF5 datasets
/// /Mesh/mesh/geometry (n x 3, float64, Placement::shift added), /Mesh/mesh/topology (m x 4,
/// int64), /Mesh/mesh/region (m, int32: building the cell stands over, or -1) and, with `zones`,
/// /Mesh/mesh/zone (m, int32: CellZones::of_cell). Grid "boundary": the
/// faces of `surface` over the same nodes, to which it refers. /MeshTags/boundary/topology (f x 3,
/// int64, normals leaving the air), /patch (f, int32, see Patch) and /building (f, int32, -1 where
/// none). The names of the patches are where meshio has its `field_data`: an Information of the
/// grid with a key for each. Both HDF5 files have Placement::origin as /origin (3, float64).
///
/// With prisms there is nothing but them (Wedge, m x 6), or tets and prisms (Mixed): then the
/// topology is one list in which the number of its type, 6 or 8, comes before the nodes of each
/// cell. The boundary has quadrilaterals at their sides, and is Mixed likewise (4 and 5).
///
/// Compressed, the datasets have chunks with the filters deflate and, for whole numbers, shuffle;
/// every program that reads HDF5 unpacks them.
///
/// Precondition: `surface` is extract_boundary of `mesh`, else Error(kGuarantee). Streams: memory
/// beside mesh and surface is a few numbers per ground vertex, triangle and boundary point. The
/// files appear complete, those with the data first. Throws Error(kInput) if they cannot be
/// written, are not in one folder, or if a name ends in .h5; Cancelled.
void write_xdmf(const std::filesystem::path& volume, const std::filesystem::path& boundary,
                const ColumnMesh& mesh, const SurfaceMesh& surface, const Placement& placement,
                const Progress& progress = {}, Compression compression = Compression::kNone,
                const CellZones& zones = {});

/// Reads a volume or a boundary that write_xdmf has written, plain or compressed: `path` and the
/// HDF5 files beside it that it names. Points of the boundary are in the order of the volume's.
/// Throws as read_vtu; other layouts of XDMF are not supported.
std::variant<TetMesh, SurfaceMesh> read_xdmf(const std::filesystem::path& path);

/// Placement::origin of a file that write_xdmf has written. Throws as read_xdmf.
Point3 read_xdmf_origin(const std::filesystem::path& path);

}  // namespace tetropolis
