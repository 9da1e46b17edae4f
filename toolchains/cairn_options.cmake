# Build options shared by every target of the project.
#
# cairn_numerics: what makes results equal to the bit on every compiler and CPU. PUBLIC for users of
# the core, because its headers hold code. cairn_warnings: our own code only.

add_library(cairn_numerics INTERFACE)
target_compile_options(cairn_numerics INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off -fno-fast-math -fno-math-errno>)
target_compile_definitions(cairn_numerics INTERFACE
  EIGEN_DONT_VECTORIZE EIGEN_MAX_ALIGN_BYTES=0 EIGEN_DONT_PARALLELIZE EIGEN_NO_IO EIGEN_MPL2_ONLY
  EIGEN_STACK_ALLOCATION_LIMIT=0
  $<$<STREQUAL:${CMAKE_SYSTEM_NAME},Generic>:EIGEN_NO_DEBUG>)  # its assertions need stdio, and that a heap

add_library(cairn_warnings INTERFACE)
target_compile_options(cairn_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wcast-align -Wundef
  $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor -Wold-style-cast -Woverloaded-virtual>
  # Notes on 32-bit Arm that GCC 7.1 passes some arguments otherwise than GCC 6.
  $<$<CXX_COMPILER_ID:GNU>:-Wno-psabi>)
if(CAIRN_WERROR)
  target_compile_options(cairn_warnings INTERFACE -Werror)
endif()

# cairn_bare_metal: what the boards of toolchains/ add. Heap calls are compile errors, and GCC writes the
# call graph with stack sizes that tests/gates read.
add_library(cairn_bare_metal INTERFACE)
if(CAIRN_BARE_METAL)
  target_compile_options(cairn_bare_metal INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:SHELL:-include ${CMAKE_CURRENT_LIST_DIR}/no_heap.h>)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES Clang)
    target_compile_options(cairn_bare_metal INTERFACE -fcallgraph-info=su)
    # A compiler cache keeps the objects alone and would lose the call graph beside them.
    set(CMAKE_C_COMPILER_LAUNCHER "")
    set(CMAKE_CXX_COMPILER_LAUNCHER "")
  endif()
endif()

# cairn_compile_sooner(): for what a folder compiles from here on, -O2 in the place of -O3, which takes the compiler a
# quarter to a third more time and is worth it in the core alone.
macro(cairn_compile_sooner)
  if(CMAKE_CXX_FLAGS_RELEASE MATCHES "-O3")
    add_compile_options($<$<CONFIG:Release>:-O2>)
  endif()
endmacro()

# cairn_compile_as_core(TARGET...): with the core's level after all, what measures the cost of the core's templates.
function(cairn_compile_as_core)
  if(NOT CMAKE_CXX_FLAGS_RELEASE MATCHES "-O3")
    return()
  endif()
  foreach(target ${ARGN})
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O3>)
  endforeach()
endfunction()

# cairn_precompile(LIBRARY HEADERS ... LIBRARIES ...): headers that many sources include, compiled once: most of a small
# source's compile time. With CAIRN_UNITY_BUILD alone: compiler caches miss what follows precompiled headers, unless
# they are told better.
function(cairn_precompile library)
  if(CAIRN_UNITY_BUILD AND NOT TARGET ${library})
    cmake_parse_arguments(arg "" "" "HEADERS;LIBRARIES" ${ARGN})
    add_library(${library} OBJECT ${PROJECT_SOURCE_DIR}/toolchains/precompiled.cpp)
    target_link_libraries(${library} PRIVATE ${arg_LIBRARIES} cairn_warnings)
    target_precompile_headers(${library} PRIVATE ${arg_HEADERS})
  endif()
endfunction()

if(CAIRN_SANITIZE)
  add_compile_options(-fsanitize=${CAIRN_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${CAIRN_SANITIZE})
endif()
