// The fields of a case's 0/: wind at every cell and face by its height above the ground. Private to
// src/case.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tetropolis/case/openfoam_case.h"

#include "foam_mesh.h"

namespace tetropolis {

/// What is the same for all winds over a mesh: heights, and where the buildings are.
struct Places {
  explicit Places(const FoamMesh& mesh);

  std::vector<double> floors;  ///< floors_below the points.
  std::vector<double> cells;   ///< heights_of_cells.
  Bounds2 town;                ///< town_of.
};

/// A patch of the case: what it is, and the wind at its faces.
struct CasePatch {
  const FoamPatch* patch = nullptr;
  enum class Kind : std::uint8_t { kGround, kBuilding, kTop, kSide } kind = Kind::kGround;
  SideRole role = SideRole::kAlong;  ///< Of a side.
  std::vector<double> heights;       ///< Per face of a side: of its centre, above the ground.
};

class FoamFields {
 public:
  /// Mesh and places must outlive them.
  FoamFields(const FoamMesh& mesh, const Places& places, const OpenfoamCaseOptions& options);

  /// Those of the mesh, in its order.
  const std::vector<CasePatch>& patches() const { return patches_; }
  /// Roughness [m] of the ground at face f of a patch.
  double roughness(const FoamPatch& patch, std::size_t f) const;

  /// The files of 0/.
  std::string velocity() const;
  std::string pressure() const;
  std::string kinetic_energy() const;
  std::string dissipation() const;
  std::string eddy_viscosity() const;

 private:
  template <typename OfPatch>
  std::string field(const std::string& name, const std::string& type, const char* dimensions,
                    const std::string& inside, const OfPatch& of_patch) const;
  template <typename At>
  std::string turbulence(const std::string& name, const char* dimensions, const std::string& inside,
                         const std::string& wall, const std::string& top, const At& at) const;
  double height_of_top() const;
  std::string ground_roughness_text(const FoamPatch& patch) const;

  const FoamMesh& mesh_;
  const Places& places_;
  OpenfoamCaseOptions options_;
  WindProfile profile_;
  std::array<double, 2> to_;
  std::vector<CasePatch> patches_;
  double top_;
};

}  // namespace tetropolis
