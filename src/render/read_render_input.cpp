#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/cityjson/city_surface.h"
#include "tetropolis/io/mesh/stl.h"
#include "tetropolis/io/mesh/vtk.h"
#include "tetropolis/io/mesh/xdmf.h"
#include "tetropolis/io/raster/geotiff.h"
#include "tetropolis/render/render.h"

#include "core/files.h"
#include "core/text.h"
#include "scene.h"
#include "split_prisms.h"
#include "volume_surface.h"

namespace tetropolis {

namespace {

namespace fs = std::filesystem;

/// Corners at one place become one point.
SurfaceMesh of_stl(const StlMesh& stl) {
  SurfaceMesh surface;
  const auto corner = [&](std::size_t c) { return stl.triangles[c / 3][c % 3]; };
  std::vector<std::size_t> corners(stl.triangles.size() * 3);
  std::iota(corners.begin(), corners.end(), std::size_t{0});
  std::sort(corners.begin(), corners.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(corner(a), a) < std::pair(corner(b), b);
  });
  surface.triangles.resize(stl.triangles.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto p = corner(corners[i]);
    if (i == 0 || p != corner(corners[i - 1]))
      surface.points.push_back({double{p[0]}, double{p[1]}, double{p[2]}});
    surface.triangles[corners[i] / 3][corners[i] % 3] =
        static_cast<std::int32_t>(surface.points.size()) - 1;
  }
  surface.building.assign(stl.triangles.size(), kNoBuilding);
  for (const std::uint16_t attribute : stl.attribute) {
    const auto patch = static_cast<Patch>(attribute);
    if (!surface.patches.contains(patch))
      // In a file of ours that has no city surface but ground in pieces.
      surface.patches.add({patch, fmt::format("patch{}", attribute),
                           stl.origin ? PatchKind::kGround : PatchKind::kOther});
    surface.patch.push_back(patch);
  }
  return surface;
}

/// Every `every`-th node of the terrain, as ground.
void add_terrain(const fs::path& path, Point2 origin, SurfaceMesh& surface) {
  constexpr double kMostNodes = 600'000;
  const Raster raster = read_raster(path, origin).raster;
  const double nodes = static_cast<double>(raster.nx) * raster.ny;
  int every = 1;
  while (nodes / (every * every) > kMostNodes) ++every;
  const std::int32_t nx = (raster.nx - 1) / every + 1, ny = (raster.ny - 1) / every + 1;
  const auto first = static_cast<std::int32_t>(surface.points.size());
  for (std::int32_t j = 0; j < ny; ++j)
    for (std::int32_t i = 0; i < nx; ++i)
      surface.points.push_back({raster.x0 + i * every * raster.step,
                                raster.y0 + j * every * raster.step,
                                raster.at(i * every, j * every)});
  const auto add = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
    surface.triangles.push_back({a, b, c});
    surface.patch.push_back(Patch::kGround);
    surface.building.push_back(kNoBuilding);
  };
  for (std::int32_t j = 0; j + 1 < ny; ++j)
    for (std::int32_t i = 0; i + 1 < nx; ++i) {
      const std::int32_t a = first + j * nx + i;
      add(a, a + 1, a + nx + 1);
      add(a, a + nx + 1, a + nx);
    }
}

RenderInput of_city(const fs::path& path) {
  CitySurface city = read_city_surface(path);
  const fs::path terrain = path.parent_path() / "dtm.tif";
  if (is_file(terrain)) add_terrain(terrain, city.origin, city.surface);
  return {std::move(city.surface), {}};
}

RenderInput of_volume(TetMesh mesh) {
  RenderInput input{surface_of(split_prisms(mesh)), {}};
  input.volume = std::move(mesh);
  return input;
}

RenderInput of_xdmf(const fs::path& path) {
  auto mesh = read_xdmf(path);
  if (auto* volume = std::get_if<TetMesh>(&mesh)) return of_volume(std::move(*volume));
  return {std::move(std::get<SurfaceMesh>(mesh)), {}};
}

RenderInput read_one(const fs::path& path) {
  const std::string name = lower_case(path.string());
  if (name.ends_with(".vtp")) return {read_vtp(path), {}};
  if (name.ends_with(".vtu")) return of_volume(read_vtu(path));
  if (name.ends_with(".xdmf")) return of_xdmf(path);
  if (name.ends_with(".stl")) return {of_stl(read_stl(path)), {}};
  if (name.ends_with("json")) return of_city(path);
  throw Error(ErrorKind::kInput,
              path.string() +
                  ": no format that is drawn has this name; give a folder of results, "
                  "or a .vtp, .vtu, .xdmf, .stl or .city.json file");
}

/// The first of these that the folder has; empty if it has none.
template <std::size_t N>
fs::path first_of(const fs::path& folder, const std::array<const char*, N>& names) {
  for (const char* name : names)
    if (is_file(folder / name)) return folder / name;
  return {};
}

RenderInput read_folder(const fs::path& folder, View view) {
  const fs::path volume = first_of(folder, std::array{"volume.vtu", "volume.xdmf"});
  const fs::path surface =
      first_of(folder, std::array{"surface.vtp", "boundary.vtp", "boundary.xdmf", "surface.stl"});
  if (surface.empty() && !volume.empty()) return read_one(volume);
  if (!surface.empty()) {
    RenderInput input = read_one(surface);
    if (view == View::kSection && !volume.empty()) {
      if (volume.extension() == ".vtu")
        input.volume = read_vtu(volume);
      else
        input.volume = read_one(volume).volume;
    }
    return input;
  }
  const fs::path city = first_of(folder, std::array{"city.city.json", "city_raw.city.json"});
  if (city.empty())
    throw Error(ErrorKind::kInput, folder.string() +
                                       ": has no surface.vtp, volume.vtu or city.city.json; give "
                                       "a folder of results, or a file");
  return of_city(city);
}

}  // namespace

RenderInput read_render_input(const fs::path& path, View view) {
  std::error_code error;
  if (!fs::exists(path, error))
    throw Error(ErrorKind::kInput, path.string() + ": no such file or folder");
  RenderInput input = fs::is_directory(path, error) ? read_folder(path, view) : read_one(path);
  if (const std::string why = why_not_drawn(input.surface); !why.empty())
    throw Error(ErrorKind::kInput, fmt::format("{}: {}", path.string(), why));
  if (view == View::kSection && !input.volume)
    throw Error(ErrorKind::kInput,
                path.string() +
                    ": has no volume for a section; give volume.vtu or volume.xdmf, or "
                    "the folder of a run that wrote one");
  return input;
}

}  // namespace tetropolis
