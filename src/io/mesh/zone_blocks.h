// Cells by zone, for formats that have those of a zone together. Private to src/io.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tetropolis/volume/cell_zones.h"
#include "tetropolis/volume/column/column_mesh.h"

#include "column_output.h"

namespace tetropolis {

struct ZoneBlock {
  std::size_t count = 0;
  std::string elements;
};

/// Per number of CellZones::of_cell a block of tets and one of prisms; the first two, of cells in
/// no zone, are counted only. append(cell, nodes, buffer) puts a cell into one of the others.
template <typename Append>
std::vector<ZoneBlock> zone_blocks(const ColumnMesh& mesh, const std::vector<CellIndex>& offsets,
                                   const CellZones& zones, const Append& append) {
  std::vector<ZoneBlock> blocks(2 * (zones.zones.size() + 1));
  const CellCounts all = count_cells(mesh, offsets);
  blocks[0].count = all.tets;
  blocks[1].count = all.prisms;
  if (zones.empty()) return blocks;
  for (std::size_t row = 0, next = 0; row < cell_rows(mesh, offsets); ++row)
    for_each_cell_of(mesh, offsets, row, [&](const auto& nodes) {
      const std::size_t cell = next++;
      const std::int32_t zone = zones.of_cell[cell];
      if (zone == 0) return;
      const std::size_t type = nodes.size() == 4 ? 0 : 1;
      ZoneBlock& block = blocks[2 * static_cast<std::size_t>(zone) + type];
      ++block.count;
      --blocks[type].count;
      append(cell, nodes, block.elements);
    });
  return blocks;
}

}  // namespace tetropolis
