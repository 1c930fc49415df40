# LASzip::laszip, the LASzip DLL interface (laszip_api.h); the Debian package ships no CMake config.
find_path(LASzip_INCLUDE_DIR laszip/laszip_api.h)
find_library(LASzip_LIBRARY NAMES laszip)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LASzip REQUIRED_VARS LASzip_LIBRARY LASzip_INCLUDE_DIR)
if(LASzip_FOUND AND NOT TARGET LASzip::laszip)
  add_library(LASzip::laszip UNKNOWN IMPORTED)
  set_target_properties(LASzip::laszip PROPERTIES
    IMPORTED_LOCATION ${LASzip_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${LASzip_INCLUDE_DIR})
endif()
mark_as_advanced(LASzip_INCLUDE_DIR LASzip_LIBRARY)
