# SPDX-License-Identifier: BSD-3-Clause

# Headers parsed once instead of in every file, which takes half the time of a build; a file still includes what it uses.
# A target of its own compiles them, since a macro that is defined here must be defined wherever they are used.
set(ADIT_COMMON_HEADERS <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <cmath> <functional> <limits> <map> <optional>
    <span> <string> <vector>)
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/common.cpp CONTENT "")
add_library(adit_common OBJECT ${CMAKE_BINARY_DIR}/common.cpp)
target_link_libraries(adit_common PRIVATE Eigen3::Eigen)
target_precompile_headers(adit_common PRIVATE ${ADIT_COMMON_HEADERS})

# A room of the house: one static library, headers included as "<room>/<name>.h".
#   adit_room(sensors FILES sick.cpp sweep.cpp USES base rays HIDES embree)
# USES: rooms whose headers ours include; HIDES: foreign targets that no header of ours shows.
function(adit_room name)
  cmake_parse_arguments(ROOM "" "" "FILES;USES;HIDES" ${ARGN})
  add_library(adit_${name} STATIC ${ROOM_FILES})
  target_include_directories(adit_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(adit_${name} PUBLIC Eigen3::Eigen)
  target_precompile_headers(adit_${name} REUSE_FROM adit_common)
  foreach(used ${ROOM_USES})
    target_link_libraries(adit_${name} PUBLIC adit_${used})
  endforeach()
  foreach(hidden ${ROOM_HIDES})
    target_link_libraries(adit_${name} PRIVATE ${hidden})
  endforeach()
endfunction()

# A program that rooms' headers and foreign targets are open to.
#   adit_program(test_sensors COMMON adit_support FILES test_sick.cpp USES sensors HIDES nlohmann_json::nlohmann_json)
# COMMON: the target whose precompiled headers it uses.
function(adit_program name)
  cmake_parse_arguments(PROGRAM "" "COMMON" "FILES;USES;HIDES" ${ARGN})
  add_executable(${name} ${PROGRAM_FILES})
  target_precompile_headers(${name} REUSE_FROM ${PROGRAM_COMMON})
  list(TRANSFORM PROGRAM_USES PREPEND adit_)
  target_link_libraries(${name} PRIVATE ${PROGRAM_USES} ${PROGRAM_HIDES})
endfunction()

# The tests of one room: one program, each test registered with ctest under the room's name; with SUITES each of these is one
# test, and what is of none of them another: for suites whose tests share one costly start.
#   adit_tests(sensors FILES test_sick.cpp USES sensors HIDES nlohmann_json::nlohmann_json)
function(adit_tests name)
  cmake_parse_arguments(ROOM "" "" "FILES;USES;HIDES;SUITES" ${ARGN})
  adit_program(test_${name} COMMON adit_support FILES ${ROOM_FILES} USES ${ROOM_USES}
               HIDES ${ROOM_HIDES} GTest::gtest_main GTest::gmock)
  if(ROOM_SUITES)
    foreach(suite ${ROOM_SUITES})
      add_test(NAME ${name}.${suite} COMMAND test_${name} --gtest_filter=${suite}.*)
    endforeach()
    list(JOIN ROOM_SUITES ".*:" others)
    add_test(NAME ${name}.others COMMAND test_${name} --gtest_filter=-${others}.*)
    list(TRANSFORM ROOM_SUITES PREPEND ${name}. OUTPUT_VARIABLE long)
    set_tests_properties(${long} ${name}.others PROPERTIES COST 100)  # begun first, the short ones fill what is left
  else()
    gtest_discover_tests(test_${name} TEST_PREFIX ${name}. DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 900)
  endif()
endfunction()
