// What several point files say of their reference systems together. Private to src/io.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "tetropolis/core/warning.h"
#include "tetropolis/io/las/las.h"

namespace tetropolis {

struct LasSystemOfFile {
  const std::filesystem::path* path;
  const LasInfo* info;
};

/// The horizontal system of the files that state one, as the first does; "" if none does. Error,
/// kInput with two files: they differ.
std::string common_crs(std::span<const LasSystemOfFile> files);

/// A warning, where files state vertical systems of different names: nothing converts heights, and
/// names may differ for one system.
std::optional<Warning> mixed_heights(std::span<const LasSystemOfFile> files);

}  // namespace tetropolis
