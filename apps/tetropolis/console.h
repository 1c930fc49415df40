// What the user sees on stderr: a progress bar on a terminal, plain lines otherwise.
#pragma once

#include <cstdio>
#include <string>

#include "tetropolis/run/run.h"

namespace tetropolis::app {

class Console {
 public:
  /// Throws Error(kUsage) if the log cannot be opened, or is a file of data (binary, JSON or
  /// XML), which would be lost. Empty `log`: none.
  Console(bool quiet, const std::string& log);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  // Each writes one line, whatever names and messages of files `text` quotes.
  void line(const std::string& text);   ///< Unless quiet.
  void error(const std::string& text);  ///< Always.
  /// What was asked for: on stdout unless quiet, and in the log.
  void result(const std::string& text);
  /// The same, quiet or not.
  void important_result(const std::string& text);
  RunHooks hooks();

 private:
  void clear_bar();
  void log_line(const std::string& line);

  bool quiet_;
  bool terminal_;
  bool bar_ = false;
  int last_percent_ = -1;
  std::string step_;
  std::string log_name_;
  std::FILE* log_ = nullptr;
};

/// Writes `text`; a stream that takes nothing (closed, full) is no reason to fail.
void put(std::FILE* stream, const std::string& text);

/// With small letters for the capital ones of ASCII.
std::string lower_case(std::string text);

}  // namespace tetropolis::app
