#include "tetropolis/volume/building_zones.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/volume/column/explicit_mesh.h"

#include "support/prism_city.h"
#include "support/small_city.h"

namespace tetropolis {
namespace {

std::vector<Building> buildings_of(const testing::SmallCity& city) {
  std::vector<Building> buildings(city.footprints.size());
  for (std::size_t b = 0; b < buildings.size(); ++b) buildings[b].id = "b" + std::to_string(b);
  return buildings;
}

/// Buildings below the cells, by the regions that Python has; of prisms by their triangle.
std::vector<BuildingIndex> buildings_below(const ColumnMesh& mesh) {
  const std::vector<CellIndex> offsets = cell_offsets(mesh);
  std::vector<BuildingIndex> below(std::size_t{offsets.back()});
  fill_regions(mesh, offsets, 0, offsets.size() - 1, below);
  for (std::int64_t i = 0; i < mesh.layers.cells(); ++i)
    below.push_back(mesh.ground.region_of(triangle_below(mesh, i)).building);
  return below;
}

void expect_zones(const ColumnMesh& mesh, const CellZones& given, const CellZones& zones,
                  const std::vector<Building>& buildings) {
  const std::vector<BuildingIndex> below = buildings_below(mesh);
  ASSERT_EQ(zones.of_cell.size(), below.size());
  std::map<std::string, std::int64_t> cells;
  for (std::size_t c = 0; c < below.size(); ++c) {
    const std::int32_t zone = zones.of_cell[c];
    const std::int32_t before = given.empty() ? 0 : given.of_cell[c];
    if (before > 0 || below[c] == kNoBuilding) {
      EXPECT_EQ(zone, before);
      continue;
    }
    ASSERT_GT(zone, 0);
    const std::string& name = zones.zones[static_cast<std::size_t>(zone) - 1].name;
    EXPECT_EQ(name, "over_" + buildings[static_cast<std::size_t>(below[c].value())].id);
    ++cells[name];
  }
  EXPECT_EQ(cells.size(), buildings.size());
  ASSERT_EQ(zones.zones.size(), given.zones.size() + buildings.size());
  for (std::size_t z = given.zones.size(); z < zones.zones.size(); ++z) {
    EXPECT_EQ(zones.zones[z].cells, cells[zones.zones[z].name]);
    EXPECT_EQ(zones.zones[z].leaf_area_density, 0);
  }
}

TEST(BuildingZones, HaveTheCellsAboveTheirBuilding) {
  const testing::SmallCity city = testing::small_city(testing::hills);
  const std::vector<Building> buildings = buildings_of(city);
  const ColumnMesh tets = testing::meshed(city).mesh;
  expect_zones(tets, {}, zone_buildings(tets, {}, buildings), buildings);
  const ColumnMesh layered = testing::prism_city(city, 10, {3, 0.5, 1.2}).mesh;
  expect_zones(layered, {}, zone_buildings(layered, {}, buildings), buildings);
}

TEST(BuildingZones, LeaveCellsThatHaveAZone) {
  const testing::SmallCity city = testing::small_city(testing::hills);
  const std::vector<Building> buildings = buildings_of(city);
  const ColumnMesh mesh = testing::meshed(city).mesh;
  CellZones given;
  given.of_cell.assign(buildings_below(mesh).size(), 0);
  for (std::size_t c = 0; c < given.of_cell.size(); c += 3) given.of_cell[c] = 1;
  given.zones.push_back({"canopy_1", 5, 0, 0.5, static_cast<std::int64_t>(given.of_cell.size())});
  expect_zones(mesh, given, zone_buildings(mesh, given, buildings), buildings);
}

TEST(BuildingZones, AreNoneWithoutBuildings) {
  testing::SmallCity city = testing::small_city(testing::hills);
  city.footprints.clear();
  city.roofs.clear();
  const ColumnMesh mesh = testing::meshed(city).mesh;
  const CellZones zones = zone_buildings(mesh, {}, {});
  EXPECT_TRUE(zones.empty());
  EXPECT_TRUE(zones.of_cell.empty());
}

}  // namespace
}  // namespace tetropolis
