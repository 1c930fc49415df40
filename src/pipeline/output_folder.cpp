#include "tetropolis/pipeline/output_folder.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <vector>

#include <stdlib.h>  // mkdtemp
#include <sys/stat.h>

#include "tetropolis/core/error.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// Every name a command may give to a result.
constexpr std::array kResultNames = {
    "city_raw.city.json", "city.city.json", "dtm.tif",           "volume.vtu",   "volume.xdmf",
    "volume.h5",          "volume.msh",     "constant/polyMesh", "boundary.vtp", "surface.stl",
    "surface.obj",        "surface.ply",    "surface.glb",       "report.json"};

/// What was written, relative to the folder: its files, and of its folders (constant) the entries
/// (polyMesh), since a folder of that name in the target may hold files of the user. The report
/// vouches for the others, so it comes last.
std::vector<fs::path> results_below(const fs::path& staging) {
  std::vector<fs::path> names;
  for (const auto& entry : fs::directory_iterator(staging)) {
    const fs::path name = entry.path().filename();
    if (!entry.is_directory()) names.push_back(name);
    if (entry.is_directory())
      for (const auto& inner : fs::directory_iterator(entry))
        names.push_back(name / inner.path().filename());
  }
  std::sort(names.begin(), names.end(), [](const fs::path& a, const fs::path& b) {
    return std::pair(a == "report.json", a) < std::pair(b == "report.json", b);
  });
  return names;
}

[[noreturn]] void fail(const fs::path& target, const std::string& reason) {
  throw Error(ErrorKind::kUsage, target.string() + ": cannot be written: " + reason +
                                     "; choose another folder with --out");
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& target) {
  if (target.empty()) fail("--out", "no folder given");
  target_ = fs::absolute(target).lexically_normal();
  if (!target_.has_filename()) target_ = target_.parent_path();
  std::error_code error;
  if (fs::exists(target_, error) && !fs::is_directory(target_, error)) fail(target, "it is a file");
  const fs::path parent = target_.parent_path();
  for (fs::path p = parent; !fs::exists(p, error) && p.has_relative_path(); p = p.parent_path())
    created_parent_ = p;
  fs::create_directories(parent, error);
  if (error) {
    if (!created_parent_.empty()) {
      std::error_code ignored;
      fs::remove(created_parent_, ignored);
    }
    fail(target, error.message());
  }
  std::string pattern = (parent / ("." + target_.filename().string() + ".part-XXXXXX")).string();
  if (mkdtemp(pattern.data()) == nullptr) fail(target, std::strerror(errno));
  staging_ = pattern;
  // An existing target must be writable itself: find out before the work, not after it.
  if (fs::exists(target_, error)) {
    std::string probe = (target_ / ".probe-XXXXXX").string();
    const int file = mkstemp(probe.data());
    if (file < 0) {
      const std::string reason = std::strerror(errno);
      fs::remove_all(staging_, error);
      fail(target, reason);
    }
    fs::remove(probe, error);
  }
  // mkdtemp makes private folders; results get the usual permissions.
  const mode_t mask = umask(0);
  umask(mask);
  chmod(staging_.c_str(), 0777 & ~mask);
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  fs::remove_all(staging_, ignored);
  if (!committed_ && !created_parent_.empty()) {
    // Only folders made for this run, and only while they are empty.
    for (fs::path p = target_.parent_path(); fs::remove(p, ignored) && p != created_parent_;)
      p = p.parent_path();
  }
}

void OutputFolder::commit() {
  std::error_code error;
  const auto check = [&](const fs::path& path) {
    if (error)
      throw Error(ErrorKind::kInput, path.string() + ": cannot be written: " + error.message());
  };
  if (!fs::exists(target_)) {
    fs::rename(staging_, target_, error);
    check(target_);
  } else {
    const std::vector<fs::path> names = results_below(staging_);
    for (const char* name : kResultNames) {
      if (std::find(names.begin(), names.end(), name) != names.end()) continue;
      fs::remove_all(target_ / name, error);
      check(target_ / name);
    }
    for (const fs::path& name : names) {
      fs::create_directories((target_ / name).parent_path(), error);
      check(target_ / name);
      if (fs::is_directory(target_ / name)) fs::remove_all(target_ / name, error);
      fs::rename(staging_ / name, target_ / name, error);
      check(target_ / name);
    }
  }
  committed_ = true;
}

}  // namespace tetropolis
