// Where GDAL and PROJ find their data. Private to src/io.
#pragma once

namespace tetropolis::gdal {

/// Packages that bring GDAL and PROJ along, such as the Python wheel, have the data of these beside
/// the library or program, in ../share/tetropolis/gdal and ../share/tetropolis/proj. Where they
/// are, these come before the folders that environment variables name, which other installations
/// set to data of other versions; grids are still found in the folders of PROJ_DATA. Elsewhere does
/// nothing. Call before other GDAL functions.
void use_own_data();

}  // namespace tetropolis::gdal
