#include "command_line.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tetropolis {

namespace {

constexpr std::array<std::pair<std::string_view, Command>, 4> kCommands{
    {{"build", kBuild}, {"city", kCity}, {"mesh", kMesh}, {"synth", kSynth}}};

std::string shell_quoted(const std::string& word) {
  constexpr std::string_view plain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=.,/:@%";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word)
    if (c == '\'')
      text += "'\\''";
    else
      text += c;
  return text + "'";
}

/// What follows the option's name.
std::string words_of(const ConfigField& field, const Config& config) {
  return std::visit(
      [&](auto member) -> std::string {
        if constexpr (std::is_same_v<decltype(member), ChoiceMember>) {
          return ' ' + std::string(field.choices[member.get(config)]);
        } else {
          const auto& value = config.*member;
          using Value = std::decay_t<decltype(value)>;
          if constexpr (std::is_same_v<Value, bool>) {
            return "";
          } else if constexpr (std::is_same_v<Value, std::string>) {
            return ' ' + shell_quoted(value);
          } else if constexpr (std::is_same_v<Value, std::vector<std::string>>) {
            std::string words;
            for (const std::string& text : value) words += ' ' + shell_quoted(text);
            return words;
          } else if constexpr (std::is_same_v<Value, std::vector<double>>) {
            return fmt::format(" {}", fmt::join(value, ","));
          } else {
            return fmt::format(" {}", value);
          }
        }
      },
      field.member);
}

}  // namespace

std::string command_line(const Config& config, const std::string& command) {
  const auto* const found = std::find_if(kCommands.begin(), kCommands.end(),
                                         [&](const auto& c) { return c.first == command; });
  std::string line = "tetropolis " + command;
  const Config defaults;
  for (const ConfigField& field : config_fields())
    if (found != kCommands.end() && (field.commands & found->second) != 0 &&
        value_text(field, config) != value_text(field, defaults))
      line += ' ' + option_name(field) + words_of(field, config);
  return line;
}

}  // namespace tetropolis
