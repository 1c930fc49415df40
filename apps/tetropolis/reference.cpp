#include "reference.h"

#include <algorithm>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/version.h"

#include "help.h"
#include "options.h"

namespace tetropolis::app {

namespace {

/// What an option takes.
enum class Value { kNothing, kChoice, kFile, kFolder, kOther };

Value value_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  if (type.empty()) return Value::kNothing;
  if (type.starts_with('{')) return Value::kChoice;
  if (type.starts_with("FILE") || type.starts_with("PATH")) return Value::kFile;
  return type == "DIR" ? Value::kFolder : Value::kOther;
}

/// "vtu msh" of "{vtu,msh}".
std::string choices_of(const CLI::Option& option) {
  std::string type = option.get_type_name();
  std::replace(type.begin(), type.end(), ',', ' ');
  return type.substr(1, type.size() - 2);
}

/// With `before` before each of `marked`.
std::string escaped(std::string_view text, std::string_view marked, std::string_view before) {
  std::string result;
  for (const char c : text) {
    if (marked.find(c) != std::string_view::npos) result += before;
    result += c;
  }
  return result;
}

std::string for_man(std::string_view text) {
  std::string result = escaped(text, "\\-", "\\");
  for (std::size_t at = 0; (at = result.find('\'', at)) != std::string::npos;)
    result.replace(at, 1, "\\(aq");
  return result.starts_with('.') ? "\\&" + result : result;
}

std::string man_entry(const CLI::Option& option) {
  return fmt::format(".TP\n.B {}\n{}.\n", for_man(option_text(option)),
                     for_man(option.get_description()));
}

std::string bash(const CLI::App& program) {
  std::string commands, options, values;
  std::set<std::string> seen;
  for (const CLI::App* command : visible_commands(program)) {
    commands += (commands.empty() ? "" : " ") + command->get_name();
    options += fmt::format("      {}) words='", command->get_name());
    for (const CLI::Option* option : options_of(*command)) {
      const std::string name = "--" + option->get_lnames().front();
      options += name + ' ';
      if (!seen.insert(name).second) continue;
      if (value_of(*option) == Value::kChoice)
        values += fmt::format("  {}) words='{}' ;;\n", name, choices_of(*option));
      else if (value_of(*option) != Value::kNothing)
        values += fmt::format("  {}) return ;;\n", name);
    }
    options += "' ;;\n";
  }
  return fmt::format(R"(# Completions of tetropolis for bash.
_tetropolis() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} command=${{COMP_WORDS[1]}} words=
  COMPREPLY=()
  case ${{COMP_WORDS[COMP_CWORD-1]}} in
{}  *)
    if [[ $COMP_CWORD -eq 1 || $command == help ]]; then
      words='{}'
    elif [[ $current == -* ]]; then
      case $command in
{}      esac
    else
      return
    fi ;;
  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
}}
complete -o default -F _tetropolis tetropolis
)",
                     values, commands, options);
}

std::string zsh(const CLI::App& program) {
  std::string commands, cases;
  for (const CLI::App* command : visible_commands(program)) {
    commands += fmt::format("    '{}:{}'\n", command->get_name(),
                            escaped(command->get_description(), ":", "\\"));
    cases += fmt::format("    {}) _arguments \\\n", command->get_name());
    for (const CLI::Option* option : options_of(*command)) {
      const std::string help = escaped(escaped(option->get_description(), "[]", "\\"), "'", "'\\'");
      std::string value;
      switch (value_of(*option)) {
        case Value::kNothing:
          break;
        case Value::kChoice:
          value = fmt::format(":value:({})", choices_of(*option));
          break;
        case Value::kFile:
          value = ":file:_files";
          break;
        case Value::kFolder:
          value = ":folder:_files -/";
          break;
        case Value::kOther:
          value = ":value:";
          break;
      }
      cases += fmt::format("      '--{}[{}]{}' \\\n", option->get_lnames().front(), help, value);
    }
    cases += "      '*:file:_files' ;;\n";
  }
  return fmt::format(R"(#compdef tetropolis
# Completions of tetropolis for zsh.
_tetropolis() {{
  local -a commands
  commands=(
{}  )
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  shift words
  (( CURRENT-- ))
  case $words[1] in
{}    help) _describe command commands ;;
  esac
}}
_tetropolis "$@"
)",
                     commands, cases);
}

