#include <algorithm>
#include <cstdint>
#include <span>
#include <system_error>

#include <fmt/format.h>

#include "tetropolis/io/las/las.h"

#include "core/text.h"
#include "io/file/input_file.h"
#include "io/file/input_paths.h"

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

/// Point files in folders below `folder`, but for hidden ones; not all where there are very many.
/// What cannot be read is passed over.
std::vector<fs::path> clouds_below(const fs::path& folder) {
  constexpr int kDeepest = 3, kMostEntries = 100'000;
  constexpr auto kOptions = fs::directory_options::skip_permission_denied;
  std::vector<fs::path> files;
  std::error_code error;
  int seen = 0;
  for (fs::recursive_directory_iterator entry(folder, kOptions, error), end;
       !error && entry != end && seen < kMostEntries; entry.increment(error), ++seen) {
    if (entry.depth() >= kDeepest || entry->path().filename().string().starts_with('.'))
      entry.disable_recursion_pending();
    if (entry.depth() > 0 && is_cloud(*entry)) files.push_back(entry->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<fs::path> clouds_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (is_cloud(*entry)) files.push_back(entry->path());
  if (error) fail_input(folder, "the folder cannot be read: " + error.message());
  if (!files.empty()) return files;
  const std::vector<fs::path> below = clouds_below(folder);
  fail_input(folder,
             below.empty()
                 ? std::string("the folder has no .las or .laz files")
                 : fmt::format("the folder has no .las or .laz files, but folders in it do; "
                               "name those ({})",
                               below.front().parent_path().string()));
}

/// `keys`: canonical paths of all files that are read, ascending.
void warn_of_files_below(const fs::path& folder, const std::vector<fs::path>& keys,
                         std::vector<Warning>& warnings) {
  std::int64_t count = 0;
  fs::path first;
  for (const fs::path& file : clouds_below(folder)) {
    std::error_code error;
    const fs::path key = fs::canonical(file, error);
    if (error || std::binary_search(keys.begin(), keys.end(), key)) continue;
    if (count++ == 0) first = file.parent_path();
  }
  if (count > 0)
    warnings.push_back(
        {"points_in_subfolders", count,
         fmt::format(
             "{}: {} point files in its subfolders are not read; name the subfolders to read "
             "them (first: {})",
             folder.string(), count, first.string())});
}

}  // namespace

std::vector<fs::path> expand_point_paths(std::span<const std::string> arguments,
                                         std::vector<Warning>* warnings) {
  std::vector<fs::path> folders;
  std::vector<fs::path> result =
      expand_paths_with(arguments, [&](const fs::path& path, std::vector<fs::path>& files) {
        std::error_code error;
        if (!fs::is_directory(path, error)) {
          files.push_back(path);
          return;
        }
        const std::vector<fs::path> inside = clouds_in(path);
        files.insert(files.end(), inside.begin(), inside.end());
        folders.push_back(path);
      });
  if (warnings == nullptr || folders.empty()) return result;
  std::vector<fs::path> keys;
  std::error_code error;
  for (const fs::path& path : result) keys.push_back(fs::canonical(path, error));
  for (const fs::path& folder : folders) warn_of_files_below(folder, keys, *warnings);
  return result;
}

}  // namespace tetropolis
