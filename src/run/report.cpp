#include "tetropolis/run/report.h"

#include <variant>

#include <nlohmann/json.hpp>

#include "tetropolis/core/version.h"

namespace tetropolis {

namespace {

using Json = nlohmann::ordered_json;

Json config_json(const Config& config) {
  Json json = Json::object();
  for (const ConfigField& field : config_fields())
    std::visit(
        [&](auto member) {
          Json& value = json[std::string(field.name)];
          if constexpr (std::is_same_v<decltype(member), ChoiceMember>)
            value = field.choices[member.get(config)];
          else
            value = config.*member;
        },
        field.member);
  return json;
}

Json input_json(const InputReport& input) {
  Json by_class = Json::object();
  for (const auto& [code, count] : input.points_by_class) by_class[std::to_string(code)] = count;
  return {{"point_files", input.point_files},
          {"point_files_skipped", input.point_files_skipped},
          {"points_read", input.points_read},
          {"points_kept", input.points_kept},
          {"points_by_class", by_class},
          {"ground_filtered", input.ground_filtered},
          {"ground_outliers", input.ground_outliers},
          {"footprints_read", input.footprints_read},
          {"footprint_parts", input.footprint_parts}};
}

Json city_json(const CityReport& city) {
  Json dropped = Json::array();
  for (const Dropped& feature : city.dropped)
    dropped.push_back({{"source_id", feature.source_id}, {"reason", feature.reason}});
  return {{"raw_buildings", city.raw_buildings},
          {"buildings", city.buildings},
          {"merged_groups", city.merged_groups},
          {"min_clearance", city.min_clearance},
          {"area_before", city.area_before},
          {"area_after", city.area_after},
          {"area_moved", city.area_moved},
          {"area_changed_share", city.area_changed_share},
          {"max_distance", city.max_distance},
          {"hulls", city.hulls},
          {"resorts", city.resorts},
          {"flags", city.flags},
          {"dtm_empty_share", city.dtm_empty_share},
          {"dtm_void_share", city.dtm_void_share},
          {"dropped", dropped}};
}

/// Places are in the coordinates of the CRS, to look up in a map.
Json worst_json(const std::vector<WorstCell>& worst, Point2 origin) {
  Json cells = Json::array();
  for (const WorstCell& cell : worst)
    cells.push_back(
        {{"position", {cell.centre[0] + origin.x, cell.centre[1] + origin.y, cell.centre[2]}},
         {"min_dihedral_deg", cell.min_dihedral_deg},
         {"max_dihedral_deg", cell.max_dihedral_deg},
         {"cause", cell.cause}});
  return cells;
}

/// Likewise.
Json points_json(const std::vector<Point3>& points, Point2 origin) {
  Json places = Json::array();
  for (const Point3& p : points) places.push_back({p[0] + origin.x, p[1] + origin.y, p[2]});
  return places;
}

Json volume_json(const VolumeMeshReport& mesh, Point2 origin) {
  return {{"vertices", mesh.vertices},
          {"cells", mesh.cells},
          {"layers", mesh.layers},
          {"volume", mesh.volume},
          {"inverted", mesh.inverted},
          {"min_vertical_gap", mesh.min_vertical_gap},
          {"ground_lowered", mesh.ground_lowered},
          {"cut_slope_deg", mesh.cut_slope},
          {"roofs_cut_back", mesh.roofs_cut_back},
          {"roof_cut_slopes_deg", mesh.roof_cut_slopes},
          {"feet_cut_back", points_json(mesh.feet_cut_back, origin)},
          {"foot_cut_slopes_deg", mesh.foot_cut_slopes},
          {"moved_by_guard", mesh.moved_by_guard},
          {"columns_improved", mesh.columns_improved},
          {"top", mesh.top},
          {"dihedral_deg",
           {{"min", mesh.dihedral_min},
            {"p0_01", mesh.dihedral_p0_01},
            {"p0_1", mesh.dihedral_p0_1},
            {"p1", mesh.dihedral_p1},
            {"median", mesh.dihedral_median},
            {"max", mesh.dihedral_max}}},
          {"aspect_ratio",
           {{"median", mesh.aspect_median}, {"p99", mesh.aspect_p99}, {"max", mesh.aspect_max}}},
          {"non_orthogonality_deg", {{"max", mesh.faces.worst.non_orthogonality_deg}}},
          {"faces_above_70_deg", mesh.faces.above_70},
          {"skewness", {{"max", mesh.faces.worst.skewness}}},
          {"worst_cells", worst_json(mesh.worst, origin)}};
}

Json surface_json(const SurfaceMeshReport& surface) {
  Json by_patch = Json::object();
  for (int i = 0; i < kPatchCount; ++i)
    by_patch[std::string(patch_name(static_cast<Patch>(i + 1)))] =
        surface.faces_by_patch[static_cast<std::size_t>(i)];
  return {{"triangles", surface.triangles},
          {"closed", surface.closed},
          {"manifold", surface.manifold},
          {"faces_by_patch", by_patch}};
}

}  // namespace

std::string to_json(const Report& report) {
  Json json;
  json["version"] = kVersion;
  json["command"] = report.command;
  json["config"] = config_json(report.config);
  json["origin"] = {report.origin.x, report.origin.y, 0.0};
  json["crs"] = report.crs;
  json["domain"] = {report.domain.xmin, report.domain.ymin, report.domain.xmax, report.domain.ymax};
  json["steps"] = Json::array();
  for (const StepReport& step : report.steps)
    json["steps"].push_back({{"id", step.id},
                             {"name", step.name},
                             {"seconds", step.seconds},
                             {"cpu_seconds", step.cpu_seconds}});
  json["peak_rss_bytes"] = report.peak_rss_bytes;
  json["threads"] = report.threads;
  if (!report.sources.empty()) json["sources"] = report.sources;
  if (report.input) json["input"] = input_json(*report.input);
  if (report.city) json["city"] = city_json(*report.city);
  if (report.ground_mesh)
    json["ground_mesh"] = {
        {"vertices", report.ground_mesh->vertices},
        {"triangles", report.ground_mesh->triangles},
        {"min_angle_deg", report.ground_mesh->min_angle_deg},
        {"small_input_angles", report.ground_mesh->small_input_angles},
        {"triangles_below_min_angle", report.ground_mesh->triangles_below_min_angle}};
  if (report.volume_mesh) json["volume_mesh"] = volume_json(*report.volume_mesh, report.origin);
  if (report.surface_mesh) json["surface_mesh"] = surface_json(*report.surface_mesh);
  json["solver"] = Json::array();
  for (const SolverStepReport& solve : report.solver)
    json["solver"].push_back({{"step", solve.step},
                              {"unknowns", solve.unknowns},
                              {"iterations", solve.iterations},
                              {"relative_residual", solve.relative_residual},
                              {"converged", solve.converged}});
  json["files"] = report.files;
  json["warnings"] = Json::array();
  for (const Warning& warning : report.warnings)
    json["warnings"].push_back(
        {{"code", warning.code}, {"count", warning.count}, {"message", warning.message}});
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tetropolis
