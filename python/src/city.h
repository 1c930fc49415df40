// A city as Python holds it.
#pragma once

#include <utility>
#include <vector>

#include "tetropolis/city/raise_roofs.h"
#include "tetropolis/run/in_memory.h"

namespace tetropolis::python {

/// NumPy writes to h_roof behind our back: parts follow when somebody asks for them.
struct City : CityInMemory {
  City() = default;
  explicit City(CityInMemory city)
      : CityInMemory(std::move(city)),
        h_roof(roof_heights(built.city)),
        raw_h_roof(roof_heights(built.raw)) {}

  void settle() {
    follow_roof_heights(built.city, h_roof);
    follow_roof_heights(built.raw, raw_h_roof);
  }

  std::vector<double> h_roof, raw_h_roof;  ///< That the parts belong to.
};

}  // namespace tetropolis::python
