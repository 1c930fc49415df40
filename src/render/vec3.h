// Vectors and colours of pictures. Private to src/render.
#pragma once

#include <algorithm>
#include <cmath>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

struct Vec3 {
  double x = 0;
  double y = 0;
  double z = 0;

  Vec3() = default;
  Vec3(double x_, double y_, double z_) : x(x_), y(y_), z(z_) {}
  explicit Vec3(const Point3& p) : x(p[0]), y(p[1]), z(p[2]) {}

  friend Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

inline double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// Of length 1; that of no length stays.
inline Vec3 normalised(Vec3 a) {
  const double length = std::sqrt(dot(a, a));
  return length > 0 ? (1 / length) * a : a;
}

/// Light, linear: 1 is white.
struct Rgb {
  float r = 0;
  float g = 0;
  float b = 0;

  friend Rgb operator+(Rgb p, Rgb q) { return {p.r + q.r, p.g + q.g, p.b + q.b}; }
  friend Rgb operator*(Rgb p, Rgb q) { return {p.r * q.r, p.g * q.g, p.b * q.b}; }
  friend Rgb operator*(float s, Rgb p) { return {s * p.r, s * p.g, s * p.b}; }
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

inline Rgb mix(Rgb a, Rgb b, float share_of_b) { return (1 - share_of_b) * a + share_of_b * b; }

/// Of sRGB, 0xRRGGBB. Source of both: IEC 61966-2-1.
inline Rgb linear(unsigned hex) {
  const auto channel = [](unsigned byte) {
    const double v = byte / 255.0;
    return static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
  };
  return {channel(hex >> 16U & 255U), channel(hex >> 8U & 255U), channel(hex & 255U)};
}

/// The byte of sRGB for a channel.
inline unsigned char srgb_byte(float light) {
  const double v = std::clamp(static_cast<double>(light), 0.0, 1.0);
  const double s = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
  return static_cast<unsigned char>(std::lround(255 * s));
}

}  // namespace tetropolis
