// Options of the command line, made from the list of settings.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tetropolis/run/config.h"

namespace tetropolis::app {

/// The settings one command takes from its options and from --config.
class ConfigOptions {
 public:
  /// Adds --config (not to `check`) and an option for every setting of `command` to `app`.
  ConfigOptions(CLI::App& app, Command command);
  ConfigOptions(const ConfigOptions&) = delete;
  ConfigOptions& operator=(const ConfigOptions&) = delete;

  /// Defaults, then the file, then the options. Throws Error(kUsage).
  Config config() const;
  /// That of --config; empty if there is none.
  const std::string& file() const { return file_; }

 private:
  std::string file_;
  std::map<const ConfigField*, std::vector<std::string>> values_;

  struct Switch {
    bool on = false;
    const CLI::Option* option = nullptr;
  };
  std::map<const ConfigField*, Switch> switches_;
};

/// A message of the library as the command line says it: settings by the spelling of their options.
/// Settings are told by their names, those of a single word in backquotes: "raise mesh_size, or
/// give smaller `bounds`" becomes "raise --mesh-size, or give smaller --bounds"; "ground_filter =
/// always" becomes "--ground-filter always".
std::string with_options(const std::string& message);

}  // namespace tetropolis::app
