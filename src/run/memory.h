// How much memory a mesh will need, told before the work.
#pragma once

#include "tetropolis/geometry/types.h"
#include "tetropolis/run/config.h"

namespace tetropolis {

/// Bytes the process may take: `max_memory`, or nine tenths of what the machine, the control groups
/// and the limits of the process leave it (usable_memory). Throws Error(kUsage) if the setting is
/// no size.
double memory_limit(const Config& config);

/// Bytes of "8G" or "500M". Throws Error(kUsage): not a size, or less than a megabyte.
double parse_size(const std::string& text);

/// What is known of a city before it is meshed.
struct CitySize {
  double area = 0;                ///< Of the domain, square metres.
  double footprint_vertices = 0;  ///< Of all rings.
  double height = 0;              ///< Of the domain over its mean ground, metres.
  double terrain_nodes = 0;

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
MeshEstimate estimate_mesh(const Config& config, const CitySize& city);

/// Throws Error(kUsage) that tells cells, memory, and a mesh size that fits even if the estimate is
/// a third too low, unless estimate_mesh is below the limit.
void require_mesh_fits(const Config& config, const CitySize& city);

/// The same for counts that are known by now.
void require_cells_fit(const Config& config, const CitySize& city, double triangles, double cells);

/// Throws Error(kUsage) that tells the memory of the points of the domain and its terrain, once
/// these are counted, unless it is below the limit.
void require_points_fit(const Config& config, double points, double terrain_nodes);

/// Throws Error(kUsage) unless a synthetic city of so many points fits into the machine's memory.
void require_scan_fits(double points);

}  // namespace tetropolis
