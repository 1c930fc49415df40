// Every check is seen to fail on a mesh broken in just that way.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tetropolis/check/check_surface.h"
#include "tetropolis/check/check_volume.h"
#include "tetropolis/io/mesh/vtk.h"
#include "tetropolis/volume/quality/cell_quality.h"

#include "check/check_ground.h"
#include "check/check_heights.h"
#include "check/check_regions.h"
#include "check/check_same_boundary.h"
#include "check/check_same_surface.h"
#include "support/small_city.h"
#include "support/test_data.h"
#include "volume/column/ground_heights.h"
#include "volume/excavate/excavate.h"

namespace tetropolis {
namespace {

bool has(const std::vector<Violation>& violations, const std::string& what) {
  return std::any_of(violations.begin(), violations.end(),
                     [&](const Violation& v) { return v.what == what; });
}

std::string names(const std::vector<Violation>& violations) {
  std::string text;
  for (const Violation& v : violations) text += v.what + " (" + v.first + "); ";
  return text;
}

constexpr double kMinimumWall = ColumnPlanOptions{}.minimum_wall;
const ExcavationSources kNotExcavated;

class CheckMesh : public ::testing::Test {
 protected:
  void SetUp() override {
    testing::TemporaryFolder folder;
    city = testing::meshed(testing::small_city(testing::hills), 12);
    write_vtu(folder / "v.vtu", city.mesh, {});
    mesh = read_vtu(folder / "v.vtu");
    surface = extract_boundary(city.mesh);
    model.domain = city.city.domain;
    for (std::size_t b = 0; b < city.city.footprints.size(); ++b) {
      Building building;
      building.id = "b" + std::to_string(b);
      building.source_ids = {building.id};
      building.footprint = city.city.footprints[b];
      building.h_ground = city.city.roofs[b] - 2.5;
      building.h_roof = city.city.roofs[b];
      model.buildings.push_back(building);
    }
  }

