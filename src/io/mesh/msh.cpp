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
#include "msh_common.h"
#include "zone_blocks.h"

namespace tetropolis {

namespace {

static_assert(std::endian::native == std::endian::little, "MSH output writes native byte order");

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
                 const Placement& placement, const CellZones& zones) {
  std::string text = "$MeshFormat\n4.1 1 8\n";
  append_raw(text, std::int32_t{1});
  text += fmt::format("\n$EndMeshFormat\n$Comments\norigin {} {} {}\n$EndComments\n",
                      placement.origin[0], placement.origin[1], placement.origin[2]);
  text += physical_names(patches, surface, zones) + "$Entities\n";
  const std::vector<std::int32_t> volumes = volumes_of(zones);
  for (const std::size_t count : {std::size_t{0}, std::size_t{0}, patches.size(), volumes.size()})
    append_size(text, count);
  for (const PatchFaces& range : patches) {
    append_entity(
        text, static_cast<std::int32_t>(range.patch),
        box_of(surface, range.begin, range.begin + range.triangles + 2 * range.quads, placement));
    append_size(text, 0);  // no bounding curves
  }
  for (const std::int32_t zone : volumes) {
    append_entity(text, volume_group(zone),
                  box_of(surface, 0, surface.triangles.size(), placement));
    append_size(text, zone == 0 ? patches.size() : 0);
    if (zone > 0) continue;
    for (const PatchFaces& range : patches)
      append_raw(text, static_cast<std::int32_t>(range.patch));
  }
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
  write_chunked(file, nodes, kRowsPerChunk,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
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

/// A block for the triangles of each patch, and one for its quadrilaterals, if there are any.
void write_faces(AtomicFile& file, const std::vector<PatchFaces>& patches,
                 const SurfaceMesh& surface) {
  for (const PatchFaces& range : patches)
    for (const bool quads : {false, true}) {
      const std::size_t first = quads ? range.triangles : 0;
      const std::size_t count = quads ? range.quads : range.triangles;
      if (count == 0) continue;
      file.write(begin_elements(2, static_cast<std::int32_t>(range.patch),
                                quads ? kMshQuad : kMshTriangle, count));
      write_chunked(
          file, count, kRowsPerChunk, [&](std::size_t begin, std::size_t end, std::string& buffer) {
            std::size_t element = range.first + first + begin;
            for_each_face_of(surface, range, first + begin, first + end, [&](const auto& nodes) {
              append_size(buffer, ++element);
              for (const NodeIndex node : nodes) append_raw(buffer, node + 1);
            });
          });
    }
}

/// The cells in no zone, `count` of them, of some rows of cell_rows(), all of one type; elements
/// are numbered after the faces.
void write_cells(AtomicFile& file, const ColumnMesh& mesh, const std::vector<CellIndex>& cells,
                 const CellZones& zones, std::size_t count, std::size_t first_row,
                 std::size_t end_row, std::int32_t type, std::size_t faces,
                 const Progress& progress) {
  if (count == 0) return;
  file.write(begin_elements(3, kAirPhysicalGroup, type, count));
  const std::uint64_t bytes = count * 7 * sizeof(std::uint64_t);
  write_chunked(
      file, end_row - first_row, grain_for(end_row - first_row, bytes),
      [&](std::size_t begin, std::size_t end, std::string& buffer) {
        std::size_t element = faces + first_cell_of(cells, first_row + begin);
        for (std::size_t row = first_row + begin; row < first_row + end; ++row)
          for_each_cell_of(mesh, cells, row, [&](const auto& nodes) {
            const std::size_t cell = element++ - faces;
            if (!zones.empty() && zones.of_cell[cell] != 0) return;
            append_size(buffer, element);
            for (const NodeIndex node : nodes) append_raw(buffer, node + 1);
          });
      },
      progress);
}

}  // namespace

void write_msh(const std::filesystem::path& path, const ColumnMesh& mesh,
               const SurfaceMesh& surface, const Placement& placement, const Progress& progress,
               const CellZones& zones) {
  require_boundary_of(mesh, surface);
  const std::vector<CellIndex> cells = cell_offsets(mesh);
  const std::vector<PatchFaces> patches = faces_of_patches(surface);
  const std::size_t faces = count_faces(surface);
  const CellCounts counts = count_cells(mesh, cells);
  const std::size_t elements = faces + counts.all();
  AtomicFile file(path);
  file.write(head(patches, surface, placement, zones));
  write_nodes(file, mesh, placement, portion(progress, 0, 0.2));
  const std::vector<ZoneBlock> in_zones = zone_blocks(
      mesh, cells, zones, [&](std::size_t cell, const auto& nodes, std::string& buffer) {
        append_size(buffer, faces + cell + 1);
        for (const NodeIndex node : nodes) append_raw(buffer, node + 1);
      });
  std::size_t blocks = 0;
  for (const ZoneBlock& block : in_zones) blocks += block.count > 0 ? 1 : 0;
  for (const PatchFaces& range : patches)
    blocks += (range.triangles > 0 ? 1U : 0U) + (range.quads > 0 ? 1U : 0U);
  std::string begin = "$Elements\n";
  for (const std::size_t count : {blocks, elements, std::size_t{1}, elements})
    append_size(begin, count);
  file.write(begin);
  write_faces(file, patches, surface);
  const std::size_t tet_rows = cells.size() - 1;
  write_cells(file, mesh, cells, zones, in_zones[0].count, 0, tet_rows, kMshTet, faces,
              portion(progress, 0.2, 0.9));
  write_cells(file, mesh, cells, zones, in_zones[1].count, tet_rows, cell_rows(mesh, cells),
              kMshPrism, faces, portion(progress, 0.9, 1));
  for (std::size_t b = 2; b < in_zones.size(); ++b) {
    if (in_zones[b].count == 0) continue;
    file.write(begin_elements(3, volume_group(static_cast<std::int32_t>(b / 2)),
                              b % 2 == 0 ? kMshTet : kMshPrism, in_zones[b].count));
    file.write(in_zones[b].elements);
  }
  file.write("\n$EndElements\n");
  file.commit();
}

}  // namespace tetropolis
