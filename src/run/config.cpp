#include "tetropolis/run/config.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <type_traits>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

namespace tetropolis {

namespace {

[[noreturn]] void fail(const std::string& origin, const std::string& what) {
  throw Error(ErrorKind::kUsage, origin + ": " + what);
}

std::string number_text(double value) {
  return value == std::floor(value) && std::abs(value) < 1e15 ? fmt::format("{:.1f}", value)
                                                              : fmt::format("{}", value);
}

/// `text`: the value as it was given.
void require_in_range(const ConfigField& field, double value, const std::string& text,
                      const std::string& origin) {
  if (!std::isfinite(value)) fail(origin, fmt::format("'{}' is not finite", text));
  if (field.above_min && value <= field.min)
    fail(origin, fmt::format("{} is not greater than {}", text, field.min));
  if (value < field.min) fail(origin, fmt::format("{} is less than {}", text, field.min));
  if (value > field.max) fail(origin, fmt::format("{} is greater than {}", text, field.max));
}

template <typename Number>
Number parse_number(const ConfigField& field, const std::string& text, const std::string& origin) {
  Number value{};
  const char* begin = text.data();
  const char* end = begin + text.size();
  const auto [stop, code] = std::from_chars(begin, end, value);
  const char* kind = std::is_integral_v<Number> ? "a whole number" : "a number";
  using Limits = std::numeric_limits<Number>;
  if (code == std::errc::result_out_of_range && stop == end)
    fail(origin, fmt::format("{} is out of range; give {} to {}", text,
                             std::max(field.min, static_cast<double>(Limits::lowest())),
                             std::min(field.max, static_cast<double>(Limits::max()))));
  if (code != std::errc() || stop != end)
    fail(origin,
         fmt::format("'{}' is not {}{}", text, kind,
                     text.find(',') == std::string::npos ? "" : "; a point goes before decimals"));
  require_in_range(field, static_cast<double>(value), text, origin);
  return value;
}

std::size_t find_choice(const ConfigField& field, const std::string& text,
                        const std::string& origin) {
  const auto found = std::find(field.choices.begin(), field.choices.end(), text);
  if (found == field.choices.end())
    fail(origin, fmt::format("'{}' is not one of {}", text, fmt::join(field.choices, ", ")));
  return static_cast<std::size_t>(found - field.choices.begin());
}

/// "1,2" "3" -> "1" "2" "3": lists may be given with commas, as several values, or both.
std::vector<std::string> split_lists(std::span<const std::string> values) {
  std::vector<std::string> parts;
  for (const std::string& value : values) {
    std::size_t begin = 0;
    while (true) {
      const std::size_t comma = value.find(',', begin);
      parts.push_back(value.substr(begin, comma - begin));
      if (comma == std::string::npos) break;
      begin = comma + 1;
    }
  }
  return parts;
}

/// An empty list means "not given", as in the template.
void require_box(const ConfigField& field, const std::vector<double>& sides,
                 const std::string& origin) {
  if (field.name == "origin" && !sides.empty()) {
    if (sides.size() != 2) fail(origin, "two numbers expected: X,Y");
    for (const double x : sides)
      if (x != std::round(x)) fail(origin, "whole metres expected");
  }
  if (field.name != "bounds" || sides.empty()) return;
  if (sides.size() != 4) fail(origin, "four numbers expected: XMIN,YMIN,XMAX,YMAX");
  if (!(sides[0] < sides[2] && sides[1] < sides[3]))
    fail(origin, "XMIN < XMAX and YMIN < YMAX expected");
}

void set_numbers(std::vector<double>& target, const ConfigField& field,
                 std::span<const std::string> values, const std::string& origin) {
  target.clear();
  for (const std::string& part : split_lists(values)) {
    // Of "1, 2": nothing is between a comma and the end of a value.
    const std::size_t first = part.find_first_not_of(' ');
    if (first != std::string::npos)
      target.push_back(parse_number<double>(
          field, part.substr(first, part.find_last_not_of(' ') + 1 - first), origin));
  }
  require_box(field, target, origin);
}

void require_choices(const ConfigField& field, const std::vector<std::string>& texts,
                     const std::string& origin) {
  if (texts.empty() && !field.choices.empty())
    fail(origin, fmt::format("is empty; give one or more of {}", fmt::join(field.choices, ", ")));
  for (const std::string& text : texts) {
    if (text.empty() && field.choices.empty())
      fail(origin, "one of the values is empty; leave it out or give a value");
    if (!field.choices.empty()) find_choice(field, text, origin);
  }
}

void require_text(const ConfigField& field, const std::string& text, const std::string& origin) {
  if (field.require == nullptr) return;
  try {
    field.require(text);
  } catch (const Error& error) {
    throw Error(error.kind(), fmt::format("{}: {}", origin, error.what()));
  }
}

void set_texts(std::vector<std::string>& target, const ConfigField& field,
               std::span<const std::string> values, const std::string& origin) {
  // Paths may hold commas; names are split.
  const bool are_names = !field.choices.empty() || field.value == "NAME,...";
  target = are_names ? split_lists(values) : std::vector(values.begin(), values.end());
  require_choices(field, target, origin);
  for (const std::string& text : target) require_text(field, text, origin);
}

/// A basic string of TOML 1.0.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      result += {'\\', c};
    else if (code < 0x20 || code == 0x7F)
      result += fmt::format("\\u{:04x}", code);
    else
      result += c;
  }
  return result + '"';
}

