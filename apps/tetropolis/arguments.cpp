#include "arguments.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/run/config.h"

#include "help.h"

namespace tetropolis::app {

namespace fs = std::filesystem;

namespace {

/// "84800", "-1e3,", "1, 2": as sides of a box are written.
bool is_numbers(std::string_view word) {
  return word.find_first_of("0123456789") != std::string_view::npos &&
         word.find_first_not_of("0123456789+-.eE, ") == std::string_view::npos;
}

/// What may have been meant by an option that is none.
std::string advice_for(const std::string& unknown, const std::vector<std::string>& known,
                       const CLI::App& command) {
  std::string meant = nearest_name(unknown, known);
  if (meant.empty()) {
    const std::string word =
        unknown.substr(std::min(unknown.find_first_not_of('-'), unknown.size()));
    for (const std::string& name : known)  // --crs, --output
      if (word.size() > 2 && (name.ends_with('-' + word) || unknown.starts_with(name)))
        meant += (meant.empty() ? "" : "' or '") + name;
  }
  if (!meant.empty()) return fmt::format("; did you mean '{}'?", meant);
  return fmt::format("; see 'tetropolis {}--help'",
                     command.get_parent() == nullptr ? "" : command.get_name() + " ");
}

}  // namespace

std::vector<std::string> arguments(const CLI::App& app, int argc, char** argv) {
  const CLI::App* command = &app;
  const auto find = [&](std::string_view word) {
    return command->get_option_no_throw(std::string(word));
  };
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    std::string_view word = argv[i];
    if (word == "--") {  // what follows are words, and all of them name files
      while (++i < argc) words.push_back((argv[i][0] == '-' ? "./" : "") + std::string(argv[i]));
      break;
    }
    words.emplace_back(word);
    if (command == &app)
      for (const CLI::App* sub : app.get_subcommands({}))
        if (sub->get_name() == word) command = sub;
    if (!word.starts_with("-")) continue;
    const std::string_view next = i + 1 < argc ? argv[i + 1] : "";
    if (word == "--bounds" && is_numbers(next)) {
      std::string& sides = words.back();
      sides += '=';
      const bool is_whole = std::count(next.begin(), next.end(), ',') == 3;
      do sides += std::string(argv[++i]) + ',';
      while (!is_whole && i + 1 < argc && is_numbers(argv[i + 1]));
      continue;
    }
    const CLI::Option* option = find(word);
    const bool takes_value = option != nullptr && option->get_items_expected_min() > 0;
    if (word.starts_with("--") && word.find('=') == word.size() - 1)
      word.remove_suffix(1);
    else if (!(takes_value && next.starts_with("-") && find(next) != nullptr))
      continue;
    throw Error(ErrorKind::kUsage,
                fmt::format("{} has no value; write one, or leave the option out", word));
  }
  std::reverse(words.begin(), words.end());
  return words;
}

std::string unknown_command(const CLI::App& app, const std::string& word) {
  std::vector<std::string> known;
  for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  const std::string nearest = nearest_name(word, known);
  std::error_code ignored;
  return fmt::format("there is no command '{}'; {}", one_line(word),
                     !nearest.empty() ? fmt::format("did you mean '{}'?", nearest)
                     : fs::exists(word, ignored)
                         ? fmt::format("write it after one: tetropolis build {} ...", word)
                         : "see 'tetropolis help'");
}

std::string usage_message(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = &app;
  for (const CLI::App* sub : app.get_subcommands()) command = sub;
  // What was not understood explains the error better than what is missing because of it.
  const std::vector<std::string> leftover = command->remaining(true);
  if (leftover.empty()) {
    if (const std::vector<std::string> before = app.remaining(); command != &app && !before.empty())
      return fmt::format("'{}' comes before the command; write it after: tetropolis {} ...",
                         before.front(), command->get_name());
    for (const CLI::Option* option : command->get_options())
      if (option->count() > 1 && option->get_items_expected_max() == 1)
        return fmt::format("{} is given {} times; give it once{}", option->get_name(),
                           option->count(),
                           option->get_name() == "--footprints"
                               ? ", with one file (ogrmerge.py -single makes one of several)"
                               : "");
    const std::string what = error.what();
    if (error.get_name() == "ArgumentMismatch")
      return what.substr(0, what.find(':')) + " has no value; write one, or leave the option out";
    if (error.get_name() == "RequiredError" && command != &app)
      return (what.starts_with('-') ? what : "a word is missing") +
             "; usage: " + usage_text(*command);
    return what;
  }
  const std::string& unknown = leftover.front();
  if (command == &app && !unknown.starts_with('-')) return unknown_command(app, unknown);
  if (std::error_code ignored; fs::exists(unknown, ignored))
    return fmt::format("unknown argument '{}'; an option before it takes one file only", unknown);
  std::vector<std::string> known;
  for (const CLI::Option* option : command->get_options()) known.push_back(option->get_name());
  return fmt::format("unknown argument '{}'{}", unknown, advice_for(unknown, known, *command));
}

}  // namespace tetropolis::app
