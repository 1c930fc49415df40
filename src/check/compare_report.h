// What the files of a folder hold, against what its report.json says of them. What differs becomes
// a violation of the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tetropolis/check/check_city.h"
#include "tetropolis/check/check_results.h"
#include "tetropolis/check/check_surface.h"
#include "tetropolis/check/check_volume.h"
#include "tetropolis/city/city_model.h"
#include "tetropolis/io/raster/geotiff.h"
#include "tetropolis/io/vector/vector.h"

#include "reported_run.h"

namespace tetropolis {

/// A number of the report that the files must bear out: between `low` and `high`.
void compare(const std::string& what, double reported, double low, double found, double high,
             CheckedFile& file);

/// The same for a whole number.
void compare_count(const std::string& what, std::int64_t reported, std::size_t found,
                   CheckedFile& file);

/// Counts, volume, angles, aspect ratios and faces of a volume and its boundary.
void compare_mesh(const Report& report, const VolumeCheck& volume, const SurfaceCheck& surface,
                  CheckedFile& file);

/// Guarantee 1 needs the number of input features, which only the report knows.
void compare_account(const CityModel& city, const std::optional<ReportedRun>& report,
                     CheckedFile& file);

/// Whether both models, the raw one and the final one, are of the same features.
void compare_features(const CityModel& raw, const CityModel& city, CheckedFile& file);

/// Whether the final model is the one that the report tells of. `check` is that of the city.
void compare_city(const CityModel& city, const CityCheck& check, const ReportedRun& report,
                  CheckedFile& file);

/// Whether the terrain is in the system of the report and of the city, and its step the one that
/// was asked for.
void compare_terrain(const RasterInput& terrain, const CityModel& city,
                     const std::optional<ReportedRun>& report, CheckedFile& file);

/// Whether the layers of a city (city_layers.h) have a feature for each building and footprint.
/// Precondition: the report has a city.
void compare_layers(const std::vector<VectorLayer>& layers, const Report& report,
                    CheckedFile& file);

/// Whether the boundary reaches to the sides of the domain.
void compare_domain(const SurfaceCheck& surface, const std::optional<ReportedRun>& report,
                    CheckedFile& file);

/// What a mesh file says of its place, if it does.
void compare_origin(const std::optional<Point3>& origin, const std::optional<ReportedRun>& report,
                    CheckedFile& file);

}  // namespace tetropolis
