// Options of the command line, made from the list of settings.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tetropolis/run/config.h"

namespace tetropolis::app {

/// The settings one command takes from its options, from words without one, and from --config.
class ConfigOptions {
 public:
  /// Adds --config (not to `check`), an option for every setting of `command`, and what words
  /// without an option stand for ("FOOTPRINTS POINTS... OUT") to `app`.
  ConfigOptions(CLI::App& app, Command command);
  ConfigOptions(const ConfigOptions&) = delete;
  ConfigOptions& operator=(const ConfigOptions&) = delete;

  /// Defaults, then the file, then the options, then the words for what these do not give. Throws
  /// Error(kUsage).
  Config config() const;
  /// That of --config; empty if there is none.
  const std::string& file() const { return file_; }

 private:
  void place_words(Config& config) const;
  void suggest_out(const Config& config) const;

  Command command_;
  std::string file_;
  std::vector<std::string> words_;
  std::map<const ConfigField*, std::vector<std::string>> values_;

  struct Switch {
    bool on = false;
    const CLI::Option* option = nullptr;
  };
  std::map<const ConfigField*, Switch> switches_;
};

/// The field of an option of CLI11; null if it is no setting.
const ConfigField* field_of(const CLI::Option& option);

/// A message of the library as the command line says it: settings by the spelling of their options.
/// Settings are told by their names, those of a single word in backquotes: "raise mesh_size, or
/// give smaller `bounds`" becomes "raise --mesh-size, or give smaller --bounds"; "ground_filter =
/// always" becomes "--ground-filter always".
std::string with_options(const std::string& message);

}  // namespace tetropolis::app
