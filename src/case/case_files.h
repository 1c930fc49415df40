// What the makers of cases share. Private to src/case.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tetropolis/case/wind.h"

namespace tetropolis {

/// `text` with each word replaced by its value.
std::string replaced(std::string text, const std::map<std::string, std::string>& words);

/// Throws Error(kUsage) naming the option: "wind_speed: 0 is not above 0".
void require_positive(const char* option, double value);
void require_wind(const Wind& wind);

/// Name below the folder, and what makes its text: fields are as large as meshes.
using CaseFile = std::pair<std::string, std::function<std::string()>>;

/// Throws Error(kUsage) for a file that is there.
void require_new(const std::filesystem::path& folder, const std::vector<CaseFile>& files);

/// Removes Allrun and programs among the files: a folder with them is a whole case.
void remove_scripts(const std::filesystem::path& folder, const std::vector<CaseFile>& files);

/// Writes the files, each complete or not at all, over those that are there. Throws Error(kInput)
/// if one cannot be written.
void write_case_files(const std::filesystem::path& folder, const std::vector<CaseFile>& files);

}  // namespace tetropolis
