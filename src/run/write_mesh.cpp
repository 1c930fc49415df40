#include "write_mesh.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tetropolis/io/mesh/mesh_formats.h"

#include "core/is_among.h"
#include "result_files.h"

namespace tetropolis {

namespace {

/// In the order they are written in; openfoam is a folder.
constexpr std::array<std::string_view, 9> kVolumes = {"vtu",  "xdmf",   "msh", "msh2",    "vtkhdf",
                                                      "cgns", "fluent", "su2", "openfoam"};
constexpr std::array<std::string_view, 3> kSurfaces = {"obj", "ply", "glb"};

std::vector<std::string_view> wanted_of(const Config& config,
                                        std::span<const std::string_view> formats) {
  std::vector<std::string_view> wanted;
  for (const std::string_view format : formats)
    if (is_among(format, config.formats)) wanted.push_back(format);
  return wanted;
}

/// Where the files of a format go: the first of them, or their folder.
std::filesystem::path result_of(std::string_view format, const VolumeFiles& files,
                                OutputFolder& out) {
  std::vector<std::string> names = results::of_format(format);
  if (format == "openfoam") {
    if (files.named_zones().empty()) std::erase(names, results::kCellZones);
    return out.result("constant/polyMesh", names);
  }
  return out.result(names.front(), {names.begin() + 1, names.end()});
}

}  // namespace

void write_mesh(const Config& config, const CityMesh& mesh, std::span<const Building> buildings,
                OutputFolder& out, const Progress& progress) {
  const MeshFileOptions options{mesh.placement, config.compression, config.building_patches,
                                config.building_zones};
  const VolumeFiles volume(mesh.volume, mesh.boundary, mesh.zones, buildings, options);
  const std::vector<std::string_view> wanted = wanted_of(config, kVolumes);
  const double share = 1.0 / static_cast<double>(std::max<std::size_t>(wanted.size(), 1));
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const double begin = static_cast<double>(i) * share;
    // One of kVolumes, which it knows.
    static_cast<void>(volume.write(wanted[i], result_of(wanted[i], volume, out),
                                   portion(progress, begin, begin + share)));
  }
  write_surface("vtp", out.result("boundary.vtp"), mesh.boundary, buildings, options);
  const SurfaceMesh surface = city_surface(mesh.boundary);
  for (const std::string_view format : {"vtp", "stl"})
    write_surface(format, out.result("surface." + std::string(format)), surface, buildings,
                  options);
  for (const std::string_view format : wanted_of(config, kSurfaces))
    write_surface(format, out.result("surface." + std::string(format)), surface, buildings,
                  options);
}

}  // namespace tetropolis
