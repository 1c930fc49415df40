// The wind that blows towards a city: a neutral boundary layer over rough ground, in balance with
// the k-epsilon model.
// Source: P. J. Richards, R. P. Hoxey, "Appropriate boundary conditions for computational wind
// engineering models using the k-epsilon turbulence model", J. Wind Eng. Ind. Aerodyn. 46-47
// (1993), 145-153.
#pragma once

#include <array>
#include <cmath>

namespace tetropolis {

inline constexpr double kKarman = 0.4;
inline constexpr double kCmu = 0.09;  ///< Of the k-epsilon model.

struct Wind {
  double speed = 5;        ///< At `height` [m/s].
  double height = 10;      ///< Above the ground [m].
  double from = 270;       ///< Where it comes from [degrees], clockwise from the grid's north.
  double roughness = 0.5;  ///< Aerodynamic roughness length of the land upwind [m].
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
class WindProfile {
 public:
  /// Preconditions: speed and height are above zero, and so is roughness.
  explicit WindProfile(const Wind& wind)
      : roughness_(wind.roughness),
        friction_velocity_(kKarman * wind.speed /
                           std::log((wind.height + wind.roughness) / wind.roughness)) {}

  double friction_velocity() const { return friction_velocity_; }  ///< [m/s]
  double speed(double height) const {                              ///< [m/s]
    return friction_velocity_ / kKarman * std::log((height + roughness_) / roughness_);
  }
  /// Turbulent kinetic energy [m2/s2], the same at all heights.
  double k() const { return friction_velocity_ * friction_velocity_ / std::sqrt(kCmu); }
  double dissipation(double height) const {  ///< Epsilon [m2/s3].
    return std::pow(friction_velocity_, 3) / (kKarman * (height + roughness_));
  }

 private:
  double roughness_;
  double friction_velocity_;
};

}  // namespace tetropolis
