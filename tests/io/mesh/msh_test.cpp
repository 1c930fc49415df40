#include "tetropolis/io/mesh/msh.h"

#include <map>

#include <gtest/gtest.h>

#include "mesh_bytes.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::Cursor;
using testing::Point3;

struct Entity {
  std::array<double, 6> box{};
  std::vector<std::int32_t> groups, boundary;
};

struct Msh {
  std::string comments;
  std::map<std::pair<int, int>, std::string> names;  // dimension, group
  std::map<std::pair<int, int>, Entity> entities;    // dimension, number
  std::map<std::uint64_t, Point3> nodes;             // by number
  std::map<std::uint64_t, std::pair<int, std::vector<std::uint64_t>>> elements;  // entity, nodes
};

Entity read_entity(Cursor& file) {
  Entity entity;
  for (double& x : entity.box) x = file.take<double>();
  entity.groups = file.take<std::int32_t>(file.take<std::uint64_t>());
  entity.boundary = file.take<std::int32_t>(file.take<std::uint64_t>());
  return entity;
}

void read_nodes(Cursor& file, Msh& msh) {
  file.expect("$Nodes\n");
  const auto counts = file.take<std::uint64_t>(4);  // blocks, nodes, least, greatest number
  for (std::uint64_t b = 0; b < counts[0]; ++b) {
    const auto entity = file.take<std::int32_t>(3);
    EXPECT_TRUE(msh.entities.contains({entity[0], entity[1]}));
    EXPECT_EQ(entity[2], 0);
    const auto size = file.take<std::uint64_t>();
    const auto numbers = file.take<std::uint64_t>(size);
    for (const std::uint64_t number : numbers) msh.nodes[number] = file.take<Point3>();
  }
  file.expect("\n$EndNodes\n");
  EXPECT_EQ(msh.nodes.size(), counts[1]);
  EXPECT_EQ(msh.nodes.begin()->first, counts[2]);
  EXPECT_EQ(msh.nodes.rbegin()->first, counts[3]);
}

void read_elements(Cursor& file, Msh& msh) {
  file.expect("$Elements\n");
  const auto counts = file.take<std::uint64_t>(4);
  for (std::uint64_t b = 0; b < counts[0]; ++b) {
    const auto entity = file.take<std::int32_t>(3);  // dimension, number, type
    EXPECT_TRUE(msh.entities.contains({entity[0], entity[1]}));
    EXPECT_EQ(entity[2], entity[0] == 2 ? 2 : 4);
    const auto size = file.take<std::uint64_t>();
    for (std::uint64_t e = 0; e < size; ++e) {
      const auto number = file.take<std::uint64_t>();
      msh.elements[number] = {entity[1],
                              file.take<std::uint64_t>(static_cast<std::size_t>(entity[0]) + 1)};
    }
  }
  file.expect("\n$EndElements\n");
  EXPECT_EQ(msh.elements.size(), counts[1]);
  EXPECT_EQ(msh.elements.begin()->first, counts[2]);
  EXPECT_EQ(msh.elements.rbegin()->first, counts[3]);
}

/// MSH 4.1, binary, as the Gmsh manual describes it.
Msh read_msh(const std::filesystem::path& path) {
  Msh msh;
  Cursor file(path);
  file.expect("$MeshFormat\n4.1 1 8\n");
  EXPECT_EQ(file.take<std::int32_t>(), 1);
  file.expect("\n$EndMeshFormat\n$Comments\n");
  msh.comments = file.until("$EndComments\n");
  file.expect("$PhysicalNames\n");
  const int names = std::stoi(file.line());
  for (int i = 0; i < names; ++i) {
    const int dimension = std::stoi(file.until(" "));
    const int group = std::stoi(file.until(" \""));
    msh.names[{dimension, group}] = file.until("\"\n");
  }
  file.expect("$EndPhysicalNames\n$Entities\n");
  const auto counts = file.take<std::uint64_t>(4);
  EXPECT_EQ(counts[0], 0U);
  EXPECT_EQ(counts[1], 0U);
  for (int dimension : {2, 3})
    for (std::uint64_t i = 0; i < counts[static_cast<std::size_t>(dimension)]; ++i) {
      const int number = file.take<std::int32_t>();
      msh.entities[{dimension, number}] = read_entity(file);
    }
  file.expect("\n$EndEntities\n");
  read_nodes(file, msh);
  read_elements(file, msh);
  EXPECT_EQ(file.left(), 0U);
  return msh;
}

