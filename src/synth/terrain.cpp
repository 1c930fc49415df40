#include <algorithm>
#include <cmath>

#include "tetropolis/synth/synthetic_city.h"

#include "core/infinity.h"

namespace tetropolis {

namespace {

constexpr double kBankWidth = 2;  // Metres over which a bank rises from the water to the quay.

/// Like sin(2 pi t), but made of two parabolas: the sine of the standard library differs between
/// platforms in the last bits.
double wave(double t) {
  t -= std::floor(t);
  return t < 0.5 ? 16 * t * (0.5 - t) : -16 * (t - 0.5) * (1 - t);
}

/// The derivative of wave().
double wave_slope(double t) {
  t -= std::floor(t);
  return t < 0.5 ? 8 - 32 * t : 32 * t - 24;
}

/// Rises smoothly from 0 at t <= 0 to 1 at t >= 1.
double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// Waves of three lengths in different directions, in [0, 1].
double hills(const SyntheticTerrain& terrain, double x, double y) {
  const double broad = wave((0.8 * x + 0.6 * y) / 870 + terrain.phases[0]);
  const double across = wave((-5.0 / 13 * x + 12.0 / 13 * y) / 610 + terrain.phases[1]);
  const double small = wave((24.0 / 25 * x - 7.0 / 25 * y) / 330 + terrain.phases[2]) *
                       wave(y / 410 + terrain.phases[3]);
  return 0.5 + 0.5 * (0.45 * broad + 0.35 * across + 0.2 * small);
}

bool in_canal(const SyntheticTerrain& terrain, double x, double y) {
  if (!(terrain.canal_spacing > 0)) return false;
  const auto beside = [&](double t) {
    const double k = std::floor(t / terrain.canal_spacing);
    return std::abs(t - terrain.canal_spacing * (k + 0.5)) <= terrain.canal_half_width;
  };
  return beside(x) || beside(y);
}

/// What slope, rock and canals add to the hills.
double relief_added(const SyntheticTerrain& terrain, double x, double y) {
  double z = terrain.slope.x * x + terrain.slope.y * y;
  if (terrain.step_normal.x * x + terrain.step_normal.y * y > terrain.step_offset)
    z += terrain.step_height;
  if (in_canal(terrain, x, y)) z -= terrain.canal_depth;
  return z;
}

}  // namespace

double synthetic_river_distance(const SyntheticTerrain& terrain, double x, double y) {
  if (!terrain.river) return kInfinity;
  const double t = x / terrain.river_wavelength + terrain.river_phase;
  const double centre = terrain.river_y + terrain.river_amplitude * wave(t);
  const double slope = terrain.river_amplitude / terrain.river_wavelength * wave_slope(t);
  return std::abs(y - centre) / std::sqrt(1 + slope * slope);
}

bool synthetic_water(const SyntheticTerrain& terrain, double x, double y) {
  return synthetic_river_distance(terrain, x, y) <= terrain.river_half_width ||
         in_canal(terrain, x, y);
}

double synthetic_ground(const SyntheticTerrain& terrain, double x, double y) {
  const double added = relief_added(terrain, x, y);
  if (!terrain.river) return terrain.base + terrain.relief * hills(terrain, x, y) + added;
  const double ashore = synthetic_river_distance(terrain, x, y) - terrain.river_half_width;
  if (ashore <= 0) return terrain.water_level + added;
  const double bank = std::min(ashore / kBankWidth, 1.0);
  return terrain.water_level + (terrain.base - terrain.water_level) * bank +
         terrain.relief * hills(terrain, x, y) *
             smooth_step((ashore - 4 * kBankWidth) / terrain.valley) +
         added;
}

}  // namespace tetropolis
