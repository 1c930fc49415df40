# Flags as interface targets: developer warnings and sanitizers never reach a consumer.
if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

add_library(tetropolis_developer_flags INTERFACE)
if(TETROPOLIS_STRICT)
  target_compile_options(tetropolis_developer_flags INTERFACE
    -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-qual
    -Wdouble-promotion -Wformat=2 -Wundef -Werror)
  # GCC 12 warns of overlapping copies inside std::string that cannot happen (GCC bug 105651).
  target_compile_options(tetropolis_developer_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
endif()
if(TETROPOLIS_SANITIZE)
  target_compile_options(tetropolis_developer_flags INTERFACE
    -fsanitize=${TETROPOLIS_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(tetropolis_developer_flags INTERFACE -fsanitize=${TETROPOLIS_SANITIZE})
  if(TETROPOLIS_SANITIZE STREQUAL "thread")
    target_compile_definitions(tetropolis_developer_flags INTERFACE TETROPOLIS_PLAIN_THREADS)
  endif()
endif()
if(TETROPOLIS_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "TETROPOLIS_FUZZ needs Clang: add -DCMAKE_CXX_COMPILER=clang++, or run scripts/run-fuzzers")
  endif()
  target_compile_options(tetropolis_developer_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()
