// A case of wind over a city that OpenFOAM solves as it is.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tetropolis/case/wind.h"

namespace tetropolis {

/// Whose OpenFOAM reads the case: openfoam.com (v1906 and later) or openfoam.org (8 and later).
enum class FoamDialect : std::uint8_t { kCom, kOrg };
inline constexpr std::array<std::string_view, 2> kFoamDialectNames = {"com", "org"};

struct OpenfoamCaseOptions {
  Wind wind;
  FoamDialect dialect = FoamDialect::kCom;
  double ground_roughness = 0.03;  ///< Of the ground in the town (write_openfoam) [m]; 0: that of
                                   ///< the wind.
  /// Of patches of the ground by their name [m], > 0; of others as said above.
  std::map<std::string, double> patch_roughness = {
      {"water", 0.0002}, {"road", 0.005}, {"vegetation", 0.1}};
  double building_roughness = 0.01;  ///< Of roofs and walls [m]; 0: smooth.
  double leaf_drag = 0.2;            ///< Drag coefficient Cd of leaves in canopies.
  bool leaf_turbulence = true;       ///< Whether they make and destroy turbulence, too (kCom).
  double sample_height = 1.75;       ///< Where people feel the wind, above the ground [m], in the
                                     ///< town.
  double sample_spacing = 2;         ///< Of the points there [m], or more: 400,000 points at most.
  int iterations = 500;    ///< At most; residuals below 1e-4 (p: 2e-4, U: 1e-3) end the run before.
  bool overwrite = false;  ///< Whether a case that is there is replaced.
};

/// What the wind does at a side of the domain.
enum class SideRole : std::uint8_t {
  kInlet,   ///< Enters.
  kOutlet,  ///< Leaves.
  kBoth,    ///< Enters at some faces and leaves at others, as they lie.
  kAlong,   ///< Blows along it, to within half a degree: slip.
};
inline constexpr std::array<std::string_view, 4> kSideRoleNames = {"inlet", "outlet",
                                                                   "inlet and outlet", "slip"};

struct OpenfoamCase {
  struct Side {
    std::string patch;
    SideRole role = SideRole::kAlong;
  };
  std::vector<Side> sides;
  std::int64_t ground_faces = 0;
  double first_cell = 0;  ///< Height of the cells on the ground [m], the median.
  double layers_top = 0;  ///< Where layers of prisms end above the ground [m], the median; or 0.
  double open_layers_top = 0;  ///< The same on the open land, or on all ground without buildings,
  double open_width = 0;       ///< and the width of the cells there [m].
  std::int64_t canopies = 0;   ///< Zones of leaves,
  std::int64_t canopy_cells = 0;  ///< and their cells.
  std::int64_t samples = 0;       ///< Points at sample_height.
  double sample_spacing = 0;      ///< [m]
};

/// Writes 0/, constant/, system/, Allrun and wind.py around the mesh in `folder`/constant/polyMesh
/// (as write_openfoam writes it): steady, k-epsilon, SIMPLEC, with the profile of the wind at each
/// face by its height above the ground below. Zones of leaves (write_openfoam) take momentum by the
/// drag -Cd LAD |U| U per volume and density (Wilson & Shaw, A higher order closure model for
/// canopy flow, J. Appl. Meteorol. 16, 1977; Cd 0.2: Katul et al., One- and two-equation models for
/// canopy turbulence, Boundary-Layer Meteorol. 113, 2004). They are sources of k, too, Cd LAD
/// |U| (|U|^2 - 4 k), and of epsilon, 1.5 epsilon / k times that (Green, Modelling turbulent air
/// flow in a stand of widely-spaced trees, PHOENICS J. 5, 1992), by OpenFOAM's
/// kEpsilonLopesdaCosta. Sanz (A note on k-epsilon modelling of vegetation canopy air-flows,
/// Boundary-Layer Meteorol. 108, 2003) derives 6.5 and 1.5 for Cmu = 0.09: with these, k and
/// epsilon do not settle. Ground outside the town becomes the patch open_land of
/// constant/polyMesh/boundary, which has the roughness of the wind; else the mesh is not touched.
/// Rough walls are in balance with the wind in cells of any height (RoughWall in
/// src/case/foam_fields.h). Each file appears complete or not at all.
/// Errors: kUsage for options out of range, and for files that are there unless `overwrite`; kInput
/// for a mesh that is missing or is none, and files that cannot be written.
OpenfoamCase write_openfoam_case(const std::filesystem::path& folder,
                                 const OpenfoamCaseOptions& options);

/// "w045", "w022.5": the folder of the wind from there [degrees].
std::string folder_of_wind(double from);

/// The same for several winds over one mesh, that of a cylinder as a rule: a case in a folder of
/// `folder` for each (`folder_of_wind`), whose constant/polyMesh is a relative link to the mesh;
/// beside them an Allrun for all, and rose.py, which puts the wind of all where people are into one
/// table. `from` is where the winds come from [degrees], other than `options.wind.from`, which is
/// ignored. What is returned is in its order. Errors: as above; kUsage, too, for no wind, and
/// for one that comes twice.
std::vector<OpenfoamCase> write_openfoam_cases(const std::filesystem::path& folder,
                                               const OpenfoamCaseOptions& options,
                                               std::span<const double> from);

}  // namespace tetropolis
