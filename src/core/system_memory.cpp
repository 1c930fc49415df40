#include "tetropolis/core/system_memory.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <sys/resource.h>
#include <unistd.h>

#include "infinity.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

constexpr double kNoLimit = kInfinity;

/// A file of the control group file system: a number, or "max" for none.
double read_limit(const fs::path& file) {
  double limit = 0;
  return std::ifstream(file) >> limit ? limit : kNoLimit;
}

/// The least limit of a group and those above it.
double least_limit(const fs::path& mount, const fs::path& group, const char* file) {
  double least = read_limit(mount / file);
  // Inside a container the group may be named as it is seen from outside, where no folder is.
  for (fs::path part = group.relative_path(); !part.empty(); part = part.parent_path())
    least = std::min(least, read_limit(mount / part / file));
  return least;
}

/// Of both versions of control groups; lines of /proc/self/cgroup are "ID:CONTROLLERS:PATH".
double control_group_limit() {
  double least = kNoLimit;
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const fs::path group = line.substr(second + 1);
    if (controllers == ",,")
      least = std::min(least, least_limit("/sys/fs/cgroup", group, "memory.max"));
    else if (controllers.find(",memory,") != std::string::npos)
      least = std::min(least, least_limit("/sys/fs/cgroup/memory", group, "memory.limit_in_bytes"));
  }
  return least;
}

double address_space_limit() {
  rlimit limit{};
  const bool limited = getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  return limited ? static_cast<double>(limit.rlim_cur) : kNoLimit;
}

}  // namespace

double usable_memory() {
  const double machine =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  return std::min({machine, control_group_limit(), address_space_limit()});
}

double address_space_left() {
  const double limit = address_space_limit();
  double pages = 0;  // of the process, the first number of its statm
  if (limit == kNoLimit || !(std::ifstream("/proc/self/statm") >> pages)) return kNoLimit;
  return limit - pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

std::int64_t peak_rss_bytes() {
  // Of this program: what getrusage tells includes the caller's until it started this one.
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::strtoll(line.c_str() + 6, nullptr, 10) * 1024;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace tetropolis
