#include "tetropolis/volume/column/building_patches.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/check/check_surface.h"

#include "support/explicit_mesh.h"
#include "support/prism_city.h"
#include "support/small_city.h"

namespace tetropolis {
namespace {

std::vector<Building> named(const std::vector<std::string>& ids) {
  std::vector<Building> buildings(ids.size());
  for (std::size_t b = 0; b < ids.size(); ++b) buildings[b].id = ids[b];
  return buildings;
}

TEST(BuildingPatches, HaveTheFacesOfTheirBuilding) {
  const testing::SmallCity city = testing::small_city(testing::hills);
  const SurfaceMesh whole = extract_boundary(testing::meshed(city).mesh);
  std::vector<std::string> ids;
  for (std::size_t b = 0; b < city.footprints.size(); ++b) ids.push_back("b" + std::to_string(b));
  const SurfaceMesh divided = divide_by_building(whole, named(ids));

  ASSERT_EQ(divided.patches.size(), 8 + 2 * ids.size());
  EXPECT_TRUE(std::is_sorted(divided.patch.begin(), divided.patch.end()));
  EXPECT_EQ(divided.points, whole.points);
  EXPECT_EQ(divided.node, whole.node);
  // The same faces, each with what it had.
  using Face = std::pair<std::array<std::int32_t, 3>, CellIndex>;
  std::map<std::string, std::set<Face>> expected, found;
  for (std::size_t f = 0; f < whole.triangles.size(); ++f) {
    std::string name = whole.patch_of(f).name;
    if (whole.building[f] != kNoBuilding) name += "_b" + std::to_string(whole.building[f].value());
    expected[name].insert({whole.triangles[f], whole.cell[f]});
  }
  for (std::size_t f = 0; f < divided.triangles.size(); ++f) {
    found[divided.patch_of(f).name].insert({divided.triangles[f], divided.cell[f]});
    EXPECT_EQ(divided.patch_of(f).of_building(), divided.building[f] != kNoBuilding);
  }
  EXPECT_EQ(found, expected);
  EXPECT_TRUE(check_surface(divided).violations.empty());
}

TEST(BuildingPatches, KeepTheHalvesOfQuadrilateralsTogether) {
  const testing::SmallCity city = testing::small_city(testing::hills);
  const SurfaceMesh whole = extract_boundary(testing::prism_city(city, 10, {3, 0.5, 1.2}).mesh);
  const SurfaceMesh divided =
      divide_by_building(whole, named(std::vector<std::string>(city.footprints.size(), "house")));
  const auto quads_of = [](const SurfaceMesh& surface) {
    std::set<std::array<std::int32_t, 4>> quads;
    for (const std::int32_t q : surface.quads) {
      const auto f = static_cast<std::size_t>(q);
      const auto& [a, b, c] = surface.triangles[f];
      EXPECT_EQ(surface.triangles[f + 1][0], a);
      EXPECT_EQ(surface.triangles[f + 1][1], c);
      EXPECT_EQ(surface.patch[f], surface.patch[f + 1]);
      quads.insert({a, b, c, surface.triangles[f + 1][2]});
    }
    return quads;
  };
  EXPECT_GT(whole.quads.size(), 0U);
  EXPECT_EQ(quads_of(divided), quads_of(whole));
}

TEST(SortByPatch, BringsOwnPatchesIntoTheOrderOfFiles) {
  const testing::SmallCity city = testing::small_city(testing::hills);
  SurfaceMesh own = extract_boundary(testing::prism_city(city, 10, {3, 0.5, 1.2}).mesh);
  const SurfaceMesh before = own;
  // Two sides become one patch: quadrilaterals of it stand among triangles.
  const Patch inlet{9};
  own.patches.add({inlet, "inlet", PatchKind::kSide});
  for (std::size_t f = 0; f < own.triangles.size(); ++f)
    if (own.patch[f] == Patch::kXMin || own.patch[f] == Patch::kYMax) own.patch[f] = inlet;
  const std::vector<Patch> given = own.patch;
  sort_by_patch(own);

  std::map<std::array<std::int32_t, 3>, std::tuple<Patch, BuildingIndex, CellIndex>> faces;
  for (std::size_t f = 0; f < own.triangles.size(); ++f)
    faces[own.triangles[f]] = {own.patch[f], own.building[f], own.cell[f]};
  ASSERT_EQ(own.triangles.size(), before.triangles.size());
  for (std::size_t f = 0; f < before.triangles.size(); ++f)
    EXPECT_EQ(faces.at(before.triangles[f]),
              std::tuple(given[f], before.building[f], before.cell[f]));
  ASSERT_EQ(own.quads.size(), before.quads.size());
  std::vector<bool> is_half(own.triangles.size(), false);
  for (const std::int32_t q : own.quads) {
    const auto f = static_cast<std::size_t>(q);
    is_half[f] = is_half[f + 1] = true;
    EXPECT_EQ(own.triangles[f][2], own.triangles[f + 1][1]);
  }
  for (std::size_t f = 1; f < own.triangles.size(); ++f)
    EXPECT_LE(std::pair(own.patch[f - 1], static_cast<int>(is_half[f - 1])),
              std::pair(own.patch[f], static_cast<int>(is_half[f])));
}

TEST(BuildingPatches, HaveNamesThatEveryFormatTakes) {
  const testing::SmallCity city = testing::small_city(testing::hills);
  const SurfaceMesh whole = extract_boundary(testing::meshed(city).mesh);
  std::vector<std::string> ids(city.footprints.size(), "way/7 (a)");
  ids[0] = "NL.IMBAG.Pand.0503100000012345";
  std::set<std::string> names;
  for (const PatchInfo& info : divide_by_building(whole, named(ids)).patches) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_LE(info.name.size(), 32U);
    EXPECT_EQ(info.name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789_-."),
              std::string::npos)
        << info.name;
  }
  EXPECT_TRUE(names.contains("roof_NL_IMBAG_Pand_05031000000.0"));
  EXPECT_TRUE(names.contains("wall_way_7__a_"));
}

}  // namespace
}  // namespace tetropolis
