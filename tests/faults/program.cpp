#include "program.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/bytes.h"

namespace tetropolis::testing {

namespace fs = std::filesystem;

namespace {

constexpr uid_t kNobody = 65534;

void set_limit(int resource, rlim_t value) {
  const rlimit limit{value, value};
  if (value != RLIM_INFINITY && setrlimit(resource, &limit) != 0) _exit(125);
}

[[noreturn]] void become(const fs::path& folder, std::vector<char*>& command, int err,
                         const ProcessLimits& limits) {
  // Children of a test runner may have been told to ignore what the program waits for.
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXFSZ}) std::signal(number, SIG_DFL);
  const int null = open("/dev/null", O_RDWR);
  dup2(null, STDIN_FILENO);
  dup2(null, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  if (chdir(folder.c_str()) != 0) _exit(124);
  if (limits.unprivileged && geteuid() == 0 && (setgid(kNobody) != 0 || setuid(kNobody) != 0))
    _exit(123);
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_FSIZE, limits.file_size);
  set_limit(RLIMIT_AS, limits.address_space);
  execv(command[0], command.data());
  _exit(126);
}

/// Both ends of a pipe, or of a pseudo-terminal: where to read, and where the program writes.
std::pair<int, int> stream_ends(bool terminal) {
  if (!terminal) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    return {ends[0], ends[1]};
  }
  const int reader = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  const bool given = reader >= 0 && grantpt(reader) == 0 && unlockpt(reader) == 0;
  const char* name = given ? ptsname(reader) : nullptr;
  const int writer = name != nullptr ? open(name, O_RDWR | O_NOCTTY | O_CLOEXEC) : -1;
  if (writer < 0) {
    if (reader >= 0) close(reader);
    throw std::runtime_error("no terminal");
  }
  return {reader, writer};
}

bool is_staging(const fs::path& name) {
  const std::string text = name.filename().string();
  return text.starts_with('.') && text.find(".part-") != std::string::npos;
}

}  // namespace

Process::Process(const fs::path& folder, const std::vector<std::string>& command,
                 const ProcessLimits& limits) {
  const auto [reader, writer] = stream_ends(limits.terminal);
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  pid_ = fork();
  if (pid_ == 0) become(folder, words, writer, limits);
  close(writer);
  err_ = reader;
  if (pid_ < 0) throw std::runtime_error("no process");
}

Process::~Process() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  close(err_);
}

void Process::signal(int number) {
  if (!signalled_) signalled_ = std::chrono::steady_clock::now();
  kill(pid_, number);
}

bool Process::ended() const {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         info.si_pid == pid_;
}

Ending Process::wait() {
  Ending ending;
  char buffer[4096];
  for (;;) {
    const ssize_t n = read(err_, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    ending.err.append(buffer, static_cast<std::size_t>(n));
  }
  int status = 0;
  waitpid(pid_, &status, 0);
  pid_ = -1;
  if (signalled_) ending.after_signal = std::chrono::steady_clock::now() - *signalled_;
  ending.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return ending;
}

bool has_terminals() {
  try {
    const auto [reader, writer] = stream_ends(true);
    close(writer);
    close(reader);
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

std::map<std::string, std::string> snapshot(const fs::path& folder) {
  std::map<std::string, std::string> contents;
  if (!fs::exists(folder)) return contents;
  for (auto at = fs::recursive_directory_iterator(folder); at != fs::recursive_directory_iterator();
       ++at) {
    const std::string name = fs::relative(at->path(), folder).string();
    if (at->is_directory()) {
      if (is_staging(at->path())) {
        at.disable_recursion_pending();
        continue;
      }
      contents[name + "/"];
      continue;
    }
    contents[name] = bytes_of(at->path());
  }
  return contents;
}

std::vector<fs::path> staging_folders(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (is_staging(entry.path())) found.push_back(entry.path());
  return found;
}

bool wait_for_staging(const fs::path& folder, const Process& process) {
  while (staging_folders(folder).empty()) {
    if (process.ended()) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

}  // namespace tetropolis::testing
