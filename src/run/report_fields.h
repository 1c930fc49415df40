// The one list of what report.json holds: writer, reader, documentation and `check` follow it.
//
// report_fields(report, field) calls field(key, member, type, meaning) for every member in the
// order of the file. A key with dots ("dihedral_deg.min") is a member of a nested object. Lists of
// structs that have fields of their own (Dropped, StepTime, ...) are lists of objects.
#pragma once

#include <string>

#include "tetropolis/run/report.h"

namespace tetropolis {

template <typename Field>
void fields_of(Dropped& dropped, const Field& field) {
  field("source_id", dropped.source_id, "text", "input feature in no building");
  field("reason", dropped.reason, "text", "why");
}

template <typename Field>
void fields_of(Warning& warning, const Field& field) {
  field("code", warning.code, "text", "name for programs: below");
  field("count", warning.count, "integer", "number of points, features, ... concerned");
  field("message", warning.message, "text", "one line");
}

template <typename Field>
void fields_of(StepTime& step, const Field& field) {
  field("id", step.id, "text", "number of the step; `0.1` and `0.2` in `synth`");
  field("name", step.name, "text", "part of the step");
  field("seconds", step.seconds, "number, s",
        "wall time; step 2.4 of `build` runs beside the next ones on two threads or more");
  field("cpu_seconds", step.cpu_seconds, "number, s",
        "CPU time of all threads, with that of steps beside it");
  field("peak_rss_bytes", step.peak_rss_bytes, "integer, bytes",
        "largest resident memory of the run until the step's end");
}

template <typename Field>
void fields_of(SolverFacts& solver, const Field& field) {
  field("step", solver.step, "text", "`3.3` or `3.5`; no entries in `city` and `synth`");
  field("unknowns", solver.unknowns, "integer", "0 without solving (graded columns, flat top)");
  field("iterations", solver.iterations, "integer", "");
  field("relative_residual", solver.relative_residual, "number",
        "estimated energy norm of the error over that of the first guess");
  field("converged", solver.converged, "Boolean", "the residual fell to `solver_tolerance`");
}

template <typename Field>
void fields_of(WorstCell& cell, const Field& field) {
  field("position", cell.centre, "list of 3 numbers, m",
        "centre of one of the ten worst cells, in the CRS");
  field("min_dihedral_deg", cell.min_dihedral_deg, "number, degrees", "its least dihedral angle");
  field("max_dihedral_deg", cell.max_dihedral_deg, "number, degrees", "its greatest");
  field("cause", cell.cause, "text",
        "`buried roof`, `steep ground`, `low wall`, `small detail` or `change of size`");
}

template <typename Field>
void fields_of(GeoPlace& place, const Field& field) {
  field("longitude", place.longitude, "number, degrees", "middle of the domain, WGS 84");
  field("latitude", place.latitude, "number, degrees", "");
  field("area", place.area, "text",
        "what the CRS is made for, such as `Netherlands`; may be empty");
}

template <typename Field>
void fields_of(Preflight& preflight, const Field& field) {
  field("overlap", preflight.overlap, "number",
        "share of the footprints' box, within the bounds, that the box of the points covers");
  field("points_per_m2", preflight.points_per_m2, "number, 1/m²", "points kept over their box");
  field("footprints", preflight.footprints, "integer", "footprints within the bounds, if given");
  field("footprints_with_points", preflight.footprints_with_points, "integer",
        "those with a point inside");
}

template <typename Field>
void fields_of(InputFacts& input, const Field& field) {
  field("ground", input.ground, "text",
        "what the terrain is made of: `points`, `raster`, `bases` (of a city model), `level`");
  field("roofs", input.roofs, "text", "the same of roofs: `points`, `raster`, `attributes`");
  field("point_files", input.point_files, "integer", "point files given; 0 in `synth`");
  field("point_files_skipped", input.point_files_skipped, "integer",
        "files outside the domain by their headers, not read");
  field("points_read", input.points_read, "integer",
        "points in the files that were read; in `synth`, written");
  field("points_kept", input.points_kept, "integer",
        "points in the domain, neither noise nor withheld; in `synth`, all");
  field("points_by_class", input.points_by_class, "map of integers",
        "points kept by class (`2`, `6`, ...) of the files");
  field("ground_filtered", input.ground_filtered, "integer",
        "points that the ground filter called ground");
  field("ground_outliers", input.ground_outliers, "integer",
        "ground points left out as birds or pits");
  field("footprints_read", input.footprints_read, "integer",
        "features in the footprint file; in `synth`, written");
  field("footprint_parts", input.footprint_parts, "integer",
        "features to account for: multipolygons, and buildings that the domain or what is planned "
        "cuts, count by part; 0 in `synth`");
}

template <typename Field>
void fields_of(FootprintAccount& account, const Field& field) {
  field("features", account.features, "integer",
        "features in the footprint file; all counts of the account are 0 in `mesh`");
  field(
      "further_parts", account.further_parts, "integer",
      "polygons beyond the first of a feature; the counts from here to `replaced` add up to both");
  field("kept", account.kept, "integer", "footprints that are a building alone");
  field("merged", account.merged, "integer", "footprints in buildings of several");
  field("unusable", account.of(DropCause::kUnusable), "integer",
        "dropped: no polygon, or beyond repair");
  field("outside", account.of(DropCause::kOutside), "integer", "dropped: outside the domain");
  field("boundary", account.of(DropCause::kBoundary), "integer",
        "dropped: across the domain's boundary, or mostly beyond the points");
  field("too_small", account.of(DropCause::kTooSmall), "integer",
        "dropped: below `min_building_area`");
  field("too_narrow", account.of(DropCause::kTooNarrow), "integer",
        "dropped: nowhere as wide as `min_building_distance`");
  field("no_building", account.of(DropCause::kNotABuilding), "integer",
        "dropped: below ground or not built, by its attributes or as the ground in it is measured");
  field("outlined", account.of(DropCause::kOutlined), "integer", "dropped: its parts stand for it");
  field("replaced", account.of(DropCause::kReplaced), "integer",
        "dropped: a planned building stands there, or nothing is to");
  field("unlisted", account.unlisted, "integer",
        "of those outside, how many are not in `city.dropped`, which has the first 100,000 beyond "
        "`bounds` of a file");
}

template <typename Field>
void fields_of(RoofFacts& roofs, const Field& field) {
  field("parts", roofs.parts, "integer",
        "parts of buildings; all of these are 0 at `lod` block and in `mesh`");
  field("parts_by_lod", roofs.parts_by_lod, "map of integers",
        "parts by the LoD that their points carry (`block`: the building's height)");
  field("fallbacks", roofs.fallbacks, "integer",
        "parts with points that stay below `lod`: too few points, or flat fits better");
  field("parts_without_points", roofs.parts_without_points, "integer", "");
  field("raised", roofs.raised, "integer", "parts raised to `min_building_height`");
  field("lost", roofs.lost, "array of strings",
        "footprints that have the roof of a neighbour, 2 m off or more: lines had no room");
  field("undivided", roofs.undivided, "integer",
        "buildings that stay one block, because their parts would not keep their clearance");
  field("shared_wall_corners", roofs.shared_wall_corners, "integer",
        "vertices at which four walls share a vertical line");
  field("max_slope_deg", roofs.max_slope_deg, "number, degrees", "of the steepest roof");
  field(
      "rmse_median", roofs.rmse_median, "number, m",
      "vertical root mean square of a footprint's points off their roofs, of points at least half "
      "a metre inside, of footprints with 20 of them");
  field("rmse_p90", roofs.rmse_p90, "number, m", "the same, 90th percentile");
  field("volume_of_points", roofs.volume_of_points, "number, m³",
        "between ground and the mean height of these points, by part");
  field("volume", roofs.volume, "number, m³", "between ground and roofs");
  field("volume_of_blocks", roofs.volume_of_blocks, "number, m³",
        "between ground and one flat roof per building");
}

template <typename Field>
void fields_of(WindDomainFacts& domain, const Field& field) {
  field(
      "building_height", domain.building_height, "number, m",
      "H: of the tallest building, from its own ground to its highest roof; all of these are 0 at "
      "`domain` data");
  field("tallest_building", domain.tallest, "text", "its id: one outlier sets the domain");
  field("guideline_length", domain.guideline_length, "number, m",
        "of the box before widening: 5 H before and 15 H behind the buildings");
  field("guideline_width", domain.guideline_width, "number, m", "5 H on both sides");
  field("guideline_height", domain.guideline_height, "number, m", "6 H");
  field("guideline_blockage", domain.guideline_blockage, "number",
        "frontal area of all buildings over that of the box before widening");
  field("length", domain.length, "number, m", "along the wind (`cylinder`: diameter)");
  field("width", domain.width, "number, m", "across it");
  field("guideline_radius", domain.guideline_radius, "number, m",
        "of a cylinder before widening: 15 H around the circle of the buildings' box");
  field("radius", domain.radius, "number, m", "of a cylinder");
  field("blockage", domain.blockage, "number", "frontal area over width times 6 H");
  field("inlet", domain.inlet, "text", "patch that the wind comes in through, of a box");
  field("data", domain.data, "list of 4 numbers, m",
        "xmin, ymin, xmax, ymax of where there are data, in the CRS");
  field("area_outside_data", domain.area_outside_data, "number",
        "share of the domain that lies outside of the data; voids inside: `city.dtm_void_share`");
  field("rim_height", domain.rim_height, "number, m",
        "mean height of the terrain's rim, to which the terrain fades over 5 H");
}

template <typename Field>
void fields_of(CityFacts& city, const Field& field) {
  field("raw_buildings", city.raw_buildings, "integer",
        "buildings before merging; in `mesh`, those of the city model");
  field("buildings", city.buildings, "integer", "buildings after merging");
  field("merged_groups", city.merged_groups, "integer", "buildings made of more than one feature");
  field("account", city.account, "object", "");
  field("area_at_boundary", city.area_at_boundary, "number, m²",
        "area of the footprints that are dropped at the domain's boundary, where the domain and "
        "points are; 0 in `mesh`");
  field("min_clearance", city.min_clearance, "number, m",
        "least distance of two vertices, or of a vertex and an edge it does not belong to, over "
        "all footprints and the boundary; null without buildings");
  field(
      "area_before", city.area_before, "number, m²",
      "area of the union of the footprints before merging, without what the domain's boundary cuts "
      "off; 0 in `mesh`");
  field("area_after", city.area_after, "number, m²",
        "area of the footprints after merging; 0 in `mesh`");
  field("volume_before", city.volume_before, "number, m³",
        "footprints times their heights, before merging; 0 in `mesh`");
  field("volume_after", city.volume_after, "number, m³", "buildings, after merging; 0 in `mesh`");
  field("area_moved", city.area_moved, "number, m²",
        "area of the symmetric difference of the two, dropped buildings included; 0 in `mesh`");
  field("area_changed_share", city.area_changed_share, "number",
        "`city.area_moved` over `city.area_before`; 0 in `mesh`");
  field("max_distance", city.max_distance, "number, m",
        "largest Hausdorff distance between a building and the union of its members; 0 in `mesh`");
  field("hulls", city.hulls, "integer", "buildings with the flag `convex_hull`; 0 in `mesh`");
  field("resorts", city.resorts, "map of integers",
        "uses of each way to simplify; empty in `mesh`");
  field("flags", city.flags, "map of integers",
        "buildings after merging with each flag; empty in `mesh`");
  field("dtm_empty_share", city.dtm_empty_share, "number",
        "share of terrain nodes without ground points, filled from their neighbours; 0 in `mesh`");
  field("dtm_void_share", city.dtm_void_share, "number",
        "share of squares of 20 m without ground points; 0 in `mesh`");
  field("roofs", city.roofs, "object", "");
  field("domain", city.domain, "object", "");
  field("dropped", city.dropped, "list", "");
}

template <typename Field>
void fields_of(CellScore& score, const Field& field) {
  field("count", score.count, "integer",
        "buildings; or pairs of neighbours with a gap of 10 m and more");
  field("least", score.least, "number",
        "cells of the coarsest: a building's cube root of volume over its mean edge along the "
        "outline; a gap's edges from wall to wall where it is narrowest");
  field("median", score.median, "number", "");
  field("share_of_ten", score.share_of_ten, "number",
        "share with ten cells or more, which COST 732 asks for");
}

template <typename Field>
void fields_of(GroundMeshFacts& mesh, const Field& field) {
  field("vertices", mesh.vertices, "integer", "");
  field("triangles", mesh.triangles, "integer", "");
  field("min_angle_deg", mesh.min_angle_deg, "number, degrees", "least angle of any triangle");
  field("small_input_angles", mesh.small_input_angles, "integer",
        "corners of the input sharper than `min_angle`");
  field("triangles_below_min_angle", mesh.triangles_below_min_angle, "integer",
        "triangles below `min_angle`, at such corners and across from them");
  field("shortest_edge", mesh.shortest_edge, "number, m",
        "with `volume_mesh.min_vertical_gap`, what bounds time steps");
  field("longest_edge", mesh.longest_edge, "number, m", "");
  field("water_area", mesh.surfaces[0], "number, m²", "of `surface_layers`, as meshed");
  field("road_area", mesh.surfaces[1], "number, m²", "");
  field("vegetation_area", mesh.surfaces[2], "number, m²", "");
  field("size_scale", mesh.size_scale, "number",
        "what all sizes were multiplied by for `target_cells`; 1 without");
  field("cells_per_building", mesh.resolution.buildings, "object", "");
  field("cells_per_gap", mesh.resolution.gaps, "object", "");
}

template <typename Field>
void fields_of(VolumeMeshFacts& mesh, const Field& field) {
  field("vertices", mesh.vertices, "integer", "");
  field("cells", mesh.cells, "integer", "tetrahedra and prisms");
  field("layers", mesh.layers, "integer",
        "uniform layers; with graded columns, the number there would be");
  field("volume", mesh.volume, "number, m³", "");
  field("inverted", mesh.inverted, "integer",
        "cells without positive volume; always 0 in a written mesh");
  field("min_vertical_gap", mesh.min_vertical_gap, "number, m", "shortest vertical edge");
  field(
      "ground_lowered", mesh.ground_lowered, "integer",
      "ground vertices below the terrain: on walls that it would bury, and where it was excavated");
  field("cut_slope_deg", mesh.cut_slope_deg, "number, degrees",
        "gentlest slope to which terrain was excavated; `cut_slope` without any");
  field("roofs_cut_back", mesh.roofs_cut_back, "list of integers",
        "buildings of `city.city.json`, from 0, with one roof, around which the terrain was "
        "excavated");
  field("roof_cut_slopes_deg", mesh.roof_cut_slopes_deg, "list of numbers, degrees",
        "slopes to which it was, in the order of `roofs_cut_back`");
  field("feet_cut_back", mesh.feet_cut_back, "list of lists of 3 numbers, m",
        "x, y (CRS) and z of the slope toes from which the terrain was excavated, and of roofs' "
        "edges, of buildings with several roofs");
  field("foot_cut_slopes_deg", mesh.foot_cut_slopes_deg, "list of numbers, degrees",
        "slopes to which it was, in the order of `feet_cut_back`");
  field("moved_by_guard", mesh.moved_by_guard, "integer",
        "nodes moved to make columns monotone after solving; 0 without solving");
  field("columns_improved", mesh.columns_improved, "integer",
        "columns changed by the local search for better cells");
  field("parts_left_out", mesh.parts_left_out, "list of integers",
        "buildings with parts that are meshed as blocks, by number");
  field("roofs_met", mesh.roofs_met, "integer",
        "vertices at which roofs of two parts were moved together by more than a centimetre: the "
        "step was too low for cells, or they crossed");
  field("roofs_met_most", mesh.most_roofs_met, "number, m", "by so much at most");
  field("roofs_lifted", mesh.roofs_lifted, "integer",
        "vertices at which a roof was lifted so that walls around it are a manifold");
  field("roofs_lifted_most", mesh.most_roofs_lifted, "number, m", "by so much at most");
  field("roof_steps_closed", mesh.roof_steps_closed, "integer",
        "edges at which a roof was lifted to the next one, since no cells fit the step");
  field("top", mesh.top, "number, m",
        "elevation of the flat top; of a free top, before it follows the terrain");
  field("dihedral_deg.min", mesh.dihedral_min, "number, degrees",
        "least dihedral angle of any tet; all of these are 0 if there are none");
  field("dihedral_deg.p0_01", mesh.dihedral_p0_01, "number, degrees",
        "0.01 % of cells have a least dihedral angle up to this; to 0.01 degrees");
  field("dihedral_deg.p0_1", mesh.dihedral_p0_1, "number, degrees", "0.1 %");
  field("dihedral_deg.p1", mesh.dihedral_p1, "number, degrees", "1 %");
  field("dihedral_deg.median", mesh.dihedral_median, "number, degrees", "half of the cells");
  field("dihedral_deg.max", mesh.dihedral_max, "number, degrees",
        "greatest dihedral angle of any cell");
  field("dihedral_deg.counts", mesh.dihedral_counts, "list of integers",
        "cells by their least dihedral angle: of 0 to 1 degrees, 1 to 2, ..., 71 to 72");
  field("aspect_ratio.median", mesh.aspect_median, "number",
        "longest edge over 2√6 inradii; 1 for the regular tetrahedron");
  field("aspect_ratio.p99", mesh.aspect_p99, "number", "99 % of the cells have at most this");
  field("aspect_ratio.max", mesh.aspect_max, "number", "");
  field("non_orthogonality_deg.max", mesh.faces.worst.non_orthogonality_deg, "number, degrees",
        "greatest angle between a face's normal and the line between its two cells' centres, as in "
        "`checkMesh`");
  field("faces_above_70_deg", mesh.faces.above_70, "integer",
        "faces above 70 degrees of non-orthogonality");
  field("skewness.max", mesh.faces.worst.skewness, "number",
        "greatest skewness of a face, boundary included, as in `checkMesh`");
  field("prisms.cells", mesh.prisms.cells, "integer", "prisms in `boundary_layers`");
  field("prisms.volume", mesh.prisms.volume, "number, m³", "");
  field("prisms.first_layer_share", mesh.prisms.share_as_asked, "number",
        "share of the open ground's area with a lowest layer of `first_layer`, to a millimetre; "
        "thinner at low walls");
  field("prisms.least_height", mesh.prisms.least_height, "number, m", "shortest upright edge");
  field("prisms.non_orthogonality_deg.max", mesh.prisms.max_non_orthogonality_deg,
        "number, degrees", "of faces between two cells, one of them a prism, as in `checkMesh`");
  field("prisms.non_orthogonality_deg.mean", mesh.prisms.mean_non_orthogonality_deg,
        "number, degrees", "");
  field("prisms.faces_above_70_deg", mesh.prisms.above_70, "integer", "");
  field("prisms.skewness.max", mesh.prisms.max_skewness, "number",
        "of all faces of prisms, as in `checkMesh`");
  field("prisms.aspect_ratio.max", mesh.prisms.max_aspect_ratio, "number", "as in `checkMesh`");
  field("prisms.flatness.min", mesh.prisms.least_flatness, "number",
        "area of a face over that of its parts; 1: plane");
  field("worst_cells", mesh.worst, "list", "the ten worst cells");
}

template <typename Field>
void fields_of(CellZone& zone, const Field& field) {
  field("name", zone.name, "text", "a canopy's zone: `canopy_1`, ..., in the order of the files");
  field("height", zone.height, "number, m", "of its top above the ground");
  field("base", zone.base, "number, m", "of its lowest leaves, the same");
  field("leaf_area_density", zone.leaf_area_density, "number, 1/m", "");
  field("cells", zone.cells, "integer", "cells in the zone");
}

template <typename Field>
void fields_of(SurfaceMeshFacts& mesh, const Field& field) {
  field("triangles", mesh.triangles, "integer",
        "triangles of the whole boundary, top and sides included");
  field("quads", mesh.quads, "integer", "quadrilaterals, of prisms at walls and sides");
  field("closed", mesh.closed, "Boolean",
        "every edge has at least two faces; always true in a written mesh");
  field("manifold", mesh.manifold, "Boolean",
        "no edge has more than two faces, or two of one direction; always true in a written mesh");
  field("faces_by_patch", mesh.faces_by_patch, "map of integers", "faces of each patch, by name");
}

template <typename Field>
void report_fields(Report& report, const Field& field) {
  field("version", report.version, "text", "of Tetropolis");
  field("command", report.command, "text", "`build`, `city`, `mesh` or `synth`");
  field("started", report.started, "text", "when, UTC: `2026-11-26T09:14:05Z`");
  field("config", report.config, "map",
        "all [settings](settings.md) of the run by name, defaults included");
  field("origin", report.origin, "list of 3 numbers, m",
        "corner of the local frame in the CRS: x and y in whole metres (unless the city model says "
        "otherwise), 0");
  field("crs", report.crs, "text", "`EPSG:` and a code, WKT without a code, empty if unknown");
  field("domain", report.domain, "list of 4 numbers, m",
        "xmin, ymin, xmax, ymax of the domain in the CRS");
  field("place", report.place, "object", "absent if the CRS is unknown");
  field("steps", report.steps, "list", "");
  field("peak_rss_bytes", report.peak_rss_bytes, "integer, bytes",
        "largest resident memory before the report is written");
  field("threads", report.threads, "integer", "threads available to the run");
  field("sources", report.sources, "map of texts",
        "`city` and `dtm` that `mesh` has read, relative to the folder of the results");
  field("preflight", report.preflight, "object", "of `build` and `city`: how the input fits");
  field("input", report.input, "object", "of `build`, `city` and `synth`");
  field("city", report.city, "object", "of `build`, `city` and `mesh`");
  field("ground_mesh", report.ground_mesh, "object", "of `build` and `mesh`");
  field("volume_mesh", report.volume_mesh, "object", "of `build` and `mesh`");
  field("surface_mesh", report.surface_mesh, "object", "of `build` and `mesh`");
  field("canopies", report.canopies, "list", "of `canopies`: zones of cells");
  field("solver", report.solver, "list", "steps that solve Laplace problems");
  field("files", report.files, "list of texts",
        "results in the folder, report excluded: of this run, and what stays of an earlier one; a "
        "later run removes those it does not write, `synth` data excepted");
  field("warnings", report.warnings, "list", "");
}

}  // namespace tetropolis
