# SPDX-License-Identifier: BSD-3-Clause

# A room of the house: one static library, headers included as "<room>/<name>.h".
#   adit_room(sensors FILES sick.cpp sweep.cpp USES base rays HIDES embree)
# USES: rooms whose headers ours include; HIDES: foreign targets that no header of ours shows.
function(adit_room name)
  cmake_parse_arguments(ROOM "" "" "FILES;USES;HIDES" ${ARGN})
  add_library(adit_${name} STATIC ${ROOM_FILES})
  target_include_directories(adit_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(adit_${name} PUBLIC Eigen3::Eigen)
  foreach(used ${ROOM_USES})
    target_link_libraries(adit_${name} PUBLIC adit_${used})
  endforeach()
  foreach(hidden ${ROOM_HIDES})
    target_link_libraries(adit_${name} PRIVATE ${hidden})
  endforeach()
endfunction()

# The tests of one room: one program, each test registered with ctest under the room's name; with WHOLE the program is one
# test, for suites whose tests share one costly start.
#   adit_tests(sensors FILES test_sick.cpp USES sensors HIDES nlohmann_json::nlohmann_json)
function(adit_tests name)
  cmake_parse_arguments(ROOM "WHOLE" "" "FILES;USES;HIDES" ${ARGN})
  add_executable(test_${name} ${ROOM_FILES})
  foreach(used ${ROOM_USES})
    target_link_libraries(test_${name} PRIVATE adit_${used})
  endforeach()
  target_link_libraries(test_${name} PRIVATE ${ROOM_HIDES} GTest::gtest_main GTest::gmock)
  if(ROOM_WHOLE)
    add_test(NAME ${name} COMMAND test_${name})
  else()
    gtest_discover_tests(test_${name} TEST_PREFIX ${name}. DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 900)
  endif()
endfunction()
