// report.json: the keys that outside tools rely on, and its numbers against the files it is about.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/mesh/vtk.h"
#include "tetropolis/io/raster/geotiff.h"
#include "tetropolis/run/config.h"
#include "tetropolis/run/run.h"
#include "tetropolis/terrain/raster.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/tet_mesh.h"

#include "support/bytes.h"
#include "support/shapes.h"
#include "support/test_data.h"
#include "village.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::Village;
using Vector = std::array<double, 3>;

enum class Type { kNumber, kText, kTruth, kList, kMap };

struct Key {
  std::string_view path;  ///< "a.b[].c": of every element of the list b.
  Type type;
};

/// What is promised to outside tools. Names may be added here, never changed.
constexpr Key kContract[] = {
    {"version", Type::kText},
    {"command", Type::kText},
    {"started", Type::kText},
    {"config", Type::kMap},
    {"origin", Type::kList},
    {"origin[]", Type::kNumber},
    {"crs", Type::kText},
    {"steps", Type::kList},
    {"steps[].id", Type::kText},
    {"steps[].name", Type::kText},
    {"steps[].seconds", Type::kNumber},
    {"steps[].cpu_seconds", Type::kNumber},
    {"peak_rss_bytes", Type::kNumber},
    {"threads", Type::kNumber},
    {"place.longitude", Type::kNumber},
    {"place.latitude", Type::kNumber},
    {"place.area", Type::kText},
    {"preflight.overlap", Type::kNumber},
    {"preflight.points_per_m2", Type::kNumber},
    {"preflight.footprints", Type::kNumber},
    {"preflight.footprints_with_points", Type::kNumber},
    {"input.points_read", Type::kNumber},
    {"input.points_kept", Type::kNumber},
    {"input.points_by_class", Type::kMap},
    {"input.points_by_class.2", Type::kNumber},
    {"input.footprints_read", Type::kNumber},
    {"city.raw_buildings", Type::kNumber},
    {"city.buildings", Type::kNumber},
    {"city.merged_groups", Type::kNumber},
    {"city.dropped", Type::kList},
    {"city.dropped[].source_id", Type::kText},
    {"city.dropped[].reason", Type::kText},
    {"city.account.features", Type::kNumber},
    {"city.account.further_parts", Type::kNumber},
    {"city.account.kept", Type::kNumber},
    {"city.account.merged", Type::kNumber},
    {"city.account.unusable", Type::kNumber},
    {"city.account.outside", Type::kNumber},
    {"city.account.unlisted", Type::kNumber},
    {"city.account.boundary", Type::kNumber},
    {"city.account.too_small", Type::kNumber},
    {"city.account.too_narrow", Type::kNumber},
    {"city.min_clearance", Type::kNumber},
    {"ground_mesh.vertices", Type::kNumber},
    {"ground_mesh.triangles", Type::kNumber},
    {"ground_mesh.min_angle_deg", Type::kNumber},
    {"ground_mesh.small_input_angles", Type::kNumber},
    {"ground_mesh.shortest_edge", Type::kNumber},
    {"ground_mesh.longest_edge", Type::kNumber},
    {"volume_mesh.vertices", Type::kNumber},
    {"volume_mesh.cells", Type::kNumber},
    {"volume_mesh.layers", Type::kNumber},
    {"volume_mesh.volume", Type::kNumber},
    {"volume_mesh.inverted", Type::kNumber},
    {"volume_mesh.min_vertical_gap", Type::kNumber},
    {"volume_mesh.ground_lowered", Type::kNumber},
    {"volume_mesh.roofs_cut_back", Type::kList},
    {"volume_mesh.roof_cut_slopes_deg", Type::kList},
    {"volume_mesh.feet_cut_back", Type::kList},
    {"volume_mesh.foot_cut_slopes_deg", Type::kList},
    {"volume_mesh.dihedral_deg.min", Type::kNumber},
    {"volume_mesh.dihedral_deg.p0_01", Type::kNumber},
    {"volume_mesh.dihedral_deg.p0_1", Type::kNumber},
    {"volume_mesh.dihedral_deg.p1", Type::kNumber},
    {"volume_mesh.dihedral_deg.median", Type::kNumber},
    {"volume_mesh.dihedral_deg.max", Type::kNumber},
    {"volume_mesh.aspect_ratio.median", Type::kNumber},
    {"volume_mesh.aspect_ratio.p99", Type::kNumber},
    {"volume_mesh.aspect_ratio.max", Type::kNumber},
    {"surface_mesh.triangles", Type::kNumber},
    {"surface_mesh.closed", Type::kTruth},
    {"surface_mesh.manifold", Type::kTruth},
    {"surface_mesh.faces_by_patch.ground", Type::kNumber},
    {"surface_mesh.faces_by_patch.roof", Type::kNumber},
    {"surface_mesh.faces_by_patch.wall", Type::kNumber},
    {"surface_mesh.faces_by_patch.top", Type::kNumber},
    {"surface_mesh.faces_by_patch.xmin", Type::kNumber},
    {"surface_mesh.faces_by_patch.xmax", Type::kNumber},
    {"surface_mesh.faces_by_patch.ymin", Type::kNumber},
    {"surface_mesh.faces_by_patch.ymax", Type::kNumber},
    {"solver", Type::kList},
    {"solver[].step", Type::kText},
    {"solver[].unknowns", Type::kNumber},
    {"solver[].iterations", Type::kNumber},
    {"solver[].relative_residual", Type::kNumber},
    {"solver[].converged", Type::kTruth},
    {"files", Type::kList},
    {"files[]", Type::kText},
    {"warnings", Type::kList},
    {"warnings[].code", Type::kText},
    {"warnings[].count", Type::kNumber},
    {"warnings[].message", Type::kText},
};

