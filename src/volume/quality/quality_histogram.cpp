#include "tetropolis/volume/quality/quality_histogram.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/infinity.h"
#include "core/units.h"
#include "tet_cosines.h"

namespace tetropolis {

namespace {

constexpr double kBinsPerDegree = 100;
constexpr std::size_t kDihedralBins = 7200;  // the least dihedral angle is at most 70.53 degrees
constexpr double kAspectBase = 1.001;        // bin i starts at aspect ratio 1.001^i
constexpr std::size_t kAspectBins = 16000;   // up to 8.8e6

/// Bin whose cumulated count first reaches `fraction` of the total.
std::size_t quantile_bin(const std::vector<std::int64_t>& bins, std::int64_t total,
                         double fraction) {
  const double wanted = std::max(1.0, std::ceil(fraction * static_cast<double>(total)));
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    sum += bins[i];
    if (static_cast<double>(sum) >= wanted) return i;
  }
  return bins.size() - 1;
}

/// Finds the bin of a value: a guide table leads near it (Chen & Asau, On generating random
/// variates from an empirical distribution, 1974), comparing with the bounds does the rest.
class BinFinder {
 public:
  /// Bin i is [bounds[i], bounds[i + 1]), ascending; the last one has no end. The guide covers
  /// values up to `guided`, below the last bound, in steps of 1 / `per_unit`.
  BinFinder(std::vector<double> bounds, double guided, double per_unit)
      : bounds_(std::move(bounds)), per_unit_(per_unit) {
    bounds_.push_back(kInfinity);
    steps_ = std::floor((guided - bounds_.front()) * per_unit);
    guide_.resize(static_cast<std::size_t>(steps_));
    std::size_t bin = 0;
    for (std::size_t i = 0; i < guide_.size(); ++i) {
      const double value = bounds_.front() + (static_cast<double>(i) - 0.01) / per_unit;
      while (bounds_[bin + 1] <= value) ++bin;
      guide_[i] = static_cast<std::uint16_t>(bin);
    }
  }
  std::size_t operator()(double value) const {
    const double step = (value - bounds_.front()) * per_unit_;
    if (!(step > 0)) return 0;
    if (step >= steps_)
      return static_cast<std::size_t>(std::upper_bound(bounds_.begin(), bounds_.end() - 1, value) -
                                      bounds_.begin()) -
             1;
    // By way of an int: one instruction.
    std::size_t bin = guide_[static_cast<std::size_t>(static_cast<int>(step))];
    bin += bounds_[bin + 1] <= value ? 1 : 0;  // mostly enough, and no branch
    while (bounds_[bin + 1] <= value) ++bin;
    return bin;
  }

 private:
  std::vector<double> bounds_;
  double per_unit_;
  std::vector<std::uint16_t> guide_;
  double steps_ = 0;  // guide_.size()
};

/// Bins of dihedral angles by 1 - cosine, which grows with the angle.
const BinFinder& dihedral_bins() {
  static const BinFinder finder = [] {
    std::vector<double> bounds;
    for (std::size_t i = 0; i < kDihedralBins; ++i) {
      const double sine = std::sin(to_radians(static_cast<double>(i) / kBinsPerDegree) / 2);
      bounds.push_back(2 * sine * sine);
    }
    return BinFinder(std::move(bounds), 0.7, 65536);
  }();
  return finder;
}

/// Bins of aspect ratios by their squares.
const BinFinder& aspect_bins() {
  static const BinFinder finder = [] {
    std::vector<double> bounds;
    for (std::size_t i = 0; i < kAspectBins; ++i)
      bounds.push_back(std::pow(kAspectBase, 2 * static_cast<double>(i)));
    return BinFinder(std::move(bounds), 17, 1024);
  }();
  return finder;
}

}  // namespace

QualityHistogram::QualityHistogram()
    : dihedral_bins_(kDihedralBins, 0), aspect_bins_(kAspectBins, 0) {}

void QualityHistogram::add(std::span<const double> greatest_cosines,
                           std::span<const double> squared_aspect_ratios, std::int64_t inverted,
                           int times) {
  const BinFinder &by_angle = dihedral_bins(), &by_aspect = aspect_bins();
  for (const double cosine : greatest_cosines) dihedral_bins_[by_angle(1 - cosine)] += times;
  for (const double square : squared_aspect_ratios) aspect_bins_[by_aspect(square)] += times;
  cells_ += times * static_cast<std::int64_t>(greatest_cosines.size());
  inverted_ += times * inverted;
}

void QualityHistogram::widen(double greatest_cosine, double least_cosine, double aspect_ratio) {
  greatest_cosine_ = std::max(greatest_cosine_, greatest_cosine);
  least_cosine_ = std::min(least_cosine_, least_cosine);
  max_aspect_ = std::max(max_aspect_, aspect_ratio);
}

double QualityHistogram::min_dihedral_deg() const {
  return cells_ == 0 ? kInfinity : angle_deg(greatest_cosine_);
}

double QualityHistogram::max_dihedral_deg() const {
  return cells_ == 0 ? 0 : angle_deg(least_cosine_);
}

void QualityHistogram::merge(const QualityHistogram& other) {
  for (std::size_t i = 0; i < kDihedralBins; ++i) dihedral_bins_[i] += other.dihedral_bins_[i];
  for (std::size_t i = 0; i < kAspectBins; ++i) aspect_bins_[i] += other.aspect_bins_[i];
  cells_ += other.cells_;
  inverted_ += other.inverted_;
  volume_ += other.volume_;
  widen(other.greatest_cosine_, other.least_cosine_, other.max_aspect_);
}

std::vector<std::int64_t> QualityHistogram::dihedral_counts() const {
  std::vector<std::int64_t> counts(kDihedralBins / static_cast<std::size_t>(kBinsPerDegree), 0);
  for (std::size_t i = 0; i < kDihedralBins; ++i)
    counts[i / static_cast<std::size_t>(kBinsPerDegree)] += dihedral_bins_[i];
  return counts;
}

double QualityHistogram::dihedral_quantile_deg(double fraction) const {
  const auto bin = static_cast<double>(quantile_bin(dihedral_bins_, cells_, fraction));
  return std::max(min_dihedral_deg(), (bin + 0.5) / kBinsPerDegree);
}

double QualityHistogram::aspect_quantile(double fraction) const {
  const auto bin = static_cast<double>(quantile_bin(aspect_bins_, cells_, fraction));
  return std::min(max_aspect_, std::pow(kAspectBase, bin + 0.5));
}

}  // namespace tetropolis
