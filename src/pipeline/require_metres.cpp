#include "require_metres.h"

#include <string>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/crs.h"

namespace tetropolis {

void require_metres(const std::string& crs, const std::string& file, const char* setting) {
  if (crs.empty()) return;
  if (is_geographic(crs))
    throw Error(
        ErrorKind::kInput,
        fmt::format(
            "{}: coordinates are degrees ({}); reproject to a metric CRS{}", file, crs_name(crs),
            setting == nullptr ? "" : fmt::format(", or name the true one with {}", setting)));
  const double unit = linear_unit_metres(crs);
  if (!is_metre(unit))
    throw Error(
        ErrorKind::kInput,
        fmt::format("{}: coordinates are in units of {} m ({}); reproject to a CRS in metres", file,
                    unit, crs_name(crs)));
}

void require_heights_in_metres(double unit, const std::string& source, const char* setting) {
  if (is_metre(unit)) return;
  const std::string what = unit < 0 ? "heights are depths, counted downwards"
                                    : fmt::format("heights are in units of {} m", unit);
  const std::string other = setting == nullptr
                                ? ""
                                : fmt::format(
                                      ", or name a CRS whose heights are metres upwards with {} if "
                                      "that is what they are",
                                      setting);
  throw Error(ErrorKind::kInput,
              fmt::format("{}: {}; convert them to heights in metres{}", source, what, other));
}

}  // namespace tetropolis