bool has_type(const Json& value, Type type) {
  switch (type) {
    case Type::kNumber:
      return value.is_number();
    case Type::kText:
      return value.is_string();
    case Type::kTruth:
      return value.is_boolean();
    case Type::kList:
      return value.is_array();
    case Type::kMap:
      return value.is_object();
  }
  return false;
}

/// Whether `path` leads to at least one value, and all it leads to are of the type.
bool holds(const Json& value, std::string_view path, Type type) {
  if (path.empty()) return has_type(value, type);
  if (path.starts_with('.')) path.remove_prefix(1);
  if (path.starts_with("[]"))
    return value.is_array() && !value.empty() &&
           std::all_of(value.begin(), value.end(),
                       [&](const Json& element) { return holds(element, path.substr(2), type); });
  const std::size_t end = std::min(path.find_first_of(".["), path.size());
  const std::string name(path.substr(0, end));
  return value.is_object() && value.contains(name) && holds(value[name], path.substr(end), type);
}

Vector operator-(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Vector& a) { return std::sqrt(dot(a, a)); }
double degrees_between(const Vector& a, const Vector& b) {
  return std::atan2(length(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi;
}

/// Shapes of all cells, the plain way.
struct Shapes {
  std::vector<double> least_dihedral, aspect;  ///< Per cell, sorted.
  double greatest_dihedral = 0, volume = 0, least_vertical = 1e9;
  std::int64_t not_positive = 0;
};

Shapes shapes_of(const TetMesh& mesh) {
  Shapes shapes;
  for (const auto& cell : mesh.cells) {
    std::array<Vector, 4> p;
    for (std::size_t i = 0; i < 4; ++i) p[i] = mesh.points[static_cast<std::size_t>(cell[i])];
    const double volume = dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]) / 6;
    shapes.volume += volume;
    if (volume <= 0) ++shapes.not_positive;
    double least = 180, longest = 0, area = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) {
        const Vector edge = p[j] - p[i];
        longest = std::max(longest, length(edge));
        if (edge[0] == 0 && edge[1] == 0)
          shapes.least_vertical = std::min(shapes.least_vertical, std::abs(edge[2]));
        // Between the parts across the edge of the ways to the two other corners.
        std::array<Vector, 2> across;
        for (std::size_t k = 0, n = 0; k < 4; ++k) {
          if (k == i || k == j) continue;
          const Vector way = p[k] - p[i];
          const double share = dot(way, edge) / dot(edge, edge);
          across[n++] = way - Vector{share * edge[0], share * edge[1], share * edge[2]};
        }
        const double angle = degrees_between(across[0], across[1]);
        least = std::min(least, angle);
        shapes.greatest_dihedral = std::max(shapes.greatest_dihedral, angle);
      }
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector& a = p[(i + 1) % 4];
      area += length(cross(p[(i + 2) % 4] - a, p[(i + 3) % 4] - a)) / 2;
    }
    shapes.least_dihedral.push_back(least);
    shapes.aspect.push_back(longest / (2 * std::sqrt(6.0) * 3 * volume / area));
  }
  std::sort(shapes.least_dihedral.begin(), shapes.least_dihedral.end());
  std::sort(shapes.aspect.begin(), shapes.aspect.end());
  return shapes;
}

