#include <algorithm>
#include <cstdint>
#include <span>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <glob.h>

#include "tetropolis/core/text.h"
#include "tetropolis/io/las.h"

#include "input_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

bool has_las_extension(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  return extension == ".las" || extension == ".laz";
}

bool is_cloud(const fs::directory_entry& entry) {
  // Hidden ones are what other systems keep beside a file ("._a.laz"), or parts of a download.
  std::error_code error;
  return has_las_extension(entry.path()) && !entry.is_directory(error) &&
         !entry.path().filename().string().starts_with('.');
}

/// A folder below that has point files, too, and how many there are in all of these. What cannot be
/// read is passed over.
struct Below {
  fs::path folder;
  std::int64_t files = 0;
};

Below clouds_below(const fs::path& folder) {
  constexpr int kDeepest = 3;
  constexpr auto kOptions = fs::directory_options::skip_permission_denied;
  Below below;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, kOptions, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry.depth() >= kDeepest) entry.disable_recursion_pending();
    if (entry.depth() == 0 || !is_cloud(*entry)) continue;
    const fs::path parent = entry->path().parent_path();
    if (below.files++ == 0 || parent < below.folder) below.folder = parent;
  }
  return below;
}

std::vector<fs::path> clouds_in(const fs::path& folder, std::vector<Warning>* warnings) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (is_cloud(*entry)) files.push_back(entry->path());
  if (error) fail_input(folder, "the folder cannot be read: " + error.message());
  if (!files.empty() && warnings == nullptr) return files;
  const Below below = clouds_below(folder);
  if (files.empty())
    fail_input(folder,
               below.files == 0
                   ? std::string("the folder holds no .las or .laz files")
                   : fmt::format("the folder holds no .las or .laz files, but folders in it do; "
                                 "name these ({})",
                                 below.folder.string()));
  if (below.files > 0)
    warnings->push_back(
        {"points_in_subfolders", below.files,
         fmt::format("{}: {} point files in folders below it are not read; name these folders if "
                     "they belong to the cloud (the first: {})",
                     folder.string(), below.files, below.folder.string())});
  return files;
}

std::vector<fs::path> matches_of(const std::string& pattern) {
  glob_t matches{};
  std::vector<fs::path> paths;
  if (::glob(pattern.c_str(), GLOB_NOSORT, nullptr, &matches) == 0)
    for (std::size_t i = 0; i < matches.gl_pathc; ++i) paths.emplace_back(matches.gl_pathv[i]);
  ::globfree(&matches);
  return paths;
}

void add(const fs::path& path, std::vector<fs::path>& result, std::vector<Warning>* warnings) {
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    result.push_back(path);
    return;
  }
  const std::vector<fs::path> files = clouds_in(path, warnings);
  result.insert(result.end(), files.begin(), files.end());
}

}  // namespace

std::vector<fs::path> expand_point_paths(std::span<const std::string> arguments,
                                         std::vector<Warning>* warnings) {
  std::vector<fs::path> found;
  for (const std::string& argument : arguments) {
    std::error_code error;
    if (fs::exists(argument, error)) {
      add(argument, found, warnings);
      continue;
    }
    if (argument.find_first_of("*?[") == std::string::npos)
      fail_input(argument, "no such file or folder; check the path");
    const std::vector<fs::path> matches = matches_of(argument);
    if (matches.empty()) fail_input(argument, "matches no file; check the pattern");
    for (const fs::path& match : matches) add(match, found, warnings);
  }
  std::vector<std::pair<fs::path, fs::path>> keyed;
  for (fs::path& path : found) {
    std::error_code error;
    fs::path key = fs::canonical(path, error);
    if (error) fail_input(path, "no such file; check the path");
    keyed.emplace_back(std::move(key), std::move(path));
  }
  std::sort(keyed.begin(), keyed.end());
  std::vector<fs::path> result;
  for (std::size_t i = 0; i < keyed.size(); ++i)
    if (i == 0 || keyed[i].first != keyed[i - 1].first)
      result.push_back(std::move(keyed[i].second));
  return result;
}

}  // namespace tetropolis
