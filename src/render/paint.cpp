#include "paint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/parallel.h"

namespace tetropolis {

namespace {

constexpr double kSunElevation = 42;              ///< Degrees.
constexpr std::size_t kMostSamples = 60'000'000;  ///< Some half a gigabyte.

/// What one face, or faces in one plane, cover of a pixel.
struct Fragment {
  int x = 0;
  std::int32_t triangle = 0;
  float share = 0;
  Vec3 normal, position;
};

class Painter {
 public:
  Painter(const Scene& scene, const Camera& camera, int width, int height,
          const PaintOptions& options)
      : scene_(scene), camera_(camera), width_(width), height_(height), options_(options) {
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    samples_ = pixels * 9 <= kMostSamples ? 3 : 2;
  }

  Canvas paint() {
    collect_fragments();
    const std::size_t pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    Canvas canvas{width_, height_, std::vector<Rgb>(pixels), std::vector<float>(pixels, 0)};
    const Lit lit = options_.is_lit ? light() : Lit{};
    parallel_chunks(rows_.size(), 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t y = begin; y < end; ++y) paint_row(static_cast<int>(y), lit, canvas);
    });
    return canvas;
  }

 private:
  /// Light on each fragment, by rows.
  struct Lit {
    std::vector<std::vector<Receiver>> sun, sky;
  };

  const Vec3& corner(std::int32_t triangle, std::size_t i) const {
    const auto t = static_cast<std::size_t>(triangle);
    return scene_.points[static_cast<std::size_t>(scene_.triangles[t][i])];
  }

  /// Towards the viewer along `direction`.
  Vec3 normal_of(std::int32_t triangle, Vec3 direction) const {
    const Vec3 a = corner(triangle, 0);
    const Vec3 n = normalised(cross(corner(triangle, 1) - a, corner(triangle, 2) - a));
    return dot(n, direction) > 0 ? -1.0 * n : n;
  }

  bool is_smooth(std::int32_t triangle) const {
    const auto& corners = scene_.triangles[static_cast<std::size_t>(triangle)];
    return std::none_of(corners.begin(), corners.end(), [&](std::int32_t c) {
      return scene_.normals[static_cast<std::size_t>(c)] == Vec3();
    });
  }

