#include "tetropolis/case/openfoam_case.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <set>
#include <system_error>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/version.h"

#include "case_files.h"
#include "foam_mesh.h"
#include "geometry/vec3.h"
#include "io/file/atomic_file.h"
#include "leaf_marks.h"
#include "openfoam_texts.h"
#include "rose_texts.h"
#include "sample_points.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

double length(const Point3& v) { return std::sqrt(dot(v, v)); }

/// Wind that meets a side at less than that (a sine, half a degree) blows along it.
constexpr double kAlong = 0.0087;

struct PlaceHash {
  std::size_t operator()(const std::pair<double, double>& place) const {
    const std::hash<double> hash;
    return hash(place.first) * 1000003U ^ hash(place.second);
  }
};

/// Per point, the elevation of the lowest one over the same place: its ground, or the roof it
/// stands on.
std::vector<double> floors_below(const std::vector<Point3>& points) {
  std::unordered_map<std::pair<double, double>, double, PlaceHash> lowest;
  for (const Point3& p : points) {
    const auto [entry, is_new] = lowest.try_emplace({p[0], p[1]}, p[2]);
    if (!is_new) entry->second = std::min(entry->second, p[2]);
  }
  std::vector<double> floors(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    floors[i] = lowest.at({points[i][0], points[i][1]});
  return floors;
}

/// Height of a point in a vertical face above the line between the floors of the face's ends.
double height_above_floor(const FoamMesh& mesh, const std::vector<double>& floors, std::size_t f,
                          const Point3& at) {
  const auto corners = mesh.face(f);
  const Point3& a = mesh.point(corners[0]);
  std::int32_t far = corners[0];
  double most = 0;
  for (const std::int32_t p : corners) {
    const double d = std::hypot(mesh.point(p)[0] - a[0], mesh.point(p)[1] - a[1]);
    if (d > most) {
      most = d;
      far = p;
    }
  }
  const double from = floors[static_cast<std::size_t>(corners[0])];
  if (most == 0) return at[2] - from;
  const Point3& b = mesh.point(far);
  const double t =
      ((at[0] - a[0]) * (b[0] - a[0]) + (at[1] - a[1]) * (b[1] - a[1])) / (most * most);
  return at[2] - (from + t * (floors[static_cast<std::size_t>(far)] - from));
}

/// Per cell, the mean height of its corners above their floors.
std::vector<double> heights_of_cells(const FoamMesh& mesh, const std::vector<double>& floors) {
  std::vector<double> sum(mesh.cells(), 0);
  std::vector<std::int32_t> count(mesh.cells(), 0);
  for (std::size_t f = 0; f < mesh.faces(); ++f)
    for (const std::int32_t p : mesh.face(f)) {
      const auto i = static_cast<std::size_t>(p);
      const auto add = [&](std::int32_t cell) {
        sum[static_cast<std::size_t>(cell)] += mesh.points[i][2] - floors[i];
        ++count[static_cast<std::size_t>(cell)];
      };
      add(mesh.owner[f]);
      if (f < mesh.neighbour.size()) add(mesh.neighbour[f]);
    }
  for (std::size_t c = 0; c < sum.size(); ++c) sum[c] /= std::max(count[c], 1);
  return sum;
}

/// How high the cells on some faces are above them: farthest corner from the plane of the face.
std::unordered_map<std::int32_t, double> heights_on(
    const FoamMesh& mesh, const std::vector<std::pair<const FoamPatch*, std::size_t>>& faces) {
  struct Plane {
    Point3 point{};
    Point3 area{};
    double size = 0;
  };
  std::unordered_map<std::int32_t, Plane> planes;
  std::unordered_map<std::int32_t, double> heights;
  for (const auto& [patch, f] : faces) {
    const FaceGeometry face = face_geometry(mesh, f);
    if (const double size = length(face.area); size > 0)
      planes[mesh.owner[f]] = {face.centre, face.area, size};
  }
  const auto look = [&](std::int32_t cell, std::size_t f) {
    const auto found = planes.find(cell);
    if (found == planes.end()) return;
    double& height = heights[cell];
    const Plane& plane = found->second;
    for (const std::int32_t p : mesh.face(f))  // normals leave the cell
      height = std::max(height, -dot(minus(mesh.point(p), plane.point), plane.area) / plane.size);
  };
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    look(mesh.owner[f], f);
    if (f < mesh.neighbour.size()) look(mesh.neighbour[f], f);
  }
  return heights;
}

