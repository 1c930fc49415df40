#include "input_paths.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glob.h>

#include "core/text.h"
#include "input_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// In no order.
std::vector<fs::path> matches_of(const std::string& pattern) {
  glob_t matches{};
  std::vector<fs::path> paths;
  if (::glob(pattern.c_str(), GLOB_NOSORT, nullptr, &matches) == 0)
    for (std::size_t i = 0; i < matches.gl_pathc; ++i) paths.emplace_back(matches.gl_pathv[i]);
  ::globfree(&matches);
  return paths;
}

void add_files(const fs::path& argument, const FileKind& kind, std::vector<fs::path>& files) {
  std::error_code error;
  const fs::path path = argument.has_filename() ? argument : argument.parent_path();
  // A folder whose name ends so is a file to those who made it (.gdb).
  if (!fs::is_directory(path, error) || kind.has(path)) {
    files.push_back(path);
    return;
  }
  const std::size_t before = files.size();
  for (fs::directory_iterator entry(path, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with('.') && kind.has(name)) files.push_back(entry->path());
  }
  if (error) fail_input(path, "the folder cannot be read: " + error.message());
  if (files.size() == before)
    fail_input(path, fmt::format("the folder has no {} ({}); name files", kind.plural,
                                 fmt::join(kind.endings, ", ")));
}

}  // namespace

bool FileKind::has(const fs::path& path) const {
  const std::string name = lower_case(path.filename().string());
  return std::any_of(endings.begin(), endings.end(),
                     [&](std::string_view ending) { return name.ends_with(ending); });
}

std::vector<fs::path> expand_paths(std::span<const std::string> arguments, const FileKind& kind) {
  return expand_paths_with(arguments, [&](const fs::path& path, std::vector<fs::path>& files) {
    add_files(path, kind, files);
  });
}

std::vector<fs::path> expand_paths_with(std::span<const std::string> arguments,
                                        const AddFiles& add) {
  std::vector<fs::path> files;
  for (const std::string& argument : arguments) {
    std::error_code error;
    if (fs::exists(argument, error)) {
      add(argument, files);
      continue;
    }
    if (argument.find_first_of("*?[") == std::string::npos)
      fail_input(argument, error ? "cannot be opened: " + error.message() + "; check the path"
                                 : "no such file or folder; check the path");
    const std::vector<fs::path> matches = matches_of(argument);
    if (matches.empty()) fail_input(argument, "matches no file; check the pattern");
    for (const fs::path& match : matches) add(match, files);
  }
  std::vector<std::pair<fs::path, fs::path>> keyed;
  for (fs::path& path : files) {
    std::error_code error;
    fs::path key = fs::canonical(path, error);
    if (error) fail_input(path, "no such file; check the path");
    keyed.emplace_back(std::move(key), std::move(path));
  }
  std::sort(keyed.begin(), keyed.end());
  files.clear();
  for (std::size_t i = 0; i < keyed.size(); ++i)
    if (i == 0 || keyed[i].first != keyed[i - 1].first) files.push_back(std::move(keyed[i].second));
  return files;
}

std::string given_text(std::span<const std::string> arguments) {
  if (arguments.empty()) return {};
  return arguments.size() == 1
             ? arguments.front()
             : fmt::format("{}, and {} more", arguments.front(), arguments.size() - 1);
}

}  // namespace tetropolis
