# Cortex-M0+, without an FPU and a product of 64 bits, as in RP2040 and STM32G0. QEMU has no such board with enough
# memory: the program runs on the Cortex-M3 of mps2-an385, whose instructions are a superset, with the trap for
# unaligned accesses on.
set(CMAKE_SYSTEM_PROCESSOR cortex-m0plus)
set(CAIRN_TARGET_CPU_FLAGS "-mcpu=cortex-m0plus -mthumb -mfloat-abi=soft")
include(${CMAKE_CURRENT_LIST_DIR}/mps2_without_fpu.cmake)