/// A patch of the case: what it is, and the wind at its faces.
struct CasePatch {
  const FoamPatch* patch = nullptr;
  enum class Kind : std::uint8_t { kGround, kBuilding, kTop, kSide } kind = Kind::kGround;
  SideRole role = SideRole::kAlong;  ///< Of a side.
  std::vector<double> heights;       ///< Per face of a side: of its centre, above the ground.
};

SideRole role_of(const FoamMesh& mesh, const FoamPatch& patch, const std::array<double, 2>& to) {
  bool enters = false, leaves = false;
  for (std::size_t f = patch.begin; f < patch.end; ++f) {
    const Point3 area = face_geometry(mesh, f).area;
    const double through = area[0] * to[0] + area[1] * to[1];
    const double least = kAlong * length(area);
    enters = enters || through < -least;
    leaves = leaves || through > least;
  }
  if (enters && leaves) return SideRole::kBoth;
  return enters ? SideRole::kInlet : leaves ? SideRole::kOutlet : SideRole::kAlong;
}

bool is_level(const FoamMesh& mesh, const FoamPatch& patch) {
  double level = 0, all = 0;
  for (std::size_t f = patch.begin; f < patch.end; ++f) {
    const Point3 area = face_geometry(mesh, f).area;
    level += std::abs(area[2]);
    all += length(area);
  }
  return level > all / 2;
}

std::vector<CasePatch> patches_of(const FoamMesh& mesh, const std::vector<double>& floors,
                                  const Wind& wind) {
  using Kind = CasePatch::Kind;
  std::vector<CasePatch> patches;
  for (const FoamPatch& patch : mesh.patches) {
    CasePatch entry;
    entry.patch = &patch;
    if (patch.is_wall)
      entry.kind = patch.of_building() ? Kind::kBuilding : Kind::kGround;
    else
      entry.kind = is_level(mesh, patch) ? Kind::kTop : Kind::kSide;
    if (entry.kind == Kind::kSide) {
      entry.role = role_of(mesh, patch, direction(wind));
      for (std::size_t f = patch.begin; f < patch.end; ++f)
        entry.heights.push_back(
            std::max(height_above_floor(mesh, floors, f, face_geometry(mesh, f).centre), 0.0));
    }
    patches.push_back(std::move(entry));
  }
  return patches;
}

/// Files of a case begin with them.
constexpr const char* kFirstWords = "// Written by tetropolis";

std::string head(const std::string& type, const std::string& object) {
  return fmt::format(
      "{} {}.\nFoamFile\n{{\n    version     2.0;\n    format      ascii;\n"
      "    class       {};\n    object      {};\n}}\n\n",
      kFirstWords, kVersion, type, object);
}

/// "nonuniform List<TYPE> ..." of text(i) for i below `size`.
template <typename Text>
std::string list(const char* type, std::size_t size, const Text& text) {
  std::string all = fmt::format("nonuniform List<{}>\n{}\n(\n", type, size);
  for (std::size_t i = 0; i < size; ++i) {
    text(i, all);
    all += '\n';
  }
  return all + ")";
}

template <typename Number>
std::string scalars(std::size_t size, const Number& number) {
  return list("scalar", size, [&](std::size_t i, std::string& all) {
    fmt::format_to(std::back_inserter(all), "{:.8g}", number(i));
  });
}

template <typename Speed>
std::string velocities(std::size_t size, const std::array<double, 2>& to, const Speed& speed) {
  return list("vector", size, [&](std::size_t i, std::string& all) {
    const double s = speed(i);
    fmt::format_to(std::back_inserter(all), "({:.8g} {:.8g} 0)", s * to[0], s * to[1]);
  });
}

std::string entry(const std::string& type, const std::string& rest = "") {
  return fmt::format("type {};{}{}", type, rest.empty() ? "" : " ", rest);
}

std::string fixed(const std::string& value) { return entry("fixedValue", "value " + value + ";"); }

/// What is the same for all winds over a mesh: heights, and where the buildings are.
struct Places {
  explicit Places(const FoamMesh& mesh)
      : floors(floors_below(mesh.points)),
        cells(heights_of_cells(mesh, floors)),
        town(town_of(mesh)) {}

