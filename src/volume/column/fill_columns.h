// From the ground mesh to the column mesh: how far apart nodes are, and where they go.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/ground/ground_mesh.h"
#include "tetropolis/terrain/raster.h"
#include "tetropolis/volume/column/column_mesh.h"

#include "roof_heights.h"

namespace tetropolis {

/// Tangent of 15 degrees: what a wall is to be seen under from the ground beside it. Distance is
/// told from the spacing, or the longest edge, so this is more than the 8 degrees that cells are to
/// have.
inline constexpr double kWallTangent = 0.2679491924311227;

/// Per vertex, the distance between nodes of its column, in metres, that fits the triangles around
/// it: 1.2 times the geometric mean of the longest edge at the vertex and of the edge of an
/// equilateral triangle as high as the flattest triangle there. Tets of a column are flat where
/// this is too small for the longest edge (least dihedral angle about atan(spacing / edge)) and
/// steep where it is too large for the least altitude a (about atan(a / spacing)); the mean keeps
/// both away from the extremes. The factor trades cells (fewer by its inverse) against angles.
/// Precondition: every vertex belongs to a triangle.
std::vector<double> column_spacing(const GroundMesh& ground);

/// The same at one vertex, from the least altitude of the triangles around it, in metres, and the
/// square of their longest edge at it.
double spacing_over(double altitude, double longest_squared);

/// Per vertex, how far the ground of a neighbour (across an edge of a triangle outside buildings)
/// lies above its own at most, in metres, >= 0. `ground`: elevation per vertex.
std::vector<double> ground_rise(const GroundMesh& mesh, std::span<const double> ground);

struct LayerPlan {
  std::int32_t layers = 0;
  double bottom = 0;  ///< Mean ground elevation: where the untransformed ground layer lies.
  double top = 0;     ///< Elevation of the flat top.
  double highest_ground = 0;
  bool raised = false;  ///< The top had to be raised to clear a roof.
};

/// The top is `domain_height` above `highest_ground`, or two layers above the highest roof where
/// that is higher; the layers are as many as make their mean height closest to `layer_height`, at
/// least two. `roofs`: the highest elevation of each. Metres; domain_height, layer_height > 0;
/// `ground` not empty.
LayerPlan plan_layers(std::span<const double> ground, std::span<const double> roofs,
                      double highest_ground, double domain_height, double layer_height);

/// What the columns are made from: per vertex of the ground mesh, in metres.
struct ColumnPlan {
  std::vector<double> terrain;           ///< Elevation of the terrain (terrain_under) plus `lift`.
  std::vector<double> ground;            ///< Elevation: the terrain, lowered at buried walls and
                                         ///< where it was excavated.
  std::vector<RegionIndex> lowest_roof;  ///< As from lowest_roofs.
  RoofHeights roofs;                     ///< Of building parts (regions).
  std::vector<double> top;               ///< Elevation of the top.
  std::vector<double> spacing;           ///< Distance between nodes asked for, > 0.
  std::vector<double> rise;              ///< As from ground_rise.
  std::vector<double> lift;              ///< Height of the layers below the tets' ground, which
                                         ///< `ground` is; empty: there are none.
  LayerPlan layers;                      ///< Height of the domain, and layers of uniform columns.
  std::vector<VertexIndex> eased;        ///< Where ground was lowered for prisms (ease_ground).
  std::int64_t lowered =
      0;               ///< Vertices outside buildings or on walls with ground below the terrain.
  double deepest = 0;  ///< How far, at most, in metres.
  std::int64_t undermined = 0;    ///< Buildings with ground at a wall below the lowest terrain that
                                  ///< was at their walls.
  double deepest_undermined = 0;  ///< How far, at most, in metres.

  /// Elevation of the floor of `region` of `mesh` at vertex v.
  double floor(const GroundMesh& mesh, RegionIndex region, VertexIndex v) const {
    return mesh.regions[region].is_building() ? roofs.at(region, v) : ground[v];
  }
  /// Elevation of the lowest roof at vertex v. Precondition: there is one.
  double lowest_roof_at(VertexIndex v) const { return roofs.at(lowest_roof[v], v); }
};

/// A mesh, and what it was made from.
struct Columns {
  ColumnPlan plan;
  ColumnMesh mesh;
};

struct ColumnPlanOptions {
  double domain_height = 100;     ///< Of the top above the highest terrain under the mesh,
                                  ///< metres, > 0.
  double layer_height = 10;       ///< Of uniform layers, metres, > 0.
  double minimum_wall = 1;        ///< Metres, > 0: where a wall would be lower, the ground beside
                                  ///< it is lowered (see lower_at_walls).
  bool fit_lowered_walls = true;  ///< Where the terrain beside a wall is above its roof, walls that
                                  ///< would be seen from there under less than 15 degrees (or half
                                  ///< of what is left to the vertical) count as too low, too; and
                                  ///< where the ground is lowered, they become so high, and at
                                  ///< least 0.6 of the spacing; but not higher than the building's
                                  ///< walls are somewhere, unless they are deep_walls. Otherwise
                                  ///< they have the minimum.
  std::span<const double> lift = {};  ///< Per vertex, height of the layers that lie on the terrain:
                                      ///< all else is about what lies on top of them. Walls are at
                                      ///< least wall_above_layers() higher. Empty: none.
  std::span<const double> excavated = {};  ///< Per vertex, elevation of the lifted terrain as
                                           ///< excavate() leaves it; empty: as it is.
  std::span<const std::uint8_t> deep_walls = {};  ///< Per building, 1: walls may become higher
                                                  ///< than they are anywhere. Empty: none may.
};

/// `roofs`: of the building parts of `mesh`; `spacing`: per vertex, > 0.
ColumnPlan plan_columns(const GroundMesh& mesh, const Raster& dtm, RoofHeights roofs,
                        std::vector<double> spacing, const ColumnPlanOptions& options);

/// Sets the plan's `ground` and `rise`, and what it tells of lowered vertices, by its terrain,
/// lift, roofs and spacing. `options.lift` has no say.
void plan_ground(const GroundMesh& mesh, const ColumnPlanOptions& options, ColumnPlan& plan);

/// Sets what the plan tells of vertices lowered and buildings undermined, from its elevations.
void count_lowered(const GroundMesh& mesh, double minimum_wall, ColumnPlan& plan);

/// About the cells that graded columns will have, before they are made: every segment makes a tet
/// in each of the about six triangles around it.
double estimate_cells(const ColumnPlan& plan);

/// How many nodes each column gets, and which of them are at floors; z has its size and no values.
/// Columns go from the lowest floor of the regions around them to the top, with a node at each
/// floor; floors of the same elevation share it. Each piece between two of these elevations is
/// divided into the number of segments that comes closest to the spacing, at least one. A piece
/// that begins at the foot of a cliff (the spacing is less than 0.6 of what the highest ground
/// beside rises above it) has two segments of 0.6 and 0.4 of that rise first, as far as it reaches:
/// the tets between its column and the edge of the cliff would otherwise be slivers, as atan(r) -
/// atan(r - s / d) with r = rise / d at distance d falls with r squared for a fixed spacing s.
/// Throws Error(kGuarantee) naming the vertex if the elevations do not increase.
ColumnMesh divide_columns(GroundMesh ground, EdgeGraph edges, const ColumnPlan& plan);

/// Sets z: exact at floors and top; and levels, where roofs are not all horizontal. `mesh` as made
/// by divide_columns with the same plan.
void place_nodes(ColumnMesh& mesh, const ColumnPlan& plan);

}  // namespace tetropolis
