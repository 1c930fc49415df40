// What an earlier run has left in a folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tetropolis {

/// A name that a report lists, as a path below its folder. None of one that leads out of it, which
/// is not believed.
std::optional<std::string> name_below(const std::string& listed);

/// The results of an earlier run in the folder, by its report, and that report. None without a
/// report of ours: files of their names are the user's then. Of the report, however large, only
/// these names are kept in memory.
std::vector<std::string> earlier_results(const std::filesystem::path& folder);

}  // namespace tetropolis
