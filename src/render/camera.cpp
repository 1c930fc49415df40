#include "camera.h"

#include <algorithm>
#include <cmath>

#include "core/infinity.h"
#include "core/units.h"

namespace tetropolis {

namespace {

struct Range {
  double low = kInfinity;
  double high = -kInfinity;

  void extend(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double middle() const { return (low + high) / 2; }
};

/// The eye is as near as it can be while every point is inside the four planes that pass it.
void fit_perspective(Camera& camera, std::span<const Vec3> points, double tan_x, double tan_y) {
  // Of a point right of the axis by x and at depth z - z_eye: |x - x_eye| <= tan_x (z - z_eye).
  double right = -kInfinity, left = kInfinity, top = -kInfinity, bottom = kInfinity;
  double nearest = kInfinity;
  for (const Vec3 p : points) {
    const double x = dot(p, camera.right), y = dot(p, camera.up), z = dot(p, camera.forward);
    right = std::max(right, x - tan_x * z);
    left = std::min(left, x + tan_x * z);
    top = std::max(top, y - tan_y * z);
    bottom = std::min(bottom, y + tan_y * z);
    nearest = std::min(nearest, z);
  }
  const double back =
      std::max({(right - left) / (2 * tan_x), (top - bottom) / (2 * tan_y), 1 - nearest});
  camera.eye = ((right + left) / 2) * camera.right + ((top + bottom) / 2) * camera.up -
               back * camera.forward;
  constexpr double kNear = 0.02;
  camera.near_depth = kNear * back;
}

}  // namespace

Camera looking(double azimuth, double elevation) {
  const double a = to_radians(azimuth), e = to_radians(elevation);
  const Vec3 ahead{std::sin(a), std::cos(a), 0}, zenith{0, 0, 1};
  Camera camera;
  camera.right = {std::cos(a), -std::sin(a), 0};
  camera.forward = std::cos(e) * ahead - std::sin(e) * zenith;
  camera.up = std::sin(e) * ahead + std::cos(e) * zenith;
  return camera;
}

void fit(Camera& camera, std::span<const Vec3> points, double width, double height, double margin,
         double field) {
  camera.middle_x = width / 2;
  camera.middle_y = height / 2;
  camera.is_perspective = field > 0;
  const double used = 1 - 2 * margin;
  if (field > 0) {
    const double tangent = std::tan(to_radians(field / 2));
    camera.scale = height / 2 / tangent;
    fit_perspective(camera, points, used * tangent * width / height, used * tangent);
    return;
  }
  Range x, y, z;
  for (const Vec3 p : points) {
    x.extend(dot(p, camera.right));
    y.extend(dot(p, camera.up));
    z.extend(dot(p, camera.forward));
  }
  constexpr double kLeast = 1e-3;  // metres: a single point has a picture, too
  camera.scale = used * std::min(width / std::max(x.high - x.low, kLeast),
                                 height / std::max(y.high - y.low, kLeast));
  camera.eye = x.middle() * camera.right + y.middle() * camera.up + z.low * camera.forward;
}

}  // namespace tetropolis
