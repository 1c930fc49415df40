#include <algorithm>
#include <span>
#include <system_error>
#include <utility>

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

std::vector<fs::path> clouds_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    // Hidden ones are what other systems keep beside a file ("._a.laz"), or parts of a download.
    if (has_las_extension(entry->path()) && !entry->is_directory() &&
        !entry->path().filename().string().starts_with('.'))
      files.push_back(entry->path());
  if (error) fail_input(folder, "the folder cannot be read: " + error.message());
  if (files.empty()) fail_input(folder, "the folder holds no .las or .laz files");
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

void add(const fs::path& path, std::vector<fs::path>& result) {
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    result.push_back(path);
    return;
  }
  const std::vector<fs::path> files = clouds_in(path);
  result.insert(result.end(), files.begin(), files.end());
}

}  // namespace

std::vector<fs::path> expand_point_paths(std::span<const std::string> arguments) {
  std::vector<fs::path> found;
  for (const std::string& argument : arguments) {
    std::error_code error;
    if (fs::exists(argument, error)) {
      add(argument, found);
      continue;
    }
    if (argument.find_first_of("*?[") == std::string::npos)
      fail_input(argument, "no such file or folder; check the path");
    const std::vector<fs::path> matches = matches_of(argument);
    if (matches.empty()) fail_input(argument, "matches no file; check the pattern");
    for (const fs::path& match : matches) add(match, found);
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
