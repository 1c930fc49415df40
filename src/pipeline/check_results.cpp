#include "tetropolis/pipeline/check_results.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tetropolis/check/check_city.h"
#include "tetropolis/check/check_ground.h"
#include "tetropolis/check/check_heights.h"
#include "tetropolis/check/check_regions.h"
#include "tetropolis/check/check_same_boundary.h"
#include "tetropolis/check/check_surface.h"
#include "tetropolis/check/check_volume.h"
#include "tetropolis/core/error.h"
#include "tetropolis/core/files.h"
#include "tetropolis/core/units.h"
#include "tetropolis/io/cityjson.h"
#include "tetropolis/io/crs.h"
#include "tetropolis/io/geotiff.h"
#include "tetropolis/io/vtk.h"
#include "tetropolis/io/xdmf.h"
#include "tetropolis/pipeline/config.h"

namespace tetropolis {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr double kDefaultDistance = 1;
constexpr const char* kRawCity = "city_raw.city.json";
constexpr const char* kCity = "city.city.json";

/// Results in formats that are not read back.
constexpr std::array kUnread = {"surface.stl", "volume.msh",  "constant/polyMesh",
                                "surface.obj", "surface.ply", "surface.glb"};

/// What report.json says that the files must bear out.
struct ReportedMesh {
  double cells, vertices, inverted, volume, triangles, least_angle, greatest_angle, ground_lowered;
};

struct ReportedGround {
  double triangles, least_angle, below_min_angle;
};

struct ReportedFacts {
  double min_distance = kDefaultDistance;
  bool absolute = false;
  std::optional<std::size_t> footprint_parts;
  std::int64_t buildings = -1;       ///< Of city.city.json.
  std::vector<std::string> dropped;  ///< Ids, sorted; likewise.
  std::optional<Point2> origin;
  std::optional<std::array<double, 4>> domain;  ///< CRS coordinates.
  std::optional<std::string> crs;
  std::optional<ReportedMesh> mesh;
  std::optional<double> min_angle;
  double min_wall = Config{}.min_wall_height;
  CutsCheck cuts;
  ReportedGround ground{};
};

/// In the local frame.
CutSources cuts_of(const Json& report) {
  CutSources cuts;
  const Json volume = report.value("volume_mesh", Json::object());
  cuts.roofs = volume.value("roofs_cut_back", std::vector<BuildingIndex>());
  for (const Point3& foot : volume.value("feet_cut_back", std::vector<Point3>())) {
    const auto origin = report.at("origin").get<std::array<double, 2>>();
    cuts.feet.push_back({foot[0] - origin[0], foot[1] - origin[1], foot[2]});
  }
  return cuts;
}

/// What is not in the report differs from every file.
ReportedFacts facts_of(const Json& report) {
  const Json config = report.value("config", Json::object());
  ReportedFacts facts;
  facts.min_distance = config.value("min_building_distance", kDefaultDistance);
  facts.absolute = config.value("coordinates", std::string("local")) == "absolute";
  if (config.contains("min_angle")) facts.min_angle = config["min_angle"].get<double>();
  facts.min_wall = config.value("min_wall_height", facts.min_wall);
  const double cut_slope = config.value("cut_slope", Config{}.cut_slope);
  if (!(cut_slope > 0 && cut_slope <= 90)) throw std::out_of_range("cut_slope");
  facts.cuts.slopes.at_start = std::tan(to_radians(cut_slope));
  facts.cuts.from = cuts_of(report);
  const Json ground = report.value("ground_mesh", Json::object());
  facts.ground = {ground.value("triangles", -1.0), ground.value("min_angle_deg", -1.0),
                  ground.value("triangles_below_min_angle", -1.0)};
  if (report.contains("input"))
    facts.footprint_parts = report["input"].value("footprint_parts", std::size_t{0});
  if (report.contains("city")) {
    facts.buildings = report["city"].value("buildings", std::int64_t{-1});
    for (const Json& dropped : report["city"].value("dropped", Json::array()))
      facts.dropped.push_back(dropped.value("source_id", std::string()));
    std::sort(facts.dropped.begin(), facts.dropped.end());
  }
  if (report.contains("origin"))
    facts.origin =
        Point2{report["origin"].at(0).get<double>(), report["origin"].at(1).get<double>()};
  if (report.contains("domain")) facts.domain = report["domain"].get<std::array<double, 4>>();
  if (report.contains("crs")) facts.crs = normalise_crs(report["crs"].get<std::string>());
  if (!report.contains("volume_mesh")) return facts;
  const Json& volume = report["volume_mesh"];
  const Json surface = report.value("surface_mesh", Json::object());
  const Json angles = volume.value("dihedral_deg", Json::object());
  facts.mesh = {volume.value("cells", -1.0),      volume.value("vertices", -1.0),
                volume.value("inverted", -1.0),   volume.value("volume", -1.0),
                surface.value("triangles", -1.0), angles.value("min", -1.0),
                angles.value("max", -1.0),        volume.value("ground_lowered", -1.0)};
  return facts;
}

/// Of report.json in the folder, if there is one.
std::optional<ReportedFacts> read_report(const fs::path& folder) {
  const fs::path path = folder / "report.json";
  std::error_code error;
  if (fs::is_fifo(path, error))  // which would be waited for
    throw Error(ErrorKind::kInput, path.string() + ": is not an ordinary file");
  std::ifstream file(path);
  if (!file) return std::nullopt;
  try {
    const Json json = Json::parse(file);
    if (json.is_object()) return facts_of(json);
  } catch (const Json::exception&) {         // no JSON, or members of other types than a report's
  } catch (const std::ios_base::failure&) {  // not even a file
  } catch (const std::out_of_range&) {       // values that no report has
  } catch (const Error&) {                   // a reference system that nobody knows
  }
  throw Error(ErrorKind::kInput, path.string() + ": not a report of tetropolis");
}

double percent(std::int64_t part, std::int64_t whole) {
  return whole == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(whole);
}

CheckedFile describe(const std::string& name, const VolumeCheck& check) {
  CheckedFile file{name, {}, check.violations, {}};
  const Distribution& angle = check.min_dihedral_deg;
  file.facts = {
      fmt::format("{} vertices, {} tets, {} inverted", check.vertices, check.cells, check.inverted),
      fmt::format("volume {:.3f} m3, {} boundary faces", check.volume, check.boundary_faces),
      fmt::format("dihedral angles: least {:.2f}, 0.01 % {:.2f}, 0.1 % {:.2f}, 1 % {:.2f}, median "
                  "of least {:.2f}, "
                  "greatest {:.2f} degrees",
                  angle.min, angle.p0_01, angle.p0_1, angle.p1, angle.median,
                  check.max_dihedral_deg),
      fmt::format("cells below {} degrees: {} ({:.4f} %)", kSliverDegrees, check.slivers,
                  percent(check.slivers, check.cells)),
      fmt::format("{} faces between cells: non-orthogonality mean {:.2f}, greatest {:.2f} degrees, "
                  "{} above 70; skewness at most {:.2f}",
                  check.faces.internal, check.faces.mean_non_orthogonality_deg,
                  check.faces.max_non_orthogonality_deg, check.faces.above_70,
                  check.faces.max_skewness),
      fmt::format("aspect ratio: median {:.2f}, 99 % {:.2f}, greatest {:.2f}",
                  check.aspect_ratio.median, check.aspect_ratio.p99, check.aspect_ratio.max)};
  return file;
}

CheckedFile describe(const std::string& name, const SurfaceCheck& check) {
  CheckedFile file{name, {}, check.violations, {}};
  std::string patches;
  for (int i = 0; i < kPatchCount; ++i)
    patches += fmt::format("{}{} {}", i == 0 ? "" : ", ", patch_name(static_cast<Patch>(i + 1)),
                           check.faces_by_patch[static_cast<std::size_t>(i)]);
  file.facts = {
      fmt::format("{} triangles, {}, {}", check.triangles, check.closed ? "closed" : "open",
                  check.manifold ? "manifold" : "not manifold"),
      fmt::format("encloses {:.3f} m3", check.enclosed_volume), "faces: " + patches};
  return file;
}

/// A boundary and what it is called in what is printed.
struct NamedSurface {
  std::string name;
  SurfaceMesh mesh;
};

std::string grid_name(const std::string& file, const char* grid) {
  return fmt::format("{}, grid '{}'", file, grid);
}

CheckedFile check_one_volume(const fs::path& path, const Progress& progress) {
  CheckedFile file = describe(path.filename().string(), check_volume(read_vtu(path), progress));
  file.not_checked = {
      "the boundary's tags, regions, footprints in the mesh, heights and the "
      "report (check the folder that has the other results)"};
  return file;
}

CheckedFile check_one_surface(const fs::path& path) {
  CheckedFile file = describe(path.filename().string(), check_surface(read_vtp(path)));
  file.not_checked = {
      "the volume behind it, footprints in the mesh, heights and the report (check "
      "the folder that has the other results)"};
  return file;
}

CheckedFile check_city_model(const std::string& name, const CityModel& city,
                             std::optional<double> min_distance,
                             const std::optional<ReportedFacts>& report) {
  if (!min_distance && name != kRawCity)
    min_distance = report ? report->min_distance : kDefaultDistance;
  const CityCheck check = check_city(city, min_distance);
  CheckedFile file{name, {}, check.violations, {}};
  file.facts = {fmt::format("{} buildings, {} dropped features, {:.1f} m2", check.buildings,
                            check.dropped, check.area)};
  if (min_distance)
    file.facts.push_back(
        fmt::format("clearance {:.6f} m, {} m asked", check.min_clearance, *min_distance));
  return file;
}

/// A number of the report that the files must bear out: between `low` and `high`.
void compare(const char* what, double reported, double low, double found, double high,
             CheckedFile& file) {
  if (reported >= low && reported <= high) return;
  file.violations.push_back({fmt::format("{} differs from report.json", what), 1,
                             fmt::format("{} reported, {} found", reported, found)});
}

void compare_with_report(const ReportedMesh& mesh, const VolumeCheck& volume,
                         const SurfaceCheck& surface, CheckedFile& file) {
  const auto near = [&](const char* what, double reported, double found, double tolerance) {
    compare(what, reported, found - tolerance, found, found + tolerance, file);
  };
  near("number of cells", mesh.cells, static_cast<double>(volume.cells), 0);
  near("number of vertices", mesh.vertices, static_cast<double>(volume.vertices), 0);
  near("inverted cells", mesh.inverted, static_cast<double>(volume.inverted), 0);
  near("volume", mesh.volume, volume.volume, 1e-9 * volume.volume);
  near("enclosed volume", volume.volume, surface.enclosed_volume, 1e-7 * volume.volume);
  near("boundary triangles", mesh.triangles, static_cast<double>(surface.triangles), 0);
  near("least dihedral angle", mesh.least_angle, volume.min_dihedral_deg.min, 0.01);
  near("greatest dihedral angle", mesh.greatest_angle, volume.max_dihedral_deg, 0.01);
}

/// Guarantee 3: footprints in the mesh, and its angles if the report says what was asked for.
void check_ground_mesh(const SurfaceMesh& surface, std::array<double, 3> shift,
                       const CityModel& city, const std::optional<ReportedFacts>& report,
                       CheckedFile& file) {
  const bool known = report && report->mesh && report->min_angle;
  const GroundCheck check = check_ground(surface, shift, city, known ? *report->min_angle : 0);
  file.violations.insert(file.violations.end(), check.violations.begin(), check.violations.end());
  file.facts.push_back(
      fmt::format("{} triangles in the plan, least angle {:.2f} degrees; outlines of roofs "
                  "compared with the footprints",
                  check.triangles, check.least_angle_deg));
  if (!known) {
    file.not_checked.emplace_back(
        "the least angle of the ground mesh (no report.json that says what was asked for)");
    return;
  }
  const ReportedGround& ground = report->ground;
  const auto triangles = static_cast<double>(check.triangles);
  compare("number of ground triangles", ground.triangles, triangles, triangles, triangles, file);
  compare("least angle of the ground mesh", ground.least_angle, check.least_angle_bounds_deg[0],
          check.least_angle_deg, check.least_angle_bounds_deg[1], file);
  compare("number of triangles below the minimum angle", ground.below_min_angle,
          static_cast<double>(check.below_bounds[0]), static_cast<double>(check.below),
          static_cast<double>(check.below_bounds[1]), file);
  file.facts.push_back(
      fmt::format("{} triangles below {} degrees", check.below, *report->min_angle));
}

void check_heights_of(const fs::path& terrain, const SurfaceMesh& surface,
                      std::array<double, 3> shift, const CityModel& city,
                      const std::optional<ReportedFacts>& report, CheckedFile& file) {
  const ReportedFacts facts = report.value_or(ReportedFacts{});
  const HeightsCheck check = check_heights(surface, shift, read_raster(terrain, city.origin).raster,
                                           city, facts.min_wall, facts.cuts);
  file.violations.insert(file.violations.end(), check.violations.begin(), check.violations.end());
  file.facts.push_back(fmt::format(
      "{} ground vertices on the terrain ({} lowered at walls, around roofs and at feet), {} "
      "roof vertices at their roof's height",
      check.ground_vertices, check.lowered, check.roof_vertices));
  if (report && report->mesh)
    compare("number of lowered ground vertices", report->mesh->ground_lowered,
            static_cast<double>(check.lowered), static_cast<double>(check.lowered),
            static_cast<double>(check.lowered + check.perhaps_lowered), file);
}

CheckedFile check_against_city(const std::string& name, const fs::path& folder, const TetMesh& mesh,
                               const SurfaceMesh& surface, const CityModel& city,
                               const std::optional<ReportedFacts>& report) {
  std::array<double, 3> shift{0, 0, 0};
  if (report && report->absolute) shift = {-city.origin.x, -city.origin.y, 0};
  CheckedFile file{name, {}, check_regions(mesh, shift, city), {}};
  file.facts.emplace_back("regions of cells compared with the footprints");
  check_ground_mesh(surface, shift, city, report, file);
  if (is_there(folder / "dtm.tif"))
    check_heights_of(folder / "dtm.tif", surface, shift, city, report, file);
  else
    file.not_checked.emplace_back("heights (there is no dtm.tif)");
  return file;
}

/// Guarantee 1 needs the number of input features, which only the report knows.
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

std::vector<std::string> all_source_ids(const CityModel& city) {
  std::vector<std::string> ids;
  for (const Building& building : city.buildings)
    ids.insert(ids.end(), building.source_ids.begin(), building.source_ids.end());
  for (const Dropped& feature : city.dropped) ids.push_back(feature.source_id);
  std::sort(ids.begin(), ids.end());
  return ids;
}

/// Both models are of the same features.
void compare_features(const CityModel& raw, const CityModel& city, CheckedFile& file) {
  const std::vector<std::string> before = all_source_ids(raw), after = all_source_ids(city);
  std::vector<std::string> lost, new_ids;
  std::set_difference(before.begin(), before.end(), after.begin(), after.end(),
                      std::back_inserter(lost));
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(),
                      std::back_inserter(new_ids));
  if (!lost.empty())
    file.violations.push_back({fmt::format("features of {} that are not here", kRawCity),
                               static_cast<std::int64_t>(lost.size()), lost.front()});
  if (!new_ids.empty())
    file.violations.push_back({fmt::format("features that are not in {}", kRawCity),
                               static_cast<std::int64_t>(new_ids.size()), new_ids.front()});
}

