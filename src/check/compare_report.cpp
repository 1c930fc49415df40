#include "compare_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tetropolis/io/crs/crs.h"

#include "describe_checks.h"
#include "run/result_files.h"

namespace tetropolis {

namespace {

void differs(const std::string& what, const std::string& reported, const std::string& found,
             CheckedFile& file) {
  file.violations.push_back({what + " differs from report.json", 1,
                             fmt::format("{} reported, {} found", reported, found)});
}

std::vector<std::string> all_source_ids(const CityModel& city) {
  std::vector<std::string> ids;
  for (const Building& building : city.buildings)
    ids.insert(ids.end(), building.source_ids.begin(), building.source_ids.end());
  for (const Dropped& feature : city.dropped) ids.push_back(feature.source_id);
  std::sort(ids.begin(), ids.end());
  return ids;
}

std::string list_of(const std::map<std::string, std::int64_t>& counts) {
  std::vector<std::string> parts;
  for (const auto& [name, count] : counts) parts.push_back(fmt::format("{} {}", name, count));
  return parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, ", "));
}

std::int64_t sum(const std::array<std::int64_t, kDropCauses>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
}

/// Ids and reasons.
std::vector<std::pair<std::string, std::string>> sorted_pairs(const std::vector<Dropped>& dropped) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const Dropped& feature : dropped) pairs.emplace_back(feature.source_id, feature.reason);
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// `check` is that of the city; `made`: the run that reports made it, and did not only read it.
void compare_buildings(const CityModel& city, const CityCheck& check, const CityFacts& report,
                       bool made, CheckedFile& file) {
  compare_count("number of buildings", report.buildings, city.buildings.size(), file);
  const std::vector<std::pair<std::string, std::string>> dropped = sorted_pairs(city.dropped);
  if (sorted_pairs(report.dropped) != dropped)
    differs("list of dropped features", std::to_string(report.dropped.size()),
            std::to_string(dropped.size()), file);
  for (const auto& [id, reason] : dropped)
    if (reason.empty()) file.violations.push_back({"features dropped without a reason", 1, id});
  std::size_t merged = 0;
  for (const Building& building : city.buildings) merged += building.source_ids.size() > 1 ? 1 : 0;
  compare_count("number of merged groups", report.merged_groups, merged, file);
  if (!made) return;
  const FootprintAccount& account = report.account;
  const std::size_t alone = city.buildings.size() - merged;
  compare_count("number of footprints that are a building alone", account.kept, alone, file);
  compare_count("number of merged footprints", account.merged,
                all_source_ids(city).size() - city.dropped.size() - alone, file);
  compare_count("number of dropped footprints", sum(account.dropped) - account.unlisted,
                city.dropped.size(), file);
  compare("area of footprints", report.area_after, check.area * (1 - 1e-9) - 1e-6, check.area,
          check.area * (1 + 1e-9) + 1e-6, file);
  const double clearance = joint_clearance_of(check);
  if (!std::isfinite(report.min_clearance) && !city.buildings.empty())
    differs("clearance", "none", fmt::format("{}", clearance), file);
  if (std::isfinite(report.min_clearance))
    compare("clearance", report.min_clearance, clearance - 1e-6, clearance, clearance + 1e-6, file);
  std::map<std::string, std::int64_t> flags;
  for (const Building& building : city.buildings)
    for (const std::string& name : flag_names(building.flags)) ++flags[name];
  if (report.flags != flags)
    differs("number of flags", list_of(report.flags), list_of(flags), file);
}

void compare_boxes(const Bounds2& reported_box, const Bounds2& found, CheckedFile& file) {
  constexpr double kSame = 1e-6;  // metres
  const auto sides_of = [](const Bounds2& box) {
    return std::array{box.xmin, box.ymin, box.xmax, box.ymax};
  };
  const auto sides = sides_of(found), reported = sides_of(reported_box);
  const auto text = [](const std::array<double, 4>& box) {
    return fmt::format("x {} .. {}, y {} .. {}", box[0], box[2], box[1], box[3]);
  };
  if (!std::equal(sides.begin(), sides.end(), reported.begin(),
                  [](double a, double b) { return std::abs(a - b) <= kSame; }))
    differs("domain", text(reported), found.empty() ? "none" : text(sides), file);
}

}  // namespace

void compare(const std::string& what, double reported, double low, double found, double high,
             CheckedFile& file) {
  if (!(reported >= low && reported <= high))
    differs(what, fmt::format("{}", reported), fmt::format("{}", found), file);
}

void compare_count(const std::string& what, std::int64_t reported, std::size_t found,
                   CheckedFile& file) {
  const auto count = static_cast<double>(found);
  compare(what, static_cast<double>(reported), count, count, count, file);
}

