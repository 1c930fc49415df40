#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/io/mesh/msh.h"

#include "column_output.h"
#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"
#include "msh_common.h"

namespace tetropolis {

namespace {

/// An element with two tags, physical group and entity, which are the same; its nodes follow.
void append_element(std::string& buffer, std::size_t number, int type, int group) {
  fmt::format_to(std::back_inserter(buffer), "{} {} 2 {} {}", number, type, group, group);
}

void append_node(std::string& buffer, NodeIndex node) {
  fmt::format_to(std::back_inserter(buffer), " {}", node.value() + 1);
}

void write_msh2_nodes(AtomicFile& file, const ColumnMesh& mesh, const Placement& placement,
                      const Progress& progress) {
  file.write(fmt::format("$Nodes\n{}\n", mesh.node_count()));
  constexpr std::uint64_t kBytes = 50;  // of a row, about
  const auto bytes = static_cast<std::uint64_t>(mesh.node_count()) * kBytes;
  write_chunked(
      file, point_rows(mesh), grain_for(point_rows(mesh), bytes),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        for_each_point(mesh, placement, begin, end, [&](NodeIndex n, double x, double y, double z) {
          fmt::format_to(std::back_inserter(buffer), "{} {} {} {}\n", n.value() + 1, x, y, z);
        });
      },
      progress);
  file.write("$EndNodes\n");
}

void write_msh2_faces(AtomicFile& file, const std::vector<PatchFaces>& patches,
                      const SurfaceMesh& surface) {
  for (const PatchFaces& range : patches)
    write_chunked(file, range.faces(), kRowsPerChunk,
                  [&](std::size_t begin, std::size_t end, std::string& buffer) {
                    std::size_t element = range.first + begin;
                    for_each_face_of(surface, range, begin, end, [&](const auto& nodes) {
                      append_element(buffer, ++element, nodes.size() == 3 ? kMshTriangle : kMshQuad,
                                     static_cast<int>(range.patch));
                      for (const NodeIndex node : nodes) append_node(buffer, node);
                      buffer += '\n';
                    });
                  });
}

void write_cells(AtomicFile& file, const ColumnMesh& mesh, const std::vector<CellIndex>& cells,
                 const CellZones& zones, std::size_t faces, const Progress& progress) {
  constexpr std::uint64_t kBytes = 45;
  const std::size_t rows = cell_rows(mesh, cells);
  write_chunked(
      file, rows, grain_for(rows, first_cell_of(cells, rows) * kBytes),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        std::size_t element = faces + first_cell_of(cells, begin);
        for (std::size_t row = begin; row < end; ++row)
          for_each_cell_of(mesh, cells, row, [&](const auto& nodes) {
            const std::int32_t zone = zones.empty() ? 0 : zones.of_cell[element - faces];
            append_element(buffer, ++element, nodes.size() == 4 ? kMshTet : kMshPrism,
                           volume_group(zone));
            for (const NodeIndex node : nodes) append_node(buffer, node);
            buffer += '\n';
          });
      },
      progress);
}

}  // namespace

void write_msh2(const std::filesystem::path& path, const ColumnMesh& mesh,
                const SurfaceMesh& surface, const Placement& placement, const Progress& progress,
                const CellZones& zones) {
  require_boundary_of(mesh, surface);
  const std::vector<CellIndex> cells = cell_offsets(mesh);
  const std::vector<PatchFaces> patches = faces_of_patches(surface);
  const std::size_t faces = count_faces(surface);
  AtomicFile file(path);
  file.write(fmt::format(
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Comments\norigin {} {} {}\n$EndComments\n",
      placement.origin[0], placement.origin[1], placement.origin[2]));
  file.write(physical_names(patches, surface, zones));
  write_msh2_nodes(file, mesh, placement, portion(progress, 0, 0.2));
  file.write(fmt::format("$Elements\n{}\n", faces + count_cells(mesh, cells).all()));
  write_msh2_faces(file, patches, surface);
  write_cells(file, mesh, cells, zones, faces, portion(progress, 0.2, 1));
  file.write("$EndElements\n");
  file.commit();
}

}  // namespace tetropolis
