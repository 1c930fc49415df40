// Runs the program under limits and signals, and says what it left behind.
#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <sys/resource.h>
#include <sys/types.h>

namespace tetropolis::testing {

/// Writes a file, and the folders above it.
inline void put(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

struct ProcessLimits {
  rlim_t file_size = RLIM_INFINITY;      ///< Bytes; what goes beyond fails with EFBIG.
  rlim_t address_space = RLIM_INFINITY;  ///< Bytes; what goes beyond finds no memory.
  bool unprivileged = false;             ///< Give root away, so that permissions count.
  bool terminal = false;                 ///< stderr is a terminal, which ends lines with "\r\n".
};

/// How a process ended: the exit code, or 128 + the signal that killed it.
struct Ending {
  int code = -1;
  std::string err;  ///< All of stderr.
  /// From the first signal to the end; 0 without.
  std::chrono::duration<double> after_signal{};
};

/// A running program; stderr goes into a pipe or a terminal, so that limits of files do not touch
/// it.
class Process {
 public:
  Process(const std::filesystem::path& folder, const std::vector<std::string>& command,
          const ProcessLimits& limits = {});
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void signal(int number);
  bool ended() const;  ///< Without waiting.
  Ending wait();

 private:
  pid_t pid_ = -1;
  int err_ = -1;
  std::optional<std::chrono::steady_clock::time_point> signalled_;
};

/// Whether there can be terminals here: some containers have none.
bool has_terminals();

/// The contents of every file below, by relative path; folders with a slash at the end. Hidden
/// folders of runs (".NAME.part-...") are left out.
std::map<std::string, std::string> snapshot(const std::filesystem::path& folder);

/// Hidden folders of runs in `folder`.
std::vector<std::filesystem::path> staging_folders(const std::filesystem::path& folder);

/// Waits until a run has made its hidden folder, or has ended; false if it ended first.
bool wait_for_staging(const std::filesystem::path& folder, const Process& process);

}  // namespace tetropolis::testing
