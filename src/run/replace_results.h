// New results in the place of earlier ones, all or none. Private to src/run.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

namespace tetropolis {

/// Throws Error(kUsage) if `target` has a folder of the name of a result: it would be replaced with
/// all in it.
void require_no_folder(const std::filesystem::path& target, const std::filesystem::path& name);

/// Throws Error(kUsage) naming a file in `target` that has one of these names and that no report of
/// ours there lists.
void require_ours(const std::filesystem::path& target,
                  const std::vector<std::filesystem::path>& names);

/// The files that were written, relative to the folder: a folder in it (constant/polyMesh) may hold
/// files of the user in the target. The report comes last.
std::vector<std::filesystem::path> results_below(const std::filesystem::path& folder);

/// Moves the results in the hidden folder `staging` to `target`, which is there and locked, but for
/// `kept` (relative to it), which stay. Earlier results are moved aside first, the report before
/// all others; the new report comes last. Throws Error(kInput) if one is gone or cannot be moved:
/// then all moves are undone, or `torn` is true and part of the earlier results in `staging`;
/// Error(kUsage), before anything is moved, for a result that would replace what is kept or, unless
/// `overwrite` is set, a file that is no earlier result.
void replace_results(const std::filesystem::path& staging, const std::filesystem::path& target,
                     std::span<const std::filesystem::path> kept, bool overwrite, bool& torn);

/// Puts back what a killed replace_results() had moved aside; false if something is in the way, or
/// there are no handles or memory for it. May itself be killed and run again. Waits for other runs
/// that may be moving their results to the target.
bool restore_earlier(const std::filesystem::path& staging, const std::filesystem::path& target);

}  // namespace tetropolis
