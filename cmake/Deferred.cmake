# GDAL, PROJ and HDF5 are loaded when first needed (src/io/deferred) where all three are shared libraries of Linux; else
# they are linked like the rest.

# Sets `result` to the full name of a shared library, which ends in its SONAME; to nothing where it has none.
function(file_of_soname library result)
  execute_process(COMMAND ${CMAKE_OBJDUMP} -p ${library} OUTPUT_VARIABLE headers ERROR_QUIET)
  set(${result} "" PARENT_SCOPE)
  if(headers MATCHES "SONAME +([^\n]+)")
    file(REAL_PATH ${library} real)
    cmake_path(REPLACE_FILENAME real ${CMAKE_MATCH_1})
    set(${result} ${real} PARENT_SCOPE)
  endif()
endfunction()

get_target_property(gdal_location GDAL::GDAL LOCATION)
get_target_property(proj_location PROJ::proj LOCATION)
list(GET HDF5_C_LIBRARIES 0 hdf5_location)
if(TARGET ${hdf5_location})
  get_target_property(hdf5_location ${hdf5_location} LOCATION)
endif()
set(TETROPOLIS_DEFERRED OFF)
if(CMAKE_SYSTEM_NAME STREQUAL Linux)
  set(TETROPOLIS_DEFERRED ON)
  foreach(library gdal proj hdf5)
    file_of_soname("${${library}_location}" ${library}_file)
    if(NOT ${library}_file)
      set(TETROPOLIS_DEFERRED OFF)
    endif()
  endforeach()
endif()
configure_file(src/io/deferred/library_names.h.in include/io/deferred/library_names.h @ONLY)
if(TETROPOLIS_DEFERRED)
  target_include_directories(tetropolis SYSTEM PRIVATE ${HDF5_C_INCLUDE_DIRS}
    $<TARGET_PROPERTY:GDAL::GDAL,INTERFACE_INCLUDE_DIRECTORIES>
    $<TARGET_PROPERTY:PROJ::proj,INTERFACE_INCLUDE_DIRECTORIES>)
  target_link_libraries(tetropolis PRIVATE ${CMAKE_DL_LIBS})
else()
  target_link_libraries(tetropolis PRIVATE GDAL::GDAL PROJ::proj HDF5::HDF5)
endif()
