#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/mesh/mesh_formats.h"
#include "tetropolis/run/in_memory.h"
#include "tetropolis/volume/column/explicit_mesh.h"

#include "arrays.h"
#include "bindings.h"
#include "call.h"
#include "city.h"
#include "render.h"
#include "settings.h"

namespace tetropolis::python {

namespace {

/// A mesh and its rows of cells.
struct Mesh {
  MeshInMemory made;
  std::vector<CellIndex> offsets;

  const CityMesh& mesh() const { return made.mesh; }
  const ColumnMesh& volume() const { return made.mesh.volume; }
};

Mesh build_mesh(const nb::dict& settings, City& city, const nb::object& progress) {
  city.settle();
  const Config config = config_of("build_mesh", settings);
  Mesh mesh;
  call(progress, kMesh, config, [&](const StepHooks& hooks) {
    mesh.made = make_mesh(config, city.built, hooks);
    mesh.offsets = cell_offsets(mesh.volume());
  });
  return mesh;
}

/// The rows whose cells come next after those of the first `begin`: as many as have at most
/// `size` cells together, but one at least.
std::size_t end_of_block(const Mesh& mesh, std::size_t begin, std::int64_t size) {
  const auto first = mesh.offsets.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto end = std::upper_bound(first, mesh.offsets.end(), *first + size) - 1;
  return std::max(begin + 1, static_cast<std::size_t>(end - mesh.offsets.begin()));
}

auto cells_over(const Mesh& mesh, std::size_t begin, std::size_t end) {
  const auto count = static_cast<std::size_t>(mesh.offsets[end] - mesh.offsets[begin]);
  using Cell = std::array<NodeIndex, 4>;
  return make_rows<std::int64_t, 4, Cell>(count, [&](Cell* cells) {
    fill_cells(mesh.volume(), mesh.offsets, begin, end, {cells, count});
  });
}

auto wedges_of(const Mesh& mesh) {
  const auto count = static_cast<std::size_t>(mesh.volume().layers.cells());
  using Cell = std::array<NodeIndex, 6>;
  return make_rows<std::int64_t, 6, Cell>(count, [&](Cell* wedges) {
    fill_wedges(mesh.volume(), {wedges, count});
  });
}

auto regions_over(const Mesh& mesh, std::size_t begin, std::size_t end) {
  const auto count = static_cast<std::size_t>(mesh.offsets[end] - mesh.offsets[begin]);
  return make_array<std::int32_t, BuildingIndex>(count, [&](BuildingIndex* regions) {
    fill_regions(mesh.volume(), mesh.offsets, begin, end, {regions, count});
  });
}

auto regions_of_wedges(const Mesh& mesh) {
  const auto count = static_cast<std::size_t>(mesh.volume().layers.cells());
  return make_array<std::int32_t, BuildingIndex>(count, [&](BuildingIndex* regions) {
    for (std::size_t i = 0; i < count; ++i)
      regions[i] = building_of_prism(mesh.volume(), static_cast<std::int64_t>(i));
  });
}

auto buildings_of_regions(const Mesh& mesh) {
  const std::vector<Region>& regions = mesh.volume().ground.regions;
  return make_array<std::int32_t, BuildingIndex>(regions.size(), [&](BuildingIndex* building) {
    for (const Region& region : regions) *building++ = region.building;
  });
}

auto points_of(const Mesh& mesh) {
  const auto count = static_cast<std::size_t>(mesh.volume().node_count());
  using Point = std::array<double, 3>;
  return make_rows<double, 3, Point>(count, [&](Point* points) {
    fill_points(mesh.volume(), {0, 0, 0}, {points, count});
  });
}

/// The format by the end of the name; "openfoam" for a folder polyMesh, "fluent" for
/// "city_fluent.msh", as runs name their files.
std::string format_of(const std::filesystem::path& path) {
  const std::filesystem::path name = (path.has_filename() ? path : path.parent_path()).filename();
  if (name == "polyMesh") return "openfoam";
  std::string format = name.extension().string();
  format.erase(0, 1);
  for (char& c : format) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const char* variant : {"fluent", "msh2"})
    if (format == "msh" && name.stem().string().ends_with(std::string("_") + variant))
      return variant;
  return format;
}

[[noreturn]] void throw_no_format(const std::filesystem::path& path, const char* names) {
  throw Error(ErrorKind::kUsage, path.string() + ": no format has this name; " + names);
}

MeshFileOptions file_options(const CityMesh& mesh, const Config& config) {
  MeshFileOptions options{mesh.placement, config.compression, config.building_patches,
                          config.building_zones};
  if (config.coordinates == tetropolis::Coordinates::kAbsolute)
    options.placement = {mesh.placement.origin, {0, 0, 0}};
  return options;
}

void save(const Mesh& mesh, const std::filesystem::path& path, const nb::dict& settings,
          const nb::object& progress) {
  const Config config = config_of("save", settings);
  call(progress, "write mesh", [&](const StepHooks& hooks) {
    const MeshFileOptions options = file_options(mesh.mesh(), config);
    const std::vector<Building>& buildings = mesh.made.city.buildings;
    const SurfaceMesh& boundary = mesh.mesh().boundary;
    const std::string format = format_of(path);
    const VolumeFiles volume(mesh.volume(), boundary, mesh.mesh().zones, buildings, options);
    if (!volume.write(format, path, {hooks.step_progress, hooks.cancelled}) &&
        !write_surface(format, path, format == "vtp" ? boundary : city_surface(boundary), buildings,
                       options))
      throw_no_format(
          path,
          "end it in .vtu, .vtkhdf, .xdmf, .msh, _msh2.msh, _fluent.msh, .cgns, .su2 (the "
          "volume), .vtp (its boundary), .stl, .obj, .ply, .glb (ground, roofs and "
          "walls), or name a folder constant/polyMesh");
  });
}

/// `surface`: one of the mesh.
void save_surface_of(const Mesh& mesh, const SurfaceMesh& surface,
                     const std::filesystem::path& path, const nb::dict& settings) {
  const Config config = config_of("save", settings);
  const nb::gil_scoped_release release;
  if (!write_surface(format_of(path), path, surface, mesh.made.city.buildings,
                     file_options(mesh.mesh(), config)))
    throw_no_format(path, "end it in .vtp, .stl, .obj, .ply or .glb");
}

TetMesh cells_of(const Mesh& mesh) {
  const std::size_t rows = mesh.offsets.size() - 1;
  std::vector<std::array<NodeIndex, 4>> cells(mesh.offsets.back());
  fill_cells(mesh.volume(), mesh.offsets, 0, rows, cells);
  std::vector<BuildingIndex> regions(cells.size());
  fill_regions(mesh.volume(), mesh.offsets, 0, rows, regions);
  TetMesh tets;
  tets.points.resize(static_cast<std::size_t>(mesh.volume().node_count()));
  fill_points(mesh.volume(), {0, 0, 0}, tets.points);
  for (const auto& c : cells)
    tets.cells.push_back({c[0].value(), c[1].value(), c[2].value(), c[3].value()});
  for (const BuildingIndex region : regions) tets.region.push_back(region.value());
  std::vector<std::array<NodeIndex, 6>> wedges(
      static_cast<std::size_t>(mesh.volume().layers.cells()));
  fill_wedges(mesh.volume(), wedges);
  for (const auto& w : wedges) {
    const auto prism = static_cast<std::int64_t>(tets.wedges.size());
    tets.region.push_back(building_of_prism(mesh.volume(), prism).value());
    tets.wedges.push_back(
        {w[0].value(), w[1].value(), w[2].value(), w[3].value(), w[4].value(), w[5].value()});
  }
  return tets;
}

void render(const Mesh& mesh, const std::filesystem::path& picture, const nb::dict& keywords) {
  const RenderOptions options = render_options(keywords);
  const nb::gil_scoped_release release;
  RenderInput input{city_surface(mesh.mesh().boundary), {}};
  if (options.view == View::kSection) input.volume = cells_of(mesh);
  write_png(picture, render_picture(input, options));
}

using Self = nb::pointer_and_handle<Mesh>;

void bind_surface(nb::module_& module) {
  using Surface = nb::pointer_and_handle<SurfaceMesh>;
  nb::class_<SurfaceMesh>(module, "Surface", "Tagged triangles.")
      .def_prop_ro(
          "points", [](Surface self) { return view_rows<double, 3>(self.p->points, self.h); },
          kArray)
      .def_prop_ro(
          "triangles",
          [](Surface self) { return view_rows<std::int32_t, 3>(self.p->triangles, self.h); },
          kArray)
      .def_prop_ro(
          "quads", [](Surface self) { return view<std::int32_t>(self.p->quads, self.h); }, kArray)
      .def_prop_ro(
          "patch", [](Surface self) { return view<std::int32_t>(self.p->patch, self.h); }, kArray)
      .def_prop_ro(
          "building", [](Surface self) { return view<std::int32_t>(self.p->building, self.h); },
          kArray)
      .def_prop_ro(
          "node", [](Surface self) { return view<std::int64_t>(self.p->node, self.h); }, kArray)
      .def_prop_ro(
          "cell", [](Surface self) { return view<std::int64_t>(self.p->cell, self.h); }, kArray)
      .def_prop_ro("patches",
                   [](const SurfaceMesh& self) {
                     std::map<int, std::string> names;
                     for (const PatchInfo& info : self.patches)
                       names[static_cast<int>(info.patch)] = info.name;
                     return names;
                   })
      .def("city_surface", city_surface);
}

}  // namespace

