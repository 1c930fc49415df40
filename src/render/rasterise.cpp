#include "rasterise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/infinity.h"
#include "core/parallel.h"

namespace tetropolis {

namespace {

constexpr std::int64_t kSteps = 256;  ///< Of corners, per pixel.
constexpr int kBand = 32;             ///< Rows that are filled at a time by one thread.

/// Beyond that whole numbers of 64 bits may not hold the product of two coordinates.
constexpr double kFarthest = 4e6;  // pixels

/// A projected point: x and y in steps.
struct Corner {
  std::int64_t x = 0;
  std::int64_t y = 0;
  double nearness = 0;
  bool is_near = false;  ///< Within kFarthest.
};

Corner rounded(const ScreenPoint& p) {
  if (!(std::abs(p.x) < kFarthest && std::abs(p.y) < kFarthest)) return {};
  const auto steps = [](double pixels) {
    return static_cast<std::int64_t>(std::floor(pixels * kSteps + 0.5));
  };
  return {steps(p.x), steps(p.y), p.nearness, true};
}

struct Face {
  std::array<std::int32_t, 3> corners;  ///< Of the projected points.
  std::int32_t triangle;
};

std::int64_t floor_divided(std::int64_t a, std::int64_t b) {
  return a / b - (a % b != 0 && (a < 0) != (b < 0) ? 1 : 0);
}

/// Everything that is drawn: projected, clipped, by bands of rows.
class Drawing {
 public:
  Drawing(std::span<const Vec3> points, Triangles triangles, const Camera& camera, int height)
      : points_(points), camera_(camera), height_(height), screen_(points.size()) {
    parallel_chunks(points.size(), 8192, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (is_seen(points[i])) screen_[i] = rounded(camera.project(points[i]));
    });
    faces_.reserve(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) add(triangles[t], static_cast<int>(t));
    sort_into_bands();
  }

