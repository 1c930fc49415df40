#include "tetropolis/check/check_results.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tetropolis/check/check_city.h"
#include "tetropolis/check/check_surface.h"
#include "tetropolis/check/check_volume.h"
#include "tetropolis/core/error.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/mesh/stl.h"
#include "tetropolis/io/mesh/vtk.h"
#include "tetropolis/io/mesh/xdmf.h"
#include "tetropolis/io/raster/geotiff.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/pipeline/mesh_city.h"
#include "tetropolis/pipeline/meshable.h"
#include "tetropolis/run/config.h"

#include "check_ground.h"
#include "check_heights.h"
#include "check_members.h"
#include "check_prisms.h"
#include "check_regions.h"
#include "check_same_boundary.h"
#include "check_same_surface.h"
#include "compare_report.h"
#include "core/files.h"
#include "core/is_among.h"
#include "core/text.h"
#include "describe_checks.h"
#include "reported_run.h"
#include "run/result_files.h"
#include "violations.h"

namespace tetropolis {

namespace {

namespace fs = std::filesystem;

/// A mesh of a file, what it is called in what is printed, and the origin that the file gives.
template <typename Mesh>
struct Named {
  std::string name;
  Mesh mesh;
  std::optional<Point3> origin;
};
using NamedVolume = Named<TetMesh>;
using NamedSurface = Named<SurfaceMesh>;

CheckedFile check_one_volume(const fs::path& path, const TetMesh& mesh, const Progress& progress) {
  CheckedFile file = describe(path.filename().string(), check_volume(mesh, progress));
  file.not_checked = {
      "the boundary's tags, regions, footprints in the mesh, heights and the "
      "report (check the folder that has the other results)"};
  return file;
}

/// surface.vtp, whatever its name, and not a boundary.
bool is_city_surface(const SurfaceMesh& surface) {
  return std::none_of(surface.patch.begin(), surface.patch.end(), [&](Patch patch) {
    const PatchKind kind = surface.patches.of(patch).kind;
    return kind == PatchKind::kTop || kind == PatchKind::kSide;
  });
}

/// Of a file of the folder, whose name says which part it is.
template <typename Mesh>
Mesh read_xdmf_as(const fs::path& path) {
  auto mesh = read_xdmf(path);
  if (auto* wanted = std::get_if<Mesh>(&mesh)) return std::move(*wanted);
  throw Error(ErrorKind::kInput,
              path.string() + ": holds another part of the mesh than its name says");
}

/// The clearance that the model must have: what `min_distance` says or else the report, of the raw
/// model nothing.
std::optional<double> distance_asked(const std::string& name, std::optional<double> min_distance,
                                     const std::optional<ReportedRun>& report) {
  if (min_distance || name == results::kRawCity) return min_distance;
  return report ? report->report.config.min_building_distance : Config{}.min_building_distance;
}

/// Of what the reader of a model noticed, what is wrong in a model of ours: as a violation if it is
/// a result, and in words if it is only what `mesh` has read, which uses the attributes.
void note_changes(const std::vector<Warning>& warnings, bool is_result, CheckedFile& file) {
  for (const Warning& warning : warnings) {
    const bool solids = warning.code == "city_solids_differ";
    if (!solids && warning.code != "city_extent_differs") continue;
    if (!is_result)
      file.facts.push_back(warning.message);
    else if (solids)
      file.violations.push_back({"solids that are not what their ground, h_ground and h_roof make",
                                 warning.count, warning.message});
    else
      file.violations.push_back({"wrong extent", warning.count, warning.message});
  }
}

/// Guarantee 3: footprints in the mesh, and its angles if the report says what was asked for.
void check_ground_mesh(const SurfaceMesh& surface, std::array<double, 3> shift,
                       const CityModel& city, const std::optional<ReportedRun>& report,
                       CheckedFile& file) {
  const bool known = report && report->report.ground_mesh;
  const double min_angle = known ? report->report.config.min_angle : 0;
  const GroundCheck check = check_ground(surface, shift, city, min_angle);
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
  const GroundMeshFacts& ground = *report->report.ground_mesh;
  const auto triangles = static_cast<double>(check.triangles);
  compare("number of ground triangles", static_cast<double>(ground.triangles), triangles, triangles,
          triangles, file);
  compare("least angle of the ground mesh", ground.min_angle_deg, check.least_angle_bounds_deg[0],
          check.least_angle_deg, check.least_angle_bounds_deg[1], file);
  compare("number of triangles below the minimum angle",
          static_cast<double>(ground.triangles_below_min_angle),
          static_cast<double>(check.below_bounds[0]), static_cast<double>(check.below),
          static_cast<double>(check.below_bounds[1]), file);
  file.facts.push_back(fmt::format("{} triangles below {} degrees", check.below, min_angle));
}

void check_heights_of(const Raster& terrain, const TetMesh& mesh, const SurfaceMesh& surface,
                      std::array<double, 3> shift, const CityModel& city,
                      const std::optional<ReportedRun>& report, CheckedFile& file) {
  const Config config = report ? report->report.config : Config{};
  const bool whole = mesh.cells.empty();
  const double min_wall =
      whole ? std::max(config.min_wall_height, kWallOfPrisms) : config.min_wall_height;
  const int count = config.boundary_layers == 0 && (whole || config.cells == Cells::kPrisms)
                        ? kLayersBelowPrisms
                        : config.boundary_layers;
  const LayersCheck layers = check_prism_layers(mesh, surface, config.first_layer, count);
  const HeightsCheck check =
      check_heights(surface, shift, terrain, city, min_wall,
                    report ? std::optional(report->excavated) : std::nullopt, layers.height);
  if (layers.columns > 0) {
    file.facts.push_back(
        fmt::format("layers: growth at most {:.4f}; the lowest is {} m high over "
                    "{:.2f} % of the ground",
                    layers.greatest_growth, config.first_layer, 100 * layers.share_as_asked));
    if (report && report->has_mesh()) {
      if (layers.greatest_growth > config.layer_growth + 1e-6)
        note_violation(file.violations, "layers that grow faster than asked", [&] {
          return fmt::format("{:.6f}, {} asked", layers.greatest_growth, config.layer_growth);
        });
      const double share = layers.share_as_asked;
      compare("share of lowest layers as high as asked",
              report->report.volume_mesh->prisms.share_as_asked, share - 1e-6, share, share + 1e-6,
              file);
    }
  }
  file.violations.insert(file.violations.end(), check.violations.begin(), check.violations.end());
  file.facts.push_back(fmt::format(
      "{} ground vertices on the terrain ({} lowered at walls, around roofs and at slope toes), {} "
      "roof vertices at their roof's height",
      check.ground_vertices, check.lowered, check.roof_vertices));
  if (check.roof_snapped > 0)
    file.facts.push_back(
        fmt::format("{} corners of roofs are more than a centimetre off their plane, to meet the "
                    "roof beside it; {:.3f} m at most",
                    check.roof_snapped, check.most_snapped));
  if (report && report->has_mesh())
    compare("number of lowered ground vertices",
            static_cast<double>(report->report.volume_mesh->ground_lowered),
            static_cast<double>(check.lowered), static_cast<double>(check.lowered),
            static_cast<double>(check.lowered + check.perhaps_lowered), file);
}

/// What a mesh was made from. Empty paths where it is not to be found.
struct Sources {
  fs::path city, terrain;
  fs::path city_wanted, terrain_wanted;     ///< Where they were to be.
  std::optional<RasterInput> read_terrain;  ///< Where there is a city, too.
};

/// In the folder, if its report tells of it; where `mesh` has read it; or else in the folder.
Sources find_sources(const fs::path& folder, const std::optional<ReportedRun>& report) {
  const auto find = [&](const char* name, const fs::path& read) {
    const bool told = report && is_among(name, report->report.files);
    if (!told && !read.empty() && is_there(read)) return read;
    return is_there(folder / name) ? folder / name : fs::path();
  };
  const fs::path city = report ? report->city_model : fs::path();
  const fs::path terrain = report ? report->terrain : fs::path();
  return {find(results::kCity, city), find(results::kTerrain, terrain),
          city.empty() ? results::kCity : city, terrain.empty() ? results::kTerrain : terrain,
          std::nullopt};
}

CheckedFile check_against_city(const std::string& name, const Sources& sources, const TetMesh& mesh,
                               const SurfaceMesh& surface, const CityModel& city,
                               const std::optional<ReportedRun>& report) {
  std::array<double, 3> shift{0, 0, 0};
  if (report && report->is_absolute()) shift = {-city.origin.x, -city.origin.y, 0};
  CheckedFile file{name, {}, check_regions(mesh, shift, city), {}};
  file.facts.emplace_back("regions of cells compared with the footprints");
  check_ground_mesh(surface, shift, city, report, file);
  if (sources.read_terrain)
    check_heights_of(sources.read_terrain->raster, mesh, surface, shift, city, report, file);
  else
    file.not_checked.push_back(
        fmt::format("heights (there is no {})", sources.terrain_wanted.string()));
  return file;
}

/// What a file of the folder, or one from elsewhere, is called in what is printed.
std::string shown_name(const fs::path& path, const fs::path& folder) {
  return path.parent_path() == folder ? path.filename().string() : path.string();
}

CheckedFile check_terrain(const std::string& name, const RasterInput& terrain,
                          const CityModel& city, const std::optional<ReportedRun>& report) {
  const auto [low, high] =
      std::minmax_element(terrain.raster.values.begin(), terrain.raster.values.end());
  CheckedFile file{name,
                   {fmt::format("{} x {} nodes, {} m apart, {:.2f} to {:.2f} m", terrain.raster.nx,
                                terrain.raster.ny, terrain.raster.step, *low, *high)},
                   {},
                   {}};
  compare_terrain(terrain, city, report, file);
  return file;
}

CheckedFile check_layers(const fs::path& folder, const ReportedRun& report) {
  const std::vector<VectorLayer> layers = list_layers(folder / results::kLayers);
  CheckedFile file{results::kLayers, {}, {}, {}};
  for (const VectorLayer& layer : layers)
    file.facts.push_back(fmt::format("{} {}", layer.features, layer.name));
  if (report.report.city) compare_layers(layers, report.report, file);
  return file;
}

/// That of the model in the coordinates of the meshes, if it is no box; `mesh` may have been given
/// another.
std::optional<Domain> domain_of(const CityModel& city, const std::optional<ReportedRun>& report) {
  const bool is_other =
      report && !report->city_model.empty() && !report->report.config.bounds.empty();
  if (city.domain.is_box() || is_other) return std::nullopt;
  return report && report->is_absolute() ? city.domain.moved(city.origin) : city.domain;
}

/// That of the model in the folder, or that its meshes were made from; none if there is none to be
/// read: nobody has asked for it.
std::optional<Domain> domain_beside(const fs::path& folder) {
  try {
    const std::optional<ReportedRun> report = read_reported_run(folder);
    const fs::path city = find_sources(folder, report).city;
    return city.empty() ? std::nullopt : domain_of(read_city(city), report);
  } catch (const Error&) {
    return std::nullopt;
  }
}

CheckedFile check_one_surface(const fs::path& path, const SurfaceMesh& surface) {
  const std::optional<Domain> domain = domain_beside(path.parent_path());
  const Domain* const given = domain ? &*domain : nullptr;
  CheckedFile file = describe(path.filename().string(), is_city_surface(surface)
                                                            ? check_city_surface(surface, given)
                                                            : check_surface(surface, given));
  file.not_checked = {
      "the volume behind it, footprints in the mesh, heights and the report (check "
      "the folder that has the other results)"};
  return file;
}

CheckedFile check_one_xdmf(const fs::path& path, const Progress& progress) {
  const auto mesh = read_xdmf(path);
  if (const auto* volume = std::get_if<TetMesh>(&mesh))
    return check_one_volume(path, *volume, progress);
  return check_one_surface(path, std::get<SurfaceMesh>(mesh));
}

/// The volume, and each of the boundaries, which are all to be that of the volume, against it.
std::vector<CheckedFile> check_volume_and_boundaries(const NamedVolume& volume,
                                                     const std::vector<NamedSurface>& boundaries,
                                                     const std::optional<Domain>& domain,
                                                     const std::optional<ReportedRun>& report,
                                                     const Progress& progress) {
  const VolumeCheck volume_check = check_volume(volume.mesh, progress);
  std::vector<CheckedFile> files{describe(volume.name, volume_check)};
  compare_origin(volume.origin, report, files.back());
  for (const NamedSurface& boundary : boundaries) {
    const SurfaceCheck surface_check = check_surface(boundary.mesh, domain ? &*domain : nullptr);
    files.push_back(describe(boundary.name, surface_check));
    compare_origin(boundary.origin, report, files.back());
    compare_domain(surface_check, report, files.back());
    CheckedFile both{fmt::format("{} and {}", volume.name, boundary.name),
                     {"faces of one compared with faces of the other"},
                     check_same_boundary(volume.mesh, volume_check, boundary.mesh),
                     {}};
    if (report && report->has_mesh())
      compare_mesh(report->report, volume_check, surface_check, both);
    else
      both.not_checked.emplace_back("numbers of the run (no report.json that has them)");
    files.push_back(both);
  }
  return files;
}

/// A mesh of the folder; `city` is city.city.json if that is there.
void add_mesh(const NamedVolume& volume, const std::vector<NamedSurface>& boundaries,
              const Sources& sources, const CityModel& city,
              const std::optional<ReportedRun>& report, const Progress& progress,
              std::vector<CheckedFile>& files) {
  for (CheckedFile& file :
       check_volume_and_boundaries(volume, boundaries, domain_of(city, report), report, progress))
    files.push_back(std::move(file));
  if (sources.city.empty()) {
    files.back().not_checked.push_back(
        fmt::format("regions, footprints in the mesh and heights (there is no {})",
                    sources.city_wanted.string()));
    return;
  }
  for (const NamedSurface& boundary : boundaries)
    files.push_back(check_against_city(
        fmt::format("{}, {}, city model and terrain", volume.name, boundary.name), sources,
        volume.mesh, boundary.mesh, city, report));
}

/// What is in the folder to look at, against the boundary if there is one.
void add_surfaces(const fs::path& folder, const std::vector<NamedSurface>& boundaries,
                  const CityModel& city, const std::optional<ReportedRun>& report,
                  std::vector<CheckedFile>& files) {
  const auto add = [&](const char* name, CheckedFile file, const auto& compare_with) {
    if (boundaries.empty()) {
      file.not_checked.emplace_back("whether its faces are those of the boundary");
    } else {
      file.facts.push_back(fmt::format("faces compared with those of {}", boundaries[0].name));
      add_violations(file.violations, compare_with(boundaries[0]));
    }
    file.name = name;
    files.push_back(std::move(file));
  };
  if (const fs::path path = folder / "surface.vtp"; is_there(path)) {
    const SurfaceMesh surface = read_vtp(path);
    const std::optional<Domain> domain = domain_of(city, report);
    CheckedFile file = describe("", check_city_surface(surface, domain ? &*domain : nullptr));
    compare_origin(read_vtk_origin(path), report, file);
    add("surface.vtp", std::move(file),
        [&](const NamedSurface& boundary) { return check_same_surface(boundary.mesh, surface); });
  }
  if (const fs::path path = folder / "surface.stl"; is_there(path)) {
    const StlMesh surface = read_stl(path);
    CheckedFile file{"", {fmt::format("{} triangles", surface.triangles.size())}, {}, {}};
    add("surface.stl", std::move(file), [&](const NamedSurface& boundary) {
      const Point3 to = surface.origin.value_or(Point3{}), from = boundary.origin.value_or(to);
      return check_same_surface(boundary.mesh, {from[0] - to[0], from[1] - to[1], from[2] - to[2]},
                                surface);
    });
  }
}

/// What is in the folder of volume and boundary, one format after the other.
void add_meshes(const fs::path& folder, const Sources& sources, const CityModel& city,
                const std::optional<ReportedRun>& report, const Progress& progress,
                std::vector<CheckedFile>& files) {
  const auto there = [&](const char* name) { return is_there(folder / name); };
  const bool vtu = there("volume.vtu"), vtp = there("boundary.vtp");
  const bool xdmf_volume = there("volume.xdmf"), xdmf_boundary = there("boundary.xdmf");
  std::vector<NamedSurface> boundaries;
  if (vtp && (vtu || xdmf_volume))
    boundaries.push_back({"boundary.vtp", read_vtp(folder / "boundary.vtp"),
                          read_vtk_origin(folder / "boundary.vtp")});
  if (vtu && vtp)
    add_mesh(
        {"volume.vtu", read_vtu(folder / "volume.vtu"), read_vtk_origin(folder / "volume.vtu")},
        boundaries, sources, city, report, progress, files);
  else if (vtu)
    files.push_back(
        check_one_volume(folder / "volume.vtu", read_vtu(folder / "volume.vtu"), progress));
  else if (vtp && !xdmf_volume)
    files.push_back(check_one_surface(folder / "boundary.vtp", read_vtp(folder / "boundary.vtp")));
  if (xdmf_volume && xdmf_boundary) {
    if (vtu) boundaries.clear();  // the one of VTK has been compared
    boundaries.push_back({"boundary.xdmf", read_xdmf_as<SurfaceMesh>(folder / "boundary.xdmf"),
                          read_xdmf_origin(folder / "boundary.xdmf")});
    add_mesh({"volume.xdmf", read_xdmf_as<TetMesh>(folder / "volume.xdmf"),
              read_xdmf_origin(folder / "volume.xdmf")},
             boundaries, sources, city, report, progress, files);
  } else if (xdmf_volume || xdmf_boundary) {
    files.push_back(
        check_one_xdmf(folder / (xdmf_volume ? "volume.xdmf" : "boundary.xdmf"), progress));
  }
  if (report && report->has_mesh() && !(vtu && vtp) && !(xdmf_volume && xdmf_boundary))
    files.push_back({"meshes",
                     {},
                     {},
                     {"there is neither volume.vtu with boundary.vtp nor volume.xdmf with "
                      "boundary.xdmf"}});
  add_surfaces(folder, boundaries, city, report, files);
}

bool is_whole(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && fs::file_size(path, error) > 0;
}

/// A result that was lost or moved away since the run, or emptied. Beside a model, the data of
/// `synth` that it was made from are none.
void require_listed(const fs::path& folder, const ReportedRun& report,
                    std::vector<CheckedFile>& files) {
  const std::vector<std::string> of_models = results::all_names();
  const bool has_model = report.report.city || report.report.volume_mesh;
  std::vector<std::string> missing;
  for (const std::string& name : report.report.files)
    if ((!has_model || is_among(name, of_models)) && !is_whole(folder / name))
      missing.push_back(name);
  if (!missing.empty())
    files.push_back({results::kReport,
                     {fmt::format("missing: {}", fmt::join(missing, ", "))},
                     {{"results that report.json lists and that are not here, or empty",
                       std::ssize(missing), missing[0]}},
                     {}});
}

/// Whoever hands on one of these files is to know that nobody has looked into it.
void add_unread(const fs::path& folder, std::vector<CheckedFile>& files) {
  std::vector<std::string_view> there;
  for (const char* name : results::kUnread)
    if (is_there(folder / name)) there.emplace_back(name);
  if (!there.empty())
    files.push_back(
        {"other formats", {fmt::format("not read: {}", fmt::join(there, ", "))}, {}, {}});
}

/// Of a model that `mesh` has read: buildings that it says it left out, which the mesh is without.
void leave_out_dropped(const CityFacts& reported, CityModel& city) {
  std::map<std::string, std::string> reasons;
  for (const Dropped& feature : reported.dropped) reasons[feature.source_id] = feature.reason;
  std::erase_if(city.buildings, [&](const Building& building) {
    const auto reason = reasons.find(building.source_ids.front());
    if (reason == reasons.end()) return false;
    for (const std::string& id : building.source_ids) city.dropped.push_back({id, reason->second});
    return true;
  });
}

void note_members(const CityModel& raw, const CityModel& city, double max_distance,
                  CheckedFile& file) {
  constexpr double kSearched = 0.02;  // metres: distances are searched to one centimetre
  const std::vector<Violation> found = check_members(raw, city, max_distance + kSearched);
  file.violations.insert(file.violations.end(), found.begin(), found.end());
}

std::vector<CheckedFile> check_folder(const fs::path& folder, std::optional<double> min_distance,
                                      const Progress& progress) {
  const std::optional<ReportedRun> report = read_reported_run(folder);
  Sources sources = find_sources(folder, report);
  std::vector<CheckedFile> files;
  CityModel city;
  std::optional<CityModel> raw;
  for (const std::string name : {results::kRawCity, results::kCity}) {
    const fs::path path = name == results::kCity ? sources.city : folder / name;
    if (path.empty() || !is_there(path)) continue;
    std::vector<Warning> warnings;
    const bool is_raw = name == results::kRawCity;
    const bool was_read = !is_raw && report && !report->city_model.empty();
    city = read_city(path, &warnings, was_read ? BrokenObjects::kDrop : BrokenObjects::kRefuse);
    if (was_read && report->report.city) leave_out_dropped(*report->report.city, city);
    // As the run did, and warned of.
    if (was_read) flatten_unmeshable(city, report->report.config.min_building_distance);
    const std::optional<double> distance =
        distance_asked(name, is_raw ? std::nullopt : min_distance, report);
    const CityCheck check = check_city(city, distance);
    files.push_back(describe(shown_name(path, folder), check, distance));
    std::error_code ignored;
    note_changes(warnings, fs::equivalent(path, folder / name, ignored), files.back());
    compare_account(city, report, files.back());
    if (is_raw) {
      raw = city;
      if (report && report->report.city && report->made_city())
        compare_count("number of raw buildings", report->report.city->raw_buildings,
                      city.buildings.size(), files.back());
      continue;
    }
    // A model that was meshed by itself may be another one than the raw model beside it.
    if (raw && report && report->made_city()) {
      compare_features(*raw, city, files.back());
      if (report->report.city)
        note_members(*raw, city, report->report.city->max_distance, files.back());
    }
    if (report) compare_city(city, check, *report, files.back());
  }
  if (!sources.city.empty() && !sources.terrain.empty()) {
    sources.read_terrain = read_raster(sources.terrain, city.origin);
    files.push_back(
        check_terrain(shown_name(sources.terrain, folder), *sources.read_terrain, city, report));
  }
  if (report && report->made_city() && is_there(folder / results::kLayers))
    files.push_back(check_layers(folder, *report));
  if (report && report->report.volume_mesh)
    for (const BuildingIndex b : report->report.volume_mesh->parts_left_out)
      if (b < city.buildings.size()) city.buildings[b].parts.clear();
  add_meshes(folder, sources, city, report, progress, files);
  if (files.empty())
    throw Error(
        ErrorKind::kInput,
        folder.string() +
            ": holds no result of tetropolis (no city.city.json, no volume.vtu or volume.xdmf)");
  if (report) require_listed(folder, *report, files);
  if (report && !report->missing.empty())
    files.push_back({results::kReport,
                     {},
                     {{"members that the report of a run has and this one has not",
                       std::ssize(report->missing), report->missing[0]}},
                     {}});
  add_unread(folder, files);
  return files;
}

/// By itself, so a report beside it that is another program's is no reason to give up.
CheckedFile check_one_city(const fs::path& path, std::optional<double> min_distance) {
  std::optional<ReportedRun> report;
  std::vector<std::string> not_checked{
      "that every input feature is accounted for, and the meshes (check the "
      "folder that has the other results)"};
  try {
    report = read_reported_run(path.parent_path());
  } catch (const Error& error) {
    not_checked.push_back(fmt::format("what report.json asks for ({})", error.what()));
  }
  const std::string name = path.filename().string();
  const std::optional<double> distance = distance_asked(name, min_distance, report);
  std::vector<Warning> warnings;
  CheckedFile file = describe(name, check_city(read_city(path, &warnings), distance), distance);
  note_changes(warnings, true, file);
  file.not_checked = std::move(not_checked);
  return file;
}

}  // namespace

std::vector<CheckedFile> check_path(const fs::path& given, std::optional<double> min_distance,
                                    const Progress& progress) {
  fs::path path = given;
  while (!path.has_filename() && path.has_relative_path()) path = path.parent_path();  // "r/"
  if (!is_there(path)) throw Error(ErrorKind::kInput, path.string() + ": no such file or folder");
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return check_folder(path, min_distance, progress);
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".vtu") return {check_one_volume(path, read_vtu(path), progress)};
  if (extension == ".vtp") return {check_one_surface(path, read_vtp(path))};
  if (extension == ".xdmf") return {check_one_xdmf(path, progress)};
  if (extension == ".json" || extension == ".cityjson") return {check_one_city(path, min_distance)};
  throw Error(
      ErrorKind::kInput,
      path.string() + ": is not a .vtu, .vtp, .xdmf or .city.json file or a folder of results");
}

}  // namespace tetropolis
