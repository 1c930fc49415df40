# Included for the wheel (TETROPOLIS_WHEEL, the prefix of build-deps): program and module share the library, which
# holds the static libraries of that prefix and shows none of their symbols; data of GDAL and PROJ go beside it, where
# src/io/crs/data_folders.cpp looks.
set(wheel_install COMPONENT python)
set_property(TARGET tetropolis PROPERTY VERSION)  # a wheel has no symbolic links
set_property(TARGET tetropolis PROPERTY SOVERSION)
target_link_options(tetropolis PRIVATE -Wl,--exclude-libs,ALL -Wl,--gc-sections)
target_link_options(tetropolis_cli PRIVATE -Wl,--exclude-libs,ALL -Wl,--gc-sections)
set_target_properties(tetropolis tetropolis_cli _core PROPERTIES BUILD_RPATH_USE_ORIGIN ON)
set_property(TARGET _core PROPERTY INSTALL_RPATH "$ORIGIN/lib")
set_property(TARGET tetropolis_cli PROPERTY INSTALL_RPATH "$ORIGIN/../lib")
set_property(TARGET tetropolis PROPERTY INSTALL_RPATH "${TETROPOLIS_WHEEL}/lib")  # auditwheel takes them from there
install(TARGETS tetropolis LIBRARY DESTINATION tetropolis/lib ${wheel_install})

set(data tetropolis/share/tetropolis)
install(FILES ${TETROPOLIS_WHEEL}/share/proj/proj.db ${TETROPOLIS_WHEEL}/share/proj/proj.ini
  DESTINATION ${data}/proj ${wheel_install})
# Of the drivers that are in it.
install(DIRECTORY ${TETROPOLIS_WHEEL}/share/gdal/ DESTINATION ${data}/gdal ${wheel_install}
  FILES_MATCHING PATTERN "*.gfs" PATTERN "*.wkt" PATTERN "gml_registry.xml" PATTERN "osmconf.ini"
  PATTERN "gt_*.csv" PATTERN "stateplane.csv")
# The licences of all of them.
install(FILES ${TETROPOLIS_WHEEL}/share/THIRD_PARTY_LICENSES.txt DESTINATION ${SKBUILD_METADATA_DIR}/licenses
  ${wheel_install})
