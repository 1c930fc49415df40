#include "help.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string_view>

#include <fmt/format.h>
#include <sys/ioctl.h>

#include "options.h"

namespace tetropolis::app {

namespace {

/// Words in lines of at most `width`, each but the first after `indent` blanks; `column`: where the
/// first one begins.
std::string wrapped(std::string_view text, std::size_t column, std::size_t indent,
                    std::size_t width) {
  std::string lines;
  bool is_first = true;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(word.size() + 1, text.size()));
    if (!is_first && column + 1 + word.size() > width) {
      lines += '\n' + std::string(indent, ' ');
      column = indent;
    } else if (!is_first) {
      lines += ' ';
      ++column;
    }
    lines += word;
    column += word.size();
    is_first = false;
  }
  return lines;
}

/// "  name        help, in a column of its own".
std::string entry(const std::string& name, const std::string& help, std::size_t indent,
                  std::size_t width) {
  std::string line = "  " + name;
  line += line.size() + 1 < indent ? std::string(indent - line.size(), ' ')
                                   : '\n' + std::string(indent, ' ');
  return line + wrapped(help, indent, indent, width) + '\n';
}

bool is_common(const CLI::Option& option) {
  const ConfigField* field = field_of(option);
  return field == nullptr || field->common;
}

std::string program_help(const CLI::App& program, std::size_t width) {
  std::string text = wrapped(program.get_description(), 0, 0, width) + "\n\nCommands:\n";
  for (const CLI::App* command : visible_commands(program))
    text += entry(command->get_name(), command->get_description(), 15, width);
  return text + "\n" + program.get_footer();
}

}  // namespace

int terminal_width(int stream) {
  constexpr int kUsual = 80, kLeast = 40;
  int width = 0;
  if (const char* columns = std::getenv("COLUMNS"))
    std::from_chars(columns, columns + std::string_view(columns).size(), width);
  winsize size{};
  if (width <= 0 && ioctl(stream, TIOCGWINSZ, &size) == 0) width = size.ws_col;
  return width <= 0 ? kUsual : std::max(width, kLeast);
}

std::vector<const CLI::App*> visible_commands(const CLI::App& program) {
  std::vector<const CLI::App*> commands;
  for (const CLI::App* command : program.get_subcommands({}))
    if (!command->get_group().empty()) commands.push_back(command);
  return commands;
}

std::string usage_text(const CLI::App& command) {
  std::string text = fmt::format("tetropolis {} [OPTIONS]", command.get_name());
  for (const CLI::Option* option : command.get_options({}))
    if (option->get_positional() && !option->nonpositional()) text += ' ' + option->get_type_name();
  return text;
}

std::vector<const CLI::Option*> options_of(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return option->nonpositional(); });
}

std::string option_text(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return option.get_name(false, true) + (type.empty() ? "" : " " + type);
}

std::string help_text(const CLI::App& app, CLI::AppFormatMode mode, int width) {
  const auto columns = static_cast<std::size_t>(width);
  if (app.get_parent() == nullptr) return program_help(app, columns);
  const bool all = mode == CLI::AppFormatMode::All;
  std::string text = fmt::format("Usage: {}\n\n{}\n", usage_text(app),
                                 wrapped(app.get_description() + ".", 0, 0, columns));
  std::vector<std::string> groups;
  std::size_t left_out = 0;
  for (const CLI::Option* option : options_of(app))
    if (std::find(groups.begin(), groups.end(), option->get_group()) == groups.end())
      groups.push_back(option->get_group());
  // --help itself is the least of it.
  std::rotate(groups.begin(), groups.begin() + (groups.size() > 1 ? 1 : 0), groups.end());
  const std::size_t indent = columns < 70 ? 10 : 26;
  for (const std::string& group : groups) {
    std::string entries;
    for (const CLI::Option* option : options_of(app)) {
      if (option->get_group() != group) continue;
      if (all || is_common(*option))
        entries += entry(option_text(*option), option->get_description(), indent, columns);
      else
        ++left_out;
    }
    if (!entries.empty()) text += fmt::format("\n{}:\n{}", group, entries);
  }
  if (!app.get_footer().empty()) text += "\nExample:\n  " + app.get_footer() + "\n";
  if (left_out > 0)
    text += fmt::format("\n{} more options: tetropolis {} --help-all\n", left_out, app.get_name());
  return text;
}

}  // namespace tetropolis::app
