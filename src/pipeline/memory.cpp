#include "memory.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/system_memory.h"
#include "tetropolis/geometry/polygon.h"

#include "make_columns.h"

namespace tetropolis {

namespace {

// Measured: peak resident sizes of `mesh` on 0.4 to 100 million cells.
constexpr double kProgram = 85e6;
constexpr double kPerTriangle = 600;
constexpr double kPerCell = 2;
/// Of a mesh with a lid: measured on 0.5 to 360 million cells, with some room.
constexpr double kPerTriangleWithLid = 450;
constexpr double kPerCellWithLid = 12;
/// Points while they are sorted into the terrain: besides its nodes 18 to 20 bytes on 12 and 6
/// million, with classes and without, and some room.
constexpr double kPerPoint = 26;
/// Points while those of each building are found: the cloud, and, for each building that a point is
/// near, what extract.h needs of it while lists are made and in them.
constexpr double kPerCloudPoint = 13;
constexpr double kPerPointAtBuilding = 12;
/// Terrain while it is made and written, of sparse points: 20 measured on 16 and 64 million nodes.
constexpr double kPerTerrainNode = 20;
/// Points of a synthetic city: their own 13, twice while their arrays grow.
constexpr double kPerSyntheticPoint = 26;
/// Of the solver, with uniform layers (uniform.peak_bytes_per_node in tests/work/limits.txt).
constexpr double kPerSolverNode = 100;

/// Triangles that a corner of a footprint brings, on the cities of bench/.
constexpr double kPerCorner = 7;
/// At most, with the walls between corners: 9 to 26 of them measured on Delft and Amsterdam at 30
/// to 2 m, whose columns are those of triangles of 8 m or less.
constexpr double kMostPerCorner = 24, kPerCornerAlone = 12, kPerMetresOfSize = 96;
constexpr double kMostAtCorners = 8;

/// How far estimate_at_most may be off; and how far, if it is corrected by what is known at one
/// mesh size, at another.
constexpr double kEstimateError = 4.0 / 3;
constexpr double kScalingError = 1.1;

/// Where fewer and fewer columns go on above a lid: a third of the cells over a triangle, and
/// metres of air below the lid, which are divided as finely as the ground. 9 to 10 in all on Delft
/// at 2 to 10 m, 9 to 20 on a random city at 10 to 1.8 m, whose buildings are up to 50 m high.
constexpr double kLayersAboveLid = 7, kBelowLid = 12;
/// Cells above the lid over a triangle: 9 to 13 of those from 5 m down to 2.
constexpr double kCellsAboveLid = 13;

double bytes_of(const MeshCityOptions& options, double triangles, double cells,
                double terrain_nodes) {
  double bytes = kProgram + 8 * terrain_nodes;
  bytes += ends_at_lid(options) ? kPerTriangleWithLid * triangles + kPerCellWithLid * cells
                                : kPerTriangle * triangles + kPerCell * cells;
  if (solves_laplace(options)) bytes += kPerSolverNode * cells / 6;
  return bytes;
}

/// Buildings that a point has within the margin, in rows of houses of 10 m x 10 m with as much open
/// ground between them: as dense as cities are.
double buildings_near(double margin) {
  constexpr double kSide = 10, kPerBuilding = 2 * kSide * kSide;  // metres, square metres
  return (4 * kSide * margin + std::numbers::pi * margin * margin) / kPerBuilding;
}

std::string in_words(double bytes) {
  if (bytes >= 1e15) return fmt::format("{:.2g} GB", bytes / 1e9);
  return bytes < 1e9 ? fmt::format("{:.0f} MB", bytes / 1e6)
                     : fmt::format("{:.1f} GB", bytes / 1e9);
}

double bytes_without_mesh(const MeshCityOptions& options, const CitySize& city) {
  return bytes_of(options, 0, 0, city.terrain_nodes);
}

/// What the bytes of the mesh and the cells of an estimate are multiplied by.
struct Correction {
  double bytes, cells;
};

/// Segments of a column over triangles with edges of length h, or as many as its cells come to.
double layers_over(const MeshCityOptions& options, const CitySize& city, double h) {
  double spacing = 0.7 * h;
  if (options.layering == Layering::kUniform)
    spacing = options.layer_height > 0 ? options.layer_height : options.mesh_size;
  else if (options.layer_height > 0)
    spacing = std::min(spacing, options.layer_height);
  const double layers = std::max(1.0, city.height / spacing);
  return ends_at_lid(options) ? std::min(layers, kLayersAboveLid + kBelowLid / spacing) : layers;
}

/// The same where sizes differ by place. What has grown up to far_size scales with it; what still
/// grows differs by as much as its source.
MeshEstimate estimate_graded(const MeshCityOptions& options, const CitySize& city) {
  const double scale = options.mesh_size / city.mesh_size;
  double far_size = 0;
  for (const auto& [size, area] : city.sizes) far_size = std::max(far_size, size);
  MeshEstimate estimate;
  const auto add = [&](double triangles, double h) {
    estimate.triangles += triangles;
    estimate.cells += 3 * triangles * layers_over(options, city, h);
  };
  for (const auto& [size, area] : city.sizes) {
    const double h = size < far_size ? std::max(size + (scale - 1) * city.mesh_size, scale * size)
                                     : scale * size;
    add(area / (0.4 * h * h), h);
  }
  add(kPerCorner * city.footprint_vertices, options.mesh_size);
  estimate.bytes = bytes_of(options, estimate.triangles, estimate.cells, city.terrain_nodes);
  return estimate;
}

/// With as many triangles at walls as real cities have, and in buildings, where edges do not grow.
MeshEstimate estimate_at_most(const MeshCityOptions& options, const CitySize& city) {
  MeshEstimate estimate = estimate_mesh(options, city);
  const double h = options.mesh_size;
  const auto add = [&](double triangles, double edge) {
    estimate.triangles += triangles;
    estimate.cells += 3 * triangles * layers_over(options, city, edge);
  };
  if (!city.sizes.empty()) add(city.footprint_area / (0.4 * h * h), h);
  if (options.layering != Layering::kUniform) {
    const double most = std::min(kPerCornerAlone + kPerMetresOfSize / h, kMostPerCorner);
    add((most - kPerCorner) * city.footprint_vertices, std::min(h, kMostAtCorners));
  }
  estimate.bytes = bytes_of(options, estimate.triangles, estimate.cells, city.terrain_nodes);
  return estimate;
}

/// Throws what `begin` says, and the least mesh size that fits: other sizes stay as they are given.
[[noreturn]] void refuse(const MeshCityOptions& options, const CitySize& city,
                         const Correction& correction, const std::string& begin) {
  const SizeGrading& grading = options.grading;
  const double fixed = bytes_without_mesh(options, city);
  const auto estimate_at = [&](double mesh_size) {
    MeshCityOptions with = options;
    with.mesh_size = mesh_size;
    CitySize size = city;
    size.mesh_size = mesh_size;
    if (city.sizes_with) size.sizes = city.sizes_with(with);
    return estimate_at_most(with, size);
  };
  const auto fits = [&](double mesh_size) {
    return fixed + correction.bytes * (estimate_at(mesh_size).bytes - fixed) <= options.max_bytes;
  };
  constexpr double kCoarsest = 1e4;  // as the setting allows
  double fine = options.mesh_size, coarse = grading.far_size > 0 ? grading.far_size : kCoarsest;
  if (coarse <= fine || !fits(coarse)) {
    std::vector<std::string> raise{"max_memory", "layer_height"};
    if (grading.far_size > 0) raise.push_back("far_size");
    if (grading.ground_size > 0) raise.push_back("ground_size");
    if (!grading.regions.empty()) raise.push_back("the sizes of `refine`");
    const std::string last = raise.back();
    raise.pop_back();
    throw MeshTooLarge(fmt::format(
        "{}; no mesh size is sure to fit: raise {} or {}, or lower `bounds` or domain_height",
        begin, fmt::join(raise, ", "), last));
  }
  const double coarsest = coarse;
  while (coarse > 1.02 * fine) {
    const double middle = std::sqrt(fine * coarse);
    (fits(middle) ? coarse : fine) = middle;
  }
  coarse = std::min(std::ceil(coarse * 20) / 20, coarsest);  // in steps of five centimetres
  throw MeshTooLarge(fmt::format("{}; about {:.2g} cells fit, with mesh_size {:.2f}", begin,
                                 correction.cells * estimate_at(coarse).cells, coarse));
}

}  // namespace

void CitySize::add(const Polygon& footprint) {
  footprint_vertices += static_cast<double>(footprint.outer.size());
  footprint_area += tetropolis::area(footprint);
  for (const Ring& hole : footprint.holes) footprint_vertices += static_cast<double>(hole.size());
}

double memory_limit(double max_bytes) { return max_bytes > 0 ? max_bytes : 0.9 * usable_memory(); }

MeshEstimate estimate_mesh(const MeshCityOptions& options, const CitySize& city) {
  MeshEstimate estimate;
  if (!city.sizes.empty()) return estimate_graded(options, city);
  const double h = options.mesh_size;
  estimate.triangles = city.area / (0.4 * h * h) + kPerCorner * city.footprint_vertices;
  estimate.cells = 3 * estimate.triangles * layers_over(options, city, h);
  estimate.bytes = bytes_of(options, estimate.triangles, estimate.cells, city.terrain_nodes);
  return estimate;
}

void require_mesh_fits(const MeshCityOptions& options, const CitySize& city) {
  const double limit = options.max_bytes;
  const MeshEstimate estimate = estimate_mesh(options, city);
  if (estimate.bytes <= limit) return;
  refuse(options, city, {kEstimateError, 1},
         fmt::format("the mesh would have about {:.2g} cells and need {} of {}", estimate.cells,
                     in_words(estimate.bytes), in_words(limit)));
}

void require_cells_fit(const MeshCityOptions& options, const CitySize& city, double triangles,
                       double cells) {
  const double limit = options.max_bytes;
  if (ends_at_lid(options)) cells += kCellsAboveLid * triangles;
  const double bytes = bytes_of(options, triangles, cells, city.terrain_nodes);
  if (bytes <= limit) return;
  const double fixed = bytes_without_mesh(options, city);
  const MeshEstimate estimate = estimate_at_most(options, city);
  refuse(options, city,
         {kScalingError * (bytes - fixed) / (estimate.bytes - fixed), cells / estimate.cells},
         fmt::format("the mesh would have {:.3g} cells and need {} of {}", cells, in_words(bytes),
                     in_words(limit)));
}

void require_points_fit(const PointsSize& size, double max_bytes) {
  const double of_terrain = kPerTerrainNode * size.terrain_nodes;
  const double at_buildings =
      kPerCloudPoint + kPerPointAtBuilding * buildings_near(size.ground_margin);
  const double per_point = std::max(kPerPoint, at_buildings);
  const double bytes = kProgram + per_point * size.points + of_terrain;
  if (bytes <= max_bytes) return;
  const std::string need = in_words(bytes), limit = in_words(max_bytes);
  if (at_buildings > kPerPoint && kProgram + kPerPoint * size.points + of_terrain <= max_bytes)
    throw Error(ErrorKind::kUsage,
                fmt::format("about {:.2g} points, each within ground_margin of {:.0f} buildings "
                            "where these are dense, need {} of {}: lower ground_margin, or raise "
                            "max_memory",
                            size.points, buildings_near(size.ground_margin), need, limit));
  if (of_terrain > per_point * size.points)
    throw Error(ErrorKind::kUsage,
                fmt::format("the terrain would have about {:.2g} nodes and need {} of {}: raise "
                            "dtm_step or max_memory, or give smaller `bounds`",
                            size.terrain_nodes, need, limit));
  throw Error(ErrorKind::kUsage,
              fmt::format("the domain has about {:.2g} points, which need {} of {}; about {:.2g} "
                          "points fit: give smaller `bounds`, a thinner cloud, or a higher "
                          "max_memory",
                          size.points, need, limit,
                          std::max(0.0, (max_bytes - kProgram - of_terrain) / per_point)));
}

void require_scan_fits(double points, double max_bytes) {
  const double bytes = kProgram + kPerSyntheticPoint * points;
  if (bytes <= max_bytes) return;
  throw Error(ErrorKind::kUsage,
              fmt::format("the city would have about {:.2g} points and need {} of {}; give a "
                          "smaller `size` or a lower point_density",
                          points, in_words(bytes), in_words(max_bytes)));
}

}  // namespace tetropolis
