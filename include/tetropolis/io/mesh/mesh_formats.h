// The formats of meshes by the names that the setting `formats` has for them: what they share, and
// which parts of a mesh each takes.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/progress.h"
#include "tetropolis/io/file/compression.h"
#include "tetropolis/io/file/placement.h"
#include "tetropolis/volume/cell_zones.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// What files say beside a mesh.
struct MeshFileOptions {
  Placement placement;
  Compression compression = Compression::kNone;  ///< Of "vtu", "xdmf" and "vtp".
  bool building_patches = false;  ///< Roof and walls of each building are patches of their own, in
                                  ///< formats that know a face by its patch alone.
  bool building_zones = false;    ///< Cells over each building are a zone, in formats that know
                                  ///< zones by their names alone.
};

/// Writes a volume mesh in several formats. What the constructor takes has to outlive it.
class VolumeFiles {
 public:
  /// `boundary`: extract_boundary of `mesh`, with patches of one's own after sort_by_patch;
  /// `buildings`: of its city model.
  VolumeFiles(const ColumnMesh& mesh, const SurfaceMesh& boundary, const CellZones& zones,
              std::span<const Building> buildings, const MeshFileOptions& options);

  /// "vtu", "xdmf", "msh", "msh2", "vtkhdf", "cgns", "fluent", "su2" or "openfoam", whose path is
  /// the folder polyMesh. "xdmf" writes the boundary, too (boundary_beside). Returns whether
  /// `format` is one of these; nothing is written for another one. Errors: those of the writers, of
  /// all that write patches kUsage where faces are not in the order of sort_by_patch.
  [[nodiscard]] bool write(std::string_view format, const std::filesystem::path& path,
                           const Progress& progress = {}) const;

  /// Of formats that know zones by their names alone.
  const CellZones& named_zones() const {
    return options_.building_zones ? over_buildings_ : zones_;
  }

 private:
  const ColumnMesh& mesh_;
  const SurfaceMesh& boundary_;
  const CellZones& zones_;
  std::span<const Building> buildings_;
  MeshFileOptions options_;
  SurfaceMesh by_building_;
  CellZones over_buildings_;
};

/// "boundary.xdmf" of "volume.xdmf", "NAME_boundary.xdmf" of "NAME.xdmf", in the same folder.
std::filesystem::path boundary_beside(const std::filesystem::path& volume);

/// "vtp", "stl", "obj", "ply" or "glb". `buildings`: of its city model. Returns whether `format` is
/// one of these; nothing is written for another one. Errors: those of the writers.
bool write_surface(std::string_view format, const std::filesystem::path& path,
                   const SurfaceMesh& surface, std::span<const Building> buildings,
                   const MeshFileOptions& options);

}  // namespace tetropolis
