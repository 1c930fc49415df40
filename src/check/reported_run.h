// What report.json says that the other files of a folder must bear out.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tetropolis/run/report.h"

#include "volume/excavate/excavate.h"

namespace tetropolis {

/// A report, with what `check` derives from it. What the file lacks has its default.
struct ReportedRun {
  Report report;                     ///< `crs` normalised; `files` below the folder.
  std::vector<std::string> missing;  ///< As in ReadReport.
  bool has_origin = false, has_domain = false, has_crs = false;
  std::filesystem::path city_model, terrain;  ///< What `mesh` has read; empty for other commands.
  ExcavationSources excavated;                ///< Local frame.

  bool is_absolute() const { return report.config.coordinates == Coordinates::kAbsolute; }
  bool has_mesh() const { return report.volume_mesh.has_value(); }
  /// Whether the run made the city, so that all input features are to be accounted for.
  bool made_city() const { return report.input.has_value(); }
};

/// Of report.json in the folder, if there is one. Throws Error(kInput) if it is none of ours.
std::optional<ReportedRun> read_reported_run(const std::filesystem::path& folder);

}  // namespace tetropolis
