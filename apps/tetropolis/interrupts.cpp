#include "interrupts.h"

#include <cerrno>
#include <csignal>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include "console.h"

namespace tetropolis::app {

namespace {

/// How long a run may take to notice: a second, less what removing its files and a busy machine
/// take.
constexpr int kGraceMilliseconds = 500;

constexpr const char* kLastLine = "tetropolis: interrupted; nothing was written";

volatile std::sig_atomic_t signals_seen = 0;
int wake_up[2] = {-1, -1};

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

void on_interrupt(int signal) {
  const int error = errno;
  signals_seen = signals_seen + 1;
  if (signals_seen > 1) std::signal(signal, SIG_DFL);
  [[maybe_unused]] const ssize_t written = ::write(wake_up[1], "!", 1);
  errno = error;
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
  signal_comes(kGraceMilliseconds);
  const std::unique_lock lock(output().mutex);
  if (output().moving) return;
  if (output().discard) output().discard();
  if (!std::exchange(output().said, true)) put(stderr, std::string(kLastLine) + "\n");
  ::_exit(kInterruptedExit);
}

}  // namespace

bool interrupted() { return signals_seen != 0; }

void catch_interrupts() {
  // A reader that went away or a file that may not grow shows as a failed write, not as a sudden
  // end.
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
  if (::pipe2(wake_up, O_CLOEXEC | O_NONBLOCK) != 0) return;
  try {
    std::thread(end_overdue_runs).detach();
  } catch (const std::exception&) {
    // No thread to be had: then the run's own looking has to do.
  }
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
