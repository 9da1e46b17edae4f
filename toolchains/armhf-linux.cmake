# 32-bit Arm under Linux with VFPv3 (Debian's armhf), as in Cortex-A7 to A9 boards.
set(CMAKE_SYSTEM_PROCESSOR armv7l)
set(CAIRN_TARGET_TRIPLE arm-linux-gnueabihf)
set(CAIRN_TARGET_QEMU qemu-arm)
include(${CMAKE_CURRENT_LIST_DIR}/linux_cross.cmake)
