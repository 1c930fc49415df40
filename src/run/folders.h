// What runs ask of the system's folders. Private to src/run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/descriptor.h"

namespace tetropolis {

/// Links count for themselves. What cannot be looked at is not there: moving it would fail too.
bool exists_itself(const std::filesystem::path& path);

/// Absolute, without links as far as there is anything; where the system refuses, as it is spelt.
std::filesystem::path real_path(const std::filesystem::path& path);

/// Whether files can be renamed from one of two folders to the other, as far as the system tells.
bool same_mount(const std::filesystem::path& a, const std::filesystem::path& b);

bool can_make_files_in(const std::filesystem::path& folder);

/// Opens a folder and locks it against other processes. Not good, and errno, if it is locked and
/// not waited for, or cannot be.
Descriptor lock_folder(const std::filesystem::path& folder, bool wait = false);

/// A new folder with the permissions that folders of this process usually have: mkdtemp's are
/// private. Its name is `prefix` and six random characters. False, and errno, where it fails.
bool make_random_folder(const std::filesystem::path& home, const std::string& prefix,
                        std::filesystem::path& made);

/// Whether that made it for this user, by its name.
bool is_random_folder(const std::filesystem::path& folder, const std::string& prefix);

/// The folders from the innermost up to `created`, none if that is empty.
std::vector<std::filesystem::path> folders_up_to(const std::filesystem::path& innermost,
                                                 const std::filesystem::path& created);

/// Removes folders made for a run, one around the other, while they are empty. For signal handlers.
void remove_empty(const std::vector<std::filesystem::path>& folders);

/// Removes a folder with all in it, while others may still write there. For signal handlers: system
/// calls and nothing else, as a signal may have come while its thread held the lock of the heap.
void remove_from_handler(const std::filesystem::path& folder);

}  // namespace tetropolis
