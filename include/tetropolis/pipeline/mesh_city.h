// Steps 3.1 to 3.5 in memory: from a city model and its terrain to a volume mesh and its boundary.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/steps.h"
#include "tetropolis/core/warning.h"
#include "tetropolis/ground/mesh_ground.h"
#include "tetropolis/ground/surfaces.h"
#include "tetropolis/io/file/placement.h"
#include "tetropolis/terrain/raster.h"
#include "tetropolis/volume/cell_zones.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/column/column_mesh.h"
#include "tetropolis/volume/quality/cell_quality.h"
#include "tetropolis/volume/quality/face_quality.h"
#include "tetropolis/volume/quality/prism_quality.h"

namespace tetropolis {

/// Columns spaced by the triangles around them, or the paper's layers of equal height.
enum class Layering { kGraded, kUniform };

/// A horizontal top, or one that follows the terrain.
enum class Top { kFlat, kFree };

/// Tets, or prisms over every triangle.
enum class Cells { kTets, kPrisms };

/// Messages call options as settings are called (docs/settings.md), of which these have other
/// names: `refine` (grading.regions), `size_growth` (grading.growth), `surface_layers` (surfaces),
/// `min_building_distance` (surface_clearance), `min_angle` (min_angle_deg), `boundary_layers`,
/// `first_layer` and `layer_growth` (boundary_layers), `cut_slope`, `max_memory` (max_bytes).
struct MeshCityOptions {
  double mesh_size = 10;  ///< Longest edge of the ground mesh in buildings, at walls and, without
                          ///< a grading, everywhere; metres, > 0, at most 10,000.
  SizeGrading grading = {};  ///< How edges grow away from buildings. Regions: CRS coordinates.
  std::vector<SurfaceArea> surfaces = {};  ///< Water, roads, vegetation. CRS coordinates.
  double surface_clearance = 1;  ///< Of their edges, from each other and buildings; metres, > 0.
  std::vector<Canopy> canopies = {};  ///< Trees, which become zones of cells. CRS coordinates.
  double target_cells = 0;     ///< Scales all sizes until the mesh has about so many; >= 0, 0: it
                               ///< does not.
  double min_angle_deg = 25;   ///< Of the ground mesh; 0 to 33.
  double domain_height = 100;  ///< Of the top above the highest terrain, metres, > 0.
  bool own_top = false;        ///< Rather the top that the city has, if it has one.
  Cells cells = Cells::kTets;  ///< Prisms: one ladder of layers for all columns, moved as uniform
                               ///< layers are, on boundary_layers (5 without).
  Layering layering = Layering::kGraded;
  double layer_height = 0;  ///< Greatest spacing of a column's nodes, which may be half as far
                            ///< apart again; of uniform layers their height; metres, >= 0. 0:
                            ///< follows from the mesh size.
  Top top = Top::kFlat;
  LayerHeights boundary_layers = {};  ///< Of prisms over open ground.
  double min_wall_height = 1;  ///< Metres, > 0: lower walls have the ground beside them lowered.
  double cut_slope_deg = 56;  ///< Gentlest slope to excavate terrain to where cells would otherwise
                              ///< be poor; > 0, at most 90: never.
  double min_gap_share = 0.25;  ///< Where Laplace problems are solved: least layer, as a share of
                                ///< the even spacing; in (0, 1).
  double solver_tolerance = 1e-3;  ///< Of them: by how much the error has to fall, > 0.
  int solver_iterations = 1000;    ///< At most, > 0.
  double max_bytes = 0;  ///< Memory of the process, >= 0; 0: nine tenths of usable_memory().
};

/// Whether nodes are placed by Laplace problems: in graded columns under a flat top there are none.
inline bool solves_laplace(const MeshCityOptions& options) {
  return options.layering == Layering::kUniform || options.top == Top::kFree ||
         options.cells == Cells::kPrisms;
}

/// Boundary layers where cells are prisms and none are asked for.
inline constexpr int kLayersBelowPrisms = 5;

/// Least wall where cells are prisms, metres: where layers are far thinner than those below or
/// beside them the centres of prisms lie far off, and faces are skewed.
inline constexpr double kWallOfPrisms = 2;

/// Gaps between buildings from this width on count as streets, metres.
constexpr double kStreetWidth = 10;

/// Of buildings, or of gaps: how many cells each has.
struct CellScore {
  std::int64_t count = 0;  ///< Buildings, or gaps.
  double least = 0;
  double median = 0;
  double share_of_ten = 0;  ///< Of those with ten cells or more.
};

/// How finely buildings and streets are resolved, in plan (mesh_scores.h).
struct ResolutionFacts {
  CellScore buildings;  ///< Cube root of the volume over the mean edge along the outline.
  CellScore gaps;       ///< Edges from wall to wall, of gaps from kStreetWidth on.
};

struct GroundMeshFacts {
  std::int64_t vertices = 0;
  std::int64_t triangles = 0;
  double min_angle_deg = 0;                    ///< As meshed.
  std::int64_t small_input_angles = 0;         ///< Corners of the input below the least angle.
  std::int64_t triangles_below_min_angle = 0;  ///< At them, or where the input is too fine.
  double shortest_edge = 0, longest_edge = 0;  ///< Metres.
  std::array<double, 3> surfaces = {};         ///< Area of each SurfaceKind, square metres.
  double size_scale = 1;  ///< What all sizes were multiplied by for the target number of cells.
  ResolutionFacts resolution = {};
};

struct VolumeMeshFacts {
  std::int64_t vertices = 0;
  std::int64_t cells = 0;           ///< Tets and prisms.
  std::int32_t layers = 0;          ///< Of uniform layering; else what it would have.
  double volume = 0;                ///< Of all cells, cubic metres.
  std::int64_t inverted = 0;        ///< Always 0 in a mesh that is returned.
  double min_vertical_gap = 0;      ///< Shortest vertical edge, metres.
  std::int64_t ground_lowered = 0;  ///< Vertices at walls, and around them, below the terrain.
  std::vector<BuildingIndex>
      parts_left_out;             ///< Buildings with parts, meshed as blocks, ascending.
  std::int64_t roofs_met = 0;     ///< Vertices at which two roofs were moved together by more than
                                  ///< a centimetre: they were less than 0.3 m apart, or crossed,
  double most_roofs_met = 0;      ///< by so much at most, metres.
  std::int64_t roofs_lifted = 0;  ///< Vertices at which a roof was lifted, so that walls around it
                                  ///< are a manifold,
  double most_roofs_lifted = 0;   ///< by so much at most, metres.
  std::int64_t roof_steps_closed = 0;  ///< Edges at which a roof was lifted to the next one, as
                                       ///< cells could not be fitted to the step.
  double cut_slope_deg = 0;            ///< The gentlest to which terrain was excavated;
                                       ///< without any, the option.
  std::vector<BuildingIndex> roofs_cut_back;  ///< From which it was, ascending,
  std::vector<double> roof_cut_slopes_deg;    ///< and to which slopes.
  std::vector<Point3> feet_cut_back;          ///< Slope toes from which it was, and roofs' edges
                                              ///< of buildings with several; local frame,
  std::vector<double> foot_cut_slopes_deg;    ///< and to which slopes.
  std::int64_t moved_by_guard = 0;            ///< Nodes of uniform layers that the guard moved.
  std::int64_t columns_improved = 0;          ///< Of which nodes were moved for better cells.
  double top = 0;                             ///< Elevation of the domain's top, metres.
  double dihedral_min = 0, dihedral_p0_01 = 0, dihedral_p0_1 = 0, dihedral_p1 = 0,
         dihedral_median = 0, dihedral_max = 0;  ///< Degrees; quantiles of the least in each cell.
  std::vector<std::int64_t> dihedral_counts;     ///< QualityHistogram::dihedral_counts.
  double aspect_median = 0, aspect_p99 = 0, aspect_max = 0;
  FaceQuality faces;
  std::vector<WorstCell> worst;  ///< Centres in the local frame.
  PrismQuality prisms;
};

struct SurfaceMeshFacts {
  std::int64_t triangles = 0;
  std::int64_t quads = 0;
  bool closed = false;
  bool manifold = false;
  std::vector<PatchCount> faces_by_patch;
};

struct SolverFacts {
  std::string step;  ///< "3.3" or "3.5".
  std::int64_t unknowns = 0;
  int iterations = 0;
  double relative_residual = 0;  ///< Preconditioned, over its value at the initial guess.
  bool converged = false;
};

struct CityMesh {
  ColumnMesh volume;
  SurfaceMesh boundary;
  CellZones zones;      ///< Of `volume`, one per canopy.
  Placement placement;  ///< For writers: local coordinates, with the origin beside them.
  GroundMeshFacts ground_facts;
  VolumeMeshFacts volume_facts;
  SurfaceMeshFacts surface_facts;
  std::vector<SolverFacts>
      solver;  ///< Steps 3.3 and 3.5; without unknowns where nothing is solved.
  std::vector<Warning> warnings;
  std::vector<StepTime> steps;
};

/// Meshes the domain of `city` above `terrain` and the buildings' roofs, and improves the mesh
/// until it keeps the floor of quality where that can be reached (cell_quality.h).
///
/// Preconditions: footprints are valid, and keep a clearance between each other and the domain's
/// boundary (build_city's `city` does; for others see require_meshable). `terrain`: in the city's
/// local frame, under all of the domain but for a fringe of one step; of a single node: level
/// ground everywhere.
///
/// Guarantees 3 to 6 (docs/quality.md): footprints are unions of mesh edges, every cell is
/// positive, the boundary is closed, manifold and tagged, heights are exact at vertices. `boundary`
/// is that of `volume`. The same bytes for any number of threads.
///
/// Throws Error(kUsage): options out of range, a mesh of too many layers or of more than max_bytes.
/// Error(kInput): a terrain that is none, with values that are no elevations (NaN, -9999), or not
/// under the domain. Error(kGuarantee): one cannot be met. Cancelled.
CityMesh mesh_city(const CityModel& city, Raster terrain, const MeshCityOptions& options = {},
                   const StepHooks& hooks = {});

/// Ground and roofs to look at: the columns of mesh_city by default options, with its
/// preconditions, but cells that nobody measures or improves. The mesh size is what about
/// `most_triangles` of ground and outlines allow; nullopt where none up to 50 m does. Throws
/// Error(kGuarantee), Cancelled.
std::optional<ColumnMesh> mesh_preview(const CityModel& city, const Raster& terrain,
                                       std::int64_t most_triangles, const StepHooks& hooks = {});

}  // namespace tetropolis
