// The fields of a case's 0/: wind at every cell and face by its height above the ground. Private to
// src/case.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tetropolis/case/openfoam_case.h"

#include "foam_heights.h"
#include "foam_mesh.h"

namespace tetropolis {

/// Heights, the same for all winds over a mesh.
struct Places {
  explicit Places(const FoamMesh& mesh);

  std::vector<double> floors;                   ///< floors_below the points.
  std::vector<double> cells;                    ///< heights_of_cells.
  std::vector<std::vector<WallCell>> on_walls;  ///< Per patch of the mesh, cells_on its faces;
                                                ///< empty where it is not of the ground.
  double layers_top = 0;                        ///< Where layers of prisms end, the median; or 0.
  OpenLand open;                                ///< open_land.
};

/// Rough ground for wall functions. The wind is in balance over it if they take y + z0 for the
/// distance y of a cell's centre: U = u*/kappa ln((y + z0)/z0), epsilon and production of k as
/// u*^3/(kappa (y + z0)) (Richards & Hoxey, Appropriate boundary conditions for computational wind
/// engineering models using the k-epsilon turbulence model, J. Wind Eng. Ind. Aerodyn. 46-47, 1993;
/// Parente et al., Improved k-epsilon model and wall function formulation for the RANS simulation
/// of ABL flows, J. Wind Eng. Ind. Aerodyn. 99, 2011). OpenFOAM's epsilonWallFunction takes y:
/// twice too much where y = z0. kappa * factor for kappa, factor = (y + z0)/y, gives what is
/// wanted. nutkAtmRoughWallFunction has the same kappa; lengths z with factor/ln(1 + y/z) = 1/ln(1
/// + y/z0) leave its stress as it is with z0.
struct RoughWall {
  double roughness = 0;         ///< z0 [m].
  double factor = 1;            ///< The median of the patch.
  std::vector<double> lengths;  ///< Per face [m].
};

/// A patch of the case: what it is, and the wind at its faces.
struct CasePatch {
  const FoamPatch* patch = nullptr;
  enum class Kind : std::uint8_t { kGround, kBuilding, kTop, kSide } kind = Kind::kGround;
  SideRole role = SideRole::kAlong;  ///< Of a side.
  std::vector<double> heights;       ///< Per face of a side: of its centre, above the ground.
  RoughWall rough;                   ///< Of ground; factor 1 elsewhere.
};

class FoamFields {
 public:
  /// Mesh and places must outlive them.
  FoamFields(const FoamMesh& mesh, const Places& places, const OpenfoamCaseOptions& options);

  /// Those of the mesh, in its order.
  const std::vector<CasePatch>& patches() const { return patches_; }
  /// The files of 0/.
  std::string velocity() const;
  std::string pressure() const;
  std::string kinetic_energy() const;
  std::string dissipation() const;
  std::string eddy_viscosity() const;

 private:
  template <typename OfPatch>
  std::string field(const std::string& name, const std::string& type, const char* dimensions,
                    const std::string& inside, const OfPatch& of_patch,
                    const std::string& note = "") const;
  template <typename OfWall, typename At>
  std::string turbulence(const std::string& name, const char* dimensions, const std::string& inside,
                         const OfWall& of_wall, const std::string& top, const At& at) const;
  double height_of_top() const;
  double roughness(const FoamPatch& patch) const;

  const FoamMesh& mesh_;
  const Places& places_;
  OpenfoamCaseOptions options_;
  WindProfile profile_;
  std::array<double, 2> to_;
  std::vector<CasePatch> patches_;
  double top_;
};

}  // namespace tetropolis
