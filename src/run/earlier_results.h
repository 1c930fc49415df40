// What an earlier run has left in a folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tetropolis {

/// Names that a report lists, as paths below its folder. Those that lead out of it are not
/// believed.
std::vector<std::string> names_below(const std::vector<std::string>& listed);

/// The results of an earlier run in the folder, by its report, and that report. None without a
/// report of ours: files of their names are the user's then. Of the report, however large, only
/// these names, and what makes it ours, are kept in memory.
std::vector<std::string> earlier_results(const std::filesystem::path& folder);

}  // namespace tetropolis