class MshFormat : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder;
};

TEST_F(MshFormat, HoldsTheVolumeAndItsTaggedBoundary) {
  const auto& city = testing::formats_city();
  write_msh(folder / "volume.msh", city.city.mesh, city.boundary, city.placement);
  const Msh msh = read_msh(folder / "volume.msh");
  EXPECT_EQ(msh.comments, "origin 319000 6396000 0\n");

  const auto reference = testing::explicit_mesh(city.city.mesh, city.placement.shift);
  ASSERT_EQ(msh.nodes.size(), reference.points.size());
  for (std::size_t i = 0; i < reference.points.size(); ++i)
    ASSERT_EQ(msh.nodes.at(i + 1), reference.points[i]);

  const auto corners = testing::corners_of(city.boundary, city.placement.shift);
  ASSERT_EQ(msh.elements.size(), corners.size() + reference.cells.size());
  for (std::size_t f = 0; f < corners.size(); ++f) {
    const auto& [group, nodes] = msh.elements.at(f + 1);
    ASSERT_EQ(group, static_cast<int>(city.boundary.patch[f]));
    for (std::size_t i = 0; i < 3; ++i) ASSERT_EQ(msh.nodes.at(nodes[i]), corners[f][i]);
  }
  for (std::size_t c = 0; c < reference.cells.size(); ++c) {
    const auto& [group, nodes] = msh.elements.at(corners.size() + c + 1);
    ASSERT_EQ(group, kAirPhysicalGroup);
    for (std::size_t i = 0; i < 4; ++i)
      ASSERT_EQ(nodes[i], static_cast<std::uint64_t>(reference.cells[c][i]) + 1);
  }
}

TEST_F(MshFormat, GroupsAreNamedAndBounded) {
  const auto& city = testing::formats_city();
  write_msh(folder / "volume.msh", city.city.mesh, city.boundary, {});
  const Msh msh = read_msh(folder / "volume.msh");
  ASSERT_EQ(msh.names.size(), 9U);
  ASSERT_EQ(msh.entities.size(), 9U);
  for (int i = 1; i <= 8; ++i) {
    EXPECT_EQ(msh.names.at({2, i}), city.boundary.patches.of(Patch{i}).name);
    EXPECT_EQ(msh.entities.at({2, i}).groups, std::vector<std::int32_t>{i});
    EXPECT_TRUE(msh.entities.at({2, i}).boundary.empty());
  }
  EXPECT_EQ(msh.names.at({3, 9}), "air");
  const Entity& air = msh.entities.at({3, 9});
  EXPECT_EQ(air.groups, std::vector<std::int32_t>{9});
  EXPECT_EQ(air.boundary, (std::vector<std::int32_t>{1, 2, 3, 4, 5, 6, 7, 8}));
  const Bounds2& domain = city.city.city.domain;
  EXPECT_EQ(air.box[0], domain.xmin);
  EXPECT_EQ(air.box[4], domain.ymax);
  EXPECT_EQ(msh.entities.at({2, 5}).box[3], domain.xmin);  // xmin is flat
  EXPECT_EQ(msh.entities.at({2, 4}).box[2], air.box[5]);   // the top is at the top
}

TEST_F(MshFormat, PatchesWithoutFacesAreLeftOut) {
  const auto& terrain = testing::formats_terrain();
  write_msh(folder / "volume.msh", terrain.city.mesh, terrain.boundary, {});
  const Msh msh = read_msh(folder / "volume.msh");
  EXPECT_EQ(msh.entities.size(), 7U);
  EXPECT_FALSE(msh.names.contains({2, 2}));
  EXPECT_FALSE(msh.names.contains({2, 3}));
}

}  // namespace
}  // namespace tetropolis