/// The final model is the one that the report tells of.
void compare_city(const CityModel& city, const ReportedFacts& report, CheckedFile& file) {
  const auto differs = [&](const char* what, const std::string& details) {
    file.violations.push_back({fmt::format("{} differs from report.json", what), 1, details});
  };
  const auto buildings = static_cast<std::int64_t>(city.buildings.size());
  if (report.buildings >= 0 && report.buildings != buildings)
    differs("number of buildings",
            fmt::format("{} reported, {} found", report.buildings, buildings));
  std::vector<std::string> dropped;
  for (const Dropped& feature : city.dropped) dropped.push_back(feature.source_id);
  std::sort(dropped.begin(), dropped.end());
  if (report.buildings >= 0 && report.dropped != dropped)
    differs("list of dropped features",
            fmt::format("{} reported, {} found", report.dropped.size(), dropped.size()));
  if (report.origin && *report.origin != city.origin)
    differs("origin", fmt::format("({}, {}) reported, ({}, {}) found", report.origin->x,
                                  report.origin->y, city.origin.x, city.origin.y));
  if (report.crs && *report.crs != city.crs && !same_horizontal_crs(*report.crs, city.crs))
    differs("reference system",
            fmt::format("{} reported, {} found", crs_name(*report.crs), crs_name(city.crs)));
  constexpr double kSame = 1e-6;  // metres
  const Bounds2 domain = city.domain.moved(city.origin);
  const std::array sides{domain.xmin, domain.ymin, domain.xmax, domain.ymax};
  // `mesh --bounds` leaves the model with its own domain.
  if (report.domain && report.footprint_parts && !city.domain.empty() &&
      !std::equal(sides.begin(), sides.end(), report.domain->begin(),
                  [](double a, double b) { return std::abs(a - b) <= kSame; }))
    differs("domain",
            fmt::format("x {} .. {}, y {} .. {} reported, x {} .. {}, y {} .. {} found",
                        (*report.domain)[0], (*report.domain)[2], (*report.domain)[1],
                        (*report.domain)[3], domain.xmin, domain.xmax, domain.ymin, domain.ymax));
}

