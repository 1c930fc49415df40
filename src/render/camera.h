// From space to the picture. Private to src/render.
#pragma once

#include <span>

#include "vec3.h"

namespace tetropolis {

/// Pixels: x to the right, y downwards from the upper left corner.
struct ScreenPoint {
  double x = 0;
  double y = 0;
  double nearness = 0;  ///< Greater is nearer, linear in x and y on a plane: 1 / depth in
                        ///< perspective, -depth else.
};

/// A line of sight: points origin + t * direction, t >= 0.
struct Sight {
  Vec3 origin;
  Vec3 direction;
};

struct Camera {
  Vec3 eye;                 ///< Without perspective: any point on the axis.
  Vec3 right, up, forward;  ///< At right angles, of length 1; a longer `up` stretches heights.
  double scale = 1;         ///< Pixels per metre; in perspective at a depth of 1 m.
  double middle_x = 0;      ///< Where the axis meets the picture, pixels.
  double middle_y = 0;
  bool is_perspective = false;
  double near_depth = 0;  ///< In perspective nothing nearer than that is seen.

  double depth(Vec3 p) const { return dot(p - eye, forward); }
  /// Precondition: in perspective, depth(p) > 0.
  ScreenPoint project(Vec3 p) const {
    const Vec3 q = p - eye;
    const double d = dot(q, forward), s = is_perspective ? scale / d : scale;
    return {middle_x + s * dot(q, right), middle_y - s * dot(q, up), is_perspective ? 1 / d : -d};
  }
  Sight sight(double x, double y) const {
    const Vec3 aside =
        ((x - middle_x) / scale) * right + ((middle_y - y) / scale / dot(up, up)) * up;
    return is_perspective ? Sight{eye, forward + aside} : Sight{eye + aside, forward};
  }
};

/// One that looks in the compass direction `azimuth` (degrees, clockwise from north, which is +y)
/// and `elevation` degrees (-90 to 90) downwards; its axis passes the origin of space.
Camera looking(double azimuth, double elevation);

/// Where the camera's perspective is `field` degrees high (0: none) and `points` fill a picture of
/// width x height pixels but for a margin, a share of both. Precondition: at least one point.
void fit(Camera& camera, std::span<const Vec3> points, double width, double height, double margin,
         double field);

}  // namespace tetropolis
