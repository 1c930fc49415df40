#include "tetropolis/case/openfoam_case.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <functional>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/file/write_file.h"

#include "case_files.h"
#include "core/is_among.h"
#include "core/median.h"
#include "foam_dictionaries.h"
#include "foam_fields.h"
#include "foam_heights.h"
#include "foam_mesh.h"
#include "io/file/atomic_file.h"
#include "leaf_marks.h"
#include "openfoam_texts.h"
#include "rose_texts.h"
#include "sample_points.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

std::function<std::string()> known(std::string text) {
  return [text = std::move(text)] { return text; };
}

/// Where leaves are sources of k and epsilon.
std::vector<LeafMarks> marks_of(const OpenfoamCaseOptions& options, const FoamMesh& mesh) {
  if (!options.leaf_turbulence || options.dialect != FoamDialect::kCom) return {};
  return mark_leaves(mesh);
}

/// Of k and epsilon. Where leaves are their sources, these meet the full wind of the first
/// iterations: with 0.8 k explodes in leaves of 1 m2/m3 and Cd 0.2, with 0.5 in those of 2.
std::string turbulence_relaxation(const OpenfoamCaseOptions& options,
                                  const std::vector<LeafMarks>& marks) {
  double relaxation = marks.empty() ? 0.8 : 0.5;
  for (const LeafMarks& leaves : marks)
    relaxation = std::min(relaxation, 0.1 / (options.leaf_drag * leaves.leaf_area_density));
  return fmt::format("{:.3g}", relaxation);
}

constexpr const char* kSurfaces = "constant/triSurface/";
constexpr const char* kFvOptions = "constant/fvOptions";
constexpr const char* kFvModels = "constant/fvModels";

bool is_number(std::string_view word) {
  return !word.empty() && word.find_first_not_of("0123456789.") == word.npos;
}

/// What an earlier case has solved: a solver would go on from there.
void remove_solution(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> solved;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const bool is_time = is_number(name) && name != "0" && fs::exists(entry.path() / "U", error);
    const bool is_part = name.starts_with("processor") && is_number(name.substr(9));
    constexpr std::array kOthers = {"postProcessing",   "log.simpleFoam",     "log.foamRun",
                                    "log.decomposePar", "log.reconstructPar", "rose.csv"};
    const std::string stem = entry.path().stem().string(), end = entry.path().extension().string();
    constexpr std::array kPictures = {"pedestrian", "against", "rose", "above", "comfort"};
    const bool is_picture = (end == ".png" || end == ".pgw") && is_among(stem, kPictures);
    if (is_time || is_part || is_picture || is_among(name, kOthers)) solved.push_back(entry.path());
  }
  for (const fs::path& path : solved) fs::remove_all(path, error);
}

/// What an earlier case has for canopies that this one has not, which has `marks` surfaces.
void remove_leaves(const fs::path& folder, const FoamMesh& mesh, std::size_t marks) {
  std::error_code error;
  while (fs::remove(folder / kSurfaces / marks_name(marks++), error)) {
  }
  if (!mesh.canopies.empty()) return;
  for (const char* name : {kFvOptions, kFvModels}) {
    std::string line;
    if (std::ifstream file(folder / name); !file || !std::getline(file, line)) continue;
    if (line.starts_with(kFoamFirstWords)) fs::remove(folder / name, error);
  }
}

/// A case of one wind that is none any more; `files` as every case has. What others have put there
/// stays.
void remove_case(const fs::path& folder, const std::vector<CaseFile>& files) {
  remove_solution(folder);
  std::error_code error;
  for (const auto& [name, text] : files) fs::remove(folder / name, error);
  for (const char* made : {"0", "constant/triSurface", "constant", "system"})
    fs::remove(folder / made, error);  // unless there is something in it
}

/// What an earlier case has solved, and the cases that it has besides `winds`: all of them folders,
/// or none for a case of one wind. `files` as for remove_case.
void remove_earlier_case(const fs::path& folder, const std::set<std::string>& winds,
                         const std::vector<CaseFile>& files) {
  std::error_code error;
  std::vector<fs::path> earlier;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with('w') && is_number(name.substr(1)) &&
        fs::is_symlink(entry.path() / "constant/polyMesh", error))
      earlier.push_back(entry.path());
  }
  for (const fs::path& wind : earlier) {
    if (winds.contains(wind.filename().string())) {
      remove_solution(wind);
      continue;
    }
    fs::remove(wind / "constant/polyMesh", error);
    remove_case(wind, files);
    fs::remove(wind, error);
  }
  if (winds.empty())
    remove_solution(folder);
  else
    remove_case(folder, files);
  fs::remove(folder / "rose.py", error);
}

