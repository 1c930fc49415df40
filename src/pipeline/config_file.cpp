// TOML in; kept apart because toml++ is slow to compile.
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "tetropolis/core/error.h"
#include "tetropolis/pipeline/config.h"

namespace tetropolis {

namespace {

/// The texts set_field expects for a TOML value.
std::vector<std::string> texts_of(const toml::node& node, const std::string& origin) {
  std::vector<std::string> texts;
  const auto scalar = [&](const toml::node& value) {
    if (const auto* text = value.as_string())
      texts.push_back(**text);
    else if (const auto* flag = value.as_boolean())
      texts.emplace_back(**flag ? "true" : "false");
    else if (const auto* whole = value.as_integer())
      texts.push_back(fmt::format("{}", **whole));
    else if (const auto* real = value.as_floating_point())
      texts.push_back(fmt::format("{}", **real));
    else
      throw Error(ErrorKind::kUsage,
                  origin + ": a number, text, true, false or a list of them expected");
  };
  if (const auto* array = node.as_array())
    for (const toml::node& element : *array) scalar(element);
  else
    scalar(node);
  return texts;
}

std::string_view wanted_type(const ConfigField& field) {
  if (std::holds_alternative<bool Config::*>(field.member)) return "true or false";
  if (std::holds_alternative<std::vector<double> Config::*>(field.member))
    return "numbers in brackets, without quotes";
  return "a number, without quotes";
}

bool takes_text(const ConfigField& field) {
  return std::holds_alternative<std::string Config::*>(field.member) ||
         std::holds_alternative<ChoiceMember>(field.member) ||
         std::holds_alternative<std::vector<std::string> Config::*>(field.member);
}

void set_key(Config& config, std::string_view key, const toml::node& value,
             const std::string& origin) {
  std::vector<std::string> names;
  for (const ConfigField& field : config_fields()) {
    names.emplace_back(field.name);
    if (field.name != key) continue;
    const auto require_type = [&](const toml::node& node) {
      if (node.is_string() != takes_text(field) && !node.is_array())
        throw Error(ErrorKind::kUsage,
                    fmt::format("{}: {} takes {}", origin, key,
                                takes_text(field) ? "text in quotes" : wanted_type(field)));
    };
    if (const auto* array = value.as_array())
      for (const toml::node& element : *array) require_type(element);
    else
      require_type(value);
    set_field(config, field, texts_of(value, origin), fmt::format("{}: {}", origin, key));
    return;
  }
  const std::string nearest = nearest_name(key, names);
  throw Error(ErrorKind::kUsage,
              fmt::format("{}: unknown key '{}'{}", origin, key,
                          nearest.empty() ? "; see 'tetropolis init'"
                                          : fmt::format("; did you mean '{}'?", nearest)));
}

[[noreturn]] void cannot_open(const std::filesystem::path& path, const std::string& reason) {
  throw Error(ErrorKind::kUsage, path.string() + ": cannot be opened: " + reason);
}

/// A key of many parts becomes tables in tables, which the parser, unlike arrays in arrays, takes
/// apart by calling itself as often as they are deep: more than a stack may hold.
void require_plain_keys(std::string_view text, const std::filesystem::path& path) {
  constexpr int kMostDots = 1000;
  int dots = 0;
  std::size_t line = 1;
  for (const char c : text) {
    if (c == '\n') ++line;
    if (c == '.')
      ++dots;
    else if (std::string_view(",=[]{}#\n").find(c) != std::string_view::npos)
      dots = 0;
    if (dots > kMostDots)
      throw Error(ErrorKind::kUsage, fmt::format("{}:{}: not valid TOML: more than {} dots in one "
                                                 "key or value",
                                                 path.string(), line, kMostDots));
  }
}

std::string read_text(std::ifstream& file, const std::filesystem::path& path) try {
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (file.bad()) cannot_open(path, std::strerror(errno));
  return text;
} catch (const std::ios_base::failure& failure) {  // as the buffer of a file throws by itself
  cannot_open(path, failure.code().message());
}

}  // namespace

void load_config(Config& config, const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    if (error && error != std::errc::no_such_file_or_directory) cannot_open(path, error.message());
    if (std::filesystem::exists(path, error))
      throw Error(ErrorKind::kUsage, path.string() + ": is not an ordinary file");
    throw Error(ErrorKind::kUsage, path.string() + ": no such configuration file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) cannot_open(path, std::strerror(errno));
  const std::string text = read_text(file, path);
  require_plain_keys(text, path);
  toml::table table;
  try {
    table = toml::parse(text, path.string());
  } catch (const toml::parse_error& wrong) {
    throw Error(ErrorKind::kUsage, fmt::format("{}:{}: not valid TOML: {}", path.string(),
                                               wrong.source().begin.line, wrong.description()));
  }
  for (const auto& [key, value] : table)
    set_key(config, key.str(), value,
            fmt::format("{}:{}", path.string(), value.source().begin.line));
}

}  // namespace tetropolis
