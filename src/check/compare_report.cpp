#include "compare_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
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

/// `check` is that of the city; `made`: the run that reports made it, and did not only read it.
void compare_buildings(const CityModel& city, const CityCheck& check, const ReportedCity& report,
                       bool made, CheckedFile& file) {
  compare_count("number of buildings", report.buildings, city.buildings.size(), file);
  std::vector<std::pair<std::string, std::string>> dropped;
  for (const Dropped& feature : city.dropped)
    dropped.emplace_back(feature.source_id, feature.reason);
  std::sort(dropped.begin(), dropped.end());
  if (report.dropped != dropped)
    differs("list of dropped features", std::to_string(report.dropped.size()),
            std::to_string(dropped.size()), file);
  for (const auto& [id, reason] : dropped)
    if (reason.empty()) file.violations.push_back({"features dropped without a reason", 1, id});
  std::size_t merged = 0;
  for (const Building& building : city.buildings) merged += building.source_ids.size() > 1 ? 1 : 0;
  compare_count("number of merged groups", report.merged_groups, merged, file);
  if (!made) return;
  compare("area of footprints", report.area, check.area * (1 - 1e-9) - 1e-6, check.area,
          check.area * (1 + 1e-9) + 1e-6, file);
  const double clearance = joint_clearance_of(check);
  if (!report.min_clearance && !city.buildings.empty())
    differs("clearance", "none", fmt::format("{}", clearance), file);
  if (report.min_clearance)
    compare("clearance", *report.min_clearance, clearance - 1e-6, clearance, clearance + 1e-6,
            file);
  std::map<std::string, std::int64_t> flags;
  for (const Building& building : city.buildings)
    for (const std::string& name : flag_names(building.flags)) ++flags[name];
  if (report.flags != flags)
    differs("number of flags", list_of(report.flags), list_of(flags), file);
}