/// The least value that a share of the sorted ones does not exceed.
double quantile(const std::vector<double>& sorted, double share) {
  const double rank = std::ceil(share * static_cast<double>(sorted.size()));
  return sorted[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

/// The least distance between vertices, and from vertices to edges that are not theirs.
double clearance_of(const CityModel& model) {
  const Bounds2& box = model.domain.bounds();
  std::vector<Ring> rings{
      {{box.xmin, box.ymin}, {box.xmax, box.ymin}, {box.xmax, box.ymax}, {box.xmin, box.ymax}}};
  for (const Building& building : model.buildings) {
    rings.push_back(building.footprint.outer);
    for (const Ring& hole : building.footprint.holes) rings.push_back(hole);
  }
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t r = 0; r < rings.size(); ++r)
    for (std::size_t i = 0; i < rings[r].size(); ++i)
      for (std::size_t s = 0; s < rings.size(); ++s)
        for (std::size_t j = 0; j < rings[s].size(); ++j) {
          const std::size_t next = (j + 1) % rings[s].size();
          const Point2 p = rings[r][i], a = rings[s][j], b = rings[s][next];
          if (r != s || i != j) least = std::min(least, std::hypot(p.x - a.x, p.y - a.y));
          if (r == s && (i == j || i == next)) continue;
          const double dx = b.x - a.x, dy = b.y - a.y;
          const double t =
              std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
          least = std::min(least, std::hypot(a.x + t * dx - p.x, a.y + t * dy - p.y));
        }
  return least;
}

/// A village with something of everything that the report counts.
class ReportContract : public ::testing::TestWithParam<Layering> {
 protected:
  ReportContract() {
    village.cloud.push_back(50.25, 35.25, 90, kHighNoise);
    village.cloud.push_back(50.75, 35.25, 14, kWater);
    village.cloud.push_back(52.25, 35.25, 12, kGround);
    village.flags.assign(village.cloud.size(), 0);
    village.flags.back() = kWithheldPoint;
    // Behind one building the ground rises above the roof.
    for (std::size_t p = 0; p < village.cloud.size(); ++p)
      if (village.cloud.classification[p] == kGround && std::abs(village.cloud.y[p] - 45) < 7)
        village.raise(p, std::clamp(2 * (village.cloud.x[p] - 62), 0.0, 12.0));
    Config config;
    config.id_attribute = "id";
    config.layering = GetParam();
    config.threads = 2;
    config.min_building_area = 70;  // the annex and the hall are one, the shed goes
    village.footprints[Village::kUnseen] = testing::rectangle(75, 60, 80, 70);
    village.write(scratch.path(), config);
    report = run_build(config);
    out = config.out;
    text = testing::bytes_of(out / "report.json");
    json = Json::parse(text);
  }

  Village village;
  testing::TemporaryFolder scratch;
  Report report;
  fs::path out;
  std::string text;
  Json json;
};

TEST_P(ReportContract, KeysAndTypesAreThosePromised) {
  for (const Key& key : kContract) EXPECT_TRUE(holds(json, key.path, key.type)) << key.path;
  EXPECT_EQ(json["origin"].size(), 3U);
}

TEST_P(ReportContract, TheFileIsWhatTheCallReturned) {
  EXPECT_EQ(text, to_json(report));
  EXPECT_EQ(json["command"], "build");
  EXPECT_EQ(json["crs"], "EPSG:28992");
  EXPECT_EQ(json["threads"], 2);
  EXPECT_GT(json["peak_rss_bytes"].get<double>(), 1e6);
  EXPECT_LT(json["peak_rss_bytes"].get<double>(), 1e11);
  for (const ConfigField& field : config_fields())
    EXPECT_TRUE(json["config"].contains(field.name)) << field.name;
  EXPECT_EQ(json["config"]["layering"], GetParam() == Layering::kUniform ? "uniform" : "graded");
  EXPECT_EQ(json["config"]["min_building_area"], 70);
}

TEST_P(ReportContract, InputIsCountedAsWritten) {
  const Json& input = json["input"];
  // By default points matter up to 40 m from the footprints.
  Bounds2 box = Bounds2::nothing();
  for (const Polygon& footprint : village.footprints) box.extend(bounds(footprint));
  box = box.grown(40);
  std::map<std::string, std::int64_t> by_class;
  std::int64_t kept = 0;
  for (std::size_t p = 0; p < village.cloud.size(); ++p) {
    const std::uint8_t code = village.cloud.classification[p];
    if (code == kHighNoise || village.flags[p] != 0) continue;
    if (!box.contains({village.cloud.x[p], village.cloud.y[p]})) continue;
    ++kept;
    ++by_class[std::to_string(code)];
  }
  EXPECT_EQ(input["points_read"], village.cloud.size());
  EXPECT_EQ(input["points_kept"], kept);
  EXPECT_LT(kept + 2, static_cast<std::int64_t>(village.cloud.size()));  // some lie outside
  EXPECT_EQ(input["points_by_class"], Json(by_class));
  EXPECT_EQ(input["footprints_read"], village.footprints.size());
}

TEST_P(ReportContract, CityIsCountedAsWritten) {
  const CityModel raw = read_city(out / "city_raw.city.json");
  const CityModel model = read_city(out / "city.city.json");
  const Json& city = json["city"];
  EXPECT_EQ(city["raw_buildings"], raw.buildings.size());
  EXPECT_EQ(city["buildings"], model.buildings.size());
  EXPECT_EQ(city["merged_groups"],
            std::count_if(model.buildings.begin(), model.buildings.end(),
                          [](const Building& b) { return b.source_ids.size() > 1; }));
  EXPECT_GE(city["merged_groups"], 2);
  EXPECT_NEAR(city["min_clearance"].get<double>(), clearance_of(model), 1e-9);
  std::multiset<std::string> accounted;
  for (const Building& building : model.buildings)
    accounted.insert(building.source_ids.begin(), building.source_ids.end());
  for (const Json& dropped : city["dropped"]) {
    accounted.insert(dropped["source_id"].get<std::string>());
    EXPECT_NE(dropped["reason"], "");
  }
  EXPECT_EQ(accounted, std::multiset<std::string>(village.ids.begin(), village.ids.end()));
  EXPECT_EQ(json["origin"], Json({model.origin.x, model.origin.y, 0.0}));
}

TEST_P(ReportContract, GroundMeshIsTheOneBelowTheVolume) {
  const TetMesh volume = read_vtu(out / "volume.vtu");
  const SurfaceMesh surface = read_vtp(out / "boundary.vtp");
  const Json& ground = json["ground_mesh"];
  std::set<std::pair<double, double>> columns;
  for (const Vector& p : volume.points) columns.emplace(p[0], p[1]);
  EXPECT_EQ(ground["vertices"], columns.size());
  // Ground and roofs, which are flat, have them all.
  std::int64_t triangles = 0;
  double least = 180, shortest = 1e9, longest = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (surface.patch[t] != Patch::kGround && surface.patch[t] != Patch::kRoof) continue;
    ++triangles;
    std::array<Vector, 3> p;
    for (std::size_t i = 0; i < 3; ++i) {
      p[i] = surface.points[static_cast<std::size_t>(surface.triangles[t][i])];
      p[i][2] = 0;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector along = p[(i + 1) % 3] - p[i];
      least = std::min(least, degrees_between(along, p[(i + 2) % 3] - p[i]));
      const double edge = length(along);
      shortest = std::min(shortest, edge);
      longest = std::max(longest, edge);
    }
  }
  EXPECT_EQ(ground["triangles"], triangles);
  EXPECT_NEAR(ground["min_angle_deg"].get<double>(), least, 1e-6);
  EXPECT_NEAR(ground["shortest_edge"].get<double>(), shortest, 1e-9);
  EXPECT_NEAR(ground["longest_edge"].get<double>(), longest, 1e-9);
}

