#include "las_agreement.h"

#include <cstdint>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/crs.h"

namespace tetropolis {

std::string common_crs(std::span<const LasSystemOfFile> files) {
  const LasSystemOfFile* first = nullptr;
  for (const LasSystemOfFile& file : files) {
    const std::string& crs = file.info->crs;
    if (crs.empty()) continue;
    if (first == nullptr)
      first = &file;
    else if (!same_horizontal_crs(first->info->crs, crs))
      throw Error(ErrorKind::kInput,
                  fmt::format("{} is in {}, but {} in {}; convert one, or name the CRS of all with "
                              "points_crs",
                              first->path->string(), first->info->crs.substr(0, 80),
                              file.path->string(), crs.substr(0, 80)));
  }
  return first == nullptr ? "" : first->info->crs;
}

std::optional<Warning> mixed_heights(std::span<const LasSystemOfFile> files) {
  const LasSystemOfFile* first = nullptr;
  const LasSystemOfFile* other = nullptr;
  std::int64_t count = 0;
  for (const LasSystemOfFile& file : files) {
    if (file.info->vertical_crs.empty()) continue;
    if (first == nullptr) first = &file;
    if (file.info->vertical_crs == first->info->vertical_crs) continue;
    if (other == nullptr) other = &file;
    ++count;
  }
  if (other == nullptr) return std::nullopt;
  return Warning{
      "las_heights_mixed", count,
      fmt::format(
          "{} has heights in {}, but {} in {}; heights are not converted, convert the files "
          "if these differ",
          first->path->string(), first->info->vertical_crs, other->path->string(),
          other->info->vertical_crs)};
}

}  // namespace tetropolis
