// `tetropolis check`: written files against the guarantees.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tetropolis/check/violation.h"
#include "tetropolis/core/progress.h"

namespace tetropolis {

/// What was found in one file, or between files.
struct CheckedFile {
  std::string name;
  std::vector<std::string> facts;  ///< Lines for the reader.
  std::vector<Violation> violations;
  std::vector<std::string> not_checked;  ///< What it takes other files to see.
};

/// Checks a volume (.vtu, .xdmf), a boundary (.vtp, .xdmf) or a city_surface() (.vtp), a city model
/// (.json), or a folder of results: all of these that are in it, and in
/// addition that the boundary is that of the volume, that surface.vtp and surface.stl are made of
/// it, that footprints are in the mesh, that heights are those of the city model and the terrain,
/// and that numbers agree with report.json. Of the guarantees 1 to 6 (docs/quality.md),
/// one that is neither among the violations nor in `not_checked` holds in these files; the others
/// are about runs. Results of the folder in formats that are not read (volume.msh, surface.obj,
/// ...) are named in the facts of a last entry.
///
/// `min_distance`: clearance to ask of a city model, finite and not negative. Without it: of a file
/// named city_raw.city.json none; of others what report.json beside it says, else 1 m. Throws
/// Error(kInput) for files that cannot be read or are of no known kind, and for a folder whose
/// report.json is none of ours; beside a single city model that is told in `not_checked`.
std::vector<CheckedFile> check_path(const std::filesystem::path& path,
                                    std::optional<double> min_distance,
                                    const Progress& progress = {});

}  // namespace tetropolis