  void fill(VisibleMap& map) const {
    parallel_chunks(first_.size() - 1, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t band = begin; band < end; ++band) {
        const int top = static_cast<int>(band) * kBand, bottom = std::min(top + kBand, height_);
        for (std::size_t i = first_[band]; i < first_[band + 1]; ++i)
          fill(faces_[in_band_[i]], top, bottom, map);
      }
    });
  }

 private:
  bool is_seen(Vec3 p) const {
    return !camera_.is_perspective || camera_.depth(p) >= camera_.near_depth;
  }

  void add(const std::array<std::int32_t, 3>& corners, std::int32_t triangle) {
    int seen = 0;
    for (const std::int32_t c : corners) seen += is_seen(points_[static_cast<std::size_t>(c)]);
    if (seen == 3) faces_.push_back({corners, triangle});
    if (seen == 1 || seen == 2) add_clipped(corners, triangle);
  }

  void add_clipped(const std::array<std::int32_t, 3>& corners, std::int32_t triangle) {
    std::vector<std::int32_t> kept;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 a = points_[static_cast<std::size_t>(corners[i])];
      const Vec3 b = points_[static_cast<std::size_t>(corners[(i + 1) % 3])];
      if (is_seen(a)) kept.push_back(corners[i]);
      if (is_seen(a) == is_seen(b)) continue;
      const double da = camera_.depth(a) - camera_.near_depth;
      const double db = camera_.depth(b) - camera_.near_depth;
      kept.push_back(static_cast<std::int32_t>(screen_.size()));
      screen_.push_back(rounded(camera_.project(a + (da / (da - db)) * (b - a))));
    }
    for (std::size_t i = 2; i < kept.size(); ++i)
      faces_.push_back({{kept[0], kept[i - 1], kept[i]}, triangle});
  }

  const Corner& corner(const Face& face, std::size_t i) const {
    return screen_[static_cast<std::size_t>(face.corners[i])];
  }

  /// First and last row or column whose middle lies between two coordinates.
  static std::pair<std::int64_t, std::int64_t> middles(std::int64_t low, std::int64_t high) {
    return {floor_divided(low + kSteps / 2 - 1, kSteps), floor_divided(high - kSteps / 2, kSteps)};
  }

  /// First and last band; none (first > last) of triangles that no middle of a pixel is in.
  std::pair<int, int> bands(const Face& face) const {
    const Corner &a = corner(face, 0), &b = corner(face, 1), &c = corner(face, 2);
    if (!a.is_near || !b.is_near || !c.is_near) return {1, 0};
    const auto [left, right] = std::minmax({a.x, b.x, c.x});
    const auto [first_column, last_column] = middles(left, right);
    if (first_column > last_column) return {1, 0};
    const auto [low, high] = std::minmax({a.y, b.y, c.y});
    const auto [first_row, last_row] = middles(low, high);
    const std::int64_t first = std::max<std::int64_t>(first_row, 0);
    const std::int64_t last = std::min<std::int64_t>(last_row, height_ - 1);
    if (first > last) return {1, 0};
    return {static_cast<int>(first / kBand), static_cast<int>(last / kBand)};
  }

  void sort_into_bands() {
    const auto count = static_cast<std::size_t>((height_ + kBand - 1) / kBand);
    first_.assign(count + 1, 0);
    for (const Face& face : faces_)
      for (auto [band, last] = bands(face); band <= last; ++band)
        ++first_[static_cast<std::size_t>(band) + 1];
    for (std::size_t b = 0; b < count; ++b) first_[b + 1] += first_[b];
    in_band_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t f = 0; f < faces_.size(); ++f)
      for (auto [band, last] = bands(faces_[f]); band <= last; ++band)
        in_band_[next[static_cast<std::size_t>(band)]++] = static_cast<std::uint32_t>(f);
  }

  void fill(const Face& face, int top, int bottom, VisibleMap& map) const {
    std::array<std::int64_t, 3> x, y;
    std::array<double, 3> n;
    for (std::size_t i = 0; i < 3; ++i) {
      const Corner& p = corner(face, i);
      x[i] = p.x;
      y[i] = p.y;
      n[i] = p.nearness;
    }
    std::int64_t twice_area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    if (twice_area == 0) return;
    if (twice_area < 0) {
      std::swap(x[1], x[2]);
      std::swap(y[1], y[2]);
      std::swap(n[1], n[2]);
      twice_area = -twice_area;
    }
    const auto area = static_cast<double>(twice_area);
    const double slope_x = ((n[1] - n[0]) * static_cast<double>(y[2] - y[0]) -
                            (n[2] - n[0]) * static_cast<double>(y[1] - y[0])) /
                           area;
    const double slope_y = ((n[2] - n[0]) * static_cast<double>(x[1] - x[0]) -
                            (n[1] - n[0]) * static_cast<double>(x[2] - x[0])) /
                           area;
    const auto [least, most] = std::minmax({n[0], n[1], n[2]});
    const auto [low, high] = std::minmax({y[0], y[1], y[2]});
    const auto [first_row, last_row] = middles(low, high);
    const std::int64_t from = std::max<std::int64_t>(top, first_row);
    const std::int64_t to = std::min<std::int64_t>(bottom - 1, last_row);
    for (std::int64_t row = from; row <= to; ++row) {
      const std::int64_t py = row * kSteps + kSteps / 2;
      std::int64_t first = 0, last = map.width - 1;
      // Left of each edge: e + slope * column >= 0.
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t a = (i + 1) % 3, b = (i + 2) % 3;
        const std::int64_t slope = -(y[b] - y[a]) * kSteps;
        const std::int64_t e = (x[b] - x[a]) * (py - y[a]) - (y[b] - y[a]) * (kSteps / 2 - x[a]);
        if (slope > 0)
          first = std::max(first, -floor_divided(e, slope));
        else if (slope < 0)
          last = std::min(last, floor_divided(e, -slope));
        else if (e < 0)
          last = -1;
      }
      const std::size_t begin = map.at(0, static_cast<int>(row));
      const double at_left = n[0] + slope_y * static_cast<double>(py - y[0]) +
                             slope_x * static_cast<double>(kSteps / 2 - x[0]);
      for (std::int64_t column = first; column <= last; ++column) {
        const auto nearness = static_cast<float>(
            std::clamp(at_left + slope_x * static_cast<double>(column * kSteps), least, most));
        const std::size_t pixel = begin + static_cast<std::size_t>(column);
        if (!(nearness > map.nearness[pixel])) continue;
        map.nearness[pixel] = nearness;
        if (!map.triangle.empty()) map.triangle[pixel] = face.triangle;
      }
    }
  }

  std::span<const Vec3> points_;
  const Camera& camera_;
  int height_;
  std::vector<Corner> screen_;  ///< Points, then those that clipping adds.
  std::vector<Face> faces_;
  std::vector<std::size_t> first_;  ///< Of each band, in in_band_.
  std::vector<std::uint32_t> in_band_;
};

}  // namespace

VisibleMap rasterise(std::span<const Vec3> points, Triangles triangles, const Camera& camera,
                     int width, int height, bool with_triangles) {
  VisibleMap map{width, height, {}, {}};
  const std::size_t size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  map.nearness.assign(size, -std::numeric_limits<float>::infinity());
  if (with_triangles) map.triangle.assign(size, -1);
  Drawing(points, triangles, camera, height).fill(map);
  return map;
}

}  // namespace tetropolis
