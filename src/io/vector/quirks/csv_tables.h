// CSV files of other programs. Private to src/io.
#pragma once

#include <filesystem>
#include <string>

#include "io/crs/gdal_support.h"

namespace tetropolis {

/// Opens a CSV file by the column of polygons, if it has one of the usual names (BigQuery's and
/// Google Open Buildings' geometry, PostGIS' the_geom and wkb_geometry, Earth Engine's .geo, ...);
/// GDAL itself knows only those that begin with WKT. Or else as lines of GeoJSON, which Microsoft's
/// building footprints are by the name of .csv.gz. `name`: of the file for GDAL; the options get
/// the column.
void find_polygons(const std::string& name, gdal::StringList& options, gdal::Dataset& dataset);

/// Throws Error(kInput) naming the line, if a CSV file has a quote that is not closed before its
/// end, or one within a field that swallows further lines: GDAL makes one feature of all these
/// lines (OSGeo/gdal#11660, a file of GeoNames; #11845). Quoted fields of several lines are fine.
/// `name`: of the file for GDAL. Source: RFC 4180; GDAL joins lines until the number of their
/// quotes is even.
void require_closed_quotes(const std::filesystem::path& path, const std::string& name);

}  // namespace tetropolis
