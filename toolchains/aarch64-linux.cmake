# 64-bit Arm under Linux, as in Cortex-A53 boards.
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CAIRN_TARGET_TRIPLE aarch64-linux-gnu)
set(CAIRN_TARGET_QEMU qemu-aarch64)
include(${CMAKE_CURRENT_LIST_DIR}/linux_cross.cmake)
