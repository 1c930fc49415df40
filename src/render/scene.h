// What is painted: coloured triangles. Private to src/render.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tetropolis/render/render.h"

#include "vec3.h"

namespace tetropolis {

struct Scene {
  std::vector<Vec3> points;   ///< All are corners of triangles.
  std::vector<Vec3> normals;  ///< Per point: of smooth ground, upwards; else zero: faces are flat.
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<Rgb> colour;          ///< Per triangle.
  std::vector<std::uint8_t> edges;  ///< Per triangle: bit i: the edge from corner i to the next is
                                    ///< drawn.
  double highest = 0;               ///< Of the faces of buildings, if colours tell heights [m].

  void add(const std::array<std::int32_t, 3>& corners, Rgb of, std::uint8_t which_edges = 0) {
    triangles.push_back(corners);
    colour.push_back(of);
    edges.push_back(which_edges);
  }
  std::int32_t add(Vec3 point) {
    points.push_back(point);
    normals.emplace_back();
    return static_cast<std::int32_t>(points.size()) - 1;
  }
};

inline constexpr std::uint8_t kAllEdges = 7;

/// What is wrong with a surface, behind its name; empty if nothing is.
std::string why_not_drawn(const SurfaceMesh& surface);

/// Ground, roofs and walls of `surface`; faces of no known kind by their slope.
Scene city_scene(const SurfaceMesh& surface, PictureColour colour, bool edges);

/// Adds the sides of a slab below the open edges of the scene, down to `floor`.
void add_slab(Scene& scene, double floor);

/// The part of the scene where dot(p, normal) >= offset.
Scene clipped(const Scene& scene, Vec3 normal, double offset);

/// Adds `by` to all points.
void move(Scene& scene, Vec3 by);

/// The colour of a value between 0 (dark blue) and 1 (yellow).
Rgb ramp(double value);

/// Colours of classes.
struct Palette {
  Rgb ground = linear(0xB6BBA0);
  Rgb water = linear(0x7FA3BF);
  Rgb road = linear(0xA3A09B);
  Rgb vegetation = linear(0x93AC7C);
  Rgb roof = linear(0xC27A63);
  Rgb wall = linear(0xF4EADA);
  Rgb earth = linear(0x8F7B69);
};

}  // namespace tetropolis
