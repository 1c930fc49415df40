#include "draw.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "tetropolis/geometry/polygon.h"

#include "scene.h"

namespace tetropolis {

namespace {

/// Strokes of a character on a grid of 4 x 6 units, as pairs "xy" from the upper left; a blank
/// lifts the pen.
std::string_view strokes(char character) {
  switch (character) {
    case '0':
      return "10304145453616050501 0110";
    case '1':
      return "022026";
    case '2':
      return "011030414206 0646";
    case '3':
      return "0110304142334445361605 1333";
    case '4':
      return "36300444";
    case '5':
      return "4000023243453616 1605";
    case '6':
      return "4130100105163645443303";
    case '7':
      return "00401606";
    case '8':
      return "1030414233130201 0110 1304051636454433";
    case '9':
      return "0516364541301001021343";
    case 'm':
      return "0602 03122326 23324346";
    case 'k':
      return "0006 0442 1346";
    case '-':
      return "1333";
    case '.':
      return "0606";
    default:
      return "";
  }
}

/// Pixels.
double letters(const Canvas& canvas) { return std::max(9.0, canvas.height / 70.0); }

}  // namespace

void draw_line(Canvas& canvas, Point2 from, Point2 to, double width, Rgb colour) {
  const double reach = width / 2 + 1;
  const auto low = [](double a, double b, double r) {
    return static_cast<int>(std::max(0.0, std::floor(std::min(a, b) - r)));
  };
  const auto high = [](double a, double b, double r, int size) {
    return static_cast<int>(std::min(size - 1.0, std::ceil(std::max(a, b) + r)));
  };
  for (int y = low(from.y, to.y, reach); y <= high(from.y, to.y, reach, canvas.height); ++y)
    for (int x = low(from.x, to.x, reach); x <= high(from.x, to.x, reach, canvas.width); ++x) {
      const double d = distance_to_segment({x + 0.5, y + 0.5}, from, to);
      const auto share = static_cast<float>(std::clamp(width / 2 + 0.5 - d, 0.0, 1.0));
      if (share <= 0) continue;
      const std::size_t pixel = canvas.at(x, y);
      canvas.colour[pixel] = mix(canvas.colour[pixel], colour, share);
      canvas.cover[pixel] = std::max(canvas.cover[pixel], share);
    }
}

void draw_text(Canvas& canvas, Point2 middle, double size, std::string_view text, double width,
               Rgb colour) {
  constexpr double kAdvance = 6;  // units
  const double unit = size / 6;
  Point2 corner{middle.x - unit * (kAdvance * static_cast<double>(text.size()) - 2) / 2,
                middle.y - size / 2};
  for (const char character : text) {
    const std::string_view path = strokes(character);
    bool is_down = false;
    Point2 last;
    for (std::size_t i = 0; i + 1 < path.size();) {
      if (path[i] == ' ') {
        is_down = false;
        ++i;
        continue;
      }
      const Point2 next{corner.x + unit * (path[i] - '0'), corner.y + unit * (path[i + 1] - '0')};
      if (is_down) draw_line(canvas, last, next, std::max(1.2, width), colour);
      last = next;
      is_down = true;
      i += 2;
    }
    corner.x += kAdvance * unit;
  }
}

void draw_scale_bar(Canvas& canvas, double pixels_per_metre, Rgb colour, Rgb halo) {
  const double most = 0.16 * canvas.width / pixels_per_metre;
  double length = std::pow(10, std::floor(std::log10(most)));
  for (const double factor : {5.0, 2.0})
    if (length * factor <= most) {
      length *= factor;
      break;
    }
  const double size = letters(canvas);
  const double x = 2 * size, y = canvas.height - 2 * size, end = x + length * pixels_per_metre;
  for (const double width : {size / 2, size / 8}) {
    const Rgb of = width == size / 2 ? halo : colour;
    draw_line(canvas, {x, y}, {end, y}, width, of);
    for (const double at : {x, end}) draw_line(canvas, {at, y - size / 2}, {at, y}, width, of);
    draw_text(canvas, {(x + end) / 2, y - size}, size, fmt::format("{:g} m", length), width, of);
  }
}

void draw_height_bar(Canvas& canvas, double highest, Rgb colour, Rgb halo) {
  const double size = letters(canvas);
  const double end = canvas.width - 3 * size, y = canvas.height - 2 * size;
  const double x = end - 0.16 * canvas.width;
  draw_line(canvas, {x, y}, {end, y}, size * 0.8, halo);
  constexpr int kSegments = 64;
  for (int k = 0; k < kSegments; ++k) {
    const auto at = [&](int step) { return Point2{x + (end - x) * step / kSegments, y}; };
    draw_line(canvas, at(k), at(k + 1), size / 2, ramp((k + 0.5) / kSegments));
  }
  for (const double width : {size / 2, size / 8}) {
    const Rgb of = width == size / 2 ? halo : colour;
    draw_text(canvas, {x, y - 1.3 * size}, size, "0", width, of);
    draw_text(canvas, {end, y - 1.3 * size}, size, fmt::format("{:.0f} m", highest), width, of);
  }
}

}  // namespace tetropolis
