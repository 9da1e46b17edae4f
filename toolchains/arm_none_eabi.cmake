# Bare-metal Cortex-M with GCC or Clang and newlib's headers; variables: bare_metal.cmake.
set(CAIRN_TARGET_TOOLS arm-none-eabi)
include(${CMAKE_CURRENT_LIST_DIR}/bare_metal.cmake)
