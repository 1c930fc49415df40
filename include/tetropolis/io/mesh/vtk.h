// VTK XML files: volume.vtu, boundary.vtp and surface.vtp, raw appended data, little endian, 64-bit
// headers.
// Format: VTK File Formats (Kitware), "XML File Formats".
#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/progress.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/io/file/compression.h"
#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/cell_zones.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/column/column_mesh.h"
#include "tetropolis/volume/tet_mesh.h"

namespace tetropolis {

/// Writes the cells of `mesh`: points in double precision column by column and upwards, tets
/// triangle by triangle and upwards, then prisms likewise, as VTK's wedges (the base clockwise from
/// above), and the cell data `region` (Int32: the building whose footprint the cell stands over, by
/// position in the city model, or -1). Streams: needs little memory beside the mesh, compressed or
/// not. The file appears complete or not at all. Throws Error(kInput) if it cannot be written,
/// Cancelled.
///
/// `buildings`, those of the city model, become field data, one value a building in that order:
/// `building_id` and `building_source_ids`, a JSON list (UTF-8 in UInt8, a zero byte behind each
/// building's; arrays of type String end meshio), `building_h_ground` and `building_h_roof`
/// (Float64, elevations in metres).
///
/// `zones`, if there are any, become the cell data `zone` (Int32: CellZones::of_cell) and the field
/// data `zone_name` (UInt8, as above) and `zone_leaf_area_density` (Float64, 1/m).
void write_vtu(const std::filesystem::path& path, const ColumnMesh& mesh,
               const Placement& placement, const Progress& progress = {},
               Compression compression = Compression::kNone,
               std::span<const Building> buildings = {}, const CellZones& zones = {});

/// Writes a surface with the cell data `patch` (Int32, see Patch) and `building` (Int32: by
/// position in the city model, or -1); points and triangles as they are numbered in `surface`.
/// Field data: `patch_number` (Int32) and `patch_name` (String), one value a patch of
/// `surface.patches`; of `buildings` as write_vtu, but in arrays of type String. The file appears
/// complete or not at all. Throws Error(kInput) if it cannot be written.
void write_vtp(const std::filesystem::path& path, const SurfaceMesh& surface,
               const Placement& placement, Compression compression = Compression::kNone,
               std::span<const Building> buildings = {});

/// Reads the tets and wedges of a VTU file with raw appended arrays, uncompressed or compressed by
/// vtkZLibDataCompressor (as write_vtu, and ParaView with these settings, write them). Headers,
/// connectivity and points of 32 or 64 bits.
/// Throws Error(kInput) naming the file and what is wrong or not supported, also if the machine has
/// not the memory to read and check so many cells.
TetMesh read_vtu(const std::filesystem::path& path);

/// The same of the triangles of a VTP file with the cell data `patch` and `building`. Patches that
/// not every city has are named by its field data, else "patch9" or the like, and are of no known
/// kind.
SurfaceMesh read_vtp(const std::filesystem::path& path);

/// Where the zero of a VTU or VTP file lies in the reference system: the field data `origin`, if it
/// is three numbers as text (as write_vtu and write_vtp put it there). Throws Error(kInput) if the
/// file cannot be read.
std::optional<Point3> read_vtk_origin(const std::filesystem::path& path);

}  // namespace tetropolis
