#include "hilbert.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tetropolis {

namespace {

// The curve through a square of four levels, in each of the frames that a part of it can lie in.
// A frame swaps the axes (bit 1) and mirrors both (bit 0).
constexpr unsigned kLevels = 4;

struct Steps {
  std::uint8_t index[4][1U << kLevels][1U << kLevels];  // frame, x, y
  std::uint8_t frame[4][1U << kLevels][1U << kLevels];  // of what lies in that cell
};

constexpr Steps make_steps() {
  Steps steps{};
  for (unsigned start = 0; start < 4; ++start) {
    for (unsigned x = 0; x < (1U << kLevels); ++x) {
      for (unsigned y = 0; y < (1U << kLevels); ++y) {
        unsigned frame = start, index = 0;
        for (unsigned level = kLevels; level-- > 0;) {
          const unsigned u = (x >> level) & 1U, v = (y >> level) & 1U, mirror = frame & 1U;
          const unsigned right = (frame < 2 ? u : v) ^ mirror, upper = (frame < 2 ? v : u) ^ mirror;
          index = (index << 2) | ((3U * right) ^ upper);
          // The lower quadrants are transposed, that on the right along the other diagonal.
          if (upper == 0) frame ^= 2U | right;
        }
        steps.index[start][x][y] = static_cast<std::uint8_t>(index);
        steps.frame[start][x][y] = static_cast<std::uint8_t>(frame);
      }
    }
  }
  return steps;
}

constexpr Steps kSteps = make_steps();

}  // namespace

std::uint32_t hilbert_index(std::uint32_t x, std::uint32_t y) {
  std::uint32_t index = 0;
  unsigned frame = 0;
  for (unsigned shift = 16; shift > 0;) {
    shift -= kLevels;
    const unsigned i = (x >> shift) & 15U, j = (y >> shift) & 15U;
    index = (index << (2 * kLevels)) | kSteps.index[frame][i][j];
    frame = kSteps.frame[frame][i][j];
  }
  return index;
}

HilbertCurve::HilbertCurve(const Bounds2& box) : box_(box) {
  const double extent = std::max(box.width(), box.height());
  // The scale of an extent near the smallest doubles would not be finite either.
  const double scale = 65535.0 / extent;
  if (extent > 0 && std::isfinite(extent) && std::isfinite(scale)) scale_ = scale;
}

std::uint32_t HilbertCurve::operator()(Point2 p) const {
  const double x = std::clamp((p.x - box_.xmin) * scale_, 0.0, 65535.0);
  const double y = std::clamp((p.y - box_.ymin) * scale_, 0.0, 65535.0);
  return hilbert_index(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
}

std::vector<std::int32_t> sorted_order(std::span<const std::uint32_t> keys) {
  // Key and index in one word, by the digits of the key from the lowest up.
  std::vector<std::uint64_t> entries(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    entries[i] = (static_cast<std::uint64_t>(keys[i]) << 32) | i;
  std::vector<std::uint64_t> other(keys.size());
  constexpr int kDigit = 11;
  for (int shift = 32; shift < 64; shift += kDigit) {
    std::array<std::size_t, 1U << kDigit> starts{};
    const auto digit = [&](std::uint64_t e) { return (e >> shift) & ((1U << kDigit) - 1U); };
    for (const std::uint64_t e : entries) ++starts[digit(e)];
    std::size_t sum = 0;
    for (std::size_t& start : starts) {
      const std::size_t count = start;
      start = sum;
      sum += count;
    }
    for (const std::uint64_t e : entries) other[starts[digit(e)]++] = e;
    entries.swap(other);
  }
  std::vector<std::int32_t> order(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    order[i] = static_cast<std::int32_t>(entries[i] & 0xffffffffU);
  return order;
}

}  // namespace tetropolis