TEST_P(ReportContract, VolumeMeshIsTheOneWritten) {
  const TetMesh mesh = read_vtu(out / "volume.vtu");
  const Json& volume = json["volume_mesh"];
  EXPECT_EQ(volume["vertices"], mesh.points.size());
  EXPECT_EQ(volume["cells"], mesh.cells.size());
  const Shapes shapes = shapes_of(mesh);
  EXPECT_EQ(volume["inverted"], shapes.not_positive);
  EXPECT_EQ(shapes.not_positive, 0);
  EXPECT_NEAR(volume["volume"].get<double>(), shapes.volume, 1e-9 * shapes.volume);
  EXPECT_NEAR(volume["min_vertical_gap"].get<double>(), shapes.least_vertical, 1e-9);
  const Json& dihedral = volume["dihedral_deg"];
  EXPECT_NEAR(dihedral["min"].get<double>(), shapes.least_dihedral.front(), 1e-6);
  EXPECT_NEAR(dihedral["max"].get<double>(), shapes.greatest_dihedral, 1e-6);
  const std::map<std::string, double> shares{
      {"p0_01", 1e-4}, {"p0_1", 1e-3}, {"p1", 1e-2}, {"median", 0.5}};
  for (const auto& [name, share] : shares)
    EXPECT_NEAR(dihedral[name].get<double>(), quantile(shapes.least_dihedral, share), 0.011)
        << name;
  const Json& aspect = volume["aspect_ratio"];
  for (const auto& [name, share] : std::map<std::string, double>{{"median", 0.5}, {"p99", 0.99}}) {
    const double expected = quantile(shapes.aspect, share);
    EXPECT_NEAR(aspect[name].get<double>(), expected, 1.1e-3 * expected) << name;
  }
  EXPECT_NEAR(aspect["max"].get<double>(), shapes.aspect.back(), 1e-6 * shapes.aspect.back());
}

