// The words of the command line, before CLI11 parses them and where it cannot.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace tetropolis::app {

/// What CLI11 is to parse, last word first. It takes what comes after "--option=", or after an
/// option with a value, as that value, be it the next option: those are refused (Error kUsage).
/// Sides of a box are given with commas or, as GDAL's programs have them, without, which become one
/// word.
std::vector<std::string> arguments(const CLI::App& app, int argc, char** argv);

/// One line for what CLI11 could not parse, with the nearest option.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error);

/// One line for a word in the place of a command.
std::string unknown_command(const CLI::App& app, const std::string& word);

}  // namespace tetropolis::app
