// What arguments of the command line name: files, folders of them, patterns. Private to src.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tetropolis {

/// Files of one kind, for folders.
struct FileKind {
  std::string_view plural;                    ///< "rasters", for messages.
  std::span<const std::string_view> endings;  ///< Lower case, with the dot.

  /// By the ending of its name, in any case.
  bool has(const std::filesystem::path& path) const;
};

/// Files as they are, folders as what has a name of the kind directly inside (but for hidden ones),
/// unless they have one themselves, and patterns. Sorted by absolute path; a file named twice
/// occurs once. Throws Error(kInput) with the argument: no such file, pattern without a match,
/// folder without any.
std::vector<std::filesystem::path> expand_paths(std::span<const std::string> arguments,
                                                const FileKind& kind);

/// Adds the files that a path stands for, which is there, to those there are.
using AddFiles =
    std::function<void(const std::filesystem::path&, std::vector<std::filesystem::path>&)>;

/// The same, with folders as `add` takes them.
std::vector<std::filesystem::path> expand_paths_with(std::span<const std::string> arguments,
                                                     const AddFiles& add);

/// Arguments as they were given, for messages about all of them: "tiles, and 3 more"; "" of none.
std::string given_text(std::span<const std::string> arguments);

}  // namespace tetropolis