/// A case but for Allrun; `points` as for control.
void add_files_of(const FoamMesh& mesh, const OpenfoamCaseOptions& options,
                  const FoamFields& fields, const std::vector<LeafMarks>& marks, const char* points,
                  const std::string& into, std::vector<CaseFile>& files) {
  const bool is_org = options.dialect == FoamDialect::kOrg;
  const auto add = [&](const std::string& name, std::function<std::string()> text) {
    files.emplace_back(into + name, std::move(text));
  };
  add("0/U", [&] { return fields.velocity(); });
  add("0/p", [&] { return fields.pressure(); });
  add("0/k", [&] { return fields.kinetic_energy(); });
  add("0/epsilon", [&] { return fields.dissipation(); });
  add("0/nut", [&] { return fields.eddy_viscosity(); });
  add("constant/transportProperties",
      known(foam_head("dictionary", "transportProperties") +
            "transportModel  Newtonian;\nnu              1.5e-05;\n"));
  add("constant/turbulenceProperties",
      known(turbulence_dict("turbulenceProperties", is_org, !marks.empty())));
  add("system/controlDict", known(control_dict(options, points)));
  add("system/fvSchemes", known(foam_head("dictionary", "fvSchemes") + foam_texts::kFvSchemes));
  add("system/fvSolution",
      known(foam_head("dictionary", "fvSolution") +
            replaced(foam_texts::kFvSolution,
                     {{"@TURBULENCE@", turbulence_relaxation(options, marks)}})));
  if (!mesh.canopies.empty())
    add(kFvOptions,
        known(leaf_drag(options, mesh, "fvOptions") + leaf_sources(options, mesh, marks)));
  for (std::size_t i = 0; i < marks.size(); ++i)
    add(kSurfaces + marks_name(i), [&surface = marks[i].surface] { return surface; });
  if (!is_org) return;
  if (!mesh.canopies.empty()) add(kFvModels, known(leaf_drag(options, mesh, "fvModels")));
  add("constant/momentumTransport", known(turbulence_dict("momentumTransport", true, false)));
  add("constant/physicalProperties",
      known(foam_head("dictionary", "physicalProperties") +
            "viscosityModel  constant;\nnu              1.5e-05;\n"));
}

/// What two cases must have in common for their cities to be compared, but for where the wind comes
/// from: a Python dictionary of texts.
std::string wind_facts(const OpenfoamCaseOptions& options) {
  std::string profile = fmt::format("logarithmic, z0 {} m", options.wind.roughness);
  if (!options.wind.levels.empty()) {
    const WindLevel& top = options.wind.levels.back();
    profile = fmt::format("measured at {} heights, {} m/s and k {} m2/s2 at {} m",
                          options.wind.levels.size(), top.speed, top.k, top.height);
  }
  std::string patches;
  for (const auto& [name, value] : options.patch_roughness)
    patches += fmt::format("{}{} {} m", patches.empty() ? "" : ", ", name, value);
  return fmt::format(
      R"({{"wind": "{} m/s at {} m", "profile": "{}", "roughness in town": "{} m", )"
      R"("of buildings": "{} m", "of patches": "{}", "drag of leaves": "{}", "seen at": "{} m"}})",
      options.wind.speed, options.wind.height, profile, options.ground_roughness,
      options.building_roughness, patches, options.leaf_drag, options.sample_height);
}

/// What all winds over a mesh share: points and the programs that look at them. `from`: where the
/// winds come from, as text.
void add_shared_files(const FoamMesh& mesh, const OpenfoamCaseOptions& options,
                      const std::string& from, const SamplePoints& samples,
                      std::vector<CaseFile>& files) {
  files.emplace_back("system/pedestrian", [&] { return pedestrian_dict(options, samples); });
  files.emplace_back("wind.py",
                     known(replaced(foam_texts::kWindPy,
                                    {{"@SPEED@", fmt::format("{}", options.wind.speed)},
                                     {"@HEIGHT@", fmt::format("{}", options.wind.height)},
                                     {"@WIND@", wind_facts(options)},
                                     {"@FROM@", from},
                                     {"@SAMPLE_HEIGHT@", fmt::format("{}", options.sample_height)},
                                     {"@SPACING@", fmt::format("{}", samples.spacing)},
                                     {"@X@", fmt::format("{}", mesh.origin[0])},
                                     {"@Y@", fmt::format("{}", mesh.origin[1])}})));
}

