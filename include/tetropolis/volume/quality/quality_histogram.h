// Distribution of the shapes of tetrahedra.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace tetropolis {

/// Shares of cells by their least dihedral angle and by aspect ratio; exact counts in fine bins.
class QualityHistogram {
 public:
  QualityHistogram();
  /// Counts tets by the cosine of their least dihedral angle and their squared aspect ratio, and
  /// how many of them are inverted; takes them away again if `times` is -1.
  void add(std::span<const double> greatest_cosines, std::span<const double> squared_aspect_ratios,
           std::int64_t inverted, int times = 1);
  void add_volume(double volume) { volume_ += volume; }
  /// The extremes take in those of tets with these figures.
  void widen(double greatest_cosine, double least_cosine, double aspect_ratio);
  void merge(const QualityHistogram& other);

  std::int64_t cells() const { return cells_; }
  std::int64_t inverted() const { return inverted_; }  ///< Cells with volume <= 0.
  double volume() const { return volume_; }
  double min_dihedral_deg() const;
  double max_dihedral_deg() const;
  double max_aspect_ratio() const { return max_aspect_; }
  /// Cells by their least dihedral angle: of 0 to 1 degrees, 1 to 2, ..., 71 to 72.
  std::vector<std::int64_t> dihedral_counts() const;
  /// The angle that a share `fraction` in [0, 1] of the cells has as least dihedral angle or less;
  /// exact to 0.01 degrees.
  double dihedral_quantile_deg(double fraction) const;
  /// Likewise for the aspect ratio, to 0.1 %.
  double aspect_quantile(double fraction) const;

  friend bool operator==(const QualityHistogram&, const QualityHistogram&) = default;

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

}  // namespace tetropolis
