// What an earlier run has left in a folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tetropolis {

/// Names that a report lists, as paths below its folder. Those that lead out of it are not
/// believed.
std::vector<std::string> names_below(const std::vector<std::string>& listed);

struct EarlierRun {
  std::vector<std::string> files;  ///< Its results, and its report.
  std::string started;             ///< As Report::started; "" if the report does not say.
};

/// The earlier run in the folder, by its report. No files without a report of ours: those of their
/// names are the user's then. Of the report, however large, only these members, and what makes it
/// ours, are kept in memory.
EarlierRun earlier_run(const std::filesystem::path& folder);

}  // namespace tetropolis
