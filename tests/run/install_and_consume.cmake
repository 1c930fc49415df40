# Installs into a scratch prefix, builds the examples against it with find_package, and runs them:
# build_and_mesh on a synthetic city, whose mesh has to pass `check`.
set(prefix ${BINARY_DIR}/consume/prefix)
set(city ${BINARY_DIR}/consume/city)
file(REMOVE_RECURSE ${BINARY_DIR}/consume)
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE text ERROR_VARIABLE text)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGN} failed:\n${text}")
  endif()
endfunction()
run(${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${prefix})
foreach(example consumer build_and_mesh)
  set(build ${BINARY_DIR}/consume/${example})
  run(${CMAKE_COMMAND} -S ${SOURCE_DIR}/examples/${example} -B ${build} -G ${GENERATOR}
    -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_BUILD_TYPE=Release)
  run(${CMAKE_COMMAND} --build ${build})
endforeach()
run(${BINARY_DIR}/consume/consumer/consumer)
run(${prefix}/bin/tetropolis --version)
run(${prefix}/bin/tetropolis synth --kind blocks --size 300 --seed 3 --out ${city} --quiet)
run(${BINARY_DIR}/consume/build_and_mesh/build_and_mesh
  ${city}/footprints.shp ${city} ${city}/volume.vtu)
run(${prefix}/bin/tetropolis check ${city}/volume.vtu)
