#include "console.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <unistd.h>

#include "tetropolis/core/error.h"

#include "help.h"
#include "interrupts.h"
#include "options.h"

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

/// Whether stderr is a terminal on which a line can be drawn again.
bool draws_on_terminal() {
  const char* kind = std::getenv("TERM");
  return isatty(STDERR_FILENO) == 1 && (kind == nullptr || std::strcmp(kind, "dumb") != 0);
}

}  // namespace

Console::Console(const Config& config)
    : quiet_(config.quiet),
      verbose_(config.verbose),
      terminal_(draws_on_terminal()),
      log_name_(config.log) {
  const std::string& log = config.log;
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
  if (!bar_.empty()) put(stderr, "\r\033[K");
  bar_.clear();
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

void Console::draw_bar(const RunProgress& progress) {
  if (quiet_ || !terminal_) return;
  // One column stays free: in the last one some terminals go to the next line.
  constexpr int kWidest = 40, kAround = 38;
  const int width = std::clamp(terminal_width(STDERR_FILENO) - 1 - kAround, 1, kWidest);
  const int percent = static_cast<int>(progress.share() * 100);
  const int filled = percent * width / 100;
  const std::string left = progress.time_left();
  std::string bar = fmt::format("{:<10} [{:=<{}}{:{}}] {:3d} %{}{}", progress.stage(), "", filled,
                                "", width - filled, percent, left.empty() ? "" : ", ", left);
  if (bar == bar_) return;
  put(stderr, "\r\033[K" + bar);
  std::fflush(stderr);
  bar_ = std::move(bar);
}

void Console::stage_line(const RunProgress::Ended& stage) {
  if (!stage.name.empty() && !verbose_)
    line(fmt::format("{:<10} {:6.2f} s", stage.name, stage.seconds));
}

RunHooks Console::hooks(RunProgress& progress) {
  RunHooks hooks;
  hooks.cancelled = interrupted;
  hooks.output = watch_output();
  // Where nobody reads it, its making is spared: it looks up places in PROJ's database.
  if (!quiet_ || log_ != nullptr)
    hooks.tell = [this](const std::string& text) { line(with_options(text)); };
  hooks.step_begins = [this, &progress](const StepTime& step) {
    stage_line(progress.begin(step));
    draw_bar(progress);
  };
  hooks.step_progress = [this, &progress](double fraction) {
    progress.update(fraction);
    draw_bar(progress);
  };
  hooks.step_ends = [this, &progress](const StepTime& step) {
#ifdef __GLIBC__
    malloc_trim(0);  // Left alone, what threads have freed in small blocks stays resident.
#endif
    progress.end(step);
    const std::string text = fmt::format("{}  {:<30} {:6.2f} s", step.id, step.name, step.seconds);
    if (verbose_)
      line(text);
    else
      log_line(text);
  };
  return hooks;
}

std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

}  // namespace tetropolis::app
