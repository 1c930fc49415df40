#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/io/mesh/xdmf.h"

#include "column_output.h"
#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"
#include "io/file/hdf5_compressed.h"
#include "io/file/hdf5_output.h"
#include "xdmf_description.h"
#include "xdmf_layout.h"

namespace tetropolis {

namespace {

using namespace xdmf;

static_assert(std::endian::native == std::endian::little, "XDMF output writes native byte order");

constexpr std::size_t kPointNumbers = std::tuple_size_v<Point3>;

Elements elements_of(const CellCounts& cells) {
  return {static_cast<std::int64_t>(cells.tets), static_cast<std::int64_t>(cells.prisms)};
}

Elements elements_of(const SurfaceMesh& surface) {
  const std::int64_t quads = std::ssize(surface.quads);
  return {std::ssize(surface.triangles) - 2 * quads, quads};
}

/// Elements of one kind are rows, those of two a list.
Hdf5Dataset topology_of(const char* path, const Kind& small, const Kind& large,
                        const Elements& elements) {
  if (elements.mixed())
    return {path, Hdf5Type::kInt64, static_cast<std::uint64_t>(mixed_size(small, large, elements)),
            0};
  return {path, Hdf5Type::kInt64, static_cast<std::uint64_t>(elements.all()),
          static_cast<std::uint64_t>((elements.large > 0 ? large : small).corners)};
}

std::vector<Hdf5Dataset> datasets_of(const ColumnMesh& mesh, const Elements& elements,
                                     const CellZones& zones) {
  const auto nodes = static_cast<std::uint64_t>(mesh.node_count());
  const auto cells = static_cast<std::uint64_t>(elements.all());
  std::vector<Hdf5Dataset> datasets{{kGeometry, Hdf5Type::kFloat64, nodes, 3},
                                    topology_of(kTopology, kTetrahedron, kWedge, elements),
                                    {kRegion, Hdf5Type::kInt32, cells, 0}};
  if (!zones.empty()) datasets.push_back({kZone, Hdf5Type::kInt32, cells, 0});
  datasets.push_back({kOrigin, Hdf5Type::kFloat64, kPointNumbers, 0});
  return datasets;
}

std::array<Hdf5Dataset, 4> datasets_of(const Elements& elements) {
  const auto faces = static_cast<std::uint64_t>(elements.all());
  return {{topology_of(kFaces, kTriangle, kQuadrilateral, elements),
           {kPatch, Hdf5Type::kInt32, faces, 0},
           {kBuilding, Hdf5Type::kInt32, faces, 0},
           {kOrigin, Hdf5Type::kFloat64, kPointNumbers, 0}}};
}

template <typename Output>
void write_origin(Output& file, const Point3& origin) {
  file.write_next(origin.size(), [&](std::size_t begin, std::size_t end, std::string& buffer) {
    for (std::size_t i = begin; i < end; ++i) append_raw(buffer, origin[i]);
  });
}

template <typename Output>
void write_volume(Output& file, const ColumnMesh& mesh, const std::vector<CellIndex>& cells,
                  const CellZones& zones, const Placement& placement, const Progress& progress) {
  write_all_points(file, mesh, placement, portion(progress, 0, 0.2));
  const std::size_t rows = cells.size() - 1;
  const bool mixed = elements_of(count_cells(mesh, cells)).mixed();
  file.write_next(
      cell_rows(mesh, cells),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        if (!mixed && begin < rows)
          append_cells<std::int64_t>(mesh, cells, begin, std::min(end, rows), buffer);
        for (std::size_t row = mixed ? begin : std::max(begin, rows); row < end; ++row)
          for_each_cell_of(mesh, cells, row, [&](const auto& nodes) {
            if (mixed) append_raw(buffer, (nodes.size() == 4 ? kTetrahedron : kWedge).number);
            for (const NodeIndex node : nodes) append_raw(buffer, node.value());
          });
      },
      portion(progress, 0.2, 0.9));
  write_regions(file, mesh, cells, zones, portion(progress, 0.9, 1));
  write_origin(file, placement.origin);
}

template <typename Output>
void write_boundary(Output& file, const SurfaceMesh& surface, const Point3& origin) {
  const SurfaceFaces faces(surface);
  const bool mixed = elements_of(surface).mixed();
  const auto write_rows = [&](const auto& append) {
    file.write_next(faces.size(), [&](std::size_t begin, std::size_t end, std::string& buffer) {
      for (std::size_t f = begin; f < end; ++f) append(f, buffer);
    });
  };
  write_rows([&](std::size_t f, std::string& buffer) {
    const FaceCorners corners = faces.corners(f);
    if (mixed) append_raw(buffer, (corners.count == 3 ? kTriangle : kQuadrilateral).number);
    for (const std::int32_t p : corners)
      append_raw(buffer, surface.node[static_cast<std::size_t>(p)]);
  });
  write_rows([&](std::size_t f, std::string& buffer) {
    append_raw(buffer, static_cast<std::int32_t>(surface.patch[faces.triangle(f)]));
  });
  write_rows([&](std::size_t f, std::string& buffer) {
    append_raw(buffer, surface.building[faces.triangle(f)]);
  });
  write_origin(file, origin);
}

/// DOLFINx derives the name of the data file from that of the description in the same way.
std::filesystem::path data_path_of(const std::filesystem::path& path) {
  std::filesystem::path data = path;
  data.replace_extension(".h5");
  if (data == path)
    throw_cannot_write(path, "that name is for the data file; give one that ends in .xdmf");
  return data;
}

/// The descriptions appear after the data they refer to.
template <typename Output>
void write_all(const std::filesystem::path& volume_path, const std::filesystem::path& boundary_path,
               const ColumnMesh& mesh, const SurfaceMesh& surface, const CellZones& zones,
               const Placement& placement, const Progress& progress) {
  const std::vector<CellIndex> cells = cell_offsets(mesh);
  const std::filesystem::path volume_data = data_path_of(volume_path);
  const std::filesystem::path boundary_data = data_path_of(boundary_path);
  const Elements cell_elements = elements_of(count_cells(mesh, cells));
  const Elements face_elements = elements_of(surface);
  Output volume(volume_data, datasets_of(mesh, cell_elements, zones));
  write_volume(volume, mesh, cells, zones, placement, progress);
  Output boundary(boundary_data, datasets_of(face_elements));
  write_boundary(boundary, surface, placement.origin);

  PatchNames names;
  for (const PatchInfo& info : surface.patches)
    names[static_cast<std::int32_t>(info.patch)] = info.name;
  AtomicFile of_volume(volume_path), of_boundary(boundary_path);
  of_volume.write(volume_description(mesh.node_count(), cell_elements, !zones.empty(),
                                     placement.origin, volume_data.filename().string()));
  of_boundary.write(boundary_description(mesh.node_count(), face_elements, names, placement.origin,
                                         volume_data.filename().string(),
                                         boundary_data.filename().string()));
  volume.commit();
  boundary.commit();
  of_volume.commit();
  of_boundary.commit();
}

}  // namespace

void write_xdmf(const std::filesystem::path& volume, const std::filesystem::path& boundary,
                const ColumnMesh& mesh, const SurfaceMesh& surface, const Placement& placement,
                const Progress& progress, Compression compression, const CellZones& zones) {
  if (volume.parent_path() != boundary.parent_path() || volume.stem() == boundary.stem())
    throw_cannot_write(boundary, "it needs another name than the volume, in the same folder");
  require_boundary_of(mesh, surface);
  if (compression == Compression::kNone)
    write_all<Hdf5Output>(volume, boundary, mesh, surface, zones, placement, progress);
  else
    write_all<Hdf5CompressedOutput>(volume, boundary, mesh, surface, zones, placement, progress);
}

}  // namespace tetropolis
