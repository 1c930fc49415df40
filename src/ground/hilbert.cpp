#include "ground/hilbert.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tetropolis {

std::uint32_t hilbert_index(std::uint32_t x, std::uint32_t y) {
  // From the coarsest of 16 levels to the finest; (x, y) is turned into the frame of its quadrant.
  std::uint32_t index = 0;
  for (std::uint32_t level = 15; level < 16; --level) {
    const std::uint32_t right = (x >> level) & 1U;
    const std::uint32_t upper = (y >> level) & 1U;
    index = (index << 2) | ((3U * right) ^ upper);
    const std::uint32_t turn = upper - 1U;             // all ones in the lower quadrants
    const std::uint32_t mirror = turn & (0U - right);  // all ones in the lower right one
    x ^= mirror;
    y ^= mirror;
    const std::uint32_t swap = (x ^ y) & turn;
    x ^= swap;
    y ^= swap;
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
