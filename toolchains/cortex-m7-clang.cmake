# The board of cortex-m7.cmake with Clang as compiler; headers, libraries and linker are those of the
# GNU toolchain.
set(CAIRN_TARGET_CLANG ON)
include(${CMAKE_CURRENT_LIST_DIR}/cortex-m7.cmake)
