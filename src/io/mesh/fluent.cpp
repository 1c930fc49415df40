#include "tetropolis/io/mesh/fluent.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "column_output.h"
#include "internal_faces.h"
#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"
#include "volume/column/upper_faces.h"

namespace tetropolis {

namespace {

// Rows formatted at a time by a thread: some hundred kilobytes of output.
constexpr std::size_t kRows = 16384;
// Numbers of zones; that of a patch is kFirstPatch more than its number.
constexpr int kNodeZone = 1, kCellZone = 2, kInteriorZone = 3, kFirstPatch = 10;

enum class Boundary { kInterior = 2, kWall = 3, kSymmetry = 7 };

int zone_of(Patch patch) { return kFirstPatch + static_cast<int>(patch); }

void write_points(AtomicFile& file, const ColumnMesh& mesh, const Placement& placement) {
  file.write(fmt::format("(10 ({:x} 1 {:x} 1 3)(\n", kNodeZone, mesh.node_count()));
  constexpr std::uint64_t kBytes = 45;  // of a row, about
  const auto bytes = static_cast<std::uint64_t>(mesh.node_count()) * kBytes;
  write_chunked(file, point_rows(mesh), grain_for(point_rows(mesh), bytes),
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  for_each_point(
                      mesh, placement, begin, end, [&](NodeIndex, double x, double y, double z) {
                        fmt::format_to(std::back_inserter(buffer), "{} {} {}\n", x, y, z);
                      });
                });
  file.write("))\n");
}

std::string begin_faces(int zone, std::size_t first, std::size_t last, Boundary type) {
  constexpr int kTriangles = 3;
  return fmt::format("(13 ({:x} {:x} {:x} {:x} {:x})(\n", zone, first + 1, last,
                     static_cast<int>(type), kTriangles);
}

/// Right-hand normals point to the cell that is named first.
void write_interior(AtomicFile& file, const ColumnMesh& mesh, const std::vector<CellIndex>& cells,
                    std::size_t count, const Progress& progress) {
  file.write(begin_faces(kInteriorZone, 0, count, Boundary::kInterior));
  constexpr std::uint64_t kBytes = 35;
  const auto append = [](const std::array<NodeIndex, 3>& nodes, CellIndex neighbour,
                         CellIndex owner, std::string& buffer) {
    fmt::format_to(std::back_inserter(buffer), "{:x} {:x} {:x} {:x} {:x}\n", nodes[0].value() + 1,
                   nodes[1].value() + 1, nodes[2].value() + 1, neighbour.value() + 1,
                   owner.value() + 1);
  };
  write_chunked(
      file, mesh.triangle_count(), grain_for(mesh.triangle_count(), count * kBytes),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        InternalFaces faces(mesh, cells);
        for (const TriangleIndex t : indices<TriangleIndex>(begin, end))
          for (const InternalFace& face : faces.owned_over(t))
            append(face.nodes, face.neighbour, face.owner, buffer);
      },
      progress);
  if (!mesh.upper.empty()) {
    const std::vector<UpperFaces::Inner> upper = upper_faces(mesh).inner;
    write_chunked(file, upper.size(), kRows,
                  [&](std::size_t begin, std::size_t end, std::string& buffer) {
                    for (std::size_t f = begin; f < end; ++f)
                      append(upper[f].nodes, upper[f].neighbour, upper[f].cell, buffer);
                  });
  }
  file.write("))\n");
}

void write_patch(AtomicFile& file, const SurfaceMesh& surface, const PatchFaces& range,
                 std::size_t interior) {
  const Boundary type =
      surface.patches.of(range.patch).is_solid() ? Boundary::kWall : Boundary::kSymmetry;
  file.write(begin_faces(zone_of(range.patch), interior + range.begin, interior + range.end, type));
  write_chunked(
      file, range.end - range.begin, kRows,
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        for (std::size_t f = range.begin + begin; f < range.begin + end; ++f) {
          const auto& corners = surface.triangles[f];
          for (std::size_t i = corners.size(); i-- > 0;)  // so that normals point inwards
            fmt::format_to(std::back_inserter(buffer), "{:x} ",
                           surface.node[static_cast<std::size_t>(corners[i])].value() + 1);
          fmt::format_to(std::back_inserter(buffer), "{:x} 0\n", surface.cell[f].value() + 1);
        }
      });
  file.write("))\n");
}

}  // namespace

void write_fluent(const std::filesystem::path& path, const ColumnMesh& mesh,
                  const SurfaceMesh& surface, const Placement& placement,
                  const Progress& progress) {
  refuse_prisms(path, mesh);
  require_boundary_of(mesh, surface);
  const std::vector<CellIndex> cells = cell_offsets(mesh);
  const std::vector<PatchFaces> patches = faces_of_patches(surface);
  const auto cell_count = static_cast<std::size_t>(cells.back().value());
  const std::size_t outer = surface.triangles.size(), interior = (4 * cell_count - outer) / 2;
  AtomicFile file(path);
  file.write(fmt::format("(0 \"Tetropolis origin {} {} {}\")\n(2 3)\n", placement.origin[0],
                         placement.origin[1], placement.origin[2]));
  file.write(fmt::format("(10 (0 1 {:x} 0 3))\n(12 (0 1 {:x} 0))\n(13 (0 1 {:x} 0))\n",
                         mesh.node_count(), cell_count, interior + outer));
  constexpr int kFluid = 1, kTets = 2;
  file.write(fmt::format("(12 ({:x} 1 {:x} {:x} {:x}))\n", kCellZone, cell_count, kFluid, kTets));
  write_points(file, mesh, placement);
  write_interior(file, mesh, cells, interior, portion(progress, 0.2, 1));
  for (const PatchFaces& range : patches) write_patch(file, surface, range, interior);
  file.write(fmt::format("(45 ({} fluid air)())\n(45 ({} interior inside)())\n", kCellZone,
                         kInteriorZone));
  for (const PatchFaces& range : patches) {
    const PatchInfo& info = surface.patches.of(range.patch);
    file.write(fmt::format("(45 ({} {} {})())\n", zone_of(range.patch),
                           info.is_solid() ? "wall" : "symmetry", info.name));
  }
  file.commit();
}

}  // namespace tetropolis
