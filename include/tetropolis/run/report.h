// What a run did: the content of report.json.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/warning.h"
#include "tetropolis/run/config.h"
#include "tetropolis/volume/column/boundary.h"
#include "tetropolis/volume/quality/cell_quality.h"
#include "tetropolis/volume/quality/face_quality.h"

namespace tetropolis {

struct StepReport {
  std::string id;  ///< The paper's number: "1.1" to "3.6"; "0.1" and "0.2" of a synthetic city.
  std::string name;
  double seconds = 0;
  double cpu_seconds = 0;  ///< Of all threads together.
};

struct InputReport {
  std::int64_t point_files = 0;
  std::int64_t point_files_skipped = 0;
  std::int64_t points_read = 0;
  std::int64_t points_kept = 0;
  std::map<int, std::int64_t> points_by_class;
  std::int64_t ground_filtered = 0;  ///< Points that the ground filter found to be ground.
  std::int64_t ground_outliers = 0;  ///< Ground points left out as birds or pits.
  std::int64_t footprints_read = 0;  ///< Features of the file.
  std::int64_t footprint_parts = 0;  ///< The same with multipolygons, and what the domain
                                     ///< cuts into parts, split: what is accounted for.
};

struct CityReport {
  std::int64_t raw_buildings = 0;
  std::int64_t buildings = 0;
  std::int64_t merged_groups = 0;  ///< Buildings made of more than one input feature.
  double min_clearance = 0;  ///< Metres; between all rings. Infinity (null in JSON) without any.
  double area_before = 0;    ///< Of the union of the footprints, square metres.
  double area_after = 0;
  double area_moved = 0;          ///< Of the symmetric difference of both unions.
  double area_changed_share = 0;  ///< area_moved / area_before.
  double max_distance = 0;        ///< Between the input and output of one building, metres.
  std::int64_t hulls = 0;         ///< Buildings that are convex hulls.
  std::map<std::string, std::int64_t> resorts;  ///< Simplification: how often each was needed.
  std::map<std::string, std::int64_t> flags;    ///< Buildings with each flag.
  double dtm_empty_share = 0;  ///< Share of the terrain's nodes without a point of their own.
  double dtm_void_share = 0;   ///< Share of the domain's squares of 20 m without a ground point.
  std::vector<Dropped> dropped;
};

struct GroundMeshReport {
  std::int64_t vertices = 0;
  std::int64_t triangles = 0;
  double min_angle_deg = 0;
  std::int64_t small_input_angles = 0;
  std::int64_t triangles_below_min_angle = 0;
};

struct VolumeMeshReport {
  std::int64_t vertices = 0;
  std::int64_t cells = 0;
  std::int32_t layers = 0;  ///< Of uniform layering; else what it would have.
  double volume = 0;
  std::int64_t inverted = 0;
  double min_vertical_gap = 0;
  std::int64_t ground_lowered = 0;
  double cut_slope = 0;                       ///< Degrees: the gentlest to which terrain was
                                              ///< excavated; without any, the setting.
  std::vector<BuildingIndex> roofs_cut_back;  ///< From which it was, ascending,
  std::vector<double> roof_cut_slopes;        ///< and to which slopes, degrees.
  std::vector<Point3> feet_cut_back;          ///< Slope toes from which it was, in the local frame,
  std::vector<double> foot_cut_slopes;        ///< and to which slopes, degrees.
  std::int64_t moved_by_guard = 0;
  std::int64_t columns_improved = 0;  ///< By improve_columns.
  double top = 0;
  double dihedral_min = 0, dihedral_p0_01 = 0, dihedral_p0_1 = 0, dihedral_p1 = 0,
         dihedral_median = 0, dihedral_max = 0;  ///< Degrees; quantiles of the least in each cell.
  double aspect_median = 0, aspect_p99 = 0, aspect_max = 0;
  FaceQuality faces;
  std::vector<WorstCell> worst;  ///< Centres in the local frame.
};

struct SurfaceMeshReport {
  std::int64_t triangles = 0;
  bool closed = false;
  bool manifold = false;
  std::array<std::int64_t, kPatchCount> faces_by_patch{};
};

struct SolverStepReport {
  std::string step;
  std::int64_t unknowns = 0;
  int iterations = 0;
  double relative_residual = 0;
  bool converged = false;
};

struct Report {
  std::string command;
  Config config;
  Point2 origin;
  std::string crs;
  Bounds2 domain;  ///< CRS coordinates.
  std::vector<StepReport> steps;
  std::int64_t peak_rss_bytes = 0;
  int threads = 0;
  std::map<std::string, std::string> sources;  ///< What `mesh` has read, by setting: paths relative
                                               ///< to the folder of the results.
  std::optional<InputReport> input;
  std::optional<CityReport> city;
  std::optional<GroundMeshReport> ground_mesh;
  std::optional<VolumeMeshReport> volume_mesh;
  std::optional<SurfaceMeshReport> surface_mesh;
  std::vector<SolverStepReport> solver;
  std::vector<Warning> warnings;
  std::vector<std::string> files;  ///< Results in the folder, sorted, without the report: what the
                                   ///< run wrote, and what it read there of an earlier run.
};

/// The report as JSON text (keys: docs/files.md), UTF-8, ending with a newline.
std::string to_json(const Report& report);

}  // namespace tetropolis