void compare_boxes(const std::array<double, 4>& reported, const Bounds2& found, CheckedFile& file) {
  constexpr double kSame = 1e-6;  // metres
  const std::array sides{found.xmin, found.ymin, found.xmax, found.ymax};
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

void compare_mesh(const ReportedMesh& mesh, const VolumeCheck& volume, const SurfaceCheck& surface,
                  CheckedFile& file) {
  const auto near = [&](const std::string& what, double reported, double found, double tolerance) {
    compare(what, reported, found - tolerance, found, found + tolerance, file);
  };
  near("number of cells", mesh.cells, static_cast<double>(volume.cells), 0);
  near("number of vertices", mesh.vertices, static_cast<double>(volume.vertices), 0);
  near("inverted cells", mesh.inverted, static_cast<double>(volume.inverted), 0);
  near("volume", mesh.volume, volume.volume, 1e-9 * volume.volume);
  near("enclosed volume", volume.volume, surface.enclosed_volume, 1e-7 * volume.volume);
  near("boundary triangles", mesh.triangles, static_cast<double>(surface.triangles), 0);
  near("greatest non-orthogonality", mesh.non_orthogonality, volume.faces.max_non_orthogonality_deg,
       0.01);
  near("greatest skewness", mesh.skewness, volume.faces.max_skewness, 0.01);
  near("faces above 70 degrees", mesh.faces_above_70, static_cast<double>(volume.faces.above_70),
       0);
  const auto near_one = [&](const std::map<std::string, double>& reported, const char* name,
                            const std::string& what, double found, double tolerance) {
    const auto value = reported.find(name);
    near(what, value == reported.end() ? -1 : value->second, found, tolerance);
  };
  const Distribution &angle = volume.min_dihedral_deg, &aspect = volume.aspect_ratio;
  near_one(mesh.angles, "min", "least dihedral angle", angle.min, 0.01);
  near_one(mesh.angles, "max", "greatest dihedral angle", volume.max_dihedral_deg, 0.01);
  near_one(mesh.angles, "p0_01", "0.01 % quantile of dihedral angles", angle.p0_01, 0.1);
  near_one(mesh.angles, "p0_1", "0.1 % quantile of dihedral angles", angle.p0_1, 0.1);
  near_one(mesh.angles, "p1", "1 % quantile of dihedral angles", angle.p1, 0.1);
  near_one(mesh.angles, "median", "median of dihedral angles", angle.median, 0.1);
  near_one(mesh.aspects, "median", "median of aspect ratios", aspect.median, 0.01 * aspect.median);
  near_one(mesh.aspects, "p99", "99 % quantile of aspect ratios", aspect.p99, 0.01 * aspect.p99);
  near_one(mesh.aspects, "max", "greatest aspect ratio", aspect.max, 1e-4 * aspect.max);
  near("least vertical edge", mesh.min_vertical_gap, volume.least_vertical_edge, 1e-6);
  if (mesh.top) {
    near("elevation of the top", *mesh.top, surface.highest, 1e-6);
    near("lowest vertex of the flat top", *mesh.top, surface.lowest_top, 1e-6);
  }
  near("closed boundary", mesh.closed ? 1 : 0, surface.closed ? 1 : 0, 0);
  near("manifold boundary", mesh.manifold ? 1 : 0, surface.manifold ? 1 : 0, 0);
  for (const auto& [name, faces] : surface.faces_by_patch) {
    const auto reported = mesh.faces_by_patch.find(name);
    near("number of faces of " + name,
         reported == mesh.faces_by_patch.end() ? 0 : static_cast<double>(reported->second),
         static_cast<double>(faces), 0);
  }
}

void compare_account(const CityModel& city, const std::optional<ReportedFacts>& report,
                     CheckedFile& file) {
  if (!report || !report->footprint_parts) {
    file.not_checked.emplace_back(
        "that every input feature is accounted for (no report.json of the run that made the city)");
    return;
  }
  std::size_t accounted = city.dropped.size();
  for (const Building& building : city.buildings) accounted += building.source_ids.size();
  const std::size_t parts = *report->footprint_parts;
  if (parts != accounted)
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

void compare_city(const CityModel& city, const CityCheck& check, const ReportedFacts& report,
                  CheckedFile& file) {
  if (report.city)
    compare_buildings(city, check, *report.city, report.footprint_parts.has_value(), file);
  if (report.origin && *report.origin != city.origin)
    differs("origin", fmt::format("({}, {})", report.origin->x, report.origin->y),
            fmt::format("({}, {})", city.origin.x, city.origin.y), file);
  // `mesh` takes models without a system, which the terrain may have.
  const bool is_unknown = city.crs.empty() && !report.footprint_parts;
  if (report.crs && *report.crs != city.crs && !is_unknown &&
      !same_horizontal_crs(*report.crs, city.crs))
    differs("reference system", crs_name(*report.crs), crs_name(city.crs), file);
  // `mesh --bounds` leaves the model with its own domain.
  if (report.domain && report.footprint_parts)
    compare_boxes(*report.domain, city.domain.moved(city.origin).bounds(), file);
}

void compare_terrain(const RasterInput& terrain, const CityModel& city,
                     const std::optional<ReportedFacts>& report, CheckedFile& file) {
  const bool is_result = report && report->dtm_step;  // `mesh` takes terrains without a system
  if (is_result && report->crs && !report->crs->empty() && terrain.crs.empty())
    differs("reference system", crs_name(*report->crs), "none", file);
  if (report && report->crs && !report->crs->empty() && city.crs.empty() && !terrain.crs.empty() &&
      !same_horizontal_crs(*report->crs, terrain.crs))
    differs("reference system", crs_name(*report->crs), crs_name(terrain.crs), file);
  if (!terrain.crs.empty() && !city.crs.empty() && !same_horizontal_crs(terrain.crs, city.crs))
    file.violations.push_back(
        {"terrain and city model in different reference systems", 1,
         fmt::format("{} and {}", crs_name(terrain.crs), crs_name(city.crs))});
  const double step = terrain.raster.step;
  if (report && report->dtm_step)
    compare("step of the terrain", *report->dtm_step, step * (1 - 1e-9), step, step * (1 + 1e-9),
            file);
}

void compare_domain(const SurfaceCheck& surface, const std::optional<ReportedFacts>& report,
                    CheckedFile& file) {
  if (!report || !report->domain || !report->mesh) return;
  const Point2 origin = report->absolute ? Point2{0, 0} : report->origin.value_or(Point2{0, 0});
  compare_boxes(*report->domain, surface.box.moved(origin), file);
}

void compare_origin(const std::optional<Point3>& origin, const std::optional<ReportedFacts>& report,
                    CheckedFile& file) {
  if (!report || !report->origin || !report->mesh) return;
  if (!origin) {
    file.not_checked.emplace_back("the origin (the file does not state it, or not as text)");
    return;
  }
  const Point3 expected =
      report->absolute ? Point3{0, 0, 0} : Point3{report->origin->x, report->origin->y, 0};
  if (*origin != expected)
    differs("origin", fmt::format("{}", fmt::join(expected, ", ")),
            fmt::format("{}", fmt::join(*origin, ", ")), file);
}

}  // namespace tetropolis
