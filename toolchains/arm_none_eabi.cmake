# Bare-metal Cortex-M with GCC and newlib's headers; no start-up files, no libstdc++. Included by the
# files per target, which set:
#   CAIRN_TARGET_CPU_FLAGS   CPU and FPU options
#   CAIRN_BOARD_QEMU         machine of qemu-system-arm that runs the programs
#   CAIRN_BOARD_*            memory and timer of that board (port/cortex_m)
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_C_FLAGS_INIT "${CAIRN_TARGET_CPU_FLAGS}")
set(CMAKE_CXX_FLAGS_INIT "${CAIRN_TARGET_CPU_FLAGS} -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-use-cxa-atexit")
set(CMAKE_CXX_FLAGS_RELEASE_INIT "-O2 -g -DNDEBUG")
set(CMAKE_C_FLAGS_RELEASE_INIT "-O2 -g -DNDEBUG")
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -g -DNDEBUG" CACHE STRING "")
set(CMAKE_C_FLAGS_RELEASE "-O2 -g -DNDEBUG" CACHE STRING "")
set(CMAKE_EXECUTABLE_SUFFIX .elf)
set(CMAKE_EXECUTABLE_SUFFIX_C .elf)
set(CMAKE_EXECUTABLE_SUFFIX_CXX .elf)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_CROSSCOMPILING_EMULATOR ${CMAKE_CURRENT_LIST_DIR}/run_qemu_system.sh ${CAIRN_BOARD_QEMU})
set(CAIRN_BARE_METAL ON)
