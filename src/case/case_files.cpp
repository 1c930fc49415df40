#include "case_files.h"

#include <cmath>
#include <cstddef>
#include <system_error>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/file/write_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

std::string replaced(std::string text, const std::map<std::string, std::string>& words) {
  for (const auto& [word, value] : words)
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += value.size())
      text.replace(at, word.size(), value);
  return text;
}

void require_positive(const char* option, double value) {
  if (!(value > 0) || !std::isfinite(value))
    throw Error(ErrorKind::kUsage, fmt::format("{}: {} is not above 0", option, value));
}

void require_wind(const Wind& wind) {
  if (wind.levels.empty()) require_positive("wind_speed", wind.speed);
  require_positive("wind_height", wind.height);
  require_positive("roughness", wind.roughness);
  if (!std::isfinite(wind.from) || std::abs(wind.from) > 360)
    throw Error(ErrorKind::kUsage,
                fmt::format("wind_from: {} is not between -360 and 360 degrees", wind.from));
  if (wind.levels.size() == 1)
    throw Error(ErrorKind::kUsage, "wind_profile: one level is no profile");
  WindLevel below;
  for (const WindLevel& level : wind.levels) {
    // Comparisons that no NaN passes.
    if (!(level.height > below.height && level.speed > below.speed && level.k > 0) ||
        !std::isfinite(level.height + level.speed + level.k))
      throw Error(ErrorKind::kUsage,
                  fmt::format("wind_profile: speed {} and k {} at {} m: levels go upwards, "
                              "with speeds that grow and k above 0",
                              level.speed, level.k, level.height));
    below = level;
  }
}

void require_new(const fs::path& folder, const std::vector<CaseFile>& files) {
  std::error_code error;
  for (const auto& [name, text] : files)
    if (fs::exists(fs::symlink_status(folder / name, error)))
      throw Error(ErrorKind::kUsage,
                  fmt::format("{}: exists already; replace the case with `overwrite`, or copy the "
                              "mesh into another folder",
                              (folder / name).string()));
}

void remove_scripts(const fs::path& folder, const std::vector<CaseFile>& files) {
  std::error_code error;
  for (const auto& [name, text] : files)
    if (name.ends_with("Allrun") || name.ends_with(".py")) fs::remove(folder / name, error);
}

void write_case_files(const fs::path& folder, const std::vector<CaseFile>& files) {
  std::error_code error;
  for (const auto& [name, text] : files) {
    fs::create_directories((folder / name).parent_path(), error);
    write_file(folder / name, text());
  }
}

}  // namespace tetropolis
