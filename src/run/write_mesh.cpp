#include "write_mesh.h"

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

#include "result_files.h"

namespace tetropolis {

namespace {

bool is_wanted(const Config& config, std::string_view format) {
  return std::find(config.formats.begin(), config.formats.end(), format) != config.formats.end();
}

/// The volume in each format asked for.
void write_volume(const Config& config, const CityMesh& city_mesh,
                  std::span<const Building> buildings, OutputFolder& out,
                  const Progress& progress) {
  const ColumnMesh& mesh = city_mesh.volume;
  const SurfaceMesh& boundary = city_mesh.boundary;
  const CellZones& zones = city_mesh.zones;
  const Placement& placement = city_mesh.placement;
  using Write = std::function<void(const Progress&)>;
  // For formats that know a face by its patch alone.
  const SurfaceMesh by_building =
      config.building_patches ? divide_by_building(boundary, buildings) : SurfaceMesh{};
  const SurfaceMesh& patches = config.building_patches ? by_building : boundary;
  // And for those that have names of zones alone.
  const CellZones over_buildings =
      config.building_zones ? zone_buildings(mesh, zones, buildings) : CellZones{};
  const CellZones& named = config.building_zones ? over_buildings : zones;
  const std::array<std::pair<std::string_view, Write>, 9> writers{{
      {"vtu",
       [&](const Progress& p) {
         write_vtu(out.result("volume.vtu"), mesh, placement, p, config.compression, buildings,
                   zones);
       }},
      {"xdmf",
       [&](const Progress& p) {
         write_xdmf(out.result("volume.xdmf", {"volume.h5"}),
                    out.result("boundary.xdmf", {"boundary.h5"}), mesh, boundary, placement, p,
                    config.compression, zones);
       }},
      {"msh",
       [&](const Progress& p) {
         write_msh(out.result("volume.msh"), mesh, patches, placement, p, named);
       }},
      {"msh2",
       [&](const Progress& p) {
         write_msh2(out.result("volume_msh2.msh"), mesh, patches, placement, p, named);
       }},
      {"vtkhdf",
       [&](const Progress& p) {
         write_vtkhdf(out.result("volume.vtkhdf"), mesh, placement, p, zones);
       }},
      {"cgns",
       [&](const Progress& p) {
         write_cgns(out.result("volume.cgns"), mesh, patches, placement, p, named);
       }},
      {"fluent",
       [&](const Progress& p) {
         write_fluent(out.result("volume_fluent.msh"), mesh, patches, placement, p, named);
       }},
      {"su2",
       [&](const Progress& p) {
         write_su2(out.result("volume.su2"), mesh, patches, placement, p);
       }},
      {"openfoam",
       [&](const Progress& p) {
         std::vector<std::string> files = results::of_format("openfoam");
         if (named.empty()) std::erase(files, results::kCellZones);
         write_openfoam(out.result("constant/polyMesh", files), mesh, patches, placement, p, named);
       }},
  }};
  std::vector<const Write*> wanted;
  for (const auto& [format, write] : writers)
    if (is_wanted(config, format)) wanted.push_back(&write);
  const double share = 1.0 / static_cast<double>(std::max<std::size_t>(wanted.size(), 1));
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const double begin = static_cast<double>(i) * share;
    (*wanted[i])(portion(progress, begin, begin + share));
  }
}

/// Ground, roofs and walls, to look at, and in each format asked for.
void write_surface(const Config& config, const SurfaceMesh& boundary,
                   std::span<const Building> buildings, const Placement& placement,
                   OutputFolder& out) {
  const SurfaceMesh surface = city_surface(boundary);
  write_vtp(out.result("surface.vtp"), surface, placement, config.compression, buildings);
  write_stl(out.result("surface.stl"), surface, placement);
  if (is_wanted(config, "obj")) write_obj(out.result("surface.obj"), surface, placement);
  if (is_wanted(config, "ply")) write_ply(out.result("surface.ply"), surface, placement);
  if (is_wanted(config, "glb")) write_glb(out.result("surface.glb"), surface, placement, buildings);
}

}  // namespace

void write_mesh(const Config& config, const CityMesh& mesh, std::span<const Building> buildings,
                OutputFolder& out, const Progress& progress) {
  write_volume(config, mesh, buildings, out, progress);
  write_vtp(out.result("boundary.vtp"), mesh.boundary, mesh.placement, config.compression,
            buildings);
  write_surface(config, mesh.boundary, buildings, mesh.placement, out);
}

}  // namespace tetropolis
