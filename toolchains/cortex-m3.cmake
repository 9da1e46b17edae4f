# Cortex-M3, without an FPU, as in STM32F1 and LPC17; run on QEMU's mps2-an385.
set(CMAKE_SYSTEM_PROCESSOR cortex-m3)
set(CAIRN_TARGET_CPU_FLAGS "-mcpu=cortex-m3 -mthumb -mfloat-abi=soft")
include(${CMAKE_CURRENT_LIST_DIR}/mps2_without_fpu.cmake)