void bind_mesh(nb::module_& module) {
  bind_surface(module);
  nb::class_<Mesh>(module, "Mesh", "A volume mesh as columns, and its boundary.")
      .def_prop_ro("n_points", [](const Mesh& self) { return self.volume().node_count(); })
      .def_prop_ro("n_cells",
                   [](const Mesh& self) {
                     return self.offsets.back().value() + self.volume().layers.cells();
                   })
      .def_prop_ro("n_rows", [](const Mesh& self) { return self.offsets.size() - 1; })
      .def("points", points_of)
      .def("cells", cells_over, nb::arg("begin"), nb::arg("end"))
      .def("wedges", wedges_of)
      .def("regions", regions_over, nb::arg("begin"), nb::arg("end"))
      .def("regions_of_wedges", regions_of_wedges)
      .def("end_of_block", end_of_block, nb::arg("begin"), nb::arg("size"))
      .def_prop_ro(
          "zone",
          [](Self self) { return view<std::int32_t>(self.p->mesh().zones.of_cell, self.h); },
          kArray)
      .def_prop_ro("zones",
                   [](const Mesh& self) {
                     std::vector<std::string> names;
                     for (const CellZone& zone : self.mesh().zones.zones)
                       names.push_back(zone.name);
                     return names;
                   })
      .def_prop_ro("boundary", [](Mesh& self) -> SurfaceMesh& { return self.made.mesh.boundary; })
      .def_prop_ro(
          "ground_vertices",
          [](Self self) { return view_rows<double, 2>(self.p->volume().ground.vertices, self.h); },
          kArray)
      .def_prop_ro(
          "ground_triangles",
          [](Self self) {
            return view_rows<std::int32_t, 3>(self.p->volume().ground.triangles, self.h);
          },
          kArray)
      .def_prop_ro(
          "ground_region",
          [](Self self) { return view<std::int32_t>(self.p->volume().ground.region, self.h); },
          kArray)
      .def_prop_ro("region_building", buildings_of_regions, kArray)
      .def_prop_ro(
          "column_first",
          [](Self self) { return view<std::int64_t>(self.p->volume().first, self.h); }, kArray)
      .def_prop_ro(
          "column_z", [](Self self) { return view<double>(self.p->volume().z, self.h); }, kArray)
      .def_prop_ro("origin",
                   [](const Mesh& self) {
                     const Point3& origin = self.mesh().placement.origin;
                     return std::tuple(origin[0], origin[1], origin[2]);
                   })
      .def_prop_ro("report", [](const Mesh& self) { return to_json(self.made.report); })
      .def(
          "page",
          [](const Mesh& self, const City& city) {
            const nb::gil_scoped_release release;
            return make_page(city, self.made);
          },
          nb::arg("city"))
      .def("render", render, nb::arg("picture"), nb::arg("options"))
      .def("save_surface", save_surface_of, nb::arg("surface"), nb::arg("path"),
           nb::arg("settings"))
      .def("save", save, nb::arg("path"), nb::arg("settings"), nb::arg("progress").none());
  module.def("build_mesh", build_mesh, nb::arg("settings"), nb::arg("city"),
             nb::arg("progress").none());
}

}  // namespace tetropolis::python