TEST_P(ReportContract, LoweredGroundIsBelowTheTerrain) {
  const SurfaceMesh surface = read_vtp(out / "boundary.vtp");
  const Raster dtm = read_raster(out / "dtm.tif", report.origin).raster;
  std::set<std::int32_t> lowered;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (surface.patch[t] != Patch::kGround) continue;
    for (const std::int32_t v : surface.triangles[t]) {
      const auto& [x, y, z] = surface.points[static_cast<std::size_t>(v)];
      const double terrain = sample(dtm, {x, y});
      if (z < terrain - 1e-9)
        lowered.insert(v);
      else
        EXPECT_NEAR(z, terrain, 1e-9);
    }
  }
  EXPECT_FALSE(lowered.empty());
  EXPECT_EQ(json["volume_mesh"]["ground_lowered"], lowered.size());
}

TEST_P(ReportContract, SurfaceMeshIsTheOneWritten) {
  const SurfaceMesh surface = read_vtp(out / "boundary.vtp");
  const Json& json_surface = json["surface_mesh"];
  EXPECT_EQ(json_surface["triangles"], surface.triangles.size());
  std::map<std::string, std::int64_t> by_patch;
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;  // directed
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    ++by_patch[surface.patch_of(t).name];
    const auto& triangle = surface.triangles[t];
    for (std::size_t i = 0; i < 3; ++i) ++edges[{triangle[i], triangle[(i + 1) % 3]}];
  }
  EXPECT_EQ(json_surface["faces_by_patch"], Json(by_patch));
  bool closed = true, manifold = true;
  for (const auto& [edge, count] : edges) {
    closed = closed && edges.contains({edge.second, edge.first});
    manifold = manifold && count == 1;
  }
  EXPECT_EQ(json_surface["closed"], closed);
  EXPECT_EQ(json_surface["manifold"], manifold);
  EXPECT_TRUE(closed && manifold);
}