  testing::MeshedCity city;
  TetMesh mesh;
  SurfaceMesh surface;
  CityModel model;
};

TEST_F(CheckMesh, PassesAGoodMeshAndAgreesWithTheGeneratorsMeasures) {
  const VolumeCheck check = check_volume(mesh);
  EXPECT_TRUE(check.violations.empty()) << names(check.violations);
  const QualityHistogram quality = measure_cells(city.mesh).histogram;
  EXPECT_NEAR(check.volume, quality.volume(), 1e-9 * quality.volume());
  EXPECT_NEAR(check.min_dihedral_deg.min, quality.min_dihedral_deg(), 1e-4);
  EXPECT_NEAR(check.max_dihedral_deg, quality.max_dihedral_deg(), 1e-4);
  EXPECT_NEAR(check.min_dihedral_deg.median, quality.dihedral_quantile_deg(0.5), 0.05);
  EXPECT_NEAR(check.aspect_ratio.max / quality.max_aspect_ratio(), 1, 1e-5);
  EXPECT_TRUE(check_surface(surface).violations.empty())
      << names(check_surface(surface).violations);
  EXPECT_TRUE(check_same_boundary(mesh, check, surface).empty());
  const HeightsCheck heights =
      check_heights(surface, {0, 0, 0}, city.city.dtm, model, kMinimumWall, kNotExcavated);
  EXPECT_TRUE(heights.violations.empty()) << names(heights.violations);
  EXPECT_EQ(heights.lowered, city.plan.lowered);
}

TEST_F(CheckMesh, CitySurfaceIsOpenAtTheSidesAlone) {
  const SurfaceMesh land = city_surface(surface);
  const SurfaceCheck check = check_city_surface(land);
  EXPECT_TRUE(check.violations.empty()) << names(check.violations);
  EXPECT_FALSE(check.closed);
  EXPECT_TRUE(check.manifold);
  EXPECT_TRUE(check_same_surface(surface, land).empty());
  EXPECT_TRUE(has(check_city_surface(surface).violations, "ground faces that do not face up"));
  EXPECT_TRUE(has(check_surface(land).violations, "ground faces that do not face down"));
  EXPECT_TRUE(has(check_surface(land).violations, "open edges"));

  SurfaceMesh holed = land;
  holed.triangles.erase(holed.triangles.begin());
  holed.patch.erase(holed.patch.begin());
  holed.building.erase(holed.building.begin());
  EXPECT_TRUE(has(check_city_surface(holed).violations, "open edges"));
  EXPECT_TRUE(has(check_same_surface(surface, holed),
                  "another number of faces than ground, roofs "
                  "and walls have"));
  const char* other = "faces that are not those of ground, roofs and walls";
  EXPECT_TRUE(has(check_same_surface(surface, holed), other));
  SurfaceMesh turned = land;
  std::swap(turned.triangles[5][0], turned.triangles[5][1]);
  EXPECT_TRUE(has(check_same_surface(surface, turned), other));
  SurfaceMesh moved = land;
  moved.building.back() += 1;
  EXPECT_TRUE(has(check_same_surface(surface, moved), other));
}

TEST_F(CheckMesh, SeesInvertedCells) {
  std::swap(mesh.cells[5][0], mesh.cells[5][1]);
  const VolumeCheck check = check_volume(mesh);
  EXPECT_EQ(check.inverted, 1);
  EXPECT_TRUE(has(check.violations, "inverted cells"));
  EXPECT_TRUE(has(check.violations, "neighbouring cells that overlap"));
}

TEST_F(CheckMesh, SeesCellsTwiceAndCracks) {
  TetMesh doubled = mesh;
  doubled.cells.push_back(doubled.cells[100]);
  EXPECT_TRUE(has(check_volume(doubled).violations, "faces of more than two cells") ||
              has(check_volume(doubled).violations, "neighbouring cells that overlap"));
  TetMesh cracked = mesh;
  cracked.points.push_back(cracked.points[static_cast<std::size_t>(cracked.cells[100][0])]);
  cracked.cells[100][0] = static_cast<std::int64_t>(cracked.points.size()) - 1;
  EXPECT_TRUE(has(check_volume(cracked).violations, "coincident vertices"));
  EXPECT_GT(check_volume(cracked).boundary_faces, check_volume(mesh).boundary_faces);
}

TEST_F(CheckMesh, SeesUnusedAndNonFiniteVertices) {
  mesh.points.push_back({1e9, 0, 0});
  EXPECT_TRUE(has(check_volume(mesh).violations, "vertices without cells"));
  mesh.points.back()[2] = std::nan("");
  EXPECT_TRUE(has(check_volume(mesh).violations, "coordinates that are not finite"));
  EXPECT_TRUE(has(check_volume(TetMesh{}).violations, "no cells"));
}

TEST_F(CheckMesh, EndsOnNonFiniteVerticesWhereverTheyAre) {
  const double inf = std::numeric_limits<double>::infinity();
  const auto ground = static_cast<std::size_t>(
      std::find(surface.patch.begin(), surface.patch.end(), Patch::kGround) -
      surface.patch.begin());
  for (const double value : {std::nan(""), -std::nan(""), inf, -inf})
    for (std::size_t d = 0; d < 3; ++d) {
      SCOPED_TRACE(std::to_string(value) + " in coordinate " + std::to_string(d));
      SurfaceMesh odd = surface;
      odd.points[static_cast<std::size_t>(odd.triangles[ground][0])][d] = value;
      EXPECT_TRUE(has(check_surface(odd).violations, "coordinates that are not finite"));
      EXPECT_TRUE(
          has(check_heights(odd, {0, 0, 0}, city.city.dtm, model, kMinimumWall, kNotExcavated)
                  .violations,
              "coordinates that are not finite"));
      const VolumeCheck check = check_volume(mesh);
      EXPECT_FALSE(check_same_boundary(mesh, check, odd).empty());
      TetMesh volume = mesh;
      volume.points[static_cast<std::size_t>(check.boundary[0][0])][d] = value;
      const VolumeCheck check_of_odd = check_volume(volume);
      EXPECT_TRUE(has(check_of_odd.violations, "coordinates that are not finite"));
      EXPECT_FALSE(check_same_boundary(volume, check_of_odd, surface).empty());
      EXPECT_EQ(
          has(check_regions(volume, {0, 0, 0}, model), "cells whose coordinates are not finite"),
          d < 2);
    }
}

TEST_F(CheckMesh, ZeroIsTheSameWhateverItsSign) {
  const VolumeCheck check = check_volume(mesh);
  int changed = 0;
  for (auto& p : surface.points)
    for (double& x : p)
      if (x == 0) {
        x = -0.0;
        ++changed;
      }
  EXPECT_GT(changed, 0);
  EXPECT_TRUE(check_same_boundary(mesh, check, surface).empty());
}

TEST_F(CheckMesh, SeesSurfacesThatAreNotTheVolumesBoundary) {
  const VolumeCheck check = check_volume(mesh);
  surface.points[7][2] += 1e-6;
  EXPECT_FALSE(check_same_boundary(mesh, check, surface).empty());
}

TEST_F(CheckMesh, SeesOpenSurfacesAndFacesTurnedOver) {
  SurfaceMesh open = surface;
  open.triangles.pop_back();
  EXPECT_FALSE(check_surface(open).closed);
  EXPECT_TRUE(has(check_surface(open).violations, "open edges"));
  SurfaceMesh turned = surface;
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_FALSE(check_surface(turned).manifold);
  EXPECT_TRUE(has(check_surface(turned).violations, "ground faces that do not face down"));
  SurfaceMesh twice = surface;
  twice.triangles.push_back(twice.triangles[0]);
  twice.patch.push_back(twice.patch[0]);
  twice.building.push_back(twice.building[0]);
  EXPECT_TRUE(check_surface(twice).closed);
  EXPECT_FALSE(check_surface(twice).manifold);
}

TEST_F(CheckMesh, SeesWrongTags) {
  const auto first = [&](Patch patch) {
    return static_cast<std::size_t>(std::find(surface.patch.begin(), surface.patch.end(), patch) -
                                    surface.patch.begin());
  };
  const auto violated = [&](std::size_t face, Patch patch, int building) {
    SurfaceMesh wrong = surface;
    wrong.patch[face] = patch;
    wrong.building[face] = BuildingIndex(building);
    return names(check_surface(wrong).violations);
  };
  EXPECT_NE(violated(first(Patch::kWall), Patch::kGround, -1), "");
  EXPECT_NE(violated(first(Patch::kGround), Patch::kWall, 0), "");
  EXPECT_NE(violated(first(Patch::kWall), Patch::kWall, -1), "");
  EXPECT_NE(violated(first(Patch::kGround), Patch::kGround, 2), "");
  EXPECT_NE(violated(first(Patch::kTop), Patch::kGround, -1), "");
  EXPECT_NE(violated(first(Patch::kXMin), Patch::kXMax, -1), "");
  EXPECT_NE(violated(first(Patch::kYMin), Patch::kYMax, -1), "");
  const int other = surface.building[first(Patch::kRoof)] == 0 ? 1 : 0;
  EXPECT_NE(violated(first(Patch::kRoof), Patch::kRoof, other), "");
}

TEST_F(CheckMesh, SeesWrongRegionsAndWallsOfAnotherBuilding) {
  EXPECT_TRUE(check_regions(mesh, {0, 0, 0}, model).empty());
  for (const std::size_t c : {std::size_t{0}, mesh.region.size() - 1}) {
    TetMesh wrong = mesh;
    ++wrong.region[c];
    EXPECT_EQ(check_regions(wrong, {0, 0, 0}, model).size(), 1U);
  }
  TetMesh untold = mesh;
  untold.region.clear();
  EXPECT_TRUE(has(check_regions(untold, {0, 0, 0}, model), "no region for every cell"));
  SurfaceMesh other = surface;
  const auto wall = static_cast<std::size_t>(
      std::find(surface.patch.begin(), surface.patch.end(), Patch::kWall) - surface.patch.begin());
  other.building[wall] = BuildingIndex(other.building[wall] == 0 ? 1 : 0);
  EXPECT_TRUE(has(check_surface(other).violations,
                  "neighbouring roof and wall faces of different buildings"));
}

TEST_F(CheckMesh, SeesHeightsOffByAMillimetre) {
  SurfaceMesh moved = surface;
  for (auto& p : moved.points)
    if (p[2] == city.city.roofs[2]) p[2] += 0.001;
  EXPECT_TRUE(has(
      check_heights(moved, {0, 0, 0}, city.city.dtm, model, kMinimumWall, kNotExcavated).violations,
      "roof vertices off the roof height"));
  Raster higher = city.city.dtm;
  for (double& z : higher.values) z -= 0.001;
  EXPECT_TRUE(
      has(check_heights(surface, {0, 0, 0}, higher, model, kMinimumWall, kNotExcavated).violations,
          "ground vertices off the terrain"));
  model.buildings.pop_back();
  EXPECT_TRUE(
      has(check_heights(surface, {0, 0, 0}, city.city.dtm, model, kMinimumWall, kNotExcavated)
              .violations,
          "roofs of buildings that the city model lacks"));
}

TEST_F(CheckMesh, GroundIsLoweredAtWallsOnlyAndOnlyWhereTheyNeedIt) {
  const auto found = [&](const char* what) {
    return has(check_heights(surface, {0, 0, 0}, city.city.dtm, model, kMinimumWall, kNotExcavated)
                   .violations,
               what);
  };
  const auto first_on = [&](Patch patch) -> std::array<double, 3>& {
    for (std::size_t f = 0; f < surface.triangles.size(); ++f)
      if (surface.patch[f] == patch)
        for (const std::int32_t v : surface.triangles[f]) {
          auto& p = surface.points[static_cast<std::size_t>(v)];
          if (std::abs(p[2] - sample(city.city.dtm, {p[0], p[1]})) < 1e-9) return p;
        }
    throw std::logic_error("no such vertex on the terrain");
  };
  std::array<double, 3>& foot = first_on(Patch::kWall);
  foot[2] -= 0.5;
  EXPECT_TRUE(found("ground vertices lowered at walls that are high enough"));
  EXPECT_FALSE(found("ground vertices off the terrain"));
  EXPECT_TRUE(check_heights(surface, {0, 0, 0}, city.city.dtm, model, kMinimumWall, std::nullopt)
                  .violations.empty())
      << "walls may be toes, if it is not known which are";
  for (Building& building : model.buildings) building.h_roof = foot[2] + 1;
  EXPECT_FALSE(found("ground vertices lowered at walls that are high enough"));
  foot[2] += 1;
  EXPECT_TRUE(found("ground vertices off the terrain")) << "raised at a wall";
}

/// The difference of roof and ground is the minimum, but for a rounding error.
TEST(CheckHeights, WhetherGroundWasLoweredByARoundingErrorIsLeftOpen) {
  testing::SmallCity city;
  city.footprints = {testing::rectangle(50, 40, 62, 52)};
  city.roofs = {1.9};
  city.dtm = testing::raster_of(city.domain, [](double, double) { return 0.9; });
  GroundMesh ground = mesh_ground(city.footprints, city.domain, {6, 25});
  ColumnPlanOptions options;
  options.domain_height = 60;
  options.fit_lowered_walls = false;
  const ColumnPlan plan =
      plan_columns(ground, city.dtm, city.roofs, column_spacing(ground), options);
  EXPECT_GT(plan.lowered, 0);
  EXPECT_LT(plan.deepest, 1e-15);
  EdgeGraph edges = build_edge_graph(ground);
  ColumnMesh mesh = divide_columns(std::move(ground), std::move(edges), plan);
  place_nodes(mesh, plan);
  CityModel model;
  model.buildings.resize(1);
  model.buildings[0].footprint = city.footprints[0];
  model.buildings[0].h_roof = city.roofs[0];
  const SurfaceMesh surface = extract_boundary(mesh);
  const auto check = [&](double minimum_wall) {
    return check_heights(surface, {0, 0, 0}, city.dtm, model, minimum_wall, kNotExcavated);
  };
  EXPECT_EQ(check(kMinimumWall).lowered, 0);
  EXPECT_GE(check(kMinimumWall).perhaps_lowered, plan.lowered);
  EXPECT_TRUE(check(kMinimumWall).violations.empty());
  EXPECT_EQ(check(kMinimumWall - 1e-5).perhaps_lowered, 0);
}

/// Terrain excavated from the roof of a house of 6 m, 10 m below the terrain around it, or, with no
/// house near, from one vertex; and, more steeply, from another vertex far off.
struct ExcavatedCity {
  testing::SmallCity city;
  ColumnPlan plan;
  ExcavationSources from;
  SurfaceMesh surface;
  CityModel model;

