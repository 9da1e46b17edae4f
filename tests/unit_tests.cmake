# cairn_test(NAME SOURCES ... [LIBRARIES ...]): a GoogleTest program of the host, run by ctest as NAME.
# Boards leave it out.
function(cairn_test name)
  if(CAIRN_BARE_METAL)
    return()
  endif()
  cmake_parse_arguments(arg "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests/support)
  target_link_libraries(${name} PRIVATE cairn::core cairn_warnings GTest::gtest_main ${arg_LIBRARIES})
  cairn_precompile(cairn_test_headers
    HEADERS <gtest/gtest.h> <Eigen/Core> <Eigen/Dense> LIBRARIES cairn::core GTest::gtest_main)
  if(TARGET cairn_test_headers)
    target_precompile_headers(${name} REUSE_FROM cairn_test_headers)
  endif()
  add_test(NAME ${name} COMMAND ${name})
endfunction()

# cairn_unit_test(NAME SOURCES ... BOARDS SET [INCLUDES ...]): the same program on the host and, over a small
# stand-in for GoogleTest, on boards. SET says on which:
#   quick        every board, in every build
#   all          every board, in builds with CAIRN_ALL_UNIT_TESTS
#   double       of these, boards with double-precision hardware: much in double, minutes by software
#   large        of these, boards with 4 MB of memory
#   fixed        of these, all; boards in fixed point (CAIRN_FIXED_POINT_ALONE) have these and `fixed-quick` alone
#   fixed-quick  the same, there in every build
#   cortex-m7    of these, one board: hundreds of frames, minutes under emulation; replays compare the others
function(cairn_unit_test name)
  cmake_parse_arguments(arg "" "BOARDS" "SOURCES;INCLUDES" ${ARGN})
  if(NOT arg_BOARDS MATCHES "^(quick|all|double|large|fixed|fixed-quick|cortex-m7)$")
    message(FATAL_ERROR "${name}: BOARDS '${arg_BOARDS}' is none of quick, all, double, large, fixed, fixed-quick, cortex-m7")
  endif()
  if(CAIRN_FIXED_POINT_ALONE AND NOT arg_BOARDS MATCHES "^fixed")
    return()
  endif()
  if(CAIRN_BARE_METAL)
    cairn_on_this_board(${arg_BOARDS} wanted)
    if(NOT wanted)
      return()
    endif()
    cairn_board_test(${name} ${arg_SOURCES})
  else()
    cairn_test(${name} SOURCES ${arg_SOURCES})
  endif()
  target_include_directories(${name} PRIVATE ${arg_INCLUDES})
endfunction()

# cairn_use_built_trackers(TARGET...): the trackers of cairn_host_trackers in the place of the target's own instances
# of the same templates, which take two thirds of its compile time. Nothing where the host simulation is not built.
function(cairn_use_built_trackers)
  if(NOT TARGET cairn_host_trackers)
    return()
  endif()
  set(trackers ${PROJECT_SOURCE_DIR}/host_sim/replay/core_trackers.hpp)
  cairn_precompile(cairn_tracker_headers HEADERS ${trackers} LIBRARIES cairn_host_trackers)
  foreach(target ${ARGN})
    target_link_libraries(${target} PRIVATE cairn_host_trackers)
    if(TARGET cairn_tracker_headers)
      set_target_properties(${target} PROPERTIES PRECOMPILE_HEADERS_REUSE_FROM cairn_tracker_headers)
    else()
      target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:SHELL:-include ${trackers}>)
    endif()
  endforeach()
endfunction()

function(cairn_on_this_board set result)
  set(wanted ${CAIRN_ALL_UNIT_TESTS})
  if(set STREQUAL quick OR (CAIRN_FIXED_POINT_ALONE AND set STREQUAL fixed-quick))
    set(wanted ON)
  elseif(set STREQUAL double AND NOT CAIRN_TARGET_HAS_DOUBLE)
    set(wanted OFF)
  elseif(set STREQUAL large AND NOT CAIRN_BOARD_RAM_BYTES STREQUAL 4M)
    set(wanted OFF)
  elseif(set STREQUAL cortex-m7 AND (NOT CMAKE_SYSTEM_PROCESSOR STREQUAL cortex-m7 OR CAIRN_TARGET_CLANG))
    set(wanted OFF)
  endif()
  set(${result} ${wanted} PARENT_SCOPE)
endfunction()
