// Sections. Private to src/render.
#pragma once

#include <optional>

#include "tetropolis/render/render.h"

#include "cut.h"
#include "paint.h"

namespace tetropolis {

/// The plane of `cut`, or the one in which most walls are cut, with the part of it to be shown.
struct SectionWindow {
  CutPlane plane;
  double left = 0;  ///< Along the line, metres.
  double right = 0;
  double bottom = 0;  ///< Elevations.
  double top = 0;
};

/// `aspect`: width of the picture over its height. The window is some three times as high as the
/// city's buildings, and as wide as that allows, where most walls are.
SectionWindow choose_section(const SurfaceMesh& surface, const std::optional<CutLine>& cut,
                             double aspect);

/// The cells in the plane, the ground and the buildings that it cuts, and pale behind them what it
/// does not.
Canvas paint_section(const RenderInput& input, const SectionWindow& window, PictureColour colour,
                     int width, int height);

}  // namespace tetropolis
