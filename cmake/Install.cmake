# cmake --install: library, headers, package files; consumers say find_package(tetropolis).
include(CMakePackageConfigHelpers)

install(TARGETS tetropolis EXPORT tetropolis_targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT program NAMELINK_COMPONENT development)
install(DIRECTORY include/tetropolis DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(FILES ${PROJECT_BINARY_DIR}/include/tetropolis/core/version.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tetropolis/core COMPONENT development)
install(EXPORT tetropolis_targets FILE tetropolisTargets.cmake NAMESPACE tetropolis::
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tetropolis COMPONENT development)
configure_package_config_file(cmake/tetropolisConfig.cmake.in
  ${PROJECT_BINARY_DIR}/tetropolisConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tetropolis)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/tetropolisConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/tetropolisConfig.cmake
  ${PROJECT_BINARY_DIR}/tetropolisConfigVersion.cmake cmake/FindLASzip.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tetropolis COMPONENT development)
