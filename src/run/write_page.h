// The page that shows a run.
#pragma once

#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/io/page/page.h"
#include "tetropolis/pipeline/build_city.h"
#include "tetropolis/run/config.h"
#include "tetropolis/run/output_folder.h"
#include "tetropolis/run/report.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// Features that have a place on the map; CRS coordinates.
std::vector<Footprint> features_near(const FootprintsInput& footprints, const PointsInput& points);

/// The buildings of `raw`, and those of `features` that did not become one though they meet the
/// domain, with what became of them in `city`.
std::vector<PageFootprint> page_footprints(const CityModel& raw, const CityModel& city,
                                           std::vector<Footprint> features);

/// Writes index.html. `report`: as it is so far.
void write_page(const Config& config, const CityModel& city, const ColumnMesh& mesh,
                std::span<const PageFootprint> footprints, Report report, OutputFolder& out);

}  // namespace tetropolis
