# 32-bit RISC-V without a floating-point unit (RV32IMC), as in ESP32-C3; run on QEMU's virt. Its builds have what works
# in fixed point; -DCAIRN_FIXED_POINT_ALONE=OFF adds all the rest, in emulated floating point.
set(CMAKE_SYSTEM_PROCESSOR rv32imc)
set(CAIRN_TARGET_CPU_FLAGS "-march=rv32imc -misa-spec=2.2 -mabi=ilp32 -mcmodel=medany -mno-relax")
set(CAIRN_TARGET_HAS_DOUBLE OFF)
set(CAIRN_TARGET_HAS_FLOAT OFF)
set(CAIRN_BOARD_QEMU virt)
set(CAIRN_BOARD_CODE 0x80000000)
set(CAIRN_BOARD_CODE_BYTES 4M)
set(CAIRN_BOARD_RAM 0x80400000)
set(CAIRN_BOARD_RAM_BYTES 4M)
set(CAIRN_BOARD_FRAME_RAM 0x80800000)
set(CAIRN_BOARD_FRAME_RAM_BYTES 16M)
set(CAIRN_BOARD_TIMER_HZ 1000000000U)

# Debian has no C++ library for this target, so the core's headers-only use of it is served by that of the Arm
# toolchain, with newlib's C headers, of the same compiler release. Memory functions and sqrt are picolibc's.
set(CAIRN_TARGET_TOOLS riscv64-unknown-elf)
file(GLOB cairn_cxx_headers /usr/include/newlib/c++/*)
list(GET cairn_cxx_headers -1 cairn_cxx_headers)
set(cairn_c_headers "-isystem /usr/include/newlib")
set(cairn_target_headers "-isystem ${cairn_cxx_headers} -isystem ${cairn_cxx_headers}/arm-none-eabi -isystem /usr/include/newlib")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-L/usr/lib/picolibc/riscv64-unknown-elf/lib/rv32im/ilp32")
include(${CMAKE_CURRENT_LIST_DIR}/bare_metal.cmake)
