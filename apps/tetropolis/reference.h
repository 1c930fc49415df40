// Texts about the whole command line, from the same options that it parses.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace tetropolis::app {

/// The manual page, in man(7).
std::string man_page(const CLI::App& program);

/// Completions for a shell: "bash", "zsh" or "fish". Throws Error(kUsage) for another.
std::string completions(const CLI::App& program, const std::string& shell);

}  // namespace tetropolis::app
