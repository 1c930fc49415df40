// What is to be read of each point file, before its points are. Private to src/io.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "tetropolis/core/warning.h"
#include "tetropolis/io/las/las.h"

#include "las_header.h"

namespace tetropolis {

struct LasPlan {
  LasLayout layout;
  bool skip = false;       ///< Its box misses the crop.
  bool is_twin = false;    ///< Another file has the same points (quirks/las_twins.h).
  bool check_box = false;  ///< Points outside of its box are to be counted.
  std::vector<Warning> warnings;
};

/// Whether the header states a box.
bool is_sound(const LasInfo& info);

/// The header's box, grown by what rounding may have cut off.
Bounds2 header_box(const LasInfo& info);

/// One plan per file: its header and chunks are sound; it is passed over if its box, which some of
/// its points confirm, misses the crop. Throws Error(kInput) naming the first file that is not
/// sound.
std::vector<LasPlan> plan_files(std::span<const std::filesystem::path> paths,
                                const ReadPointsOptions& options);

}  // namespace tetropolis
