// What --help prints, made from the options that CLI11 knows.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace tetropolis::app {

/// The columns of the terminal on `stream` (STDOUT_FILENO, ...): COLUMNS, what the terminal says,
/// or 80.
int terminal_width(int stream);

/// Of a command: usage, the options that matter (`mode` kAll: all), an example. Of the program: its
/// commands and first steps. Lines are wrapped to `width`.
std::string help_text(const CLI::App& app, CLI::AppFormatMode mode, int width);

/// The commands that people call.
std::vector<const CLI::App*> visible_commands(const CLI::App& program);

/// "tetropolis build [OPTIONS] FOOTPRINTS POINTS... OUT".
std::string usage_text(const CLI::App& command);

/// The options of a command, and what is written in front of their help: "-o,--out DIR".
std::vector<const CLI::Option*> options_of(const CLI::App& command);
std::string option_text(const CLI::Option& option);

}  // namespace tetropolis::app
