# The board of cortex-m7.cmake with Clang as compiler; headers, libraries and linker are those of the
# GNU toolchain. For size: -O2 inlines more, 80 KB of flash for few instructions less.
set(CAIRN_TARGET_CLANG ON)
set(CAIRN_TARGET_OPTIMISATION -Os)
include(${CMAKE_CURRENT_LIST_DIR}/cortex-m7.cmake)
