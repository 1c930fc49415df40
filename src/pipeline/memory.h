// How much memory points and meshes will need, told before the work. Bytes, of the whole process.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/pipeline/mesh_city.h"

namespace tetropolis {

/// Pairs of longest edge and area, square metres.
using AreasBySize = std::vector<std::pair<double, double>>;

/// What is known of a city before it is meshed.
struct CitySize {
  double area = 0;                ///< Of the domain, square metres.
  double footprint_vertices = 0;  ///< Of all rings.
  double footprint_area = 0;      ///< Square metres.
  double height = 0;              ///< Of the domain over its mean ground, metres.
  double terrain_nodes = 0;
  AreasBySize sizes = {};  ///< Of a graded mesh, at `mesh_size`.
  double mesh_size = 0;
  /// Those of other options; empty before there is a city model. Valid as long as that.
  std::function<AreasBySize(const MeshCityOptions&)> sizes_with = {};

  void add(const Polygon& footprint);
};

struct MeshEstimate {
  double triangles = 0;
  double cells = 0;
  double bytes = 0;  ///< Peak of steps 3.1 to 3.6.
};

/// Triangles, cells and peak memory to about a third. A triangle takes about 0.4 h^2 away from
/// buildings, and each corner of a footprint brings seven more (measured on the cities of
/// bench/); columns are divided about every 0.7 h.
MeshEstimate estimate_mesh(const MeshCityOptions& options, const CitySize& city);

/// What a process may take: `max_bytes`, or, if that is 0, nine tenths of usable_memory().
double memory_limit(double max_bytes);

/// A mesh that memory does not hold: kUsage.
class MeshTooLarge : public Error {
 public:
  explicit MeshTooLarge(const std::string& message) : Error(ErrorKind::kUsage, message) {}
};

/// Throws MeshTooLarge that tells cells, memory, and a mesh size that fits even if the estimate is
/// too low, or the settings that leave none, unless estimate_mesh is within options.max_bytes.
void require_mesh_fits(const MeshCityOptions& options, const CitySize& city);

/// The same for counts that are known by now. `cells`: of columns, up to the lid if they end there.
void require_cells_fit(const MeshCityOptions& options, const CitySize& city, double triangles,
                       double cells);

/// What points need besides the memory of the program.
struct PointsSize {
  double points = 0;         ///< Of the domain.
  double terrain_nodes = 0;  ///< 0: not known yet.
  double ground_margin = 1;  ///< ExtractOptions::margin.
};

/// Throws Error(kUsage) that tells the memory of the points and their terrain, unless it is within
/// `max_bytes`.
void require_points_fit(const PointsSize& size, double max_bytes);

/// Throws Error(kUsage) unless a synthetic city of so many points is within `max_bytes`.
void require_scan_fits(double points, double max_bytes);

}  // namespace tetropolis