/// The volume, and each of the boundaries, which are all to be that of the volume, against it.
std::vector<CheckedFile> check_volume_and_boundaries(const std::string& volume, const TetMesh& mesh,
                                                     const std::vector<NamedSurface>& boundaries,
                                                     const std::optional<ReportedFacts>& report,
                                                     const Progress& progress) {
  const VolumeCheck volume_check = check_volume(mesh, progress);
  std::vector<CheckedFile> files{describe(volume, volume_check)};
  for (const NamedSurface& boundary : boundaries) {
    const SurfaceCheck surface_check = check_surface(boundary.mesh);
    files.push_back(describe(boundary.name, surface_check));
    CheckedFile both{fmt::format("{} and {}", volume, boundary.name),
                     {"faces of one compared with faces of the other"},
                     check_same_boundary(mesh, volume_check, boundary.mesh),
                     {}};
    if (report && report->mesh)
      compare_with_report(*report->mesh, volume_check, surface_check, both);
    else
      both.not_checked.emplace_back("numbers of the run (no report.json that has them)");
    files.push_back(both);
  }
  return files;
}

/// A mesh of the folder; `city` is city.city.json if that is there.
void add_mesh(const std::string& volume, const TetMesh& mesh,
              const std::vector<NamedSurface>& boundaries, const fs::path& folder,
              const CityModel& city, const std::optional<ReportedFacts>& report,
              const Progress& progress, std::vector<CheckedFile>& files) {
  for (CheckedFile& file : check_volume_and_boundaries(volume, mesh, boundaries, report, progress))
    files.push_back(std::move(file));
  if (!is_there(folder / kCity)) {
    files.back().not_checked.emplace_back(
        "regions, footprints in the mesh and heights (there is no city.city.json)");
    return;
  }
  for (const NamedSurface& boundary : boundaries)
    files.push_back(
        check_against_city(fmt::format("{}, {}, city model and terrain", volume, boundary.name),
                           folder, mesh, boundary.mesh, city, report));
}

