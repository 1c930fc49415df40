// What the cells and faces of a column mesh are like, kept up to date as its columns change.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
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
  kGood,    ///< kGoodAngles.
};
inline constexpr std::array kAskedBounds{
    kQualityFloor, AngleBounds{kLeastOfMost, kQualityFloor.greatest}, kGoodAngles};

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
  friend bool operator==(const FaultCounts&, const FaultCounts&) = default;
};

struct MeshQuality {
  CellQuality cells;
  FaceQuality faces;
  FaultCounts faults;
};

/// The figures of each stack and of the faces over each edge, from one sweep over the mesh. Fast
/// loops (stack_kernels.h) tell where the worst cells and faces are; figures of these are those of
/// tet_cosines(), face_shape() and boundary_skewness(). Takes 48 bytes for each triangle of the
/// ground mesh and 20 for each edge. The same for any number of threads.
class MeasuredMesh {
 public:
  enum class Counting { kFaults, kHistogram };
  /// With kHistogram for quality(), too.
  explicit MeasuredMesh(const ColumnMesh& mesh, Counting counting = Counting::kFaults);

  /// Where columns change: forget() before, with the mesh as it was measured, and look_again()
  /// after that with the same columns, or more than change. Without histogram, look_again() alone
  /// does. Precondition: the ground mesh stays.
  void forget(const ColumnMesh& mesh, std::span<const VertexIndex> columns);
  void look_again(const ColumnMesh& mesh, std::span<const VertexIndex> columns);

  FaultCounts counts() const;

  /// 1 for the triangles over which a cell is outside the bounds, or over which (or over an edge of
  /// which) a face is more than kMostNonOrthogonal.
  std::vector<std::uint8_t> bad_triangles(const ColumnMesh& mesh, Asked asked) const;

  /// The same for the faces alone.
  std::vector<std::uint8_t> steep_triangles(const ColumnMesh& mesh) const;

  /// Without what measure_ends() adds. Lists the `worst` worst cells. Precondition: made with
  /// kHistogram.
  MeshQuality quality(const ColumnMesh& mesh, std::size_t worst) const;

 private:
  struct Faces {
    std::int32_t count = 0;  // between two cells
    std::int32_t steep = 0;  // of these
    float worst_steep_deg = 0;
    float straight2 = 1;  // as in FaceExtremes, rounded
    float skewness2 = 0;
  };
  struct Stack {
    std::int32_t thin = 0;
    std::array<std::int32_t, kAskedBounds.size()> outside{};
    float least = 2, greatest = 2;  // 1 - cosine of the least angle, 1 + cosine of the greatest
    float aspect2 = 0;              // rounded all
    Faces faces;                    // over the triangle
  };
  class Sweep;

  void sweep(const ColumnMesh& mesh, std::span<const TriangleIndex> triangles, int times);
  std::vector<TriangleIndex> suspects(std::size_t worst) const;
  FaceQuality face_quality(const ColumnMesh& mesh) const;

  std::vector<Stack> stacks_;  // per triangle
  std::vector<Faces> beside_;  // per edge
  std::optional<QualityHistogram> histogram_;
};

/// Adds the faces at the ends of the mesh's columns, and the upper part, to the figures of these:
/// they may have been measured before it had one, and before it had layers.
void measure_ends(const ColumnMesh& mesh, std::size_t worst, MeshQuality& quality);

/// Everything about a mesh that does not change any more.
MeshQuality measure_quality(const ColumnMesh& mesh, std::size_t worst);

}  // namespace tetropolis