std::string allrun(const OpenfoamCaseOptions& options, const FoamMesh& mesh, const char* look) {
  std::int64_t faces = 0;
  for (const FoamPatch& patch : mesh.patches)
    faces += static_cast<std::int64_t>(patch.end - patch.begin);
  return replaced(foam_texts::kAllrun,
                  {{"@ARGUMENTS@", foam_texts::kArguments},
                   {"@MESH@", fmt::format("{} {}", mesh.patches.size(), faces)},
                   {"@SOLVER@", options.dialect == FoamDialect::kOrg ? "foamRun" : "simpleFoam"},
                   {"@LOOK@", look}});
}

void let_run(const fs::path& script) {
  std::error_code error;
  fs::permissions(script, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                  fs::perm_options::add, error);
  if (error) throw_cannot_write(script, error.message());
}

/// `link` to `target`, relative to its folder. A folder in its place is somebody's mesh.
void link_folder(const fs::path& link, const fs::path& target) {
  std::error_code error;
  const fs::file_status found = fs::symlink_status(link, error);
  if (fs::is_symlink(found))
    fs::remove(link, error);
  else if (fs::exists(found))
    throw Error(ErrorKind::kUsage,
                fmt::format("{}: is there and no link to the mesh; move it away", link.string()));
  fs::create_directories(link.parent_path(), error);
  fs::create_directory_symlink(target, link, error);
  if (error) throw_cannot_write(link, error.message());
}

/// The options, if they are in range; the speed of a measured wind is that of its levels.
OpenfoamCaseOptions checked(OpenfoamCaseOptions options) {
  require_wind(options.wind);
  const WindProfile profile(options.wind);
  if (profile.is_measured()) options.wind.speed = profile.speed(options.wind.height);
  require_positive("leaf_drag", options.leaf_drag);
  require_positive("sample_height", options.sample_height);
  require_positive("sample_spacing", options.sample_spacing);
  const auto not_negative = [](const char* name, double value) {
    if (!(value >= 0) || !std::isfinite(value))
      throw Error(ErrorKind::kUsage, fmt::format("{}: {} is below 0", name, value));
  };
  not_negative("ground_roughness", options.ground_roughness);
  not_negative("building_roughness", options.building_roughness);
  for (const auto& [patch, value] : options.patch_roughness)
    require_positive("patch_roughness", value);
  if (options.iterations < 1)
    throw Error(ErrorKind::kUsage, fmt::format("iterations: {} is below 1", options.iterations));
  return options;
}

void write_boundary(const fs::path& folder, const FoamMesh& mesh) {
  if (!mesh.new_boundary.empty())
    write_file(folder / "constant/polyMesh/boundary", mesh.new_boundary);
}

/// Names that nobody has are mistyped; those that are there by default need not be patches.
void require_patches(const FoamMesh& mesh, const OpenfoamCaseOptions& options) {
  std::vector<std::string> ground;
  for (const FoamPatch& patch : mesh.patches)
    if (patch.is_wall && !patch.of_building()) ground.push_back(patch.name);
  const OpenfoamCaseOptions usual;
  for (const auto& [name, value] : options.patch_roughness)
    if (!usual.patch_roughness.contains(name) && !is_among(name, ground))
      throw Error(ErrorKind::kUsage,
                  fmt::format("patch_roughness: the ground has no patch {}; it has: {}", name,
                              fmt::join(ground, ", ")));
}

OpenfoamCase facts_of(const FoamMesh& mesh, const Places& places, const FoamFields& fields,
                      const SamplePoints& samples) {
  OpenfoamCase result;
  for (const CasePatch& p : fields.patches())
    if (p.kind == CasePatch::Kind::kSide && p.patch->begin < p.patch->end)
      result.sides.push_back({p.patch->name, p.role});
  std::vector<double> first;
  for (const std::vector<WallCell>& cells : places.on_walls)
    for (const WallCell& cell : cells) first.push_back(cell.height);
  result.ground_faces = std::ssize(first);
  result.layers_top = places.layers_top;
  result.open_width = places.open.width;
  result.open_layers_top = places.open.layers_top;
  if (!first.empty()) result.first_cell = median(first);
  result.canopies = std::ssize(mesh.canopies);
  for (const FoamCanopy& canopy : mesh.canopies) result.canopy_cells += std::ssize(canopy.cells);
  result.samples = static_cast<std::int64_t>(samples.points.size());
  result.sample_spacing = samples.spacing;
  return result;
}

}  // namespace