/// What is in the folder of volume and boundary, one format after the other.
void add_meshes(const fs::path& folder, const CityModel& city,
                const std::optional<ReportedFacts>& report, const Progress& progress,
                std::vector<CheckedFile>& files) {
  const auto there = [&](const char* name) { return is_there(folder / name); };
  const bool vtu = there("volume.vtu"), vtp = there("boundary.vtp"), xdmf = there("volume.xdmf");
  std::vector<NamedSurface> vtp_boundary;
  if (vtp && (vtu || xdmf))
    vtp_boundary.push_back({"boundary.vtp", read_vtp(folder / "boundary.vtp")});
  if (vtu && vtp)
    add_mesh("volume.vtu", read_vtu(folder / "volume.vtu"), vtp_boundary, folder, city, report,
             progress, files);
  else if (vtu)
    files.push_back(check_one_volume(folder / "volume.vtu", progress));
  else if (vtp && !xdmf)
    files.push_back(check_one_surface(folder / "boundary.vtp"));
  if (xdmf) {
    XdmfMesh mesh = read_xdmf(folder / "volume.xdmf");
    std::vector<NamedSurface> boundaries = vtu ? std::vector<NamedSurface>() : vtp_boundary;
    boundaries.push_back({grid_name("volume.xdmf", "boundary"), std::move(mesh.boundary)});
    add_mesh(grid_name("volume.xdmf", "mesh"), mesh.volume, boundaries, folder, city, report,
             progress, files);
  } else if (report && report->mesh && !(vtu && vtp)) {
    files.push_back(
        {"meshes", {}, {}, {"there is neither volume.vtu with boundary.vtp nor volume.xdmf"}});
  }
}

