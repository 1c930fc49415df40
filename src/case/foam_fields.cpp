#include "foam_fields.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "core/infinity.h"
#include "core/median.h"
#include "foam_dictionaries.h"
#include "geometry/vec3.h"

namespace tetropolis {

namespace {

/// Wind that meets a side at less than that (a sine, half a degree) blows along it.
constexpr double kAlong = 0.0087;

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

/// For ground of roughness z0 [m] below `cells`, of which there is one at least.
RoughWall rough_wall(const std::vector<WallCell>& cells, double z0) {
  RoughWall wall{z0, 1, {}};
  if (cells.empty()) return wall;
  constexpr double kLeast = 1e-6;  // [m] above the ground
  std::vector<double> factors;
  for (const WallCell& cell : cells) factors.push_back(1 + z0 / std::max(cell.centre, kLeast));
  wall.factor = median(factors);
  for (const WallCell& cell : cells) {
    const double y = std::max(cell.centre, kLeast);
    wall.lengths.push_back(y / (std::pow(1 + y / z0, wall.factor) - 1));
  }
  return wall;
}

std::string constants(const CasePatch& patch) {
  return fmt::format("Cmu {}; kappa {:.8g}; E 9.8;", kCmu, kKarman * patch.rough.factor);
}

std::string rough_lengths(const RoughWall& wall) {
  if (wall.lengths.empty()) return fmt::format("uniform {:.8g}", wall.roughness);
  return scalars(wall.lengths.size(), [&](std::size_t i) { return wall.lengths[i]; });
}

}  // namespace

Places::Places(const FoamMesh& mesh)
    : floors(floors_below(mesh.points)), cells(heights_of_cells(mesh, floors)) {
  const std::vector<double> tops = tops_of_prisms(mesh, floors);
  std::vector<double> columns;
  for (std::size_t i = 0; i < tops.size(); ++i)
    if (tops[i] > 0 && mesh.points[i][2] == floors[i]) columns.push_back(tops[i]);
  if (!columns.empty()) layers_top = median(columns);
  open = open_land(mesh, tops);
  for (const FoamPatch& patch : mesh.patches) {
    std::vector<std::size_t> faces;
    if (patch.is_wall && !patch.of_building())
      for (std::size_t f = patch.begin; f < patch.end; ++f) faces.push_back(f);
    on_walls.push_back(faces.empty() ? std::vector<WallCell>() : cells_on(mesh, faces));
  }
}

FoamFields::FoamFields(const FoamMesh& mesh, const Places& places,
                       const OpenfoamCaseOptions& options)
    : mesh_(mesh),
      places_(places),
      options_(options),
      profile_(options.wind),
      to_(direction(options.wind)),
      patches_(patches_of(mesh, places.floors, options.wind)),
      top_(height_of_top()) {
  for (std::size_t i = 0; i < patches_.size(); ++i)
    if (patches_[i].kind == CasePatch::Kind::kGround)
      patches_[i].rough = rough_wall(places.on_walls[i], roughness(*patches_[i].patch));
}

template <typename OfPatch>
std::string FoamFields::field(const std::string& name, const std::string& type,
                              const char* dimensions, const std::string& inside,
                              const OfPatch& of_patch, const std::string& note) const {
  std::string text = foam_head(type, name) + note +
                     fmt::format("dimensions      {};\n\ninternalField   ", dimensions);
  text += inside;
  text += ";\n\nboundaryField\n{\n";
  for (const CasePatch& p : patches_)
    text += fmt::format("    {} {{ {} }}\n", p.patch->name, of_patch(p));
  return text + "}\n";
}

/// k and epsilon: `at` gives the values for heights.
template <typename OfWall, typename At>
std::string FoamFields::turbulence(const std::string& name, const char* dimensions,
                                   const std::string& inside, const OfWall& of_wall,
                                   const std::string& top, const At& at) const {
  return field(name, "volScalarField", dimensions, inside, [&](const CasePatch& p) -> std::string {
    if (p.patch->is_wall) return of_wall(p);
    if (p.kind == CasePatch::Kind::kTop) return fixed(top);
    if (p.role == SideRole::kAlong) return entry("zeroGradient");
    const std::string values = at(p.heights);
    if (p.role == SideRole::kInlet) return fixed(values);
    return entry("inletOutlet", fmt::format("inletValue {}; value {};", values, values));
  });
}

std::string FoamFields::velocity() const {
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

std::string FoamFields::pressure() const {
  return field("p", "volScalarField", "[0 2 -2 0 0 0 0]", "uniform 0",
               [&](const CasePatch& p) -> std::string {
                 if (p.kind == CasePatch::Kind::kSide && p.role == SideRole::kOutlet)
                   return fixed("uniform 0");
                 if (p.kind == CasePatch::Kind::kSide && p.role == SideRole::kBoth)
                   return entry("freestreamPressure", "freestreamValue uniform 0;");
                 return entry("zeroGradient");
               });
}

std::string FoamFields::kinetic_energy() const {
  const auto uniform = [&](double height) {
    return fmt::format("uniform {:.8g}", profile_.k(height));
  };
  const auto at = [&](const std::vector<double>& heights) {
    return profile_.is_measured()
               ? scalars(heights.size(), [&](std::size_t i) { return profile_.k(heights[i]); })
               : uniform(0);
  };
  const auto of_wall = [wall = entry("kqRWallFunction", "value " + uniform(0) + ";")](
                           const CasePatch&) { return wall; };
  return turbulence("k", "[0 2 -2 0 0 0 0]", at(places_.cells), of_wall, uniform(top_), at);
}

std::string FoamFields::dissipation() const {
  const auto epsilon = [&](const std::vector<double>& heights) {
    return scalars(heights.size(), [&](std::size_t i) { return profile_.dissipation(heights[i]); });
  };
  const auto of_wall = [&](const CasePatch& p) {
    return entry("epsilonWallFunction",
                 fmt::format("value uniform {:.8g}; {}", profile_.dissipation(2), constants(p)));
  };
  return turbulence("epsilon", "[0 2 -3 0 0 0 0]", epsilon(places_.cells), of_wall,
                    fmt::format("uniform {:.8g}", profile_.dissipation(top_)), epsilon);
}

std::string FoamFields::eddy_viscosity() const {
  std::string note =
      "// On the ground, kappa and z0 make wall functions, which take y, fit a wind that has y + "
      "z0."
      "\n// Roughness lengths:";
  for (const CasePatch& p : patches_)
    if (p.kind == CasePatch::Kind::kGround)
      note += fmt::format(" {} {} m;", p.patch->name, p.rough.roughness);
  note += "\n\n";
  return field(
      "nut", "volScalarField", "[0 2 -1 0 0 0 0]", "uniform 0",
      [&](const CasePatch& p) -> std::string {
        if (!p.patch->is_wall) return entry("calculated", "value uniform 0;");
        const std::string rest = constants(p) + " value uniform 0;";
        const double building = options_.building_roughness;
        if (p.kind == CasePatch::Kind::kGround)
          return entry("nutkAtmRoughWallFunction",
                       fmt::format("z0 {}; {}", rough_lengths(p.rough), rest));
        return building > 0 ? entry("nutkAtmRoughWallFunction",
                                    fmt::format("z0 uniform {:.8g}; {}", building, rest))
                            : entry("nutkWallFunction", rest);
      },
      note);
}

double FoamFields::roughness(const FoamPatch& patch) const {
  const auto own = options_.patch_roughness.find(patch.name);
  if (own != options_.patch_roughness.end()) return own->second;
  const bool is_land = patch.name == kOpenLand || mesh_.town.empty();
  return is_land || options_.ground_roughness <= 0 ? options_.wind.roughness
                                                   : options_.ground_roughness;
}

/// Of the top above the ground along the sides, the mean of it.
double FoamFields::height_of_top() const {
  double highest = -kInfinity, sum = 0, count = 0;
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

}  // namespace tetropolis
