#include "tetropolis/io/mesh/su2.h"

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "column_output.h"
#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"
#include "vtk_cells.h"

namespace tetropolis {

namespace {

void write_cells(AtomicFile& file, const ColumnMesh& mesh, const Progress& progress) {
  const std::vector<CellIndex> cells = cell_offsets(mesh);
  const std::uint64_t count = count_cells(mesh, cells).all();
  file.write(fmt::format("NDIME= 3\nNELEM= {}\n", count));
  constexpr std::uint64_t kBytes = 40;  // of a row, about
  const std::size_t rows = cell_rows(mesh, cells);
  write_chunked(
      file, rows, grain_for(rows, count * kBytes),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        std::size_t number = first_cell_of(cells, begin);
        for (std::size_t row = begin; row < end; ++row)
          for_each_cell_of(mesh, cells, row, [&](const auto& nodes) {
            buffer += std::to_string(nodes.size() == 4 ? kVtkTetra : kVtkWedge);
            for (const NodeIndex node : nodes)
              fmt::format_to(std::back_inserter(buffer), " {}", node.value());
            fmt::format_to(std::back_inserter(buffer), " {}\n", number++);
          });
      },
      progress);
}

void write_points(AtomicFile& file, const ColumnMesh& mesh, const Placement& placement,
                  const Progress& progress) {
  file.write(fmt::format("NPOIN= {}\n", mesh.node_count()));
  constexpr std::uint64_t kBytes = 50;
  const auto bytes = static_cast<std::uint64_t>(mesh.node_count()) * kBytes;
  write_chunked(
      file, point_rows(mesh), grain_for(point_rows(mesh), bytes),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        for_each_point(mesh, placement, begin, end, [&](NodeIndex n, double x, double y, double z) {
          fmt::format_to(std::back_inserter(buffer), "{} {} {} {}\n", x, y, z, n.value());
        });
      },
      progress);
}

void write_markers(AtomicFile& file, const SurfaceMesh& surface) {
  const std::vector<PatchFaces> patches = faces_of_patches(surface);
  file.write(fmt::format("NMARK= {}\n", patches.size()));
  for (const PatchFaces& range : patches) {
    file.write(fmt::format("MARKER_TAG= {}\nMARKER_ELEMS= {}\n",
                           surface.patches.of(range.patch).name, range.faces()));
    write_chunked(file, range.faces(), kRowsPerChunk,
                  [&](std::size_t begin, std::size_t end, std::string& buffer) {
                    for_each_face_of(surface, range, begin, end, [&](const auto& nodes) {
                      buffer += std::to_string(nodes.size() == 3 ? kVtkTriangle : kVtkQuad);
                      for (const NodeIndex node : nodes)
                        fmt::format_to(std::back_inserter(buffer), " {}", node.value());
                      buffer += '\n';
                    });
                  });
  }
}

}  // namespace

void write_su2(const std::filesystem::path& path, const ColumnMesh& mesh,
               const SurfaceMesh& surface, const Placement& placement, const Progress& progress) {
  require_boundary_of(mesh, surface);
  AtomicFile file(path);
  file.write(fmt::format("% origin {} {} {}\n", placement.origin[0], placement.origin[1],
                         placement.origin[2]));
  write_cells(file, mesh, portion(progress, 0, 0.7));
  write_points(file, mesh, placement, portion(progress, 0.7, 1));
  write_markers(file, surface);
  file.commit();
}

}  // namespace tetropolis
