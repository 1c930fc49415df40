// Where the cells and faces of a column mesh are bad, kept up to date as its columns change.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/volume/column/column_mesh.h"
#include "tetropolis/volume/quality/cell_quality.h"
#include "tetropolis/volume/quality/face_quality.h"

#include "improve_columns.h"

namespace tetropolis {

/// What may be asked of the dihedral angles of cells.
enum class Asked : std::size_t {
  kFloor,   ///< kQualityFloor, which all cells keep to.
  kOfMost,  ///< kLeastOfMost and the greatest angle of the floor.
  kGood,    ///< What columns are improved for: ImproveOptions' own angles.
};
inline constexpr std::array kAskedBounds{
    kQualityFloor, AngleBounds{kLeastOfMost, kQualityFloor.greatest},
    AngleBounds{ImproveOptions{}.least_deg, ImproveOptions{}.greatest_deg}};

/// Of a whole mesh.
struct FaultCounts {
  std::int64_t cells = 0;
  std::int64_t thin = 0;  ///< Cells with an angle below kLeastOfMost.
  std::array<std::int64_t, kAskedBounds.size()> outside{};  ///< Cells outside of each bounds.
  std::array<std::int64_t, kAskedBounds.size()>
      triangles{};               ///< Over how many triangles these are.
  std::int64_t steep_faces = 0;  ///< Faces that are more than kMostNonOrthogonal.
  double worst_face_deg = 0;     ///< Greatest non-orthogonality of these; 0 without any.

  std::int64_t cells_outside(Asked asked) const { return outside[static_cast<std::size_t>(asked)]; }
  std::int64_t triangles_outside(Asked asked) const {
    return triangles[static_cast<std::size_t>(asked)];
  }
};

/// A look at every cell takes seconds on large meshes, of which trials change little. Takes 28
/// bytes for each triangle of the ground mesh and 8 for each edge. The same for any number of
/// threads.
class MeshFaults {
 public:
  explicit MeshFaults(const ColumnMesh& mesh);

  /// Looks again where columns have changed, or at least those of `columns` have. Precondition: the
  /// ground mesh is the one of before.
  void look_again(const ColumnMesh& mesh, std::span<const VertexIndex> columns);

  FaultCounts counts() const;

  /// 1 for the triangles over which a cell is outside the bounds, or over which (or over an edge of
  /// which) a face is more than kMostNonOrthogonal.
  std::vector<std::uint8_t> bad_triangles(const ColumnMesh& mesh, Asked asked) const;

  /// The same for the faces alone.
  std::vector<std::uint8_t> steep_triangles(const ColumnMesh& mesh) const;

 private:
  struct Stack {
    std::int32_t cells = 0;
    std::int32_t thin = 0;
    std::array<std::int32_t, kAskedBounds.size()> outside{};
    SteepFaces steep;  // of the faces over the triangle
  };
  static Stack look_at(const ColumnMesh& mesh, std::size_t t);

  std::vector<Stack> stacks_;       // per triangle
  std::vector<SteepFaces> beside_;  // per edge
};

}  // namespace tetropolis
