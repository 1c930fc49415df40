// Options that are one of some words, or a name.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tetropolis::app {

using Words = std::span<const std::string_view>;

/// What is wrong with the name of a file or folder: a script has none where a variable is not set.
inline std::string wrong_name(const std::string& text) {
  return text.empty() ? "an empty name" : "";
}

/// What is wrong with `word`; empty if it is one of `words`.
inline std::string not_one_of(const std::string& word, Words words) {
  const bool known = std::find(words.begin(), words.end(), word) != words.end();
  return known ? std::string() : fmt::format("'{}' is not one of {}", word, fmt::join(words, ", "));
}

/// Adds an option that is one of `words`, the first by default.
inline void add_choice(CLI::App& command, const std::string& name, std::string& value, Words words,
                       const std::string& help) {
  command.add_option(name, value, fmt::format("{} (default {})", help, words.front()))
      ->type_name(fmt::format("{{{}}}", fmt::join(words, ",")))
      ->check([words](const std::string& word) { return not_one_of(word, words); });
}

/// The enumerator at the place of a word. Precondition: it is one of `words`.
template <typename Enumeration>
Enumeration named(const std::string& word, Words words) {
  return static_cast<Enumeration>(std::find(words.begin(), words.end(), word) - words.begin());
}

}  // namespace tetropolis::app
