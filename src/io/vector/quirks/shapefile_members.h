// Whether the files of a shapefile fit together. Private to src/io.
#pragma once

#include <filesystem>

namespace tetropolis {

/// Throws Error(kInput) naming the file, if a member of the shapefile is shorter than its header
/// says (it was cut on the way), if the numbers of shapes by the header of the index and of
/// attribute records differ (GDAL reads what is there of the first and silently only as many shapes
/// as there are records of the second), or if the index names places that hold no shape of the
/// length it states, or one twice. Members that are missing, and tables without columns, are no
/// defect here. Does nothing for other files. Source: ESRI Shapefile Technical Description (1998);
/// dBASE III+ table header.
void require_whole_shapefile(const std::filesystem::path& path);

/// Whether the shapefile has a table without any column, as PostGIS writes it where there are no
/// attributes. Such a table has no records either, and GDAL would read no more shapes than these.
bool has_empty_table(const std::filesystem::path& path);

}  // namespace tetropolis
