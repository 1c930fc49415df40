// A city as Python holds it.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "tetropolis/city/raise_roofs.h"
#include "tetropolis/pipeline/wind_domain.h"
#include "tetropolis/run/in_memory.h"

namespace tetropolis::python {

/// NumPy writes to h_roof behind our back: parts, and the top of a fitted domain, follow when
/// somebody asks for them.
struct City : CityInMemory {
  City() = default;
  explicit City(CityInMemory city)
      : CityInMemory(std::move(city)),
        h_roof(roof_heights(built.city)),
        raw_h_roof(roof_heights(built.raw)) {}

  void settle() {
    CityModel& city = built.city;
    const bool is_edited = roof_heights(city) != h_roof;
    follow_roof_heights(city, h_roof);
    if (is_edited && std::isfinite(city.domain_top))
      city.domain_top = std::max(city.domain_top, guideline_top(city));
    follow_roof_heights(built.raw, raw_h_roof);
  }

  std::vector<double> h_roof, raw_h_roof;  ///< That the parts belong to.
};

}  // namespace tetropolis::python