  /// At a point of the triangle whose own normal is `flat`: of smooth ground between its corners'.
  Vec3 smooth_normal(std::int32_t triangle, Vec3 flat, Vec3 at) const {
    if (!is_smooth(triangle)) return flat;
    const auto& corners = scene_.triangles[static_cast<std::size_t>(triangle)];
    const Vec3 p = corner(triangle, 0);
    const Vec3 area = cross(corner(triangle, 1) - p, corner(triangle, 2) - p);
    Vec3 sum;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 a = corner(triangle, (i + 1) % 3), b = corner(triangle, (i + 2) % 3);
      sum = sum + std::max(0.0, dot(cross(b - a, at - a), area)) *
                      scene_.normals[static_cast<std::size_t>(corners[i])];
    }
    sum = normalised(sum);
    constexpr double kSteep = 0.7;
    return std::abs(dot(sum, flat)) > kSteep ? sum : flat;
  }

  bool is_one_plane(std::int32_t s, std::int32_t t, Vec3 direction) const {
    constexpr double kSame = 0.94;  // some 20 degrees
    if (s == t) return true;
    if (!(scene_.colour[static_cast<std::size_t>(s)] == scene_.colour[static_cast<std::size_t>(t)]))
      return false;
    return (is_smooth(s) && is_smooth(t)) ||
           dot(normal_of(s, direction), normal_of(t, direction)) > kSame;
  }

  void collect_fragments() {
    Camera fine = camera_;
    fine.scale *= samples_;
    fine.middle_x *= samples_;
    fine.middle_y *= samples_;
    const VisibleMap map =
        rasterise(scene_.points, scene_.triangles, fine, width_ * samples_, height_ * samples_);
    rows_.resize(static_cast<std::size_t>(height_));
    parallel_chunks(rows_.size(), 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t y = begin; y < end; ++y)
        for (int x = 0; x < width_; ++x) add_fragments(map, fine, x, static_cast<int>(y));
    });
  }

  void add_fragments(const VisibleMap& map, const Camera& fine, int x, int y) {
    struct Group {
      std::int32_t triangle;
      int count;
      double x, y;  // sums
    };
    std::array<Group, 9> groups;
    std::size_t n = 0;
    const Vec3 direction = camera_.sight(x + 0.5, y + 0.5).direction;
    for (int j = y * samples_; j < (y + 1) * samples_; ++j)
      for (int i = x * samples_; i < (x + 1) * samples_; ++i) {
        const std::int32_t triangle = map.triangle[map.at(i, j)];
        if (triangle < 0) continue;
        std::size_t g = 0;
        while (g < n && !is_one_plane(groups[g].triangle, triangle, direction)) ++g;
        if (g == n) groups[n++] = {triangle, 0, 0, 0};
        ++groups[g].count;
        groups[g].x += i + 0.5;
        groups[g].y += j + 0.5;
      }
    for (std::size_t g = 0; g < n; ++g) {
      const Group& group = groups[g];
      const Sight sight = fine.sight(group.x / group.count, group.y / group.count);
      const Vec3 normal = normal_of(group.triangle, sight.direction);
      const double slope = dot(normal, sight.direction);
      const double t = dot(normal, corner(group.triangle, 0) - sight.origin) / slope;
      const float share = static_cast<float>(group.count) / static_cast<float>(samples_ * samples_);
      const Vec3 position =
          std::isfinite(t) ? sight.origin + t * sight.direction : corner(group.triangle, 0);
      rows_[static_cast<std::size_t>(y)].push_back(
          {x, group.triangle, share, smooth_normal(group.triangle, normal, position), position});
    }
  }

  Lit light() const {
    Lit lit;
    lit.sun.resize(rows_.size());
    const auto single = [](Vec3 v) {
      return std::array{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
    };
    for (std::size_t y = 0; y < rows_.size(); ++y)
      for (const Fragment& f : rows_[y])
        lit.sun[y].push_back({single(f.position), single(f.normal), 0});
    lit.sky = lit.sun;
    // About as fine as the picture.
    const int sun_map = std::clamp(std::max(width_, height_) * 5 / 4, 512, 4096);
    const int sky_map = std::clamp(sun_map / 2, 256, 1024);
    illuminate(scene_.points, scene_.triangles, sun_lights(options_.sun_azimuth, kSunElevation),
               sun_map, lit.sun);
    illuminate(scene_.points, scene_.triangles, sky_lights(), sky_map, lit.sky);
    return lit;
  }

  Rgb shaded(const Fragment& fragment, float sun, float sky) const {
    constexpr Rgb kSun{0.87F, 0.81F, 0.72F}, kSky{0.41F, 0.445F, 0.49F};
    constexpr Rgb kBounce{0.24F, 0.22F, 0.195F};  // from the ground, on what looks at it
    constexpr Rgb kLeast{0.07F, 0.07F, 0.075F};   // in the deepest yard
    const auto down = static_cast<float>(0.5 - 0.5 * fragment.normal.z);
    const float open = 0.4F + 0.6F * std::min(1.0F, 2 * sky);
    const Rgb light = sun * kSun + sky * kSky + (down * open) * kBounce + kLeast;
    return scene_.colour[static_cast<std::size_t>(fragment.triangle)] * light;
  }

  /// How much of a pixel's colour an edge of the triangle takes.
  float edge_share(const Fragment& fragment) const {
    const std::uint8_t which = scene_.edges[static_cast<std::size_t>(fragment.triangle)];
    if (which == 0) return 0;
    std::array<ScreenPoint, 3> p;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 c = corner(fragment.triangle, i);
      if (camera_.is_perspective && camera_.depth(c) < camera_.near_depth) return 0;
      p[i] = camera_.project(c);
    }
    const ScreenPoint at = camera_.project(fragment.position);
    double least = 1e9, size = 1e9;
    for (std::size_t i = 0; i < 3; ++i) {
      const ScreenPoint& a = p[i];
      const ScreenPoint& b = p[(i + 1) % 3];
      const double dx = b.x - a.x, dy = b.y - a.y, length = std::hypot(dx, dy);
      if (length <= 0) return 0;
      const double opposite =
          std::abs(dx * (p[(i + 2) % 3].y - a.y) - dy * (p[(i + 2) % 3].x - a.x)) / length;
      size = std::min(size, opposite);
      if ((which >> i & 1U) != 0)
        least = std::min(least, std::abs(dx * (at.y - a.y) - dy * (at.x - a.x)) / length);
    }
    // A line is a pixel wide; of triangles of few pixels, it fades.
    constexpr double kFade = 7;
    const double fade = std::clamp(size / kFade, 0.0, 1.0);
    return static_cast<float>(std::clamp(1 - least, 0.0, 1.0) * fade) * options_.edge_strength;
  }

  void paint_row(int y, const Lit& lit, Canvas& canvas) const {
    const std::vector<Fragment>& row = rows_[static_cast<std::size_t>(y)];
    for (std::size_t begin = 0; begin < row.size();) {
      std::size_t end = begin;
      Rgb sum;
      float cover = 0, largest = 0;
      for (; end < row.size() && row[end].x == row[begin].x; ++end) {
        const Fragment& f = row[end];
        Rgb colour = scene_.colour[static_cast<std::size_t>(f.triangle)];
        if (options_.is_lit)
          colour = shaded(f, lit.sun[static_cast<std::size_t>(y)][end].light,
                          lit.sky[static_cast<std::size_t>(y)][end].light);
        colour = mix(colour, options_.edge, edge_share(f));
        if (options_.haze > 0)
          colour = mix(options_.air, colour,
                       static_cast<float>(std::exp(-options_.haze * camera_.depth(f.position))));
        sum = sum + f.share * colour;
        cover += f.share;
        largest = std::max(largest, f.share);
      }
      constexpr float kCrease = 0.22F;
      if (options_.is_lit) sum = (1 - 4 * kCrease * largest * (1 - largest)) * sum;
      const std::size_t pixel = canvas.at(row[begin].x, y);
      canvas.colour[pixel] = sum;
      canvas.cover[pixel] = cover;
      begin = end;
    }
  }

  const Scene& scene_;
  const Camera& camera_;
  int width_;
  int height_;
  const PaintOptions& options_;
  int samples_ = 1;
  std::vector<std::vector<Fragment>> rows_;
};

}  // namespace

Canvas paint(const Scene& scene, const Camera& camera, int width, int height,
             const PaintOptions& options) {
  return Painter(scene, camera, width, height, options).paint();
}

}  // namespace tetropolis