  explicit ExcavatedCity(bool at_roof) {
    city.footprints = {at_roof ? testing::rectangle(50, 40, 62, 52)
                               : testing::rectangle(5, 5, 12, 12)};
    city.roofs = {at_roof ? 6.0 : 30.0};
    city.dtm = testing::raster_of(city.domain, [](double, double) { return 16.0; });
    GroundMesh ground = mesh_ground(city.footprints, city.domain, {6, 25});
    ExcavationMarks marks, steep_marks;
    const std::vector<double> none(ground.vertices.size(), std::numeric_limits<double>::infinity());
    if (at_roof) {
      marks.roofs = {1};
    } else {
      marks.toes = none;
      marks.toes[nearest(ground, {56, 46})] = 4;
    }
    steep_marks.toes = none;
    steep_marks.toes[nearest(ground, {104, 74})] = -8;
    const std::vector<RegionIndex> building = lowest_roofs(ground, city.roofs);
    std::vector<double> excavated = terrain_under(ground, city.dtm);
    from = excavate(ground, building, city.roofs, marks, {}, excavated);
    const ExcavationSources steep =
        excavate(ground, building, city.roofs, steep_marks, {std::tan(75 * kDegree)}, excavated);
    from.roof_slopes_deg.assign(from.roofs.size(), 56);
    from.toe_slopes_deg.assign(from.toes.size(), 56);
    from.toes.push_back(steep.toes.at(0));
    from.toe_slopes_deg.push_back(75);
    ColumnPlanOptions options;
    options.domain_height = 60;
    options.excavated = excavated;
    plan = plan_columns(ground, city.dtm, city.roofs, column_spacing(ground), options);
    EdgeGraph edges = build_edge_graph(ground);
    ColumnMesh mesh = divide_columns(std::move(ground), std::move(edges), plan);
    place_nodes(mesh, plan);
    surface = extract_boundary(mesh);
    model.buildings.resize(1);
    model.buildings[0].footprint = city.footprints[0];
    model.buildings[0].h_roof = city.roofs[0];
  }

