#include "tetropolis/io/mesh/mesh_formats.h"

#include <string>

#include "tetropolis/io/mesh/cgns.h"
#include "tetropolis/io/mesh/fluent.h"
#include "tetropolis/io/mesh/gltf.h"
#include "tetropolis/io/mesh/msh.h"
#include "tetropolis/io/mesh/obj.h"
#include "tetropolis/io/mesh/openfoam.h"
#include "tetropolis/io/mesh/ply.h"
#include "tetropolis/io/mesh/stl.h"
#include "tetropolis/io/mesh/su2.h"
#include "tetropolis/io/mesh/vtk.h"
#include "tetropolis/io/mesh/vtkhdf.h"
#include "tetropolis/io/mesh/xdmf.h"
#include "tetropolis/volume/building_zones.h"
#include "tetropolis/volume/column/building_patches.h"

namespace tetropolis {

VolumeFiles::VolumeFiles(const ColumnMesh& mesh, const SurfaceMesh& boundary,
                         const CellZones& zones, std::span<const Building> buildings,
                         const MeshFileOptions& options)
    : mesh_(mesh), boundary_(boundary), zones_(zones), buildings_(buildings), options_(options) {
  if (options.building_patches) by_building_ = divide_by_building(boundary, buildings);
  if (options.building_zones) over_buildings_ = zone_buildings(mesh, zones, buildings);
}

bool VolumeFiles::write(std::string_view format, const std::filesystem::path& path,
                        const Progress& progress) const {
  const SurfaceMesh& patches = options_.building_patches ? by_building_ : boundary_;
  const CellZones& named = named_zones();
  const Placement& placement = options_.placement;
  if (format == "vtu")
    write_vtu(path, mesh_, placement, progress, options_.compression, buildings_, zones_);
  else if (format == "xdmf")
    write_xdmf(path, boundary_beside(path), mesh_, boundary_, placement, progress,
               options_.compression, zones_);
  else if (format == "msh")
    write_msh(path, mesh_, patches, placement, progress, named);
  else if (format == "msh2")
    write_msh2(path, mesh_, patches, placement, progress, named);
  else if (format == "vtkhdf")
    write_vtkhdf(path, mesh_, placement, progress, zones_);
  else if (format == "cgns")
    write_cgns(path, mesh_, patches, placement, progress, named);
  else if (format == "fluent")
    write_fluent(path, mesh_, patches, placement, progress, named);
  else if (format == "su2")
    write_su2(path, mesh_, patches, placement, progress);
  else if (format == "openfoam")
    write_openfoam(path, mesh_, patches, placement, progress, named, buildings_);
  else
    return false;
  return true;
}

std::filesystem::path boundary_beside(const std::filesystem::path& volume) {
  std::string name = volume.stem().string();
  constexpr std::string_view kVolume = "volume";
  if (const std::size_t at = name.find(kVolume); at != std::string::npos)
    name.replace(at, kVolume.size(), "boundary");
  else
    name += "_boundary";
  return volume.parent_path() / (name + volume.extension().string());
}

bool write_surface(std::string_view format, const std::filesystem::path& path,
                   const SurfaceMesh& surface, std::span<const Building> buildings,
                   const MeshFileOptions& options) {
  if (format == "vtp")
    write_vtp(path, surface, options.placement, options.compression, buildings);
  else if (format == "stl")
    write_stl(path, surface, options.placement);
  else if (format == "obj")
    write_obj(path, surface, options.placement);
  else if (format == "ply")
    write_ply(path, surface, options.placement);
  else if (format == "glb")
    write_glb(path, surface, options.placement, buildings);
  else
    return false;
  return true;
}

}  // namespace tetropolis
