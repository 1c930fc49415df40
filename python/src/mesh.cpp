#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/mesh/gltf.h"
#include "tetropolis/io/mesh/msh.h"
#include "tetropolis/io/mesh/obj.h"
#include "tetropolis/io/mesh/openfoam.h"
#include "tetropolis/io/mesh/ply.h"
#include "tetropolis/io/mesh/stl.h"
#include "tetropolis/io/mesh/vtk.h"
#include "tetropolis/io/mesh/xdmf.h"
#include "tetropolis/run/in_memory.h"
#include "tetropolis/volume/column/explicit_mesh.h"

#include "arrays.h"
#include "bindings.h"
#include "call.h"
#include "settings.h"

namespace tetropolis::python {

namespace {

/// A mesh and where the cells over each triangle are.
struct Mesh {
  MeshInMemory made;
  std::vector<CellIndex> offsets;

  const CityMesh& mesh() const { return made.mesh; }
  const ColumnMesh& volume() const { return made.mesh.volume; }
};

Mesh build(const nb::dict& settings, const CityInMemory& city, const nb::object& progress) {
  const Config config = config_of("build_mesh", settings);
  Mesh mesh;
  call(progress, [&](const StepHooks& hooks) {
    mesh.made = make_mesh(config, city.built, hooks);
    mesh.offsets = cell_offsets(mesh.volume());
  });
  return mesh;
}

/// The triangles whose cells come next after those over the first `begin`: as many as have at most
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

auto regions_over(const Mesh& mesh, std::size_t begin, std::size_t end) {
  const auto count = static_cast<std::size_t>(mesh.offsets[end] - mesh.offsets[begin]);
  return make_array<std::int32_t, BuildingIndex>(count, [&](BuildingIndex* regions) {
    fill_regions(mesh.volume(), mesh.offsets, begin, end, {regions, count});
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

/// What is written to a file of one format.
using Write = std::function<void(const CityMesh& mesh, const std::filesystem::path& path,
                                 const Placement& placement, Compression compression,
                                 const Progress& progress)>;

/// Of the surface alone: ground, roofs and walls.
Write write_surface(void (*write)(const std::filesystem::path&, const SurfaceMesh&,
                                  const Placement&)) {
  return [write](const CityMesh& mesh, const std::filesystem::path& path,
                 const Placement& placement, Compression, const Progress&) {
    write(path, select_patches(mesh.boundary, mesh.boundary.patches.solid()), placement);
  };
}

const std::map<std::string, Write>& writers() {
  static const std::map<std::string, Write> all{
      {"vtu",
       [](const CityMesh& mesh, const std::filesystem::path& path, const Placement& placement,
          Compression compression, const Progress& progress) {
         write_vtu(path, mesh.volume, placement, progress, compression);
       }},
      {"vtp", [](const CityMesh& mesh, const std::filesystem::path& path,
                 const Placement& placement, Compression compression,
                 const Progress&) { write_vtp(path, mesh.boundary, placement, compression); }},
      {"xdmf",
       [](const CityMesh& mesh, const std::filesystem::path& path, const Placement& placement,
          Compression compression, const Progress& progress) {
         write_xdmf(path, mesh.volume, mesh.boundary, placement, progress, compression);
       }},
      {"msh",
       [](const CityMesh& mesh, const std::filesystem::path& path, const Placement& placement,
          Compression, const Progress& progress) {
         write_msh(path, mesh.volume, mesh.boundary, placement, progress);
       }},
      {"openfoam",
       [](const CityMesh& mesh, const std::filesystem::path& path, const Placement& placement,
          Compression, const Progress& progress) {
         write_openfoam(path, mesh.volume, mesh.boundary, placement, progress);
       }},
      {"stl", write_surface(write_stl)},
      {"obj", write_surface(write_obj)},
      {"ply", write_surface(write_ply)},
      {"glb", write_surface(write_glb)},
  };
  return all;
}

/// "polyMesh" is OpenFOAM's folder; else the extension tells.
std::string format_of(const std::filesystem::path& path) {
  const std::filesystem::path name = path.has_filename() ? path : path.parent_path();
  if (name.filename() == "polyMesh") return "openfoam";
  std::string extension = name.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension.empty() ? "" : extension.substr(1);
}

void save(const Mesh& mesh, const std::filesystem::path& path, const nb::dict& settings,
          const nb::object& progress) {
  const Config config = config_of("save", settings);
  const auto writer = writers().find(format_of(path));
  if (writer == writers().end())
    throw Error(
        ErrorKind::kUsage,
        path.string() +
            ": no format has this name; end it in .vtu, .xdmf, .msh (the volume), .vtp (its "
            "boundary), .stl, .obj, .ply, .glb (ground, roofs and walls), or name a folder "
            "constant/polyMesh");
  Placement placement = mesh.mesh().placement;
  if (config.coordinates == tetropolis::Coordinates::kAbsolute)
    placement = {placement.origin, {0, 0, 0}};
  call(progress, [&](const StepHooks& hooks) {
    if (hooks.step_begins) hooks.step_begins({"3.6", "write meshes"});
    writer->second(mesh.mesh(), path, placement, config.compression,
                   {hooks.step_progress, hooks.cancelled});
  });
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
      .def("solid",
           [](const SurfaceMesh& self) { return select_patches(self, self.patches.solid()); });
}

}  // namespace

void bind_mesh(nb::module_& module) {
  bind_surface(module);
  nb::class_<Mesh>(module, "Mesh", "A volume mesh as columns, and its boundary.")
      .def_prop_ro("n_points", [](const Mesh& self) { return self.volume().node_count(); })
      .def_prop_ro("n_cells", [](const Mesh& self) { return self.offsets.back(); })
      .def_prop_ro("n_triangles", [](const Mesh& self) { return self.volume().triangle_count(); })
      .def("points", points_of)
      .def("cells", cells_over, nb::arg("begin"), nb::arg("end"))
      .def("regions", regions_over, nb::arg("begin"), nb::arg("end"))
      .def("end_of_block", end_of_block, nb::arg("begin"), nb::arg("size"))
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
      .def("save", save, nb::arg("path"), nb::arg("settings"), nb::arg("progress").none());
  module.def("build_mesh", build, nb::arg("settings"), nb::arg("city"), nb::arg("progress").none());
}

}  // namespace tetropolis::python
