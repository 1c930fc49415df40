#include "options.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>
#include <system_error>
#include <variant>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

namespace tetropolis::app {

namespace {

bool is_switch(const ConfigField& field) {
  return std::holds_alternative<bool Config::*>(field.member);
}

bool is_text_list(const ConfigField& field) {
  return std::holds_alternative<std::vector<std::string> Config::*>(field.member);
}

/// "FILE", "{a,b}", "NUMBER" ... shown behind the option's name.
std::string type_name(const ConfigField& field) {
  if (!field.choices.empty()) return fmt::format("{{{}}}", fmt::join(field.choices, ","));
  if (field.value == "PATH") return "PATH...";
  if (!field.value.empty()) return std::string(field.value);
  if (std::holds_alternative<int Config::*>(field.member)) return "INT";
  if (std::holds_alternative<double Config::*>(field.member)) return "NUMBER";
  return "TEXT";
}

std::string description(const ConfigField& field) {
  static const Config defaults;
  std::string text(field.help);
  if (!field.unit.empty() && field.value.empty()) text += fmt::format(" [{}]", field.unit);
  std::string value = value_text(field, defaults);
  std::erase_if(value, [](char c) { return c == '"' || c == '[' || c == ']'; });
  if (!is_switch(field) && !value.empty()) text += fmt::format(" (default {})", value);
  return text;
}

/// What words without an option stand for. Of `points` there may be many.
std::vector<std::string_view> names_of_words(Command command) {
  if (command == kBuild || command == kCity) return {"footprints", "points", "out"};
  if (command == kMesh) return {"city", "dtm", "out"};
  return command == kSynth ? std::vector<std::string_view>{"out"} : std::vector<std::string_view>{};
}

std::string usage_of_words(Command command) {
  std::string text;
  for (const std::string_view name : names_of_words(command)) {
    if (!text.empty()) text += ' ';
    for (const char c : name) text += static_cast<char>(c - 'a' + 'A');
    if (name == "points") text += "...";
  }
  return text;
}

bool is_given(const ConfigField& field, const Config& config) {
  if (const auto* text = std::get_if<std::string Config::*>(&field.member))
    return !(config.**text).empty();
  return !(config.*std::get<std::vector<std::string> Config::*>(field.member)).empty();
}

/// Whether there is no file or folder of this name, and it is no pattern.
bool is_nowhere(const std::string& word) {
  std::error_code error;
  return !std::filesystem::exists(word, error) && word.find_first_of("*?[") == std::string::npos;
}

/// Whether it is a folder of an earlier run without point clouds, or an empty one.
bool holds_results(const std::string& word) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_directory(word, error)) return false;
  if (fs::is_empty(word, error)) return true;
  if (!fs::exists(fs::path(word) / "report.json", error)) return false;
  for (fs::directory_iterator entry(word, error), end; !error && entry != end;
       entry.increment(error))
    if (const fs::path ending = entry->path().extension(); ending == ".laz" || ending == ".las")
      return false;
  return true;
}

/// "-o,--out".
std::string spellings(const ConfigField& field) {
  return (field.letter == 0 ? "" : fmt::format("-{},", field.letter)) + option_name(field);
}

}  // namespace

ConfigOptions::ConfigOptions(CLI::App& app, Command command) : command_(command) {
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
      given.option = app.add_flag(spellings(field), given.on, description(field))->group(group);
      continue;
    }
    CLI::Option* option =
        app.add_option(spellings(field), values_[&field], description(field))->group(group);
    option->type_name(type_name(field));
    if (is_text_list(field) && field.choices.empty())
      option->expected(1, -1);
    else
      // A word too many is a mistake, not a better value.
      option->expected(1)->allow_extra_args(false)->multi_option_policy(
          CLI::MultiOptionPolicy::Throw);
  }
  if (!names_of_words(command).empty())
    app.add_option("words", words_)->type_name(usage_of_words(command))->expected(0, -1);
}

/// Words stand for what is not given otherwise, the last for the last of it.
void ConfigOptions::place_words(Config& config) const {
  if (words_.empty()) return;
  std::vector<const ConfigField*> fields;
  std::vector<std::string> given;
  for (const std::string_view name : names_of_words(command_)) {
    const ConfigField& field = *find_field(name);
    if (is_given(field, config))
      given.push_back(option_name(field));
    else if (!(name == "footprints" && config.terrain_only && words_.size() < 3))
      fields.push_back(&field);
  }
  const auto is_many = [](const ConfigField* field) { return field->name == "points"; };
  const bool has_many = std::any_of(fields.begin(), fields.end(), is_many);
  if (words_.size() > fields.size() && !has_many)
    throw Error(
        ErrorKind::kUsage,
        fmt::format("unknown argument '{}'; {}", words_[fields.size()],
                    given.empty() ? "the words of this command are " + usage_of_words(command_)
                                  : fmt::format("given already: {}", fmt::join(given, ", "))));
  // Of too few, one that is nowhere or has results already is the folder for them.
  if (words_.size() < fields.size() && fields.back()->name == "out" &&
      (is_nowhere(words_.back()) || holds_results(words_.back())))
    fields.erase(fields.begin() + std::ssize(words_) - 1, fields.end() - 1);
  std::size_t next = 0;
  for (const ConfigField* field : fields) {
    if (next == words_.size()) return;
    const std::size_t count =
        is_many(field) ? words_.size() - std::min(words_.size(), fields.size()) + 1 : 1;
    const auto words = std::span(words_).subspan(next, count);
    if (const auto lost = std::find_if(words.begin(), words.end(), is_nowhere);
        count > 1 && lost != words.end())
      throw Error(ErrorKind::kInput,
                  fmt::format("{}: no such file or folder; all words but the first and the last, "
                              "which is the folder for the results ({}), are points",
                              *lost, words_.back()));
    set_field(config, *field, words, option_name(*field));
    next += count;
  }
}

const ConfigField* field_of(const CLI::Option& option) {
  for (const ConfigField& field : config_fields())
    if (option.check_lname(option_name(field).substr(2))) return &field;
  return nullptr;
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
  place_words(config);
  suggest_out(config);
  return config;
}

/// The folder for the results may have been taken for a file to read: the last word of a list.
void ConfigOptions::suggest_out(const Config& config) const {
  const ConfigField& out = *find_field("out");
  if ((out.commands & command_) == 0 || is_given(out, config)) return;
  std::vector<std::string> last;
  for (const char* name : {"footprints", "points", "dtm", "dsm"})
    if (const auto& words =
            config.*std::get<std::vector<std::string> Config::*>(find_field(name)->member);
        !words.empty())
      last.push_back(words.back());
  std::error_code error;
  for (const std::string& word : last)
    if (is_nowhere(word) ||
        (words_.size() > 1 && word == words_.back() && std::filesystem::is_directory(word, error)))
      throw Error(
          ErrorKind::kUsage,
          fmt::format("missing: --out (a folder for the results); if {} is it, write --out {}",
                      word, word));
}

std::string with_options(const std::string& message) {
  return respell_settings(message, ",;:", [](const ConfigField& field, std::string_view& rest) {
    constexpr std::string_view kEquals = " = ";
    if (!rest.starts_with(kEquals)) return option_name(field);
    rest.remove_prefix(kEquals.size());
    return option_name(field) + ' ';
  });
}

}  // namespace tetropolis::app
