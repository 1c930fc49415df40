#include "tetropolis/volume/building_zones.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "volume/column/building_names.h"

namespace tetropolis {

CellZones zone_buildings(const ColumnMesh& mesh, CellZones zones,
                         std::span<const Building> buildings) {
  const std::vector<CellIndex> offsets = cell_offsets(mesh);
  const auto tets = static_cast<std::size_t>(offsets.back().value());
  const std::int64_t prisms = mesh.layers.cells();
  zones.of_cell.resize(tets + static_cast<std::size_t>(prisms), 0);
  // Calls visit(building, its zone) for the cells over buildings that have no other zone.
  const auto for_each_cell = [&](const auto& visit) {
    const auto visit_cell = [&](BuildingIndex building, std::size_t cell) {
      if (building != kNoBuilding && zones.of_cell[cell] == 0)
        visit(static_cast<std::size_t>(building.value()), zones.of_cell[cell]);
    };
    for (std::size_t row = 0; row + 1 < offsets.size(); ++row)
      for (CellIndex c = offsets[row]; c < offsets[row + 1]; ++c)
        visit_cell(building_below(mesh, row), std::size_t{c});
    for (std::int64_t i = 0; i < prisms; ++i)
      visit_cell(building_of_prism(mesh, i), tets + static_cast<std::size_t>(i));
  };
  std::vector<std::int64_t> cells(buildings.size(), 0);
  for_each_cell([&](std::size_t b, std::int32_t) { ++cells[b]; });
  const std::vector<std::string> names = plain_names(buildings);
  std::vector<std::int32_t> zone(buildings.size(), 0);
  for (std::size_t b = 0; b < buildings.size(); ++b) {
    if (cells[b] == 0) continue;
    zones.zones.push_back({"over_" + names[b], 0, 0, 0, cells[b]});
    zone[b] = static_cast<std::int32_t>(zones.zones.size());
  }
  for_each_cell([&](std::size_t b, std::int32_t& own) { own = zone[b]; });
  if (zones.empty()) zones.of_cell.clear();
  return zones;
}

}  // namespace tetropolis