  std::vector<double> floors;
  std::vector<double> cells;
  Bounds2 town;
};

/// The files of 0/.
class Fields {
 public:
  /// Mesh and places must outlive them.
  Fields(const FoamMesh& mesh, const Places& places, const OpenfoamCaseOptions& options)
      : mesh_(mesh),
        places_(places),
        options_(options),
        profile_(options.wind),
        to_(direction(options.wind)),
        patches_(patches_of(mesh, places.floors, options.wind)),
        top_(height_of_top()) {}

  const std::vector<CasePatch>& patches() const { return patches_; }

  std::string velocity() const {
    const auto speed = [&](const std::vector<double>& heights) {
      return velocities(heights.size(), to_,
                        [&](std::size_t i) { return profile_.speed(heights[i]); });
    };
    const double s = profile_.speed(top_);
    const std::string top = fmt::format("uniform ({:.8g} {:.8g} 0)", s * to_[0], s * to_[1]);
    return field(
        "U", "volVectorField", "[0 1 -1 0 0 0 0]", speed(places_.cells),
        [&](const CasePatch& p) -> std::string {
          if (p.patch->is_wall) return entry("noSlip");
          if (p.kind == CasePatch::Kind::kTop) return fixed(top);
          switch (p.role) {
            case SideRole::kInlet:
              return fixed(speed(p.heights));
            case SideRole::kOutlet:
              return entry("inletOutlet", "inletValue uniform (0 0 0); value uniform (0 0 0);");
            case SideRole::kBoth:
              return entry("freestreamVelocity", "freestreamValue " + speed(p.heights) + ";");
            case SideRole::kAlong:
              break;
          }
          return entry("slip");
        });
  }

  std::string pressure() const {
    return field("p", "volScalarField", "[0 2 -2 0 0 0 0]", "uniform 0",
                 [&](const CasePatch& p) -> std::string {
                   if (p.kind == CasePatch::Kind::kSide && p.role == SideRole::kOutlet)
                     return fixed("uniform 0");
                   if (p.kind == CasePatch::Kind::kSide && p.role == SideRole::kBoth)
                     return entry("freestreamPressure", "freestreamValue uniform 0;");
                   return entry("zeroGradient");
                 });
  }

  std::string kinetic_energy() const {
    const auto uniform = [&](double height) {
      return fmt::format("uniform {:.8g}", profile_.k(height));
    };
    const auto at = [&](const std::vector<double>& heights) {
      return profile_.is_measured()
                 ? scalars(heights.size(), [&](std::size_t i) { return profile_.k(heights[i]); })
                 : uniform(0);
    };
    return turbulence("k", "[0 2 -2 0 0 0 0]", at(places_.cells),
                      entry("kqRWallFunction", "value " + uniform(0) + ";"), uniform(top_), at);
  }

  std::string dissipation() const {
    const auto epsilon = [&](const std::vector<double>& heights) {
      return scalars(heights.size(),
                     [&](std::size_t i) { return profile_.dissipation(heights[i]); });
    };
    const std::string wall = fmt::format("value uniform {:.8g}; Cmu {}; kappa {}; E 9.8;",
                                         profile_.dissipation(2), kCmu, kKarman);
    return turbulence("epsilon", "[0 2 -3 0 0 0 0]", epsilon(places_.cells),
                      entry("epsilonWallFunction", wall),
                      fmt::format("uniform {:.8g}", profile_.dissipation(top_)), epsilon);
  }

  std::string eddy_viscosity() const {
    const std::string constants =
        fmt::format("Cmu {}; kappa {}; E 9.8; value uniform 0;", kCmu, kKarman);
    return field(
        "nut", "volScalarField", "[0 2 -1 0 0 0 0]", "uniform 0",
        [&](const CasePatch& p) -> std::string {
          if (!p.patch->is_wall) return entry("calculated", "value uniform 0;");
          const double building = options_.building_roughness;
          if (p.kind == CasePatch::Kind::kBuilding)
            return building > 0 ? entry("nutkAtmRoughWallFunction",
                                        fmt::format("z0 uniform {:.8g}; {}", building, constants))
                                : entry("nutkWallFunction", constants);
          return entry("nutkAtmRoughWallFunction",
                       fmt::format("z0 {}; {}", ground_roughness_text(*p.patch), constants));
        });
  }