std::string fish(const CLI::App& program) {
  std::string text = "# Completions of tetropolis for fish.\n";
  const auto quoted = [](const std::string& words) {
    return '\'' + escaped(words, "\\'", "\\") + '\'';
  };
  for (const CLI::App* command : visible_commands(program)) {
    text += fmt::format("complete -c tetropolis -n __fish_use_subcommand -f -a {} -d {}\n",
                        command->get_name(), quoted(command->get_description()));
    for (const CLI::Option* option : options_of(*command)) {
      text += fmt::format("complete -c tetropolis -n '__fish_seen_subcommand_from {}' -l {}",
                          command->get_name(), option->get_lnames().front());
      for (const std::string& letter : option->get_snames()) text += " -s " + letter;
      switch (value_of(*option)) {
        case Value::kNothing:
          break;
        case Value::kChoice:
          text += fmt::format(" -x -a '{}'", choices_of(*option));
          break;
        case Value::kFile:
          text += " -r";
          break;
        case Value::kFolder:
          text += " -x -a '(__fish_complete_directories)'";
          break;
        case Value::kOther:
          text += " -x";
          break;
      }
      text += fmt::format(" -d {}\n", quoted(option->get_description()));
    }
  }
  return text;
}

}  // namespace

std::string man_page(const CLI::App& program) {
  std::string text = fmt::format(
      ".TH TETROPOLIS 1 \"\" \"Tetropolis {}\" \"User Commands\"\n"
      ".SH NAME\ntetropolis \\- conforming tetrahedral city meshes from footprints and LiDAR\n"
      ".SH SYNOPSIS\n",
      kVersion);
  for (const CLI::App* command : visible_commands(program))
    text += fmt::format(".B {}\n.br\n", for_man(usage_text(*command)));
  text += fmt::format(".SH DESCRIPTION\n{}.\n.SH COMMANDS\n", for_man(program.get_description()));
  for (const CLI::App* command : visible_commands(program)) {
    text += fmt::format(".SS {}\n{}.\n", command->get_name(), for_man(command->get_description()));
    for (const CLI::Option* option : options_of(*command))
      if (field_of(*option) == nullptr && option->get_group() != "Options" &&
          !option->check_lname("config"))
        text += man_entry(*option);
    if (!command->get_footer().empty())
      text += fmt::format(".PP\nExample:\n.PP\n.nf\n  {}\n.fi\n", for_man(command->get_footer()));
  }
  text +=
      ".SH OPTIONS\nEach is a key of the TOML file that\n.B \\-\\-config FILE\nnames, too "
      "(\\(aqtetropolis init\\(aq writes one).\n";
  std::string_view group;
  for (const ConfigField& field : config_fields()) {
    if (field.group != group) text += fmt::format(".SS {}\n", field.group);
    group = field.group;
    for (const CLI::App* command : visible_commands(program))
      if (const CLI::Option* option = command->get_option_no_throw(option_name(field))) {
        text += man_entry(*option);
        break;
      }
  }
  return text +
         ".SH EXIT STATUS\n0 done; 1 a check failed or a guarantee cannot be kept; 2 wrong "
         "options; 3 unusable input; 130 interrupted.\n";
}

std::string completions(const CLI::App& program, const std::string& shell) {
  if (shell == "bash") return bash(program);
  if (shell == "zsh") return zsh(program);
  if (shell == "fish") return fish(program);
  throw Error(ErrorKind::kUsage,
              fmt::format("there are no completions for '{}'; name bash, zsh or fish", shell));
}

}  // namespace tetropolis::app
