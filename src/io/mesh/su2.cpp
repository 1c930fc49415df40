#include "tetropolis/io/mesh/su2.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "column_output.h"
#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"

namespace tetropolis {

namespace {

// Rows formatted at a time by a thread: some hundred kilobytes of output.
constexpr std::size_t kRows = 16384;
// Elements have the numbers of VTK.
constexpr int kTriangle = 5;
constexpr int kTet = 10;

void write_cells(AtomicFile& file, const ColumnMesh& mesh, const Progress& progress) {
  const std::vector<CellIndex> cells = cell_offsets(mesh);
  const auto count = static_cast<std::uint64_t>(cells.back().value());
  file.write(fmt::format("NDIME= 3\nNELEM= {}\n", count));
  constexpr std::uint64_t kBytes = 40;  // of a row, about
  write_chunked(
      file, cells.size() - 1, grain_for(cells.size() - 1, count * kBytes),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        for (std::size_t row = begin; row < end; ++row) {
          std::int64_t number = cells[row].value();
          for_each_tet_of(mesh, row, [&](const std::array<NodeIndex, 4>& tet) {
            fmt::format_to(std::back_inserter(buffer), "{} {} {} {} {} {}\n", kTet, tet[0].value(),
                           tet[1].value(), tet[2].value(), tet[3].value(), number++);
          });
        }
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
                           surface.patches.of(range.patch).name, range.end - range.begin));
    write_chunked(file, range.end - range.begin, kRows,
                  [&](std::size_t begin, std::size_t end, std::string& buffer) {
                    for (std::size_t f = range.begin + begin; f < range.begin + end; ++f) {
                      const auto& nodes = surface.triangles[f];
                      buffer += std::to_string(kTriangle);
                      for (const std::int32_t p : nodes)
                        fmt::format_to(std::back_inserter(buffer), " {}",
                                       surface.node[static_cast<std::size_t>(p)].value());
                      buffer += '\n';
                    }
                  });
  }
}

}  // namespace

void write_su2(const std::filesystem::path& path, const ColumnMesh& mesh,
               const SurfaceMesh& surface, const Placement& placement, const Progress& progress) {
  refuse_prisms(path, mesh);
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