void compare_mesh(const Report& report, const VolumeCheck& volume, const SurfaceCheck& surface,
                  CheckedFile& file) {
  const VolumeMeshFacts& mesh = *report.volume_mesh;
  const SurfaceMeshFacts boundary = report.surface_mesh.value_or(SurfaceMeshFacts{});
  const auto number = [](std::int64_t count) { return static_cast<double>(count); };
  const auto near = [&](const std::string& what, double reported, double found, double tolerance) {
    compare(what, reported, found - tolerance, found, found + tolerance, file);
  };
  near("number of cells", number(mesh.cells), static_cast<double>(volume.cells), 0);
  near("number of vertices", number(mesh.vertices), static_cast<double>(volume.vertices), 0);
  near("inverted cells", number(mesh.inverted), static_cast<double>(volume.inverted), 0);
  near("volume", mesh.volume, volume.volume, 1e-9 * volume.volume);
  near("enclosed volume", volume.volume, surface.enclosed_volume, 1e-7 * volume.volume);
  near("boundary triangles", number(boundary.triangles), static_cast<double>(surface.triangles), 0);
  near("boundary quadrilaterals", number(boundary.quads), number(surface.quads), 0);
  const PrismMeasures& prisms = volume.prisms;
  near("number of prisms", number(mesh.prisms.cells), number(prisms.cells), 0);
  near("greatest aspect ratio of prisms", mesh.prisms.max_aspect_ratio, prisms.max_aspect_ratio,
       1e-4 * prisms.max_aspect_ratio);
  near("least flatness of faces of prisms", mesh.prisms.least_flatness, prisms.least_flatness,
       1e-9);
  near("greatest non-orthogonality", mesh.faces.worst.non_orthogonality_deg,
       volume.faces.max_non_orthogonality_deg, 0.01);
  near("greatest skewness", mesh.faces.worst.skewness, volume.faces.max_skewness, 0.01);
  near("faces above 70 degrees", number(mesh.faces.above_70),
       static_cast<double>(volume.faces.above_70), 0);
  const Distribution &angle = volume.min_dihedral_deg, &aspect = volume.aspect_ratio;
  near("least dihedral angle", mesh.dihedral_min, angle.min, 0.01);
  near("greatest dihedral angle", mesh.dihedral_max, volume.max_dihedral_deg, 0.01);
  near("0.01 % quantile of dihedral angles", mesh.dihedral_p0_01, angle.p0_01, 0.1);
  near("0.1 % quantile of dihedral angles", mesh.dihedral_p0_1, angle.p0_1, 0.1);
  near("1 % quantile of dihedral angles", mesh.dihedral_p1, angle.p1, 0.1);
  near("median of dihedral angles", mesh.dihedral_median, angle.median, 0.1);
  near("median of aspect ratios", mesh.aspect_median, aspect.median, 0.01 * aspect.median);
  near("99 % quantile of aspect ratios", mesh.aspect_p99, aspect.p99, 0.01 * aspect.p99);
  near("greatest aspect ratio", mesh.aspect_max, aspect.max, 1e-4 * aspect.max);
  near("least vertical edge", mesh.min_vertical_gap, volume.least_vertical_edge, 1e-6);
  if (report.config.top == Top::kFlat) {
    near("elevation of the top", mesh.top, surface.highest, 1e-6);
    near("lowest vertex of the flat top", mesh.top, surface.lowest_top, 1e-6);
  }
  near("closed boundary", boundary.closed ? 1 : 0, surface.closed ? 1 : 0, 0);
  near("manifold boundary", boundary.manifold ? 1 : 0, surface.manifold ? 1 : 0, 0);
  std::map<std::string, std::int64_t> reported;
  for (const auto& [name, faces] : boundary.faces_by_patch) reported[name] = faces;
  for (const auto& [name, faces] : surface.faces_by_patch)
    near("number of faces of " + name, number(reported[name]), number(faces), 0);
}

void compare_account(const CityModel& city, const std::optional<ReportedRun>& report,
                     CheckedFile& file) {
  if (!report || !report->made_city()) {
    file.not_checked.emplace_back(
        "that every input feature is accounted for (no report.json of the run that made the city)");
    return;
  }
  std::size_t accounted = city.dropped.size();
  if (report->report.city)
    accounted += static_cast<std::size_t>(report->report.city->account.unlisted);
  for (const Building& building : city.buildings) accounted += building.source_ids.size();
  const std::int64_t parts = report->report.input->footprint_parts;
  if (parts != static_cast<std::int64_t>(accounted))
    file.violations.push_back(
        {"input features not accounted for", 1,
         fmt::format("{} in the input, {} in buildings or dropped", parts, accounted)});
  else
    file.facts.push_back(fmt::format("all {} input features accounted for", parts));
}

