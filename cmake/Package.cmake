# cpack -G DEB (or TGZ) in the build folder: the packages `tetropolis`, program and documents, and
# `libtetropolis-dev`, static library, headers and CMake package, as Debian wants them.
set(CPACK_PACKAGE_NAME tetropolis)
set(CPACK_PACKAGE_VENDOR "the Tetropolis authors")
set(CPACK_PACKAGE_CONTACT "the Tetropolis authors <tetropolis@localhost>" CACHE STRING "Maintainer of packages")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "city meshes for simulation from footprints and LiDAR")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_COMPONENTS_GROUPING IGNORE)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# dpkg-shlibdeps sees what is linked. What is loaded later is in the packages of these files.
find_program(DPKG_QUERY dpkg-query)
if(TETROPOLIS_DEFERRED AND DPKG_QUERY)
  foreach(file ${gdal_file} ${proj_file} ${hdf5_file})
    execute_process(COMMAND ${DPKG_QUERY} -S ${file} OUTPUT_VARIABLE package ERROR_QUIET)
    if(package MATCHES "^([^:, ]+)")
      list(APPEND loaded ${CMAKE_MATCH_1})
    endif()
  endforeach()
  list(JOIN loaded ", " CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS)
endif()
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME tetropolis)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION
"Tetropolis turns building footprints and airborne LiDAR into a conforming
tetrahedral mesh of the air of a city, a watertight surface with tagged
ground, roofs and walls, a city model and the terrain. It runs unattended,
and every mesh that it writes is valid.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libtetropolis-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
# What find_package(tetropolis) finds and links.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libgdal-dev, libgeos-dev, libhdf5-dev, liblaszip-dev, libtbb-dev, \
zlib1g-dev, libbz2-dev, libproj-dev, libexpat1-dev, libfmt-dev, libtomlplusplus-dev, nlohmann-json3-dev")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION
"The library behind the program of the package tetropolis, as static library
with headers and a CMake package.")

# As Debian wants them: documents of both packages, compressed; completions of zsh in a folder of their own.
foreach(pair program:tetropolis development:libtetropolis-dev)
  string(REPLACE ":" ";" pair ${pair})
  list(GET pair 0 component)
  list(GET pair 1 package)
  install(FILES packaging/debian/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package}
    COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES CHANGELOG.md RENAME changelog DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package}
    COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/packaging/debian/arrange.cmake)
include(CPack)
