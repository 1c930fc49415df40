// The page that shows a run.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/io/page/page.h"
#include "tetropolis/pipeline/build_city.h"
#include "tetropolis/run/config.h"
#include "tetropolis/run/output_folder.h"
#include "tetropolis/run/report.h"

namespace tetropolis {

/// The buildings of `built.raw`, and those of `built.footprints` that did not become one though
/// they meet the domain, with what became of them in `built.city`.
std::vector<PageFootprint> page_footprints(const BuiltCity& built);

/// Ground and roofs of a city of which there is no mesh. Of `hooks` those of the page alone.
PageMesh page_preview(const CityModel& city, const Raster& terrain, const StepHooks& hooks = {});

/// The page of a run. `mesh` may be nullptr. `repeat`: PageContents::repeat.
std::string page_of(const CityModel& city, const PageMesh* mesh,
                    std::span<const PageFootprint> footprints, Report report, std::string repeat);

/// Writes index.html. `report`: as it is so far.
void write_page(const Config& config, const CityModel& city, const PageMesh& mesh,
                std::span<const PageFootprint> footprints, Report report, OutputFolder& out);

}  // namespace tetropolis
