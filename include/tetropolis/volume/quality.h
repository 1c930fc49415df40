// Shape of tetrahedra: dihedral angles and aspect ratios, and their distribution over a mesh.
#pragma once

#include <array>
#include <cstdint>
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
  void add(const TetShape& shape);
  void merge(const QualityHistogram& other);

  std::int64_t cells() const { return cells_; }
  std::int64_t inverted() const { return inverted_; }  ///< Cells with volume <= 0.
  double volume() const { return volume_; }
  double min_dihedral_deg() const { return min_dihedral_; }
  double max_dihedral_deg() const { return max_dihedral_; }
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
  double min_dihedral_;
  double max_dihedral_;
  double max_aspect_;
};

/// Over all cells of the mesh. The same bits for any number of threads.
QualityHistogram measure_quality(const ColumnMesh& mesh);

}  // namespace tetropolis