void compare_features(const CityModel& raw, const CityModel& city, CheckedFile& file) {
  const std::vector<std::string> before = all_source_ids(raw), after = all_source_ids(city);
  std::vector<std::string> lost, new_ids;
  std::set_difference(before.begin(), before.end(), after.begin(), after.end(),
                      std::back_inserter(lost));
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(),
                      std::back_inserter(new_ids));
  if (!lost.empty())
    file.violations.push_back({fmt::format("features of {} that are not here", results::kRawCity),
                               static_cast<std::int64_t>(lost.size()), lost.front()});
  if (!new_ids.empty())
    file.violations.push_back({fmt::format("features that are not in {}", results::kRawCity),
                               static_cast<std::int64_t>(new_ids.size()), new_ids.front()});
}

void compare_city(const CityModel& city, const CityCheck& check, const ReportedRun& report,
                  CheckedFile& file) {
  const Report& run = report.report;
  if (run.city) compare_buildings(city, check, *run.city, report.made_city(), file);
  if (report.has_origin && run.origin != city.origin)
    differs("origin", fmt::format("({}, {})", run.origin.x, run.origin.y),
            fmt::format("({}, {})", city.origin.x, city.origin.y), file);
  // `mesh` takes models without a system, which the terrain may have.
  const bool is_unknown = city.crs.empty() && !report.made_city();
  if (report.has_crs && run.crs != city.crs && !is_unknown &&
      !same_horizontal_crs(run.crs, city.crs))
    differs("reference system", crs_name(run.crs), crs_name(city.crs), file);
  // `mesh --bounds` leaves the model with its own domain.
  if (!report.has_domain || !report.made_city()) return;
  // A domain that guidelines ask for is put around the merged city alone.
  const Bounds2 domain = city.domain.moved(city.origin).bounds();
  const bool is_of_data = run.city && check.violations.empty() && run.city->domain.data == domain;
  if (!is_of_data) compare_boxes(run.domain, domain, file);
}

void compare_terrain(const RasterInput& terrain, const CityModel& city,
                     const std::optional<ReportedRun>& report, CheckedFile& file) {
  const bool is_result = report && report->made_city();  // `mesh` takes terrains without a system
  const std::string crs = report ? report->report.crs : std::string();
  if (is_result && !crs.empty() && terrain.crs.empty())
    differs("reference system", crs_name(crs), "none", file);
  if (!crs.empty() && city.crs.empty() && !terrain.crs.empty() &&
      !same_horizontal_crs(crs, terrain.crs))
    differs("reference system", crs_name(crs), crs_name(terrain.crs), file);
  if (!terrain.crs.empty() && !city.crs.empty() && !same_horizontal_crs(terrain.crs, city.crs))
    file.violations.push_back(
        {"terrain and city model in different reference systems", 1,
         fmt::format("{} and {}", crs_name(terrain.crs), crs_name(city.crs))});
  const double step = terrain.raster.step;
  if (is_result)
    compare("step of the terrain", report->report.config.dtm_step, step * (1 - 1e-9), step,
            step * (1 + 1e-9), file);
}

void compare_layers(const std::vector<VectorLayer>& layers, const Report& report,
                    CheckedFile& file) {
  const auto compare_layer = [&](const char* name, std::int64_t reported) {
    const auto found = std::find_if(layers.begin(), layers.end(),
                                    [&](const VectorLayer& layer) { return layer.name == name; });
    const std::int64_t count = found == layers.end() ? 0 : found->features;
    compare_count(fmt::format("number of {}", name), reported, static_cast<std::size_t>(count),
                  file);
  };
  const FootprintAccount& account = report.city->account;
  compare_layer("buildings", report.city->buildings);
  const std::int64_t outside = account.of(DropCause::kOutside);
  compare_layer("dropped", sum(account.dropped) - outside);
  // What the domain or a planned building cuts into parts is one footprint there.
  if (report.config.boundary_buildings == BoundaryBuildings::kDrop && report.config.planned.empty())
    compare_layer("footprints", account.features + account.further_parts - outside);
}

void compare_domain(const SurfaceCheck& surface, const std::optional<ReportedRun>& report,
                    CheckedFile& file) {
  if (!report || !report->has_domain || !report->has_mesh()) return;
  const Point2 origin = report->is_absolute() ? Point2{0, 0} : report->report.origin;
  compare_boxes(report->report.domain, surface.box.moved(origin), file);
}

void compare_origin(const std::optional<Point3>& origin, const std::optional<ReportedRun>& report,
                    CheckedFile& file) {
  if (!report || !report->has_origin || !report->has_mesh()) return;
  if (!origin) {
    file.not_checked.emplace_back("the origin (the file does not state it, or not as text)");
    return;
  }
  const Point3 expected = report->is_absolute()
                              ? Point3{0, 0, 0}
                              : Point3{report->report.origin.x, report->report.origin.y, 0};
  if (*origin != expected)
    differs("origin", fmt::format("{}", fmt::join(expected, ", ")),
            fmt::format("{}", fmt::join(*origin, ", ")), file);
}

}  // namespace tetropolis
