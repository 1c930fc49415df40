// A city model as layers for GIS: one GeoPackage.
#pragma once

#include <filesystem>

#include "tetropolis/city/city_model.h"
#include "tetropolis/io/vector/vector.h"

namespace tetropolis {

/// Writes a GeoPackage with layers of polygons, CRS coordinates:
/// - "footprints": the footprints of the input as they were read, then those that are unusable
///   (without geometry), but for those outside the domain. All attributes of `footprints`, then
///   source_id; fate ("kept", "merged into b3", or "dropped: " and the reason); tetropolis_id of
///   the building in `city` that it is in; h_ground, h_roof, n_ground_points, n_roof_points and
///   flags of the footprint by itself, before merging. Of a footprint that the boundary cuts into
///   parts, these are of the first.
/// - "buildings": those of `city`: tetropolis_id; n_sources; source_ids (a JSON array); h_ground,
///   h_roof, n_ground_points, n_roof_points, flags.
/// - "parts", if there are any: tetropolis_id; part (from 0, in the building); source_id; lod
///   (name_of); slope and azimuth (degrees; azimuth clockwise from north, none of flat roofs); area
///   in the plan (m2); rmse (m, none without points); n_points; h_min and h_max (elevation of the
///   roof's lowest and highest corner, m).
/// - "dropped": source_id, cause (name_of), reason; the footprint, if there was one. Not those
///   outside the domain.
/// flags are names with commas between them. An attribute of the input that has the name of another
/// column, in whatever case, gets "_2", "_3", ... added; one without a name is "attribute". SQLite
/// has room for 1,900 of them; the rest is left out.
///
/// `raw`, `city`, `footprints`: as build_city returns them; ids are unique within each. Guarantees:
/// the same input gives the same bytes with the same GDAL; the file appears complete or not at all.
/// Errors: kInput if it cannot be written.
/// Source: OGC 12-128r18, GeoPackage Encoding Standard 1.3.1.
void write_city_layers(const std::filesystem::path& path, const CityModel& raw,
                       const CityModel& city, const FootprintsInput& footprints);

}  // namespace tetropolis