  static constexpr double kDegree = std::numbers::pi / 180;

  static std::size_t nearest(const GroundMesh& ground, Point2 p) {
    std::size_t best = 0;
    const auto off = [&](std::size_t v) {
      return std::hypot(ground.vertices[v].x - p.x, ground.vertices[v].y - p.y);
    };
    for (std::size_t v = 1; v < ground.vertices.size(); ++v)
      if (off(v) < off(best)) best = v;
    return best;
  }
  HeightsCheck check(const std::optional<ExcavationSources>& with) const {
    return check_heights(surface, {0, 0, 0}, city.dtm, model, kMinimumWall, with);
  }
  bool is_off(const std::optional<ExcavationSources>& with) const {
    return has(check(with).violations, "ground vertices off the terrain");
  }
  /// With other slopes, for the gentle source and the steep one.
  bool is_off(double gentle_deg, double steep_deg) const {
    ExcavationSources other = from;
    other.roof_slopes_deg.assign(other.roofs.size(), gentle_deg);
    other.toe_slopes_deg.assign(other.toes.size(), gentle_deg);
    other.toe_slopes_deg.back() = steep_deg;
    return is_off(other);
  }
};

TEST(CheckHeights, GroundIsExcavatedAsFarAsReportedAndNoFurther) {
  for (const bool at_roof : {true, false}) {
    SCOPED_TRACE(at_roof ? "roof" : "toe");
    ExcavatedCity city(at_roof);
    EXPECT_EQ(city.from.roofs.size(), at_roof ? 1U : 0U);
    EXPECT_EQ(city.from.toes.size(), at_roof ? 1U : 2U);
    const HeightsCheck sound = city.check(city.from);
    EXPECT_TRUE(sound.violations.empty()) << names(sound.violations);
    EXPECT_EQ(sound.lowered, city.plan.lowered);
    EXPECT_GT(sound.lowered, 5);
    EXPECT_FALSE(city.is_off(56, 75));
    EXPECT_TRUE(city.is_off(71, 75)) << "deeper than from a steeper slope";
    EXPECT_TRUE(city.is_off(36, 75)) << "not as deep as from a gentler one";
    EXPECT_TRUE(city.is_off(56, 56)) << "each source has its own slope";
    EXPECT_TRUE(city.is_off(75, 75));
    EXPECT_TRUE(city.is_off(ExcavationSources{}));
    EXPECT_TRUE(city.is_off(
        ExcavationSources{{kNoBuilding, BuildingIndex(7)}, {{56, 46.5, 4}}, {56, 56}, {56}}))
        << "from elsewhere";
    // A single vertex that is lower than all around it could be the toe of nothing.
    EXPECT_TRUE(city.is_off(std::nullopt));
    int changed = 0;
    for (auto& p : city.surface.points) {
      const bool on_wall = at_roof && p[0] >= 50 && p[0] <= 62 && p[1] >= 40 && p[1] <= 52;
      if (on_wall || p[2] < 5.5 || p[2] > 15 || p[0] > 85) continue;
      const double z = p[2];
      p[2] = z - 0.001;
      EXPECT_TRUE(city.is_off(city.from));
      p[2] = z + 0.001;
      EXPECT_TRUE(city.is_off(city.from)) << "too little";
      p[2] = z;
      ++changed;
      break;
    }
    EXPECT_EQ(changed, 1);
  }
}

/// From a roof, without a report.
TEST(CheckHeights, GroundIsExcavatedFromAnywhereIfNobodyKnows) {
  ExcavatedCity city(true);
  // Fills the other pit.
  for (auto& p : city.surface.points)
    if (p[0] > 85 && p[2] < 16) p[2] = 16;
  EXPECT_FALSE(city.is_off(std::nullopt));
  int changed = 0;
  for (auto& p : city.surface.points) {
    const bool on_wall = p[0] >= 50 && p[0] <= 62 && p[1] >= 40 && p[1] <= 52;
    if (on_wall || p[2] < 4.5 || p[2] > 15) continue;
    const double z = p[2];
    p[2] = z - 12;
    EXPECT_TRUE(city.is_off(std::nullopt));
    p[2] = 16.001;
    EXPECT_TRUE(city.is_off(std::nullopt)) << "raised";
    p[2] = z;
    ++changed;
    break;
  }
  EXPECT_EQ(changed, 1);
}

}  // namespace
}  // namespace tetropolis
