// From a scene to colours. Private to src/render.
#pragma once

#include <cstddef>
#include <vector>

#include "camera.h"
#include "light.h"
#include "scene.h"

namespace tetropolis {

/// Light per pixel, row by row from the top; `cover` is the share of the pixel that is painted, and
/// `colour` is multiplied by it.
struct Canvas {
  int width = 0;
  int height = 0;
  std::vector<Rgb> colour;
  std::vector<float> cover;

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

struct PaintOptions {
  bool is_lit = true;        ///< By sun and sky, and creases are drawn; else colours as they are.
  double sun_azimuth = 315;  ///< Where it stands, compass degrees.
  double haze = 0;           ///< Share of light lost per metre of depth, of what is left;
  Rgb air = {1, 1, 1};       ///< and the colour that takes its place.
  Rgb edge = linear(0x3A3F45);  ///< Colour of edges,
  float edge_strength = 0.5F;   ///< and how much of it there is.
};

/// Paints the scene as `camera` sees it, with several samples a pixel. The same for any number of
/// threads.
Canvas paint(const Scene& scene, const Camera& camera, int width, int height,
             const PaintOptions& options);

}  // namespace tetropolis
