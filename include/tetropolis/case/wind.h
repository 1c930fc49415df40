// The wind that blows towards a city: a neutral boundary layer over rough ground, in balance with
// the k-epsilon model.
// Source: P. J. Richards, R. P. Hoxey, "Appropriate boundary conditions for computational wind
// engineering models using the k-epsilon turbulence model", J. Wind Eng. Ind. Aerodyn. 46-47
// (1993), 145-153.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <vector>

namespace tetropolis {

inline constexpr double kKarman = 0.4;
inline constexpr double kCmu = 0.09;  ///< Of the k-epsilon model.

/// One height of a measured wind.
struct WindLevel {
  double height = 0;  ///< Above the ground [m].
  double speed = 0;   ///< [m/s]
  double k = 0;       ///< Turbulent kinetic energy [m2/s2].
};

struct Wind {
  double speed = 5;        ///< At `height` [m/s]; ignored where there are levels.
  double height = 10;      ///< Above the ground [m].
  double from = 270;       ///< Where it comes from [degrees], clockwise from the grid's north.
  double roughness = 0.5;  ///< Aerodynamic roughness length of the land upwind [m].
  /// What was measured, instead of the logarithmic law: two levels at least, upwards, faster from
  /// one to the next.
  std::vector<WindLevel> levels{};
};

/// Where it blows to: a unit vector, x to the east and y to the north. Multiples of 90 degrees are
/// exact.
inline std::array<double, 2> direction(const Wind& wind) {
  constexpr double kRadians = 3.14159265358979323846 / 180;
  const double quarters = wind.from / 90;
  if (quarters == std::round(quarters)) {
    constexpr std::array<std::array<double, 2>, 4> kTo = {{{0, -1}, {-1, 0}, {0, 1}, {1, 0}}};
    return kTo[static_cast<std::size_t>(std::fmod(quarters, 4) + 4) % 4];
  }
  return {-std::sin(wind.from * kRadians), -std::cos(wind.from * kRadians)};
}

/// Its profiles by the height above the ground [m].
///
/// Of measured levels: the speed is linear in ln(height + roughness) between them, zero on the
/// ground and constant above the highest; k is linear in height and constant beyond the levels;
/// epsilon is sqrt(Cmu) k dU/dz (Y. Tominaga et al., "AIJ guidelines for practical applications of
/// CFD to pedestrian wind environment around buildings", J. Wind Eng. Ind. Aerodyn. 96 (2008),
/// 1749-1761), above the highest with the slope of the last two.
class WindProfile {
 public:
  /// Preconditions: speed and height are above zero, and so is roughness; levels as Wind says.
  explicit WindProfile(const Wind& wind)
      : roughness_(wind.roughness),
        friction_velocity_(kKarman * wind.speed /
                           std::log((wind.height + wind.roughness) / wind.roughness)),
        levels_(wind.levels) {}

  bool is_measured() const { return !levels_.empty(); }
  double speed(double height) const {  ///< [m/s]
    if (!is_measured())
      return friction_velocity_ / kKarman * std::log((height + roughness_) / roughness_);
    const Piece piece = piece_at(height);
    const double top = std::min(height, levels_.back().height);
    return piece.speed + piece.slope * std::log((top + roughness_) / (piece.height + roughness_));
  }
  /// Turbulent kinetic energy [m2/s2], the same at all heights unless it is measured.
  double k(double height) const {
    if (!is_measured()) return friction_velocity_ * friction_velocity_ / std::sqrt(kCmu);
    if (height <= levels_.front().height) return levels_.front().k;
    if (height >= levels_.back().height) return levels_.back().k;
    const auto above = std::find_if(levels_.begin(), levels_.end(),
                                    [&](const WindLevel& level) { return level.height > height; });
    const WindLevel& a = *(above - 1);
    return a.k + (above->k - a.k) * (height - a.height) / (above->height - a.height);
  }
  double dissipation(double height) const {  ///< Epsilon [m2/s3].
    if (is_measured())
      return std::sqrt(kCmu) * k(height) * piece_at(height).slope / (height + roughness_);
    return std::pow(friction_velocity_, 3) / (kKarman * (height + roughness_));
  }

 private:
  struct Piece {
    double height = 0, speed = 0;  ///< Where it begins.
    double slope = 0;              ///< Of the speed over ln(height + roughness).
  };
  Piece piece_at(double height) const {
    std::size_t i = 0;
    while (i + 1 < levels_.size() && levels_[i].height <= height) ++i;
    const WindLevel ground;
    const WindLevel& a = i == 0 ? ground : levels_[i - 1];
    const WindLevel& b = levels_[i];
    return {a.height, a.speed,
            (b.speed - a.speed) / std::log((b.height + roughness_) / (a.height + roughness_))};
  }

  double roughness_;
  double friction_velocity_;
  std::vector<WindLevel> levels_;
};

/// Reads a table with the heading `height,speed,k` (in any order, other columns are left alone).
/// Throws Error(kInput) naming the file and its line.
std::vector<WindLevel> read_wind_levels(const std::filesystem::path& path);

}  // namespace tetropolis
