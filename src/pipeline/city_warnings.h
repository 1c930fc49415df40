// What a run warns of when it has made a city model: data that is odd or seems to be missing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/extract.h"
#include "tetropolis/city/simplify/simplify.h"
#include "tetropolis/city/stated_roof.h"
#include "tetropolis/pipeline/build_city.h"
#include "tetropolis/terrain/dtm.h"

#include "city_input.h"
#include "clean_features.h"

namespace tetropolis {

// Each adds at most one warning to `warnings`, and none where all is as it should be.

/// Of nodes without ground points nearby, and of voids. `filtered`: the ground was found by the
/// filter.
void warn_of_terrain(const DtmReport& dtm, bool filtered, std::vector<Warning>& warnings);

/// Of a terrain that is far from the points of the ground, as of another vertical system or unit,
/// and of one that lies above the surface ("surface_below_terrain"), as if the two were swapped.
void warn_off_terrain(const CityInput& input, const Raster& terrain,
                      std::vector<Warning>& warnings);

/// Of footprints dropped at the domain's boundary that are more than 5 % of the area in it.
/// `has_cloud`: that there are points, and not of a raster.
void warn_of_boundary(const CleanFeatures& clean, bool has_cloud, std::vector<Warning>& warnings);

/// Of a country's footprints around a city, where nobody has said which box is wanted.
void warn_of_country(const CityModel& raw, const BuildCityOptions& options,
                     std::vector<Warning>& warnings);

/// A polygon that covers most of the domain is hardly a building, and swallows those in it.
void warn_of_giants(const CityModel& raw, std::vector<Warning>& warnings);

/// Where so many buildings have no roof points that it is not the buildings that are odd. `raw` has
/// heights.
void warn_of_missing_roofs(const CityModel& raw, std::vector<Warning>& warnings);

/// Heights that are stated and not measured. `raw` has heights; buildings that keep the roofs that
/// they state, `kept`, do not count.
void warn_of_stated_heights(const FootprintsInput& footprints, const CityModel& raw,
                            const BuildCityOptions& options, const StatedRoofs& kept,
                            std::vector<Warning>& warnings);

/// Stated heights that are averaged over blocks. `members`: of the buildings of `city` in `raw`;
/// both have heights.
void warn_of_averages(const CityModel& raw, const CityModel& city,
                      std::span<const std::vector<BuildingIndex>> members,
                      std::vector<Warning>& warnings);

/// Where the heights that features state differ from the measured ones as feet do from metres, or
/// by more than a third. `raw` has heights.
void warn_of_other_heights(const CityModel& raw, std::vector<Warning>& warnings);

/// Of features of the plan that do not show ("planned_left_out"), and of planned buildings that are
/// raised to the least height ("planned_raised"). `raw` and `city` have heights.
void warn_of_plan(const FootprintsInput& footprints, const CityModel& raw, const CityModel& city,
                  const BuildCityOptions& options, std::vector<Warning>& warnings);

/// Where roof points were told by what they are not. `all_points`: of the cloud.
void warn_of_exclusion(const BuildingPoints& points, std::int64_t all_points,
                       std::vector<Warning>& warnings);

/// Footprints of which little is as wide as the distance that they have to keep. `simple` is made
/// of those of `raw`.
void warn_of_lost_area(const CityModel& raw, const Simplification& simple,
                       std::vector<Warning>& warnings);

/// Where more than a quarter of the roofs stay below the LoD asked for, and where footprints have
/// the roofs of neighbours.
void warn_of_roofs(const RoofFacts& roofs, const CityModel& raw, Lod lod,
                   std::vector<Warning>& warnings);

}  // namespace tetropolis
