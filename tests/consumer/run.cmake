# SPDX-License-Identifier: GPL-3.0-or-later
#
# cmake -D SOURCE= -D BUILD= -D WORK= -D VERSION= -D COMPILER= -D CONFIG= -D FLAGS= -P run.cmake
# Installs the runtime into an empty folder, moves the folder (nothing may remember where it was), builds two
# outside projects against it, runs them, and asks pkg-config as well.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed (${status}): ${ARGN}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --config ${CONFIG} --component runtime --prefix ${WORK}/first)
file(RENAME ${WORK}/first ${WORK}/installed)

foreach(project consumer example)
  set(folder ${SOURCE}/tests/consumer)
  if(project STREQUAL "example")
    set(folder ${SOURCE}/runtime/example)
  endif()
  run(${CMAKE_COMMAND} -S ${folder} -B ${WORK}/${project} -DCMAKE_PREFIX_PATH=${WORK}/installed
      -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=${CONFIG} -DCMAKE_CXX_FLAGS=${FLAGS}
      -DSPHERETREE_EXPECTED_VERSION=${VERSION})
  run(${CMAKE_COMMAND} --build ${WORK}/${project} --config ${CONFIG})
endforeach()
run(${WORK}/consumer/consumer)
if(NOT output STREQUAL "spheretree ${VERSION}\n")
  message(FATAL_ERROR "the consumer says: ${output}")
endif()
file(WRITE ${WORK}/ball.sph "1 1\n0 0 0 1 1\n# mesh-diagonal: 3.4641\n# level-0: overhang-worst=[0,0.01]\n")
run(${WORK}/example/two_bodies ${WORK}/ball.sph)
message("${output}")

find_program(pkg_config pkg-config)
if(pkg_config)
  file(GLOB_RECURSE pc ${WORK}/installed/*/spheretree.pc)
  get_filename_component(pc_dir "${pc}" DIRECTORY)
  set(ENV{PKG_CONFIG_PATH} "${pc_dir}")
  run(${pkg_config} --exists "spheretree = ${VERSION}")
  run(${pkg_config} --cflags --libs spheretree)
  separate_arguments(flags UNIX_COMMAND "${output}")
  separate_arguments(own_flags UNIX_COMMAND "${FLAGS}")
  run(${COMPILER} -std=c++20 ${own_flags} ${SOURCE}/tests/consumer/main.cpp -o ${WORK}/by_pkg_config ${flags})
  run(${WORK}/by_pkg_config)
endif()

# Under 200 kB of code and data, as installed for release. The file of the archive also holds what a linker
# needs; the file of a shared library of all of it is weighed for information.
find_program(size size)
find_program(strip strip)
if(size AND strip AND CONFIG STREQUAL "Release" AND NOT FLAGS)
  set(allowed 200000)
  file(GLOB_RECURSE library ${WORK}/installed/*/libspheretree_runtime.a)
  run(${size} -t ${library})
  string(REGEX MATCH "([0-9]+)[ \t]+([0-9]+)[ \t]+[0-9]+[ \t]+[0-9]+[ \t]+[0-9a-f]+[ \t]+\\(TOTALS\\)" total "${output}")
  math(EXPR bytes "${CMAKE_MATCH_1} + ${CMAKE_MATCH_2}")
  message("code and data: ${bytes} bytes")
  set(shared ${WORK}/libspheretree_runtime.so)
  run(${COMPILER} -shared -o ${shared} -Wl,--whole-archive ${library} -Wl,--no-whole-archive)
  run(${strip} ${shared})
  file(SIZE ${shared} file_bytes)
  message("as a stripped shared library: ${file_bytes} bytes")
  if(bytes GREATER allowed)
    message(FATAL_ERROR "${bytes} bytes of code and data in the library; ${allowed} are allowed")
  endif()
endif()
