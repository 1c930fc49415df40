#include "measure_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <system_error>

#include "core/infinity.h"
#include "core/text.h"

namespace tetropolis {

namespace {

constexpr double kFoot = 0.3048, kInch = 0.0254;

void trim(std::string_view& text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

/// Takes a number from the front; NaN, with the text as it was, if there is none. A comma may stand
/// for the point, but not before three digits, where it may group thousands.
double take_number(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && ((text[end] >= '0' && text[end] <= '9') || text[end] == '.' ||
                               text[end] == ',' || (end == 0 && text[end] == '-')))
    ++end;
  std::string number(text.substr(0, end));
  if (const std::size_t comma = number.find(','); comma != std::string::npos) {
    const bool again = number.find_first_of(",.", comma + 1) != std::string::npos ||
                       number.find('.') != std::string::npos;
    if (again || number.size() - comma - 1 == 3 || comma + 1 == number.size()) return kNaN;
    number[comma] = '.';
  }
  double value = kNaN;
  const auto [stop, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error != std::errc{} || stop != number.data() + number.size()) return kNaN;
  text.remove_prefix(end);
  trim(text);
  return value;
}

/// Takes a unit from the front: its metres; 0 if there is none there.
double take_unit(std::string_view& text) {
  struct Unit {
    std::string_view name;
    double metres;
  };
  // Longer names before those that they begin with.
  constexpr Unit kUnits[] = {{"metres", 1},   {"meters", 1},  {"metre", 1},  {"meter", 1},
                             {"mtrs", 1},     {"mts", 1},     {"mm", 0.001}, {"m.", 1},
                             {"m", 1},        {"cm", 0.01},   {"dm", 0.1},   {"feet", kFoot},
                             {"foot", kFoot}, {"ft.", kFoot}, {"ft", kFoot}, {"inches", kInch},
                             {"inch", kInch}, {"in.", kInch}, {"in", kInch}, {"\"", kInch},
                             {"''", kInch},   {"'", kFoot}};
  for (const Unit& unit : kUnits)
    if (text.starts_with(unit.name)) {
      text.remove_prefix(unit.name.size());
      trim(text);
      return unit.metres;
    }
  return 0;
}

double one_measure(std::string_view text, double unit) {
  trim(text);
  for (const std::string_view mark : {"ca.", "ca ", "approx.", "~", "+"})
    if (text.starts_with(mark)) {
      text.remove_prefix(mark.size());
      trim(text);
      break;
    }
  double value = take_number(text);
  if (std::isnan(value)) return kNaN;
  const double first = take_unit(text);
  value *= first > 0 ? first : unit;
  // "40'6\"", "40 ft 6 in", and "40'6".
  if (first == kFoot && !text.empty()) {
    const double rest = take_number(text);
    const double second = text.empty() ? kInch : take_unit(text);
    if (!(rest >= 0) || second != kInch) return kNaN;
    value += rest * kInch;
  }
  return text.empty() && std::isfinite(value) ? value : kNaN;
}

/// The greatest of a list; NaN if one is not understood.
template <typename Measure>
double greatest(std::string_view text, const Measure& measure) {
  double most = kNaN;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(';', begin), text.size());
    const double value = measure(text.substr(begin, end - begin));
    if (std::isnan(value)) return kNaN;
    most = std::isnan(most) ? value : std::max(most, value);
    begin = end + 1;
  }
  return most;
}

}  // namespace

double metres_of(std::string_view text, double unit) {
  std::string plain = lower_case(std::string(text));
  for (const std::string_view prime : {"\u2019", "\u2032", "\u00b4"})
    replace_all(plain, prime, "'");
  for (const std::string_view prime : {"\u201d", "\u2033"}) replace_all(plain, prime, "\"");
  replace_all(plain, "\u00a0", " ");
  return greatest(plain, [&](std::string_view part) { return one_measure(part, unit); });
}

double floors_of(std::string_view text) {
  return greatest(text, [](std::string_view part) {
    trim(part);
    const double value = take_number(part);
    return part.empty() ? value : kNaN;
  });
}

}  // namespace tetropolis
