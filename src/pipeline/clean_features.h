// Step 1.4: which features of the footprints are buildings, and their outlines.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/progress.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/pipeline/build_city.h"

namespace tetropolis {

struct CleanFeatures {
  std::vector<Building> buildings;   ///< Without heights.
  std::vector<std::uint32_t> basis;  ///< Per building: the flag of what its attribute_height is.
  std::vector<Dropped> dropped;      ///< Those of the input first.
  /// What the footprints that are dropped for crossing the boundary have within the domain.
  std::vector<Polygon> crossing;
  std::int64_t parts = 0;  ///< That features were cut into, beyond the first of each.
  double area = 0;         ///< Of all features, where there are points, square metres.
  double area_lost = 0;    ///< Of those dropped at the boundary, where there are points.
};

/// Cleans the features that meet `domain`, and clips or drops those across its boundary, as
/// options.boundary_buildings says. `covered`, if the domain is the default one: the box of the
/// points; features of which it holds less than half are dropped, too, unless they are clipped.
/// `outline`, if the domain becomes a polygon: what is not inside is dropped.
/// Every feature ends in `buildings` or in `dropped`. Features that have lost parts are one
/// warning.
CleanFeatures clean_features(const BuildCityOptions& options, const FootprintsInput& input,
                             const Domain& domain, const std::optional<Bounds2>& covered,
                             const std::optional<Domain>& outline, std::vector<Warning>& warnings,
                             const Progress& progress);

}  // namespace tetropolis
