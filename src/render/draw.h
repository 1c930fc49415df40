// Lines and numbers on a finished picture. Private to src/render.
#pragma once

#include <string_view>

#include "paint.h"

namespace tetropolis {

/// A straight line from (x0, y0) to (x1, y1) with round ends, `width` pixels wide.
void draw_line(Canvas& canvas, Point2 from, Point2 to, double width, Rgb colour);

/// Digits, '.', '-', 'm', 'k' and blanks, `size` pixels high, their middle at `middle`,
/// in strokes of `width` pixels.
void draw_text(Canvas& canvas, Point2 middle, double size, std::string_view text, double width,
               Rgb colour);

/// A bar in the lower left corner that is 1, 2 or 5 times a power of ten of metres long.
void draw_scale_bar(Canvas& canvas, double pixels_per_metre, Rgb colour, Rgb halo);

/// The colours of heights from 0 to `highest` metres, in the lower right corner.
void draw_height_bar(Canvas& canvas, double highest, Rgb colour, Rgb halo);

}  // namespace tetropolis
