// What the user sees on stderr: stages, with a bar for the whole run on a terminal.
#pragma once

#include <cstdio>
#include <string>

#include "tetropolis/run/progress.h"
#include "tetropolis/run/run.h"

namespace tetropolis::app {

class Console {
 public:
  /// By quiet, verbose and log of the settings. Throws Error(kUsage) if the log cannot be opened,
  /// or is a file of data (binary, JSON or XML), which would be lost. Empty `log`: none.
  explicit Console(const Config& config);
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
  /// Of one run; `progress` is used as long as they are.
  RunHooks hooks(RunProgress& progress);
  void stage_line(const RunProgress::Ended& stage);

 private:
  void draw_bar(const RunProgress& progress);
  void clear_bar();
  void log_line(const std::string& line);

  bool quiet_;
  bool verbose_;
  bool terminal_;
  std::string bar_;  ///< As it stands on the terminal; empty if there is none.
  std::string log_name_;
  std::FILE* log_ = nullptr;
};

/// Writes `text`; a stream that takes nothing (closed, full) is no reason to fail.
void put(std::FILE* stream, const std::string& text);

/// With small letters for the capital ones of ASCII.
std::string lower_case(std::string text);

}  // namespace tetropolis::app
