#include "interrupts.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <new>
#include <utility>

#include <time.h>
#include <unistd.h>

#include "tetropolis/core/error.h"
#include "tetropolis/core/foreign_input.h"

// No thread waits for signals: in a program of one thread stdio takes no locks, for which LASzip
// (it reads bytes one by one) needs a tenth of its time. So whatever ends a run here does it within
// a handler, by system calls that need neither locks nor memory.

namespace tetropolis::app {

namespace {

/// How long a run may take to notice: a second, less what removing its files and a busy machine
/// take.
constexpr long kGraceNanoseconds = 500'000'000;

constexpr unsigned kLastSeconds = 5;

constexpr const char* kLastLine = "tetropolis: interrupted; nothing was written";

/// One thread ends the process: that of a handler, or that of the run. None does while results move
/// to their place.
enum class State { kRuns, kMoves, kEnds };
std::atomic<State> state{State::kRuns};
static_assert(std::atomic<State>::is_always_lock_free);

/// What removes the files of a run, if there are any. Never freed: a handler may be in it.
std::atomic<const std::function<void()>*> discard_output{nullptr};

std::atomic<int> signals_seen{0};
static_assert(std::atomic<int>::is_always_lock_free);
timer_t grace;
bool has_timer = false;
bool on_terminal = false;

constexpr int kFaults[] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};
/// What the system would have done about a crash.
struct sigaction before_fault[std::size(kFaults)];

bool moves_on_to(State next) {
  State from = State::kRuns;
  return state.compare_exchange_strong(from, next);
}

/// Another thread is at it.
[[noreturn]] void wait_for_the_end() {
  for (;;) ::pause();
}

/// After a crash the last words are given no longer than this.
void end_for_certain() {
  std::signal(SIGALRM, SIG_DFL);
  ::alarm(kLastSeconds);
}

/// Last words, and the end. Precondition: moves_on_to(kEnds) was granted.
[[noreturn]] void end(std::initializer_list<const char*> words, int code) {
  if (const auto* discard = discard_output.load()) (*discard)();
  char line[8192];
  std::size_t length = 0;
  const auto add = [&](const char* word) {
    const std::size_t size = std::min(std::strlen(word), sizeof line - length);
    std::memcpy(line + length, word, size);
    length += size;
  };
  if (on_terminal) add("\r\033[K");  // over the progress bar
  for (const char* word : words) add(word);
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, line, length);
  ::_exit(code);
}

void end_overdue_run(int) {
  if (moves_on_to(State::kEnds)) end({kLastLine, "\n"}, kInterruptedExit);
}

void on_interrupt(int signal) {
  const int error = errno;
  if (signals_seen.fetch_add(1) > 0) {
    std::signal(signal, SIG_DFL);
    end_overdue_run(signal);
  } else if (has_timer) {
    const itimerspec once{{}, {0, kGraceNanoseconds}};
    ::timer_settime(grace, 0, &once, nullptr);
  } else {
    ::alarm(1);
  }
  errno = error;
}

/// Of a crash on broken input, and of a library that gives up (GDAL does where a small allocation
/// fails), remains one line. Any other crash stays what it is.
void on_fault(int signal, siginfo_t*, void*) {
  const char* input = foreign_input();
  if (input != nullptr || signal == SIGABRT) {
    if (moves_on_to(State::kEnds)) {
      end_for_certain();
      if (input == nullptr)
        end({"tetropolis: a library ended the program, perhaps out of memory; nothing was "
             "written\n"},
            1);
      end({"tetropolis: ", input,
           ": a library crashed on it: the file is broken or was changed while it was read, or "
           "memory ran out; get it again, or leave it out\n"},
          static_cast<int>(ErrorKind::kInput));
    }
    if (state == State::kEnds) wait_for_the_end();
  }
  for (std::size_t i = 0; i < std::size(kFaults); ++i)
    if (kFaults[i] == signal) ::sigaction(signal, &before_fault[i], nullptr);  // it happens again
}

/// What no thread has caught, such as an exception of a library's own thread. No handler: it may
/// call anything.
[[noreturn]] void on_terminate() {
  end_for_certain();
  if (!moves_on_to(State::kEnds)) {
    if (state == State::kEnds) wait_for_the_end();
    discard_output = nullptr;
  }
  // There may be no memory left for a string.
  std::array<char, 1024> reason{"std::terminate"};
  const auto keep = [&](const char* text) {
    const std::size_t size = std::min(std::strlen(text), reason.size() - 1);
    std::replace_copy_if(
        text, text + size, reason.begin(), [](unsigned char c) { return c < ' ' || c == 0x7F; },
        ' ');
    reason[size] = '\0';
  };
  try {
    if (const auto error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    end({"tetropolis: out of memory; free some, or give it less to work on\n"}, 1);
  } catch (const std::exception& error) {
    keep(error.what());
  } catch (...) {
    keep("an exception from a library");
  }
  end({"tetropolis: ", reason.data(), ": out of memory or threads, or an internal error\n"}, 1);
}

void catch_faults() {
  struct sigaction action {};
  action.sa_sigaction = on_fault;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  for (std::size_t i = 0; i < std::size(kFaults); ++i)
    ::sigaction(kFaults[i], &action, &before_fault[i]);
}

void catch_timer() {
  struct sigaction action {};
  action.sa_handler = end_overdue_run;
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGALRM, &action, nullptr);
  has_timer = ::timer_create(CLOCK_MONOTONIC, nullptr, &grace) == 0;
}

}  // namespace

bool interrupted() { return signals_seen != 0; }

void catch_interrupts() {
  // A reader that went away or a file that may not grow shows as a failed write, not as a sudden
  // end.
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
  std::set_terminate(on_terminate);
  on_terminal = ::isatty(STDERR_FILENO) == 1;
  catch_timer();
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
    discard_output = new std::function(std::move(discard));
  };
  watcher.moves = [] {
    if (!moves_on_to(State::kMoves) && state == State::kEnds) wait_for_the_end();
  };
  return watcher;
}

void wait_if_ending() {
  if (state == State::kEnds) wait_for_the_end();
}

int say_interrupted(const std::function<void(const std::string&)>& say) {
  if (!moves_on_to(State::kEnds) && state == State::kEnds) wait_for_the_end();
  say(kLastLine);
  return kInterruptedExit;
}

}  // namespace tetropolis::app
