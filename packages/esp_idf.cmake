# Cairn as a component of ESP-IDF: included by the project's CMakeLists.txt where ESP_PLATFORM is set.
# The component's menu is not used: CAIRN_C_CONFIG (default, tiny or large) is a CMake variable.
file(GLOB_RECURSE cairn_sources ${CMAKE_CURRENT_LIST_DIR}/../core/src/*.cpp)
idf_component_register(SRCS ${cairn_sources} INCLUDE_DIRS core/include REQUIRES eigen)
target_compile_options(${COMPONENT_LIB} PUBLIC
  $<$<COMPILE_LANGUAGE:CXX>:-std=gnu++17 -ffp-contract=off -fno-fast-math -fno-math-errno>)
target_compile_definitions(${COMPONENT_LIB} PUBLIC
  EIGEN_DONT_VECTORIZE EIGEN_MAX_ALIGN_BYTES=0 EIGEN_DONT_PARALLELIZE EIGEN_NO_IO EIGEN_MPL2_ONLY
  EIGEN_STACK_ALLOCATION_LIMIT=0 EIGEN_NO_DEBUG)
if(CAIRN_C_CONFIG STREQUAL tiny)
  target_compile_definitions(${COMPONENT_LIB} PUBLIC CAIRN_CONFIG_TINY)
elseif(CAIRN_C_CONFIG STREQUAL large)
  target_compile_definitions(${COMPONENT_LIB} PUBLIC CAIRN_CONFIG_LARGE)
endif()
