#include <array>
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

namespace tetropolis {

namespace {

// Rows formatted at a time by a thread: some hundred kilobytes of output.
constexpr std::size_t kRows = 16384;
constexpr int kTriangle = 2, kTet = 4;

/// An element with two tags, physical group and entity, which are the same; its nodes follow.
void append_element(std::string& buffer, std::size_t number, int type, int group) {
  fmt::format_to(std::back_inserter(buffer), "{} {} 2 {} {}", number, type, group, group);
}

void append_node(std::string& buffer, NodeIndex node) {
  fmt::format_to(std::back_inserter(buffer), " {}", node.value() + 1);
}

std::string head(const std::vector<PatchFaces>& patches, const SurfaceMesh& surface,
                 const Placement& placement) {
  std::string text = fmt::format(
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Comments\norigin {} {} {}\n$EndComments\n",
      placement.origin[0], placement.origin[1], placement.origin[2]);
  text += fmt::format("$PhysicalNames\n{}\n", patches.size() + 1);
  for (const PatchFaces& range : patches)
    text += fmt::format("2 {} \"{}\"\n", static_cast<int>(range.patch),
                        surface.patches.of(range.patch).name);
  return text + fmt::format("3 {} \"air\"\n$EndPhysicalNames\n", kAirPhysicalGroup);
}

void write_nodes(AtomicFile& file, const ColumnMesh& mesh, const Placement& placement,
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

void write_triangles(AtomicFile& file, const SurfaceMesh& surface) {
  write_chunked(file, surface.triangles.size(), kRows,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  for (std::size_t f = begin; f < end; ++f) {
                    append_element(buffer, f + 1, kTriangle, static_cast<int>(surface.patch[f]));
                    for (const std::int32_t p : surface.triangles[f])
                      append_node(buffer, surface.node[static_cast<std::size_t>(p)]);
                    buffer += '\n';
                  }
                });
}

void write_tets(AtomicFile& file, const ColumnMesh& mesh, const std::vector<CellIndex>& cells,
                std::size_t triangles, const Progress& progress) {
  constexpr std::uint64_t kBytes = 45;
  const std::uint64_t bytes = static_cast<std::uint64_t>(cells.back().value()) * kBytes;
  write_chunked(
      file, cells.size() - 1, grain_for(cells.size() - 1, bytes),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        for (std::size_t row = begin; row < end; ++row) {
          std::size_t element = triangles + static_cast<std::size_t>(cells[row].value());
          for_each_tet_of(mesh, row, [&](const std::array<NodeIndex, 4>& tet) {
            append_element(buffer, ++element, kTet, kAirPhysicalGroup);
            for (const NodeIndex node : tet) append_node(buffer, node);
            buffer += '\n';
          });
        }
      },
      progress);
}

}  // namespace

void write_msh2(const std::filesystem::path& path, const ColumnMesh& mesh,
                const SurfaceMesh& surface, const Placement& placement, const Progress& progress) {
  refuse_prisms(path, mesh);
  require_boundary_of(mesh, surface);
  const std::vector<CellIndex> cells = cell_offsets(mesh);
  const std::size_t triangles = surface.triangles.size();
  AtomicFile file(path);
  file.write(head(faces_of_patches(surface), surface, placement));
  write_nodes(file, mesh, placement, portion(progress, 0, 0.2));
  file.write(
      fmt::format("$Elements\n{}\n", triangles + static_cast<std::size_t>(cells.back().value())));
  write_triangles(file, surface);
  write_tets(file, mesh, cells, triangles, portion(progress, 0.2, 1));
  file.write("$EndElements\n");
  file.commit();
}

}  // namespace tetropolis
