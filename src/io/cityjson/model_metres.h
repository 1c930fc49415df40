// Coordinates of city models of other programs, put into metres. Private to src/io.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

struct ModelMetres {
  std::string crs;         ///< In metres; "" if nobody says which.
  double height_unit = 1;  ///< Metres per unit of the heights that were given.
};

/// Puts points into a system in metres: degrees into their zone of UTM, feet into the same
/// projection. Heights have the unit of the vertical system that `stated` names, else that of the
/// plan. Points with degrees of latitude first are turned where no other order is possible.
/// `stated`: the system as the file spells it; `crs`: its canonical name, "" if it has none.
/// Throws Error(kInput) with the path for points that are none of the system.
ModelMetres put_into_metres(const std::filesystem::path& path, const std::string& stated,
                            const std::string& crs, std::vector<Point3>& points);

}  // namespace tetropolis
