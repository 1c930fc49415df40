#include "tetropolis/render/render.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

#include "core/infinity.h"
#include "core/parallel.h"
#include "draw.h"
#include "paint.h"
#include "scene.h"
#include "section.h"

namespace tetropolis {

namespace {

constexpr double kField = 26;  ///< Of perspective, degrees.
constexpr double kMargin = 0.03;

double require_number(std::string_view text, const std::string& all) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, code] = std::from_chars(text.data(), end, value);
  if (code == std::errc() && stop == end && std::isfinite(value)) return value;
  throw Error(ErrorKind::kUsage,
              fmt::format("cut: '{}' is no plane; give x, y, x=METRES, y=METRES or the compass "
                          "direction of its line in degrees",
                          all));
}

void require(bool holds, const std::string& what) {
  if (!holds) throw Error(ErrorKind::kUsage, what);
}

void check_options(const RenderInput& input, const RenderOptions& options) {
  constexpr int kLeast = 16, kMost = 8192;
  for (const auto& [name, value] :
       {std::pair{"width", options.width}, std::pair{"height", options.height}})
    require(value >= kLeast && value <= kMost,
            fmt::format("{}: {} is not from {} to {} pixels", name, value, kLeast, kMost));
  constexpr std::int64_t kMostPixels = 1 << 24;
  require(std::int64_t{options.width} * options.height <= kMostPixels,
          fmt::format("width: {} x {} is more than {} pixels", options.width, options.height,
                      kMostPixels));
  require(std::isfinite(options.azimuth), "azimuth: is not finite");
  require(options.elevation >= 5 && options.elevation <= 90,
          fmt::format("elevation: {:g} is not from 5 to 90 degrees", options.elevation));
  require(options.colour != PictureColour::kQuality || options.view == View::kSection,
          "colour: 'quality' is that of cells, which only the view 'section' shows");
  require(!options.cut || options.view == View::kSection,
          "cut: only the view 'section' has a plane");
  if (const std::string why = why_not_drawn(input.surface); !why.empty())
    throw Error(ErrorKind::kInput, "the surface " + why);
}

/// The box of buildings, and somewhat around them; empty without buildings.
Bounds2 around_buildings(const SurfaceMesh& surface) {
  Bounds2 box = Bounds2::nothing();
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    if (!surface.patch_of(f).of_building()) continue;
    for (const std::int32_t v : surface.triangles[f]) {
      const Point3& p = surface.points[static_cast<std::size_t>(v)];
      box.extend(Point2{p[0], p[1]});
    }
  }
  constexpr double kLeast = 12, kShare = 0.07;  // metres, and of the longer side
  return box.empty() ? box
                     : box.grown(std::max(kLeast, kShare * std::max(box.width(), box.height())));
}

/// The scene of `city` and `plan`: on a slab whose thickness fits its width, if there is ground.
Scene city_on_slab(const SurfaceMesh& surface, const RenderOptions& options) {
  Scene scene = city_scene(surface, options.colour, options.edges);
  const Bounds2 box = around_buildings(surface);
  if (options.view == View::kCity && !box.empty()) {
    scene = clipped(scene, {1, 0, 0}, box.xmin);
    scene = clipped(scene, {-1, 0, 0}, -box.xmax);
    scene = clipped(scene, {0, 1, 0}, box.ymin);
    scene = clipped(scene, {0, -1, 0}, -box.ymax);
  }
  Vec3 low{kInfinity, kInfinity, kInfinity}, high = -1.0 * low;
  for (const Vec3 p : scene.points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  // Near zero, where single precision has its digits.
  const Vec3 middle = 0.5 * (low + high);
  move(scene, -1.0 * middle);
  constexpr double kThickness = 0.025;
  const auto is_ground = [&](Patch patch) {
    return surface.patches.of(patch).kind == PatchKind::kGround;
  };
  if (std::any_of(surface.patch.begin(), surface.patch.end(), is_ground))
    add_slab(scene, low.z - middle.z - kThickness * std::max(high.x - low.x, high.y - low.y));
  return scene;
}

/// A sky that is paler at the bottom.
Picture on_background(const Canvas& canvas, Rgb top, Rgb bottom) {
  Picture picture{canvas.width, canvas.height, std::vector<std::uint8_t>(canvas.colour.size() * 3)};
  parallel_chunks(
      static_cast<std::size_t>(canvas.height), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y) {
          const Rgb sky =
              mix(top, bottom, (static_cast<float>(y) + 0.5F) / static_cast<float>(canvas.height));
          for (int x = 0; x < canvas.width; ++x) {
            const std::size_t pixel = canvas.at(x, static_cast<int>(y));
            const Rgb c = canvas.colour[pixel] + (1 - canvas.cover[pixel]) * sky;
            const std::array bytes{srgb_byte(c.r), srgb_byte(c.g), srgb_byte(c.b)};
            std::copy(bytes.begin(), bytes.end(),
                      picture.rgb.begin() + static_cast<std::ptrdiff_t>(3 * pixel));
          }
        }
      });
  return picture;
}

Picture render_city(const SurfaceMesh& surface, const RenderOptions& options) {
  const Scene scene = city_on_slab(surface, options);
  Camera camera = looking(options.azimuth, options.elevation);
  fit(camera, scene.points, options.width, options.height, kMargin, kField);
  PaintOptions paint_options;
  paint_options.sun_azimuth = options.azimuth + 180 + 48;  // from the left, behind the viewer
  Canvas canvas = paint(scene, camera, options.width, options.height, paint_options);
  if (scene.highest > 0) draw_height_bar(canvas, scene.highest, linear(0x3C4248), linear(0xF6F3EC));
  return on_background(canvas, linear(0xCBDCEA), linear(0xF6F3EC));
}

Picture render_plan(const SurfaceMesh& surface, const RenderOptions& options) {
  const Scene scene = city_on_slab(surface, options);
  Camera camera = looking(0, 90);
  fit(camera, scene.points, options.width, options.height, kMargin, 0);
  Canvas canvas = paint(scene, camera, options.width, options.height, {});
  draw_scale_bar(canvas, camera.scale, linear(0x3C4248), linear(0xF6F3EC));
  if (scene.highest > 0) draw_height_bar(canvas, scene.highest, linear(0x3C4248), linear(0xF6F3EC));
  return on_background(canvas, linear(0xF6F3EC), linear(0xF6F3EC));
}

Picture render_section(const RenderInput& input, const RenderOptions& options) {
  const double aspect = static_cast<double>(options.width) / options.height;
  const SectionWindow window = choose_section(input.surface, options.cut, aspect);
  Canvas canvas = paint_section(input, window, options.colour, options.width, options.height);
  draw_scale_bar(canvas, options.width / (window.right - window.left), linear(0xFFFFFF),
                 Palette().earth);
  return on_background(canvas, linear(0xDCE8F1), linear(0xF6F3EC));
}

}  // namespace

CutLine cut_named(const std::string& text) {
  if (text == "x") return {0, {}};
  if (text == "y") return {90, {}};
  if (text.starts_with("x=")) return {0, require_number(std::string_view(text).substr(2), text)};
  if (text.starts_with("y=")) return {90, require_number(std::string_view(text).substr(2), text)};
  return {require_number(text, text), {}};
}

Picture render_picture(const RenderInput& input, const RenderOptions& options) {
  check_options(input, options);
  switch (options.view) {
    case View::kCity:
      return render_city(input.surface, options);
    case View::kPlan:
      return render_plan(input.surface, options);
    case View::kSection:
      return render_section(input, options);
  }
  return {};
}

}  // namespace tetropolis
