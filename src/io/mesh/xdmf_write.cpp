#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
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

std::array<Hdf5Dataset, 6> datasets_of(const ColumnMesh& mesh, NodeIndex cell_count,
                                       const SurfaceMesh& surface) {
  const auto nodes = static_cast<std::uint64_t>(mesh.node_count());
  const auto cells = static_cast<std::uint64_t>(cell_count);
  const std::uint64_t faces = surface.triangles.size();
  return {{{kGeometry, Hdf5Type::kFloat64, nodes, 3},
           {kTopology, Hdf5Type::kInt64, cells, 4},
           {kRegion, Hdf5Type::kInt32, cells, 0},
           {kFaces, Hdf5Type::kInt64, faces, 3},
           {kPatch, Hdf5Type::kInt32, faces, 0},
           {kBuilding, Hdf5Type::kInt32, faces, 0}}};
}

/// The first three datasets.
template <typename Output>
void write_volume(Output& file, const ColumnMesh& mesh, const std::vector<NodeIndex>& cells,
                  const Placement& placement, const Progress& progress) {
  file.write_next(
      mesh.vertex_count(),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        append_points(mesh, placement, begin, end, buffer);
      },
      portion(progress, 0, 0.2));
  file.write_next(
      mesh.triangle_count(),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        append_cells<NodeIndex>(mesh, cells, begin, end, buffer);
      },
      portion(progress, 0.2, 0.9));
  file.write_next(
      mesh.triangle_count(),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        append_regions(mesh, cells, begin, end, buffer);
      },
      portion(progress, 0.9, 1));
}

/// The last three.
template <typename Output>
void write_boundary(Output& file, const SurfaceMesh& surface) {
  const auto write_rows = [&](const auto& append) {
    file.write_next(surface.triangles.size(),
                    [&](std::size_t begin, std::size_t end, std::string& buffer) {
                      for (std::size_t f = begin; f < end; ++f) append(f, buffer);
                    });
  };
  write_rows([&](std::size_t f, std::string& buffer) {
    for (const std::int32_t p : surface.triangles[f])
      append_raw(buffer, surface.node[static_cast<std::size_t>(p)]);
  });
  write_rows([&](std::size_t f, std::string& buffer) {
    append_raw(buffer, static_cast<std::int32_t>(surface.patch[f]));
  });
  write_rows([&](std::size_t f, std::string& buffer) { append_raw(buffer, surface.building[f]); });
}

/// The description appears after the data it refers to.
template <typename Output>
void write_both(const std::filesystem::path& path, const std::filesystem::path& data_path,
                const ColumnMesh& mesh, const SurfaceMesh& surface, const Placement& placement,
                const Progress& progress) {
  const std::vector<NodeIndex> cells = cell_offsets(mesh);
  Output data(data_path, datasets_of(mesh, cells.back(), surface));
  write_volume(data, mesh, cells, placement, progress);
  write_boundary(data, surface);
  AtomicFile file(path);
  file.write(description(
      {mesh.node_count(), cells.back(), static_cast<std::int64_t>(surface.triangles.size())},
      placement.origin, data_path.filename().string()));
  data.commit();
  file.commit();
}

}  // namespace

void write_xdmf(const std::filesystem::path& path, const ColumnMesh& mesh,
                const SurfaceMesh& surface, const Placement& placement, const Progress& progress,
                Compression compression) {
  // DOLFINx derives the name of the data file from that of the description in the same way.
  const std::filesystem::path data_path = std::filesystem::path(path).replace_extension(".h5");
  if (data_path == path)
    throw_cannot_write(path, "that name is for the data file; give one that ends in .xdmf");
  require_boundary_of(mesh, surface);
  if (compression == Compression::kNone)
    write_both<Hdf5Output>(path, data_path, mesh, surface, placement, progress);
  else
    write_both<Hdf5CompressedOutput>(path, data_path, mesh, surface, placement, progress);
}

}  // namespace tetropolis
