// What a reader noticed about input that it could use nevertheless.
#pragma once

#include <cstdint>
#include <string>

namespace tetropolis {

/// One kind of oddity in one input. Goes to `warnings[]` of the report as it is.
struct Warning {
  std::string code;        ///< Stable, lower case with underscores ("footprints_crs_unknown").
  std::int64_t count = 1;  ///< How many points, features or cells it concerns.
  std::string message;     ///< One line that names the file.
};

}  // namespace tetropolis
