#include "decimal_text.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>

#include <fmt/compile.h>
#include <fmt/format.h>

namespace tetropolis {

namespace {

/// The whole number that decimal rounding of value * scale gives, if it is sure: the product is off
/// by less than 2^-6, so a fraction further than that from one half rounds like the exact value.
std::optional<std::uint64_t> rounded(double value, double scale) {
  const double product = value * scale;
  if (!(product < 0x1p46)) return std::nullopt;
  const double whole = std::floor(product), fraction = product - whole;
  if (std::abs(fraction - 0.5) < 0x1p-6) return std::nullopt;
  return static_cast<std::uint64_t>(whole) + (fraction > 0.5 ? 1 : 0);
}

/// The `count` last digits of a number, from the left.
void put_digits(std::uint64_t number, int count, char* out) {
  for (int i = count - 1; i >= 0; --i, number /= 10) out[i] = static_cast<char>('0' + number % 10);
}

}  // namespace

void append_fixed(std::string& text, double value) {
  const auto millionths = rounded(std::abs(value), 1e6);
  if (!millionths) {
    fmt::format_to(std::back_inserter(text), FMT_COMPILE("{:.6f}"), value);
    return;
  }
  std::array<char, 32> digits;
  char* end = digits.data();
  if (std::signbit(value)) *end++ = '-';
  end = std::to_chars(end, digits.data() + digits.size(), *millionths / 1000000).ptr;
  *end++ = '.';
  put_digits(*millionths % 1000000, 6, end);
  text.append(digits.data(), end + 6);
}

void append_general(std::string& text, double value) {
  const double size = std::abs(value);
  if (size == 0 || size == 1) {
    text += std::signbit(value) ? "-" : "";
    text += size == 0 ? '0' : '1';
    return;
  }
  // From 0.0001 to 1 the six digits stand behind "0." and up to three zeros.
  int zeros = 0;
  double scale = 1e6;
  for (double bound = 0.1; zeros < 4 && size < bound; bound /= 10, scale *= 10) ++zeros;
  const auto number = size < 1 && zeros < 4 ? rounded(size, scale) : std::nullopt;
  if (!number || *number < 100000 || *number >= 1000000) {
    fmt::format_to(std::back_inserter(text), FMT_COMPILE("{:.6g}"), value);
    return;
  }
  std::array<char, 16> digits{'-', '0', '.', '0', '0', '0'};
  put_digits(*number, 6, digits.data() + 3 + zeros);
  int length = 9 + zeros;
  while (digits[static_cast<std::size_t>(length - 1)] == '0') --length;
  const int skipped = std::signbit(value) ? 0 : 1;
  text.append(digits.data() + skipped, static_cast<std::size_t>(length - skipped));
}

}  // namespace tetropolis
