// Sun and sky. Private to src/render.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "rasterise.h"
#include "vec3.h"

namespace tetropolis {

/// Light from far away, in one direction.
struct FarLight {
  Vec3 towards;        ///< Of length 1: where it is.
  float strength = 1;  ///< On a surface that faces it.
};

/// The sun as a disc, so that shadows are soft: many lights of strength 1 together around compass
/// direction `azimuth` and `elevation`, degrees.
std::vector<FarLight> sun_lights(double azimuth, double elevation);

/// An even sky as lights, of strength 1 together on level ground.
std::vector<FarLight> sky_lights();

/// Where light is looked for.
struct Receiver {
  std::array<float, 3> position;
  std::array<float, 3> normal;  ///< Of length 1.
  float light = 0;              ///< What has arrived.
};

/// Adds to all receivers what arrives of `lights` past the triangles, by a depth map of so many
/// pixels square for each (Williams, "Casting curved shadows on curved surfaces", SIGGRAPH 1978).
/// The same for any number of threads.
void illuminate(std::span<const Vec3> points, Triangles triangles, std::span<const FarLight> lights,
                int map_size, std::span<std::vector<Receiver>> receivers);

}  // namespace tetropolis