std::vector<CheckedFile> check_one_xdmf(const fs::path& path, const Progress& progress) {
  XdmfMesh mesh = read_xdmf(path);
  const std::string name = path.filename().string();
  std::vector<CheckedFile> files = check_volume_and_boundaries(
      grid_name(name, "mesh"), mesh.volume,
      {{grid_name(name, "boundary"), std::move(mesh.boundary)}}, std::nullopt, progress);
  files.back().not_checked = {
      "regions, footprints in the mesh, heights and the report (check the folder that has the "
      "other results)"};
  return files;
}

/// Whoever hands on one of these files is to know that nobody has looked into it.
void add_unread(const fs::path& folder, std::vector<CheckedFile>& files) {
  std::vector<std::string_view> there;
  for (const char* name : kUnread)
    if (is_there(folder / name)) there.emplace_back(name);
  if (!there.empty())
    files.push_back(
        {"other formats", {fmt::format("not read: {}", fmt::join(there, ", "))}, {}, {}});
}

std::vector<CheckedFile> check_folder(const fs::path& folder, std::optional<double> min_distance,
                                      const Progress& progress) {
  const std::optional<ReportedFacts> report = read_report(folder);
  const auto there = [&](const char* name) { return is_there(folder / name); };
  std::vector<CheckedFile> files;
  CityModel city;
  std::optional<CityModel> raw;
  for (const char* name : {kRawCity, kCity}) {
    if (!there(name)) continue;
    city = read_city(folder / name);
    files.push_back(check_city_model(
        name, city, std::string_view(name) == kRawCity ? std::nullopt : min_distance, report));
    compare_account(city, report, files.back());
    if (std::string_view(name) == kRawCity) {
      raw = city;
      continue;
    }
    // A model that was meshed by itself may be another one than the raw model beside it.
    if (raw && report && report->footprint_parts) compare_features(*raw, city, files.back());
    if (report) compare_city(city, *report, files.back());
  }
  add_meshes(folder, city, report, progress, files);
  if (files.empty())
    throw Error(
        ErrorKind::kInput,
        folder.string() +
            ": holds no result of tetropolis (no city.city.json, no volume.vtu or volume.xdmf)");
  add_unread(folder, files);
  return files;
}

