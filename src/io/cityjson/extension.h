// Our CityJSON extension, as docs/tetropolis.ext.json describes it. Private to src/io.
#pragma once

namespace tetropolis {

/// The root member that it adds.
inline constexpr const char* kExtensionMember = "+tetropolis";

inline constexpr const char* kExtensionVersion = "1.0";
inline constexpr const char* kExtensionUrl =
    "https://raw.githubusercontent.com/tetropolis/tetropolis/main/docs/tetropolis.ext.json";

}  // namespace tetropolis