OpenfoamCase write_openfoam_case(const fs::path& folder, const OpenfoamCaseOptions& given) {
  const OpenfoamCaseOptions options = checked(given);
  const FoamMesh mesh = read_foam_mesh(folder / "constant/polyMesh");
  require_patches(mesh, options);
  const Places places(mesh);
  const FoamFields fields(mesh, places, options);
  const SamplePoints samples = sample_points(mesh, options.sample_height, options.sample_spacing);
  const std::vector<LeafMarks> marks = marks_of(options, mesh);
  std::vector<CaseFile> files;
  add_files_of(mesh, options, fields, marks, "pedestrian", "", files);
  add_shared_files(mesh, options, fmt::format("{}", options.wind.from), samples, files);
  // The last: a folder with it is a whole case.
  files.emplace_back("Allrun", known(allrun(options, mesh, "wind.py")));
  if (options.overwrite)
    remove_earlier_case(folder, {}, files);
  else
    require_new(folder, files);
  remove_scripts(folder, files);
  write_boundary(folder, mesh);
  write_case_files(folder, files);
  remove_leaves(folder, mesh, marks.size());
  let_run(folder / "Allrun");
  return facts_of(mesh, places, fields, samples);
}

std::string folder_of_wind(double from) {
  const double turned = std::fmod(std::fmod(from, 360) + 360, 360);
  const std::string number = fmt::format("{}", turned);
  const std::size_t whole = std::min(number.find('.'), number.size());
  return "w" + std::string(whole < 3 ? 3 - whole : 0, '0') + number;
}

std::vector<OpenfoamCase> write_openfoam_cases(const fs::path& folder,
                                               const OpenfoamCaseOptions& given,
                                               std::span<const double> from) {
  const OpenfoamCaseOptions options = checked(given);
  std::vector<OpenfoamCaseOptions> winds;
  std::string names;
  std::set<std::string> seen;
  for (const double degrees : from) {
    winds.push_back(options);
    winds.back().wind.from = degrees;
    require_wind(winds.back().wind);
    const std::string name = folder_of_wind(degrees);
    if (!seen.insert(name).second)
      throw Error(ErrorKind::kUsage, fmt::format("wind_from: {} comes twice", degrees));
    names += (names.empty() ? "" : " ") + name;
  }
  if (winds.empty()) throw Error(ErrorKind::kUsage, "wind_from: names no direction");

  const FoamMesh mesh = read_foam_mesh(folder / "constant/polyMesh");
  require_patches(mesh, options);
  const Places places(mesh);
  const SamplePoints samples = sample_points(mesh, options.sample_height, options.sample_spacing);
  const std::vector<LeafMarks> marks = marks_of(options, mesh);
  std::vector<FoamFields> fields;
  fields.reserve(winds.size());
  std::vector<CaseFile> files, of_one;
  add_shared_files(mesh, options, names, samples, files);
  for (const OpenfoamCaseOptions& wind : winds) {
    const std::string into = folder_of_wind(wind.wind.from) + "/";
    fields.emplace_back(mesh, places, wind);
    add_files_of(mesh, wind, fields.back(), marks, "../../system/pedestrian", into, files);
    files.emplace_back(into + "Allrun", known(allrun(options, mesh, "../wind.py .")));
  }
  files.emplace_back(
      "rose.py",
      known(replaced(foam_texts::kRosePy,
                     {{"@WINDS@", names}, {"@SPEED@", fmt::format("{}", options.wind.speed)}})));
  files.emplace_back(
      "Allrun", known(replaced(foam_texts::kAllrunWinds,
                               {{"@ARGUMENTS@", foam_texts::kArguments}, {"@WINDS@", names}})));
  add_files_of(mesh, options, fields.front(), marks, "", "", of_one);
  of_one.emplace_back("Allrun", known(""));
  if (options.overwrite)
    remove_earlier_case(folder, seen, of_one);
  else
    require_new(folder, files);
  remove_scripts(folder, files);
  write_boundary(folder, mesh);
  for (const std::string& name : seen)
    link_folder(folder / name / "constant/polyMesh", "../../constant/polyMesh");
  write_case_files(folder, files);
  let_run(folder / "Allrun");
  std::vector<OpenfoamCase> results;
  for (std::size_t i = 0; i < winds.size(); ++i) {
    remove_leaves(folder / folder_of_wind(winds[i].wind.from), mesh, marks.size());
    let_run(folder / folder_of_wind(winds[i].wind.from) / "Allrun");
    results.push_back(facts_of(mesh, places, fields[i], samples));
  }
  return results;
}

}  // namespace tetropolis