/// By itself, so a report beside it that is another program's is no reason to give up.
CheckedFile check_one_city(const fs::path& path, std::optional<double> min_distance) {
  std::optional<ReportedFacts> report;
  std::vector<std::string> not_checked{
      "that every input feature is accounted for, and the meshes (check the "
      "folder that has the other results)"};
  try {
    report = read_report(path.parent_path());
  } catch (const Error& error) {
    not_checked.push_back(fmt::format("what report.json asks for ({})", error.what()));
  }
  CheckedFile file =
      check_city_model(path.filename().string(), read_city(path), min_distance, report);
  file.not_checked = std::move(not_checked);
  return file;
}

}  // namespace

std::vector<CheckedFile> check_path(const fs::path& path, std::optional<double> min_distance,
                                    const Progress& progress) {
  if (!is_there(path)) throw Error(ErrorKind::kInput, path.string() + ": no such file or folder");
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return check_folder(path, min_distance, progress);
  if (path.extension() == ".vtu") return {check_one_volume(path, progress)};
  if (path.extension() == ".vtp") return {check_one_surface(path)};
  if (path.extension() == ".xdmf") return check_one_xdmf(path, progress);
  if (path.extension() == ".json") return {check_one_city(path, min_distance)};
  throw Error(
      ErrorKind::kInput,
      path.string() + ": is not a .vtu, .vtp, .xdmf or .city.json file or a folder of results");
}

}  // namespace tetropolis
