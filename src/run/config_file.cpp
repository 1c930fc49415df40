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
#include "tetropolis/run/config.h"

namespace tetropolis {

namespace {

bool is_scalar(const toml::node& node) {
  return node.is_string() || node.is_boolean() || node.is_number();
}

/// The text set_field expects for a scalar.
std::string text_of(const toml::node& scalar) {
  if (const auto* text = scalar.as_string()) return **text;
  if (const auto* flag = scalar.as_boolean()) return **flag ? "true" : "false";
  if (const auto* whole = scalar.as_integer()) return fmt::format("{}", **whole);
  return fmt::format("{}", **scalar.as_floating_point());
}

std::string_view wanted_type(const ConfigField& field) {
  if (std::holds_alternative<bool Config::*>(field.member)) return "true or false";
  if (std::holds_alternative<std::vector<double> Config::*>(field.member))
    return "numbers in brackets, without quotes";
  return "a number, without quotes";
}

bool takes_list(const ConfigField& field) {
  return std::holds_alternative<std::vector<double> Config::*>(field.member) ||
         std::holds_alternative<std::vector<std::string> Config::*>(field.member);
}

bool takes_text(const ConfigField& field) {
  return std::holds_alternative<std::string Config::*>(field.member) ||
         std::holds_alternative<ChoiceMember>(field.member) ||
         std::holds_alternative<std::vector<std::string> Config::*>(field.member);
}

void set_key(Config& config, std::string_view key, const toml::node& value,
             const std::string& origin) {
  const ConfigField* field = find_field(key);
  if (field == nullptr) {
    std::vector<std::string> names;
    for (const ConfigField& known : config_fields()) names.emplace_back(known.name);
    const std::string nearest = nearest_name(key, names);
    throw Error(ErrorKind::kUsage,
                fmt::format("{}: unknown key '{}'{}", origin, key,
                            nearest.empty() ? "; see 'tetropolis init'"
                                            : fmt::format("; did you mean '{}'?", nearest)));
  }
  const std::string place = fmt::format("{}: {}", origin, key);
  std::vector<std::string> texts;
  const auto take = [&](const toml::node& node) {
    if (!is_scalar(node) || node.is_string() != takes_text(*field))
      throw Error(ErrorKind::kUsage,
                  fmt::format("{} takes {}", place,
                              takes_text(*field) ? "text in quotes" : wanted_type(*field)));
    texts.push_back(text_of(node));
  };
  const auto* array = value.as_array();
  if (array != nullptr && !takes_list(*field))
    throw Error(ErrorKind::kUsage, place + " takes one value, without brackets");
  if (array != nullptr)
    for (const toml::node& element : *array) take(element);
  else
    take(value);
  set_field(config, *field, texts, place);
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
