#include "require_metres.h"

#include <cmath>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs.h"

namespace tetropolis {

void require_metres(const std::string& crs, const std::string& file, const char* option) {
  if (crs.empty()) return;
  if (is_geographic(crs))
    throw Error(
        ErrorKind::kInput,
        fmt::format(
            "{}: coordinates are degrees ({}); reproject to a metric CRS{}", file, crs_name(crs),
            option == nullptr ? "" : fmt::format(", or name the true one with {}", option)));
  const double unit = linear_unit_metres(crs);
  if (std::abs(unit - 1) > 1e-9)
    throw Error(
        ErrorKind::kInput,
        fmt::format("{}: coordinates are in units of {} m ({}); reproject to a CRS in metres", file,
                    unit, crs_name(crs)));
}

void require_heights_in_metres(double unit, const std::string& source, const char* option) {
  if (std::abs(unit - 1) <= 1e-9) return;
  if (unit < 0)
    throw Error(ErrorKind::kInput,
                fmt::format("{}: heights are depths, counted downwards; convert them to heights in "
                            "metres{}",
                            source,
                            option == nullptr ? ""
                                              : fmt::format(", or name a CRS whose heights count "
                                                            "upwards with {} if they do",
                                                            option)));
  throw Error(
      ErrorKind::kInput,
      fmt::format("{}: heights are in units of {} m; convert them to metres{}", source, unit,
                  option == nullptr ? ""
                                    : fmt::format(", or name a CRS whose heights are metres with "
                                                  "{} if that is what they are",
                                                  option)));
}

}  // namespace tetropolis
