#include "tetropolis/io/mesh/msh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "column_output.h"
#include "core/infinity.h"
#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"

namespace tetropolis {

namespace {

static_assert(std::endian::native == std::endian::little, "MSH output writes native byte order");

// Rows formatted at a time by a thread: some hundred kilobytes of output.
constexpr std::size_t kRows = 32768;
constexpr std::int32_t kTriangleType = 2;
constexpr std::int32_t kTetType = 4;

/// Lowest and highest coordinates.
struct Box {
  std::array<double, 3> low;
  std::array<double, 3> high;
};

Box box_of(const SurfaceMesh& surface, std::size_t begin, std::size_t end,
           const Placement& placement) {
  Box box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (std::size_t f = begin; f < end; ++f)
    for (const std::int32_t p : surface.triangles[f])
      for (std::size_t c = 0; c < 3; ++c) {
        const double x = surface.points[static_cast<std::size_t>(p)][c] + placement.shift[c];
        box.low[c] = std::min(box.low[c], x);
        box.high[c] = std::max(box.high[c], x);
      }
  return box;
}

void append_size(std::string& buffer, std::size_t value) {
  append_raw(buffer, static_cast<std::uint64_t>(value));
}

/// The start of an entity: its number, box and one physical group of the same number.
void append_entity(std::string& buffer, std::int32_t number, const Box& box) {
  append_raw(buffer, number);
  for (const double x : box.low) append_raw(buffer, x);
  for (const double x : box.high) append_raw(buffer, x);
  append_size(buffer, 1);
  append_raw(buffer, number);
}

std::string head(const std::vector<PatchFaces>& patches, const SurfaceMesh& surface,
                 const Placement& placement) {
  std::string text = "$MeshFormat\n4.1 1 8\n";
  append_raw(text, std::int32_t{1});
  text += fmt::format("\n$EndMeshFormat\n$Comments\norigin {} {} {}\n$EndComments\n",
                      placement.origin[0], placement.origin[1], placement.origin[2]);
  text += fmt::format("$PhysicalNames\n{}\n", patches.size() + 1);
  for (const PatchFaces& range : patches)
    text += fmt::format("2 {} \"{}\"\n", static_cast<int>(range.patch),
                        surface.patches.of(range.patch).name);
  text += fmt::format("3 {} \"air\"\n$EndPhysicalNames\n$Entities\n", kAirPhysicalGroup);
  for (const std::size_t count : {std::size_t{0}, std::size_t{0}, patches.size(), std::size_t{1}})
    append_size(text, count);
  for (const PatchFaces& range : patches) {
    append_entity(text, static_cast<std::int32_t>(range.patch),
                  box_of(surface, range.begin, range.end, placement));
    append_size(text, 0);  // no bounding curves
  }
  append_entity(text, kAirPhysicalGroup, box_of(surface, 0, surface.triangles.size(), placement));
  append_size(text, patches.size());
  for (const PatchFaces& range : patches) append_raw(text, static_cast<std::int32_t>(range.patch));
  return text + "\n$EndEntities\n";
}

/// All nodes belong to the volume, which is one block.
void write_nodes(AtomicFile& file, const ColumnMesh& mesh, const Placement& placement,
                 const Progress& progress) {
  const auto nodes = static_cast<std::size_t>(mesh.node_count());
  std::string begin_block = "$Nodes\n";
  for (const std::size_t count : {std::size_t{1}, nodes, std::size_t{1}, nodes})
    append_size(begin_block, count);
  for (const std::int32_t entity : {3, kAirPhysicalGroup, 0}) append_raw(begin_block, entity);
  append_size(begin_block, nodes);
  file.write(begin_block);
  write_chunked(file, nodes, kRows, [&](std::size_t begin, std::size_t end, std::string& buffer) {
    for (std::size_t n = begin; n < end; ++n) append_size(buffer, n + 1);
  });
  write_chunked(
      file, point_rows(mesh), grain_for(point_rows(mesh), nodes * 3 * sizeof(double)),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        append_points(mesh, placement, begin, end, buffer);
      },
      progress);
  file.write("\n$EndNodes\n");
}

std::string begin_elements(std::int32_t dimension, std::int32_t entity, std::int32_t type,
                           std::size_t count) {
  std::string block;
  for (const std::int32_t value : {dimension, entity, type}) append_raw(block, value);
  append_size(block, count);
  return block;
}

void write_triangles(AtomicFile& file, const std::vector<PatchFaces>& patches,
                     const SurfaceMesh& surface) {
  for (const PatchFaces& range : patches) {
    file.write(begin_elements(2, static_cast<std::int32_t>(range.patch), kTriangleType,
                              range.end - range.begin));
    write_chunked(file, range.end - range.begin, kRows,
                  [&](std::size_t begin, std::size_t end, std::string& buffer) {
                    for (std::size_t f = range.begin + begin; f < range.begin + end; ++f) {
                      append_size(buffer, f + 1);
                      for (const std::int32_t p : surface.triangles[f])
                        append_raw(buffer, surface.node[static_cast<std::size_t>(p)] + 1);
                    }
                  });
  }
}

void write_tets(AtomicFile& file, const ColumnMesh& mesh, const std::vector<CellIndex>& cells,
                std::size_t triangles, const Progress& progress) {
  const auto count = static_cast<std::size_t>(cells.back());
  file.write(begin_elements(3, kAirPhysicalGroup, kTetType, count));
  const std::uint64_t bytes = count * 5 * sizeof(std::uint64_t);
  write_chunked(
      file, cells.size() - 1, grain_for(cells.size() - 1, bytes),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        for (std::size_t row = begin; row < end; ++row) {
          std::size_t element = triangles + static_cast<std::size_t>(cells[row]);
          for_each_tet_of(mesh, row, [&](const std::array<NodeIndex, 4>& tet) {
            append_size(buffer, ++element);
            for (const NodeIndex node : tet) append_raw(buffer, node + 1);
          });
        }
      },
      progress);
}

}  // namespace

void write_msh(const std::filesystem::path& path, const ColumnMesh& mesh,
               const SurfaceMesh& surface, const Placement& placement, const Progress& progress) {
  refuse_prisms(path, mesh);
  require_boundary_of(mesh, surface);
  const std::vector<CellIndex> cells = cell_offsets(mesh);
  const std::vector<PatchFaces> patches = faces_of_patches(surface);
  const std::size_t elements = surface.triangles.size() + static_cast<std::size_t>(cells.back());
  AtomicFile file(path);
  file.write(head(patches, surface, placement));
  write_nodes(file, mesh, placement, portion(progress, 0, 0.2));
  std::string begin = "$Elements\n";
  for (const std::size_t count : {patches.size() + 1, elements, std::size_t{1}, elements})
    append_size(begin, count);
  file.write(begin);
  write_triangles(file, patches, surface);
  write_tets(file, mesh, cells, surface.triangles.size(), portion(progress, 0.2, 1));
  file.write("\n$EndElements\n");
  file.commit();
}

}  // namespace tetropolis
