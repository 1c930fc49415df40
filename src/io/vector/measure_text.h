// Heights and numbers of floors as people write them. Private to src/io.
#pragma once

#include <string_view>

namespace tetropolis {

/// Metres of a height: "12.5", "12,5 m", "15.5 meters", "574'", "40'6\"", "40 ft", "12 ft 6 in",
/// "~10"; of several ("10;12") the greatest. `unit`: metres per unit of numbers that name none. NaN
/// for anything else, and for what may be either of two ("1,234").
/// Source: the OpenStreetMap wiki, Map features/Units, and its usage.
double metres_of(std::string_view text, double unit);

/// A number of floors: "3", "2.5", of several ("3;4") the greatest; NaN for anything else.
double floors_of(std::string_view text);

}  // namespace tetropolis
