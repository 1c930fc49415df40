// Shape of tetrahedra: dihedral angles and aspect ratios, and their distribution over a mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "tetropolis/volume/column_mesh.h"

namespace tetropolis {

using Point3 = std::array<double, 3>;

struct TetShape {
  double volume = 0;            ///< Signed, cubic metres.
  double min_dihedral_deg = 0;  ///< Least of the six dihedral angles.
  double max_dihedral_deg = 0;  ///< Greatest of the six.
  double aspect_ratio = 0;      ///< Longest edge over 2 sqrt(6) times the inradius: 1 for the
                                ///< regular tet (Stimpson et al., The Verdict Library, 2007).
};

/// Of a tet of zero or negative volume, the angles and the ratio are those of the flat or mirrored
/// one.
TetShape tet_shape(const Point3& p0, const Point3& p1, const Point3& p2, const Point3& p3);

/// Shares of cells by their least dihedral angle and by aspect ratio; exact counts in fine bins.
class QualityHistogram {
 public:
  QualityHistogram();
  /// Adds a tet by its volume, the cosines of its least and greatest dihedral angle and its aspect
  /// ratio.
  void add(double volume, double greatest_cosine, double least_cosine, double aspect_ratio);
  void merge(const QualityHistogram& other);

  std::int64_t cells() const { return cells_; }
  std::int64_t inverted() const { return inverted_; }  ///< Cells with volume <= 0.
  double volume() const { return volume_; }
  double min_dihedral_deg() const;
  double max_dihedral_deg() const;
  double max_aspect_ratio() const { return max_aspect_; }
  /// The angle that a share `fraction` in [0, 1] of the cells has as least dihedral angle or less;
  /// exact to 0.01 degrees.
  double dihedral_quantile_deg(double fraction) const;
  /// Likewise for the aspect ratio, to 0.1 %.
  double aspect_quantile(double fraction) const;

 private:
  std::vector<std::int64_t> dihedral_bins_;
  std::vector<std::int64_t> aspect_bins_;
  std::int64_t cells_ = 0;
  std::int64_t inverted_ = 0;
  double volume_ = 0;
  double greatest_cosine_ = -1;
  double least_cosine_ = 1;
  double max_aspect_ = 0;
};

/// A cell that is far from regular, and why.
struct WorstCell {
  double badness = 0;  ///< The lesser of min_dihedral_deg and 180 - max_dihedral_deg.
  double min_dihedral_deg = 0;
  double max_dihedral_deg = 0;
  Point3 centre{};             ///< Local frame, metres.
  TriangleIndex triangle = 0;  ///< That it stands over.
  /// "buried roof": beside a building, the ground rises above its roof by more than twice the
  /// triangle's altitude; "steep ground": the floor of its stack rises by more than the triangle's
  /// altitude; "low wall": beside a building, a wall or roof segment shorter than that altitude;
  /// "small detail": the altitude is less than half the cell's vertical edge; "change of size":
  /// none of these.
  std::string_view cause;
};

struct CellQuality {
  QualityHistogram histogram;
  std::vector<WorstCell> worst;  ///< Worst first.
};

/// Over all cells of the mesh; lists the `worst` worst ones. The same bits for any number of
/// threads.
CellQuality measure_quality(const ColumnMesh& mesh, std::size_t worst = 0);

/// Shape of a face between two cells as OpenFOAM's checkMesh measures it.
struct FaceShape {
  double non_orthogonality_deg = 0;  ///< Between the face's normal and the line of cell centres.
  double skewness = 0;  ///< Distance of the face's centre from where that line meets its plane,
                        ///< over the face's extent in this direction (at least a fifth of the
                        ///< distance of the cell centres).
};

/// `c0`, `c1`: centres of the cells on both sides, not in the face's plane.
FaceShape face_shape(const std::array<Point3, 3>& face, const Point3& c0, const Point3& c1);

struct FaceQuality {
  std::int64_t faces = 0;     ///< Internal ones.
  std::int64_t above_70 = 0;  ///< Of them more than 70 degrees non-orthogonal.
  FaceShape worst;            ///< Greatest non-orthogonality and greatest skewness of any face.
};

/// Over all internal faces of the mesh. The same bits for any number of threads.
FaceQuality measure_faces(const ColumnMesh& mesh);

}  // namespace tetropolis