TEST_P(ReportContract, SolverTellsOfBothSmoothings) {
  const Json& solver = json["solver"];
  ASSERT_EQ(solver.size(), 2U);
  EXPECT_EQ(solver[0]["step"], "3.3");
  EXPECT_EQ(solver[1]["step"], "3.5");
  std::set<std::string> ids;
  for (const Json& step : json["steps"]) {
    ids.insert(step["id"].get<std::string>());
    EXPECT_GE(step["seconds"].get<double>(), 0);
    EXPECT_GE(step["cpu_seconds"].get<double>(), 0);
  }
  EXPECT_EQ(ids,
            (std::set<std::string>{"1.1", "1.2", "1.3", "1.4", "1.5", "1.6", "1.7", "2.1", "2.2",
                                   "2.3", "2.4", "3.1", "3.2", "3.3", "3.4", "3.5", "3.6"}));
  if (GetParam() == Layering::kGraded) {
    for (const Json& step : solver) {
      EXPECT_EQ(step["unknowns"], 0);
      EXPECT_EQ(step["iterations"], 0);
    }
    return;
  }
  // Free are the nodes of a column but for its lowest, its highest and, at walls, that of the roof.
  const TetMesh mesh = read_vtu(out / "volume.vtu");
  const SurfaceMesh surface = read_vtp(out / "boundary.vtp");
  std::map<std::pair<double, double>, std::int64_t> columns;
  for (const Vector& p : mesh.points) ++columns[{p[0], p[1]}];
  std::set<std::pair<double, double>> walls;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    if (surface.patch[t] == Patch::kWall)
      for (const std::int32_t v : surface.triangles[t]) {
        const Vector& p = surface.points[static_cast<std::size_t>(v)];
        walls.emplace(p[0], p[1]);
      }
  std::int64_t layers = 0;
  for (const auto& [place, nodes] : columns) layers = std::max(layers, nodes - 1);
  EXPECT_EQ(json["volume_mesh"]["layers"], layers);
  const auto count = [](const auto& set) { return static_cast<std::int64_t>(set.size()); };
  EXPECT_EQ(solver[0]["unknowns"], count(columns) * (layers - 1));
  EXPECT_EQ(solver[1]["unknowns"], count(mesh.points) - 2 * count(columns) - count(walls));
  for (const Json& step : solver) {
    EXPECT_GT(step["iterations"].get<int>(), 0);
    EXPECT_TRUE(step["converged"].get<bool>());
    EXPECT_LE(step["relative_residual"].get<double>(), Config{}.solver_tolerance);
  }
}

std::string name_of(Layering layering) {
  return layering == Layering::kUniform ? "uniform" : "graded";
}

INSTANTIATE_TEST_SUITE_P(Layerings, ReportContract,
                         ::testing::Values(Layering::kGraded, Layering::kUniform),
                         [](const auto& each) { return name_of(each.param); });

}  // namespace
}  // namespace tetropolis
