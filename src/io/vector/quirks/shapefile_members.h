// Shapefiles whose members are missing, cut or of different exports. Private to src/io.
#pragma once

#include <filesystem>
#include <string>

#include "io/crs/gdal_support.h"

namespace tetropolis {

/// Throws Error(kInput) naming the file, if a member of the shapefile is shorter than its header
/// says (a download that was cut), or if the numbers of shapes by the header of the index and of
/// attribute records differ (members of two exports in one folder): GDAL silently reads as many
/// shapes as there are of both. Members that are missing, and tables without columns, are no defect
/// here. Does nothing for other files. Source: ESRI Shapefile Technical Description (1998); dBASE
/// III+ table header.
void require_whole_shapefile(const std::filesystem::path& path);

/// Whether GDAL can read all of a shapefile from a copy only: where the index (.shx) is missing, as
/// in downloads of the .shp alone (mapshaper's test data), and where the table has no columns, as
/// PostGIS writes it without attributes: such a table has no records either.
bool needs_copy(const std::filesystem::path& path);

/// Copies the members into memory, where GDAL may make the index; without a table that has no
/// columns. Returns the name of the copy for GDAL.
std::string copy_shapefile(const std::filesystem::path& path, const gdal::MemoryFolder& folder);

}  // namespace tetropolis
