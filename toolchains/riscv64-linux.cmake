# 64-bit RISC-V (rv64gc) under Linux.
set(CMAKE_SYSTEM_PROCESSOR riscv64)
set(CAIRN_TARGET_TRIPLE riscv64-linux-gnu)
set(CAIRN_TARGET_QEMU qemu-riscv64)
include(${CMAKE_CURRENT_LIST_DIR}/linux_cross.cmake)
