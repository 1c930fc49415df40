#include "console.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "tetropolis/core/error.h"

#include "interrupts.h"

namespace tetropolis::app {

void put(std::FILE* stream, const std::string& text) { std::fputs(text.c_str(), stream); }

namespace {

/// Whether a file is there that is no text, or text of a format of data (JSON, XML).
bool holds_data(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  std::ifstream file(path, std::ios::binary);
  std::string start(1 << 16, ' ');
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  const std::size_t first = start.find_first_not_of(" \t\r\n");
  return start.find('\0') != std::string::npos ||
         (first != std::string::npos && std::strchr("{[<", start[first]) != nullptr);
}

}  // namespace

Console::Console(bool quiet, const std::string& log)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1), log_name_(log) {
  if (log.empty()) return;
  if (holds_data(log))
    throw Error(
        ErrorKind::kUsage,
        fmt::format("--log: {} is no log but data, which would be lost; choose another name", log));
  log_ = std::fopen(log.c_str(), "w");
  if (log_ == nullptr)
    throw Error(ErrorKind::kUsage,
                fmt::format("--log: {} cannot be written: {}; choose a folder that is there", log,
                            std::strerror(errno)));
  // Whatever ends the run, the log has its last line.
  std::setvbuf(log_, nullptr, _IOLBF, BUFSIZ);
}

Console::~Console() {
  clear_bar();
  if (log_ == nullptr) return;
  const bool lost = std::ferror(log_) != 0;
  if (std::fclose(log_) != 0 || lost)
    put(stderr, fmt::format("tetropolis: {}: the log could not be written whole; make room\n",
                            one_line(log_name_)));
}

void Console::clear_bar() {
  if (bar_) put(stderr, "\r\033[K");
  bar_ = false;
}

void Console::log_line(const std::string& line) {
  if (log_ != nullptr) put(log_, line + "\n");
}

void Console::line(const std::string& text) {
  const std::string line = one_line(text);
  log_line(line);
  if (quiet_) return;
  clear_bar();
  put(stderr, line + "\n");
}

void Console::error(const std::string& text) {
  const std::string line = one_line(text);
  clear_bar();
  log_line(line);
  put(stderr, line + "\n");
}

void Console::result(const std::string& text) {
  const std::string line = one_line(text);
  log_line(line);
  if (!quiet_) put(stdout, line + "\n");
}

void Console::important_result(const std::string& text) {
  const std::string line = one_line(text);
  log_line(line);
  put(stdout, line + "\n");
}

RunHooks Console::hooks() {
  RunHooks hooks;
  hooks.cancelled = interrupted;
  hooks.output = watch_output();
  hooks.step_begins = [this](const StepTime& step) {
    step_ = fmt::format("{}  {}", step.id, step.name);
    last_percent_ = -1;
  };
  hooks.step_progress = [this](double fraction) {
    const int percent = static_cast<int>(fraction * 100);
    if (quiet_ || !terminal_ || percent == last_percent_) return;
    last_percent_ = percent;
    constexpr int width = 30;
    const int filled = percent * width / 100;
    put(stderr, fmt::format("\r\033[K{:<32} [{:=<{}}{:{}}] {:3d} %", step_, "", filled, "",
                            width - filled, percent));
    std::fflush(stderr);
    bar_ = true;
  };
  hooks.step_ends = [this](const StepTime& step) {
    line(fmt::format("{:<34} {:6.2f} s", step_, step.seconds));
  };
  return hooks;
}

std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

}  // namespace tetropolis::app
