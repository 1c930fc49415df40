#include "options.h"

#include <algorithm>
#include <string_view>
#include <variant>

#include <fmt/format.h>

namespace tetropolis::app {

namespace {

bool is_switch(const ConfigField& field) {
  return std::holds_alternative<bool Config::*>(field.member);
}

bool is_text_list(const ConfigField& field) {
  return std::holds_alternative<std::vector<std::string> Config::*>(field.member);
}

bool is_box(const ConfigField& field) {
  return std::holds_alternative<std::vector<double> Config::*>(field.member);
}

/// "TEXT", "{a,b}", "M" ... shown behind the option's name.
std::string type_name(const ConfigField& field) {
  if (!field.choices.empty()) return fmt::format("{{{}}}", fmt::join(field.choices, ","));
  if (is_box(field)) return "XMIN,YMIN,XMAX,YMAX";
  if (field.name == "defects") return "NAME,...";
  if (is_text_list(field)) return "PATH...";
  if (std::holds_alternative<int Config::*>(field.member)) return "INT";
  if (std::holds_alternative<double Config::*>(field.member)) return "NUMBER";
  return "TEXT";
}

std::string description(const ConfigField& field) {
  static const Config defaults;
  std::string text(field.help);
  if (!field.unit.empty() && !is_box(field)) text += fmt::format(" [{}]", field.unit);
  const std::string value = value_text(field, defaults);
  if (!is_switch(field) && value != "\"\"" && value != "[]")
    text += fmt::format(" (default {})", value);
  return text;
}

}  // namespace

ConfigOptions::ConfigOptions(CLI::App& app, Command command) {
  // What was made tells `check` its settings.
  if (command != kCheck)
    app.add_option("--config", file_, "TOML file with settings; 'tetropolis init' writes one")
        ->type_name("FILE")
        ->group("Input");
  for (const ConfigField& field : config_fields()) {
    if ((field.commands & command) == 0) continue;
    const std::string group(field.group);
    if (is_switch(field)) {
      Switch& given = switches_[&field];
      given.option = app.add_flag(option_name(field), given.on, description(field))->group(group);
      continue;
    }
    CLI::Option* option =
        app.add_option(option_name(field), values_[&field], description(field))->group(group);
    option->type_name(type_name(field));
    // Sides of a box are given with commas or, as GDAL's programs have them, without.
    if ((is_text_list(field) && field.choices.empty()) || is_box(field))
      option->expected(1, -1);
    else
      // A word too many is a mistake, not a better value.
      option->expected(1)->allow_extra_args(false)->multi_option_policy(
          CLI::MultiOptionPolicy::Throw);
  }
}

Config ConfigOptions::config() const {
  Config config;
  if (!file_.empty()) load_config(config, file_);
  for (const auto& [field, values] : values_)
    if (!values.empty()) set_field(config, *field, values, option_name(*field));
  // --quiet=false takes back what the file says.
  for (const auto& [field, given] : switches_)
    if (given.option->count() > 0)
      set_field(config, *field, std::vector<std::string>{given.on ? "true" : "false"},
                option_name(*field));
  return config;
}

std::string with_options(const std::string& message) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; };
  const auto field_of = [](std::string_view name) {
    const auto fields = config_fields();
    const auto found = std::find_if(fields.begin(), fields.end(),
                                    [&](const ConfigField& field) { return field.name == name; });
    return found == fields.end() ? nullptr : &*found;
  };
  constexpr std::string_view kBefore = " (`,;:", kAfter = " )`,;:.", kEquals = " = ";
  std::string text;
  for (std::size_t i = 0; i < message.size();) {
    std::size_t end = i;
    while (end < message.size() && is_letter(message[end])) ++end;
    if (end == i) {
      text += message[i++];
      continue;
    }
    const std::string_view name = std::string_view(message).substr(i, end - i);
    const bool quoted =
        i > 0 && message[i - 1] == '`' && end < message.size() && message[end] == '`';
    const bool alone =
        (i == 0 || kBefore.find(message[i - 1]) != std::string_view::npos) &&
        (end == message.size() || kAfter.find(message[end]) != std::string_view::npos);
    const ConfigField* field =
        quoted || (alone && name.find('_') != std::string_view::npos) ? field_of(name) : nullptr;
    i = end;
    if (field == nullptr) {
      text += name;
      while (i < message.size() && !is_letter(message[i]) && message[i] != '`' &&
             kBefore.find(message[i]) == std::string_view::npos)
        text += message[i++];
      continue;
    }
    if (quoted) {
      text.pop_back();
      ++i;
    }
    text += option_name(*field);
    if (std::string_view(message).substr(i).starts_with(kEquals)) {
      text += ' ';
      i += kEquals.size();
    }
  }
  return text;
}

}  // namespace tetropolis::app
