// Named groups of cells: the air among the leaves of trees.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

struct ColumnMesh;

/// One-sided area of leaves per volume [1/m]: a leaf area index of 5.1, the mean of temperate
/// broadleaf forests, over a height of ten metres. Source: Asner, Scurlock & Hicke, Global
/// synthesis of leaf area index observations, Global Ecology and Biogeography 12 (2003), table 2.
inline constexpr double kLeafAreaDensity = 0.5;

/// Trees that stand close, or one.
struct Canopy {
  Polygon area;  ///< Any polygon. Of zone_cells: the mesh's frame. Of mesh_city: CRS coordinates.
  double height = 0;                            ///< Of its top above the ground, metres.
  double base = 0;                              ///< Of the lowest leaves, the same.
  double leaf_area_density = kLeafAreaDensity;  ///< [1/m]
};

struct CellZone {
  std::string name;  ///< As patches have them: "canopy_1".
  double height = 0;
  double base = 0;
  double leaf_area_density = 0;  ///< [1/m]; 0 where there are no leaves.
  std::int64_t cells = 0;        ///< May be none.
};

struct CellZones {
  std::vector<CellZone> zones;
  std::vector<std::int32_t> of_cell;  ///< Per cell, as write_vtu orders them: 0, or 1 + its zone in
                                      ///< `zones`. Empty without zones.
  bool empty() const { return zones.empty(); }
};

/// A zone per canopy, in their order: the cells whose centroid lies in its area in plan, above its
/// base and not above its top. Where canopies overlap, the first has the cell; cells over buildings
/// have none. Heights are above the ground of the mesh at the centroid; in the upper part, where
/// cells span several triangles of the ground, above the mean of the ground below their corners.
///
/// A zone is as exact as cells are small: edges of canopies are no edges of the mesh. Areas: the
/// mesh's frame. The same result for any number of threads.
CellZones zone_cells(const ColumnMesh& mesh, std::span<const Canopy> canopies);

}  // namespace tetropolis
