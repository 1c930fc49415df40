#include "interrupts.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <exception>
#include <functional>
#include <iterator>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/foreign_code.h"

#include "console.h"

namespace tetropolis::app {

namespace {

/// How long a run may take to notice: a second, less what removing its files and a busy machine
/// take.
constexpr int kGraceMilliseconds = 500;

constexpr unsigned kLastSeconds = 5;

constexpr char kGaveUp[] =
    "tetropolis: a library ended the program, perhaps out of memory; nothing was written\n";

constexpr const char* kLastLine = "tetropolis: interrupted; nothing was written";

volatile std::sig_atomic_t signals_seen = 0;
volatile std::sig_atomic_t watching = 0;
int wake_up[2] = {-1, -1};

/// Input that crashed a library, and what the system would have done about the crash.
std::atomic<const char*> crashed_on{nullptr};
constexpr int kFaults[] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};
struct sigaction before_fault[std::size(kFaults)];

/// What there is to remove. Left to the system at exit: the thread may outlive main().
struct Output {
  std::mutex mutex;
  std::function<void()> discard;
  bool moving = false;
  bool said = false;
};
Output& output() {
  static auto* const instance = new Output;
  return *instance;
}

/// At the very end, when there may be no memory.
void discard_output() {
  try {
    if (!output().moving && output().discard) output().discard();
  } catch (const std::exception&) {
    // Then the next run tidies up.
  }
}

void on_interrupt(int signal) {
  const int error = errno;
  signals_seen = signals_seen + 1;
  if (signals_seen > 1) std::signal(signal, SIG_DFL);
  [[maybe_unused]] const ssize_t written = ::write(wake_up[1], "!", 1);
  errno = error;
}

/// Of a crash on broken input, and of a library that gives up (GDAL does where a small allocation
/// fails), remains one line: the thread that waits for signals says it and ends the process, as
/// this one is in no state to. Any other crash stays what it is.
void on_fault(int signal, siginfo_t*, void*) {
  const char* input = foreign_input();
  if (input == nullptr && signal == SIGABRT) input = "";  // no input's fault
  if (input != nullptr && watching != 0) {
    crashed_on = input;
    ::alarm(kLastSeconds);  // this thread may hold a lock that the last words need
    [[maybe_unused]] const ssize_t written = ::write(wake_up[1], "!", 1);
    for (;;) ::pause();
  }
  if (signal == SIGABRT) {  // no thread to say so
    ::alarm(kLastSeconds);
    discard_output();
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kGaveUp, sizeof kGaveUp - 1);
    ::_exit(1);
  }
  for (std::size_t i = 0; i < std::size(kFaults); ++i)
    if (kFaults[i] == signal) ::sigaction(signal, &before_fault[i], nullptr);  // it happens again
}

/// What no thread has caught, such as an exception of a library's own thread.
[[noreturn]] void on_terminate() {
  std::string reason = "std::terminate";
  try {
    if (const auto error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::exception& error) {
    reason = error.what();
  } catch (...) {
    reason = "an exception from a library";
  }
  ::alarm(kLastSeconds);
  const std::unique_lock lock(output().mutex);
  discard_output();
  put(stderr, fmt::format("tetropolis: {}: out of memory or threads, or an internal error\n",
                          one_line(reason)));
  ::_exit(1);
}

void catch_faults() {
  struct sigaction action {};
  action.sa_sigaction = on_fault;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  for (std::size_t i = 0; i < std::size(kFaults); ++i)
    ::sigaction(kFaults[i], &action, &before_fault[i]);
}

/// Waits for a signal, or for so long. Negative: for ever.
bool signal_comes(int milliseconds) {
  pollfd ready{wake_up[0], POLLIN, 0};
  char byte;
  return ::poll(&ready, 1, milliseconds) > 0 && ::read(wake_up[0], &byte, 1) == 1;
}

void end_overdue_runs() {
  while (!signal_comes(-1)) {
  }
  const char* broken = crashed_on;
  if (broken == nullptr) signal_comes(kGraceMilliseconds);
  const std::unique_lock lock(output().mutex);
  if (output().moving) return;
  discard_output();
  if (broken != nullptr && *broken == '\0') {
    put(stderr, kGaveUp);
    ::_exit(1);
  }
  if (broken != nullptr) {
    put(stderr, fmt::format("tetropolis: {}: a library crashed on it: the file is broken, or "
                            "memory ran out; get it again, or leave it out\n",
                            broken));
    ::_exit(static_cast<int>(ErrorKind::kInput));
  }
  if (!std::exchange(output().said, true)) put(stderr, std::string(kLastLine) + "\n");
  ::_exit(kInterruptedExit);
}

}  // namespace

bool interrupted() { return signals_seen != 0; }

void catch_interrupts() {
  // A reader that went away or a file that may not grow shows as a failed write, not as a sudden
  // end.
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
  std::set_terminate(on_terminate);
  if (::pipe2(wake_up, O_CLOEXEC | O_NONBLOCK) != 0) return;
  try {
    std::thread(end_overdue_runs).detach();
    watching = 1;
  } catch (const std::exception&) {
    // No thread to be had: then the run's own looking has to do.
  }
  catch_faults();
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, on_interrupt);
  // Ignored from the start (nohup): the run is meant to outlive the terminal.
  struct sigaction hangup {};
  if (::sigaction(SIGHUP, nullptr, &hangup) != 0 || hangup.sa_handler != SIG_IGN)
    std::signal(SIGHUP, on_interrupt);
}

OutputWatcher watch_output() {
  OutputWatcher watcher;
  watcher.begins = [](std::function<void()> discard) {
    const std::lock_guard lock(output().mutex);
    output().discard = std::move(discard);
  };
  watcher.moves = [] {
    const std::lock_guard lock(output().mutex);
    output().moving = true;
  };
  return watcher;
}

int say_interrupted(const std::function<void(const std::string&)>& say) {
  const std::lock_guard lock(output().mutex);
  if (!std::exchange(output().said, true)) say(kLastLine);
  return kInterruptedExit;
}

}  // namespace tetropolis::app