  /// Roughness of the ground at face f of a patch.
  double roughness(const FoamPatch& patch, std::size_t f) const {
    const auto own = options_.patch_roughness.find(patch.name);
    if (own != options_.patch_roughness.end()) return own->second;
    if (options_.ground_roughness <= 0) return options_.wind.roughness;
    const Point3 at = face_geometry(mesh_, f).centre;
    return places_.town.contains({at[0], at[1]}) ? options_.ground_roughness
                                                 : options_.wind.roughness;
  }

 private:
  template <typename OfPatch>
  std::string field(const std::string& name, const std::string& type, const char* dimensions,
                    const std::string& inside, const OfPatch& of_patch) const {
    std::string text =
        head(type, name) + fmt::format("dimensions      {};\n\ninternalField   ", dimensions);
    text += inside;
    text += ";\n\nboundaryField\n{\n";
    for (const CasePatch& p : patches_)
      text += fmt::format("    {} {{ {} }}\n", p.patch->name, of_patch(p));
    return text + "}\n";
  }

  /// k and epsilon: `at` gives the values for heights.
  template <typename At>
  std::string turbulence(const std::string& name, const char* dimensions, const std::string& inside,
                         const std::string& wall, const std::string& top, const At& at) const {
    return field(
        name, "volScalarField", dimensions, inside, [&](const CasePatch& p) -> std::string {
          if (p.patch->is_wall) return wall;
          if (p.kind == CasePatch::Kind::kTop) return fixed(top);
          if (p.role == SideRole::kAlong) return entry("zeroGradient");
          const std::string values = at(p.heights);
          if (p.role == SideRole::kInlet) return fixed(values);
          return entry("inletOutlet", fmt::format("inletValue {}; value {};", values, values));
        });
  }

  /// Of the top above the ground along the sides, the mean of it.
  double height_of_top() const {
    double highest = -std::numeric_limits<double>::infinity(), sum = 0, count = 0;
    for (const CasePatch& p : patches_) {
      if (p.kind != CasePatch::Kind::kSide) continue;
      for (std::size_t f = p.patch->begin; f < p.patch->end; ++f)
        for (const std::int32_t corner : mesh_.face(f)) {
          highest = std::max(highest, mesh_.point(corner)[2]);
          sum += places_.floors[static_cast<std::size_t>(corner)];
          ++count;
        }
    }
    return count > 0 ? highest - sum / count : options_.wind.height;
  }

  std::string ground_roughness_text(const FoamPatch& patch) const {
    if (options_.ground_roughness <= 0 || options_.patch_roughness.contains(patch.name))
      return fmt::format("uniform {:.8g}", roughness(patch, patch.begin));
    return scalars(patch.end - patch.begin,
                   [&](std::size_t i) { return roughness(patch, patch.begin + i); });
  }

  const FoamMesh& mesh_;
  const Places& places_;
  OpenfoamCaseOptions options_;
  WindProfile profile_;
  std::array<double, 2> to_;
  std::vector<CasePatch> patches_;
  double top_;
};

/// `points`: the file of the points of people.
std::string control(const OpenfoamCaseOptions& options, const char* points) {
  const bool is_org = options.dialect == FoamDialect::kOrg;
  return head("dictionary", "controlDict") +
         fmt::format(R"(application     {};
{}startFrom       latestTime;
startTime       0;
stopAt          endTime;
endTime         {};
deltaT          1;
writeControl    timeStep;
writeInterval   $endTime;
purgeWrite      1;
writeFormat     binary;
writePrecision  8;
timePrecision   8;
runTimeModifiable true;
libs            ("libatmosphericModels.so");  // roughness, in later versions

functions
{{
    #include "{}"
}}
)",
                     is_org ? "foamRun" : "simpleFoam",
                     is_org ? "solver          incompressibleFluid;\n" : "", options.iterations,
                     points);
}