std::string range_text(const ConfigField& field) {
  const bool below = std::isfinite(field.min), above = std::isfinite(field.max);
  if (below && above)
    return fmt::format("{}{} to {}", field.above_min ? "above " : "", field.min, field.max);
  if (below) return fmt::format("{} {}", field.above_min ? "above" : "at least", field.min);
  return above ? fmt::format("at most {}", field.max) : "";
}

std::string command_names(unsigned commands) {
  std::vector<std::string_view> names;
  for (const auto& [bit, name] :
       {std::pair{kBuild, "build"}, std::pair{kCity, "city"}, std::pair{kMesh, "mesh"},
        std::pair{kSynth, "synth"}, std::pair{kCheck, "check"}})
    if ((commands & bit) != 0) names.emplace_back(name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string toml_text(bool value) { return value ? "true" : "false"; }
std::string toml_text(int value) { return fmt::format("{}", value); }
std::string toml_text(double value) { return number_text(value); }
std::string toml_text(const std::string& value) { return quoted(value); }

template <typename Value>
std::string toml_text(const std::vector<Value>& values) {
  std::vector<std::string> parts;
  for (const Value& value : values) parts.push_back(toml_text(value));
  return fmt::format("[{}]", fmt::join(parts, ", "));
}

}  // namespace

std::string option_name(const ConfigField& field) {
  std::string name = "--" + std::string(field.name);
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

std::string value_text(const ConfigField& field, const Config& config) {
  return std::visit(
      [&](auto member) {
        if constexpr (std::is_same_v<decltype(member), ChoiceMember>)
          return toml_text(std::string(field.choices[member.get(config)]));
        else
          return toml_text(config.*member);
      },
      field.member);
}

void set_field(Config& config, const ConfigField& field, std::span<const std::string> values,
               const std::string& origin) {
  // The system would take it for the end of a name.
  for (const std::string& value : values)
    if (value.find('\0') != std::string::npos) fail(origin, "holds a NUL character; leave it out");
  const auto single = [&]() -> const std::string& {
    if (values.size() != 1) fail(origin, "one value expected");
    return values[0];
  };
  std::visit(
      [&](auto member) {
        if constexpr (std::is_same_v<decltype(member), ChoiceMember>) {
          member.set(config, find_choice(field, single(), origin));
        } else {
          auto& target = config.*member;
          using Value = std::decay_t<decltype(target)>;
          if constexpr (std::is_same_v<Value, bool>) {
            if (single() != "true" && single() != "false") fail(origin, "true or false expected");
            target = single() == "true";
          } else if constexpr (std::is_arithmetic_v<Value>) {
            target = parse_number<Value>(field, single(), origin);
          } else if constexpr (std::is_same_v<Value, std::string>) {
            require_text(field, single(), origin);
            target = single();
          } else if constexpr (std::is_same_v<Value, std::vector<double>>) {
            set_numbers(target, field, values, origin);
          } else {
            set_texts(target, field, values, origin);
          }
        }
      },
      field.member);
}

void require_in_range(const Config& config, unsigned commands) {
  for (const ConfigField& field : config_fields()) {
    if ((field.commands & commands) == 0) continue;
    const std::string origin = fmt::format("`{}`", field.name);
    std::visit(
        [&](auto member) {
          if constexpr (std::is_same_v<decltype(member), ChoiceMember>) {
            if (member.get(config) >= field.choices.size())
              fail(origin, fmt::format("is not one of {}", fmt::join(field.choices, ", ")));
          } else {
            const auto& value = config.*member;
            using Value = std::decay_t<decltype(value)>;
            const auto require = [&](double number) {
              require_in_range(field, number, number_text(number), origin);
            };
            if constexpr (std::is_same_v<Value, std::string>) {
              require_text(field, value, origin);
            } else if constexpr (std::is_same_v<Value, std::vector<double>>) {
              std::for_each(value.begin(), value.end(), require);
              require_box(field, value, origin);
            } else if constexpr (std::is_same_v<Value, std::vector<std::string>>) {
              require_choices(field, value, origin);
            } else if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>) {
              require(static_cast<double>(value));
            }
          }
        },
        field.member);
  }
}

std::string config_template(unsigned commands) {
  const Config defaults;
  std::string text =
      "# Settings of Tetropolis. Remove the '#' before a key to set it; options of the\n"
      "# command line take precedence over this file.\n";
  std::string_view group;
  for (const ConfigField& field : config_fields()) {
    if ((field.commands & commands) == 0) continue;
    if (field.group != group) text += fmt::format("\n# --- {} ---\n", field.group);
    group = field.group;
    text += fmt::format(
        "\n# {}{}{}\n", field.help, field.unit.empty() ? "" : fmt::format(" [{}]", field.unit),
        field.choices.empty() ? "" : fmt::format(" ({})", fmt::join(field.choices, ", ")));
    text += fmt::format("# {} = {}\n", field.name, value_text(field, defaults));
  }
  return text;
}

std::string config_markdown() {
  const Config defaults;
  std::string text;
  std::string_view group;
  for (const ConfigField& field : config_fields()) {
    if (field.group != group)
      text += fmt::format(
          "{}### {}\n\n| key | option | default | unit | range | commands | meaning |\n"
          "|---|---|---|---|---|---|---|\n",
          group.empty() ? "" : "\n", field.group);
    group = field.group;
    std::string help(field.help);
    if (!field.choices.empty()) help += fmt::format(" ({})", fmt::join(field.choices, ", "));
    text += fmt::format("| `{}` | `{}` | `{}` | {} | {} | {} | {} |\n", field.name,
                        option_name(field), value_text(field, defaults), field.unit,
                        range_text(field), command_names(field.commands), help);
  }
  return text;
}

std::string respell_settings(
    std::string_view message, std::string_view marks,
    const std::function<std::string(const ConfigField& field, std::string_view& rest)>& spell) {
  const auto is_one_of = [](char c, std::string_view list) {
    return list.find(c) != std::string_view::npos;
  };
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; };
  std::string text;
  for (std::size_t i = 0; i < message.size();) {
    std::size_t end = i;
    while (end < message.size() && is_letter(message[end])) ++end;
    if (end == i) {
      text += message[i++];
      continue;
    }
    const std::string_view name = message.substr(i, end - i);
    const char before = i > 0 ? message[i - 1] : ' ';
    const char after = end < message.size() ? message[end] : ' ';
    const bool quoted = before == '`' && after == '`';
    const bool alone = (is_one_of(before, " (`") || is_one_of(before, marks)) &&
                       (is_one_of(after, " )`.") || is_one_of(after, marks));
    const ConfigField* field =
        quoted || (alone && is_one_of('_', name)) ? find_field(name) : nullptr;
    i = end;
    if (field == nullptr) {
      text += name;
      continue;
    }
    if (quoted) {
      text.pop_back();
      ++i;
    }
    std::string_view rest = message.substr(i);
    text += spell(*field, rest);
    i = message.size() - rest.size();
  }
  return text;
}

std::string nearest_name(std::string_view name, std::span<const std::string> known) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, name.size() / 3) + 1;
  for (const std::string& candidate : known) {
    std::vector<std::size_t> row(candidate.size() + 1);
    for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= name.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j < row.size(); ++j) {
        const std::size_t substitution = diagonal + (name[i - 1] == candidate[j - 1] ? 0 : 1);
        diagonal = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitution});
      }
    }
    if (row.back() >= best_distance) continue;
    best_distance = row.back();
    best = candidate;
  }
  return best;
}

}  // namespace tetropolis