std::string pedestrian(const OpenfoamCaseOptions& options, const SamplePoints& samples) {
  const bool is_org = options.dialect == FoamDialect::kOrg;
  std::string text = fmt::format(R"(// Written by tetropolis {}: points {} m above the ground.
pedestrian
{{
    type            sets;
    libs            ("libsampling.so");
    writeControl    writeTime;
    interpolationScheme cellPoint;
    setFormat       raw;
    fields          (U);
    sets
    (
        grid
        {{
            type    {};
            axis    xyz;
            ordered yes;
            points
            (
)",
                                 kVersion, options.sample_height, is_org ? "points" : "cloud");
  for (const Point3& p : samples.points)
    fmt::format_to(std::back_inserter(text), "({:.8g} {:.8g} {:.8g})\n", p[0], p[1], p[2]);
  return text + "            );\n        }\n    );\n}\n";
}

constexpr double kC1 = 1.44, kC2 = 1.92, kSigmaK = 1;

/// Keeps the profile in balance with kappa 0.4: kappa^2 / ((C2 - C1) sqrt(Cmu)).
double sigma_epsilon() { return kKarman * kKarman / ((kC2 - kC1) * std::sqrt(kCmu)); }

/// `leaves`: with sources of k and epsilon in them.
std::string turbulence_model(const std::string& object, bool is_org, bool leaves) {
  const char* const model = leaves ? "kEpsilonLopesdaCosta" : "kEpsilon";
  return head("dictionary", object) +
         fmt::format(
             "simulationType  RAS;\n\nRAS\n{{\n    {}        {};\n    turbulence      on;\n"
             "    printCoeffs     on;\n    {}Coeffs {{ Cmu {}; C1 {}; C2 {}; sigmak {:.1f}; "
             "sigmaEps {:.4f}; }}\n}}\n",
             is_org ? "model   " : "RASModel", model, model, kCmu, kC1, kC2, kSigmaK,
             sigma_epsilon());
}

std::function<std::string()> known(std::string text) {
  return [text = std::move(text)] { return text; };
}

/// Drag of leaves: explicit porosity with the force -f |U| U / 2 per volume and density. Versions
/// that call it porosityForce know the older name, too.
std::string drag(const OpenfoamCaseOptions& options, const FoamMesh& mesh,
                 const std::string& object) {
  std::string text = head("dictionary", object);
  for (const FoamCanopy& canopy : mesh.canopies) {
    const double f = 2 * options.leaf_drag * canopy.leaf_area_density;
    text += fmt::format(R"({0}  // 2 Cd LAD: leaf area density {1} 1/m
{{
    type            explicitPorositySource;
    explicitPorositySourceCoeffs
    {{
        selectionMode   cellZone;
        cellZone        {0};
        type            DarcyForchheimer;
        d               (0 0 0);
        f               ({2:.8g} {2:.8g} {2:.8g});
        coordinateSystem
        {{
            type    cartesian;
            origin  (0 0 0);
            coordinateRotation {{ type axesRotation; e1 (1 0 0); e2 (0 1 0); }}
        }}
    }}
}}
)",
                        canopy.name, canopy.leaf_area_density, f);
  }
  return text;
}

/// Where leaves are sources of k and epsilon.
std::vector<LeafMarks> marks_of(const OpenfoamCaseOptions& options, const FoamMesh& mesh) {
  if (!options.leaf_turbulence || options.dialect != FoamDialect::kCom) return {};
  return mark_leaves(mesh);
}

std::string marks_name(std::size_t i) { return fmt::format("leaves_{}.obj", i + 1); }

/// The sources for kEpsilonLopesdaCosta. That finds them in the porosity of the same author, with
/// Cd 0 here, whose cells are those right below a surface: marks over their centres.
std::string leaf_sources(const OpenfoamCaseOptions& options, const std::vector<LeafMarks>& marks) {
  std::string text;
  for (std::size_t i = 0; i < marks.size(); ++i)
    text += fmt::format(R"(leaves_{0}  // k and epsilon where the leaf area density is {1} 1/m
{{
    type            explicitPorositySource;
    explicitPorositySourceCoeffs
    {{
        selectionMode   all;
        type            powerLawLopesdaCosta;
        Sigma           constant {1};
        CdSigma         {2};
        betap           1;
        betad           4;
        C4              1.5;
        C5              1.5;
        powerLawLopesdaCostaCoeffs
        {{
            Cd              0;  // drag is above
            C1              2;
            zDir            (0 0 1);
            searchSpan      {3};
            topSurface      {4};
            groundPatches   (ground);
            coordinateSystem
            {{
                type    cartesian;
                origin  (0 0 0);
                coordinateRotation {{ type axesRotation; e1 (1 0 0); e2 (0 1 0); }}
            }}
        }}
    }}
}}
)",
                        i + 1, marks[i].leaf_area_density, options.leaf_drag, 2 * kMarkHeight,
                        marks_name(i));
  return text;
}

constexpr const char* kSurfaces = "constant/triSurface/";
constexpr const char* kFvOptions = "constant/fvOptions";
constexpr const char* kFvModels = "constant/fvModels";

/// What an earlier case has for canopies that this one has not, which has `marks` surfaces.
void remove_leaves(const fs::path& folder, const FoamMesh& mesh, std::size_t marks) {
  std::error_code error;
  while (fs::remove(folder / kSurfaces / marks_name(marks++), error)) {
  }
  if (!mesh.canopies.empty()) return;
  for (const char* name : {kFvOptions, kFvModels}) {
    std::string line;
    if (std::ifstream file(folder / name); !file || !std::getline(file, line)) continue;
    if (line.starts_with(kFirstWords)) fs::remove(folder / name, error);
  }
}

/// A case but for Allrun; `points` as for control.
void add_files_of(const FoamMesh& mesh, const OpenfoamCaseOptions& options, const Fields& fields,
                  const std::vector<LeafMarks>& marks, const char* points, const std::string& into,
                  std::vector<CaseFile>& files) {
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
      known(head("dictionary", "transportProperties") +
            "transportModel  Newtonian;\nnu              1.5e-05;\n"));
  add("constant/turbulenceProperties",
      known(turbulence_model("turbulenceProperties", is_org, !marks.empty())));
  add("system/controlDict", known(control(options, points)));
  add("system/fvSchemes", known(head("dictionary", "fvSchemes") + foam_texts::kFvSchemes));
  add("system/fvSolution", known(head("dictionary", "fvSolution") + foam_texts::kFvSolution));
  if (!mesh.canopies.empty())
    add(kFvOptions, known(drag(options, mesh, "fvOptions") + leaf_sources(options, marks)));
  for (std::size_t i = 0; i < marks.size(); ++i)
    add(kSurfaces + marks_name(i), [&surface = marks[i].surface] { return surface; });
  if (!is_org) return;
  if (!mesh.canopies.empty()) add(kFvModels, known(drag(options, mesh, "fvModels")));
  add("constant/momentumTransport", known(turbulence_model("momentumTransport", true, false)));
  add("constant/physicalProperties",
      known(head("dictionary", "physicalProperties") +
            "viscosityModel  constant;\nnu              1.5e-05;\n"));
}

/// What all winds over a mesh share: points and the programs that look at them.
void add_shared_files(const OpenfoamCaseOptions& options, const SamplePoints& samples,
                      std::vector<CaseFile>& files) {
  files.emplace_back("system/pedestrian", [&] { return pedestrian(options, samples); });
  files.emplace_back("wind.py",
                     known(replaced(foam_texts::kWindPy,
                                    {{"@SPEED@", fmt::format("{}", options.wind.speed)},
                                     {"@HEIGHT@", fmt::format("{}", options.wind.height)},
                                     {"@SAMPLE_HEIGHT@", fmt::format("{}", options.sample_height)},
                                     {"@SPACING@", fmt::format("{}", samples.spacing)}})));
}

std::string allrun(const OpenfoamCaseOptions& options, const char* look) {
  return replaced(foam_texts::kAllrun,
                  {{"@SOLVER@", options.dialect == FoamDialect::kOrg ? "foamRun" : "simpleFoam"},
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
  require_positive("leaf-drag", options.leaf_drag);
  require_positive("sample-height", options.sample_height);
  require_positive("sample-spacing", options.sample_spacing);
  const auto not_negative = [](const char* name, double value) {
    if (!(value >= 0) || !std::isfinite(value))
      throw Error(ErrorKind::kUsage, fmt::format("{}: {} is below 0", name, value));
  };
  not_negative("ground-roughness", options.ground_roughness);
  not_negative("building-roughness", options.building_roughness);
  for (const auto& [patch, value] : options.patch_roughness)
    require_positive("patch-roughness", value);
  if (options.iterations < 1)
    throw Error(ErrorKind::kUsage, fmt::format("iterations: {} is below 1", options.iterations));
  return options;
}

/// First cells on the ground, against the roughness there.
void look_at_ground(const FoamMesh& mesh, const Fields& fields, OpenfoamCase& result) {
  std::vector<std::pair<const FoamPatch*, std::size_t>> faces;
  for (const CasePatch& p : fields.patches())
    if (p.kind == CasePatch::Kind::kGround)
      for (std::size_t f = p.patch->begin; f < p.patch->end; ++f) faces.emplace_back(p.patch, f);
  const auto heights = heights_on(mesh, faces);
  std::vector<double> sorted;
  for (const auto& [patch, f] : faces) {
    const auto found = heights.find(mesh.owner[f]);
    if (found == heights.end()) continue;
    sorted.push_back(found->second);
    // A hair below is rounding.
    const double least = kRoughnessLengths * fields.roughness(*patch, f);
    if (found->second < least * (1 - 1e-6)) ++result.shallow;
  }
  result.ground_faces = static_cast<std::int64_t>(sorted.size());
  if (sorted.empty()) return;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  result.first_cell = *middle;
}

OpenfoamCase facts_of(const FoamMesh& mesh, const Fields& fields, const SamplePoints& samples) {
  OpenfoamCase result;
  for (const CasePatch& p : fields.patches())
    if (p.kind == CasePatch::Kind::kSide && p.patch->begin < p.patch->end)
      result.sides.push_back({p.patch->name, p.role});
  look_at_ground(mesh, fields, result);
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
  const Places places(mesh);
  const Fields fields(mesh, places, options);
  const SamplePoints samples =
      sample_points(mesh, places.town, options.sample_height, options.sample_spacing);
  const std::vector<LeafMarks> marks = marks_of(options, mesh);
  std::vector<CaseFile> files;
  add_files_of(mesh, options, fields, marks, "pedestrian", "", files);
  add_shared_files(options, samples, files);
  // The last: a folder with it is a whole case.
  files.emplace_back("Allrun", known(allrun(options, "wind.py")));
  write_case_files(folder, files, options.overwrite);
  remove_leaves(folder, mesh, marks.size());
  let_run(folder / "Allrun");
  return facts_of(mesh, fields, samples);
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
      throw Error(ErrorKind::kUsage, fmt::format("wind-from: {} comes twice", degrees));
    names += (names.empty() ? "" : " ") + name;
  }
  if (winds.empty()) throw Error(ErrorKind::kUsage, "wind-from: names no direction");

  const FoamMesh mesh = read_foam_mesh(folder / "constant/polyMesh");
  const Places places(mesh);
  const SamplePoints samples =
      sample_points(mesh, places.town, options.sample_height, options.sample_spacing);
  const std::vector<LeafMarks> marks = marks_of(options, mesh);
  std::vector<Fields> fields;
  fields.reserve(winds.size());
  std::vector<CaseFile> files;
  add_shared_files(options, samples, files);
  for (const OpenfoamCaseOptions& wind : winds) {
    const std::string into = folder_of_wind(wind.wind.from) + "/";
    fields.emplace_back(mesh, places, wind);
    add_files_of(mesh, wind, fields.back(), marks, "../../system/pedestrian", into, files);
    files.emplace_back(into + "Allrun", known(allrun(options, "../wind.py .")));
  }
  files.emplace_back("rose.py", known(replaced(foam_texts::kRosePy, {{"@WINDS@", names}})));
  files.emplace_back("Allrun", known(replaced(foam_texts::kAllrunWinds, {{"@WINDS@", names}})));
  if (!options.overwrite) require_new(folder, files);
  for (const std::string& name : seen)
    link_folder(folder / name / "constant/polyMesh", "../../constant/polyMesh");
  write_case_files(folder, files, options.overwrite);
  let_run(folder / "Allrun");
  std::vector<OpenfoamCase> results;
  for (std::size_t i = 0; i < winds.size(); ++i) {
    remove_leaves(folder / folder_of_wind(winds[i].wind.from), mesh, marks.size());
    let_run(folder / folder_of_wind(winds[i].wind.from) / "Allrun");
    results.push_back(facts_of(mesh, fields[i], samples));
  }
  return results;
}

}  // namespace tetropolis
